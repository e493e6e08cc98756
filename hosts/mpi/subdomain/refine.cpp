// Refinement: residuals of all bonds in twice the precision, where rounding may be more than the library promises.
#include <cmath>
#include <limits>

#include "subdomain.hpp"

// Products in twice the precision take one instruction more where the processor fuses them, and a call elsewhere.
#if defined(__x86_64__) && defined(__gnu_linux__)
#define HOL_SUBDOMAIN_CLONES __attribute__((target_clones("arch=haswell", "default")))
#else
#define HOL_SUBDOMAIN_CLONES
#endif

namespace holonomic_subdomain {

namespace {

constexpr double eps = std::numeric_limits<double>::epsilon();
constexpr int most_rounds = 6;

}  // namespace

HOL_SUBDOMAIN_CLONES void Subdomain::inner_right_hand_sides(const double *v, const double *f, bool with_forces) {
    d_.resize(lengths_.size());
    b_.resize(lengths_.size());
    for (int k = 0; k < n_bonds(); ++k) {
        double w[2], ends[12] = {0};
        const int atoms[2] = {graph_.bonds[k].from, graph_.bonds[k].to};
        for (int side = 0; side < 2; ++side) {
            w[side] = graph_.w[atoms[side]];
            if (v) std::copy_n(v + 3 * static_cast<std::size_t>(atoms[side]), 3, ends + 6 * side);
            if (f) std::copy_n(f + 3 * static_cast<std::size_t>(atoms[side]), 3, ends + 6 * side + 3);
        }
        d_[k] = bond_vector(k);
        b_[k] = right_hand_side(d_[k], w, ends, ends + 6, with_forces).b;
    }
}

/** rho = b - A t, from the accelerations that the multipliers give each atom. */
HOL_SUBDOMAIN_CLONES void Subdomain::residuals(std::vector<double> &rho, std::vector<double> &parts) {
    accelerations_.assign(graph_.w.size(), {});
    TwiceVector *a = accelerations_.data();
    for (int k = 0; k < graph_.n_bonds(); ++k) {
        add_multiple(a[graph_.bonds[k].from], t_[k], d_[k]);
        add_multiple(a[graph_.bonds[k].to], -t_[k], d_[k]);
    }
    for (const End &end : ends_) add_multiple(a[end.atom], -end.sign() * t_cut_[end.cut], cut_d_[end.cut]);
    for (int i = 0; i < n_atoms(); ++i)
        for (Twice &x : a[i].c) {
            const Twice p = product_of(graph_.w[i], x.hi);
            x = {p.hi, p.lo + graph_.w[i] * x.lo};
        }
    for (int k = 0; k < graph_.n_bonds(); ++k)
        rho[k] = (b_[k] + dot(d_[k], a[graph_.bonds[k].to] - a[graph_.bonds[k].from])).hi;
    parts.assign(4 * cut_lengths_.size(), 0.0);
    for (const End &end : ends_) {
        const Twice part = Twice{end.sign(), 0} * dot(cut_d_[end.cut], a[end.atom]);
        double *to = parts.data() + 4 * static_cast<std::size_t>(end.cut) + 2 * end.side;
        // The right-hand side is known to every process: the owner of the first atom adds it.
        const Twice whole = end.side ? part : part + b_cut_[end.cut].b;
        to[0] = whole.hi, to[1] = whole.lo;
    }
}

/** The largest change of a multiplier, relative to itself and those beside it, and to what its own pull amounts to. */
double Subdomain::change_of(const std::vector<double> &dt, const std::vector<double> &dt_cut) {
    at_atoms_.assign(graph_.w.size(), 0.0);
    std::vector<double> &size = at_atoms_;
    for (int k = 0; k < graph_.n_bonds(); ++k) {
        const double t = std::fabs(t_[k]);
        double &from = size[graph_.bonds[k].from], &to = size[graph_.bonds[k].to];
        from = std::max(from, t), to = std::max(to, t);
    }
    for (const End &end : ends_) size[end.atom] = std::max(size[end.atom], std::fabs(t_cut_[end.cut]));
    double worst = 0;
    const auto take = [&](double change, double around, double b, double diagonal) {
        const double scaled = std::fabs(change) * diagonal, scale = around * diagonal + std::fabs(b);
        if (!(scaled <= worst * scale)) worst = scaled / scale;  // a NaN is taken, and stays
    };
    for (int k = 0; k < graph_.n_bonds(); ++k) {
        const Graph::Bond &bond = graph_.bonds[k];
        const TwiceVector &d = d_[k];
        const double dd = d.c[0].hi * d.c[0].hi + d.c[1].hi * d.c[1].hi + d.c[2].hi * d.c[2].hi;
        take(dt[k], std::max(size[bond.from], size[bond.to]), b_[k].hi, (graph_.w[bond.from] + graph_.w[bond.to]) * dd);
    }
    for (const End &end : ends_)
        take(dt_cut[end.cut], size[end.atom], b_cut_[end.cut].b.hi,
             (cut_w_[2 * end.cut] + cut_w_[2 * end.cut + 1]) * dot(cut_d_[end.cut], cut_d_[end.cut]).hi);
    return worst;
}

/** A dt = rho. parts: those of the cut bonds, [n_cut][2 ends] in twice the precision, each by the end's owner. */
void Subdomain::correct(const std::vector<double> &rho, std::vector<double> &parts, std::vector<double> &dt,
                        std::vector<double> &dt_cut) {
    const std::size_t n = cut_lengths_.size();
    dt.resize(rho.size());
    parts.resize(6 * n, 0.0);
    processes.alone([&] {
        if (chains_) check(hol_solve(chains_.get(), r_.data(), rho.data(), dt.data(), nullptr, HOL_WRITE, nullptr));
        for (double &t : dt) t *= 4;  // Z = 4 A
        ++n_solves_;
        for (const End &end : ends_) parts[4 * n + 2 * end.cut + end.side] = pull_at(end, dt).sum;
    });
    processes.add_up(parts);
    dt_cut.resize(n);
    for (std::size_t k = 0; k < n; ++k) {
        const double *p = parts.data() + 4 * k, *pulls = parts.data() + 4 * n + 2 * k;
        dt_cut[k] = (Twice{p[0], p[1]} + Twice{p[2], p[3]}).hi - (pulls[0] + pulls[1]);
    }
    factors_.solve(dt_cut.data());
    for (int q = 0; q < reach_.n_colours; ++q)
        for (int k = 0; k < n_bonds(); ++k)
            if (reach_.puller[q][k] >= 0) dt[k] -= columns_[q][k] * dt_cut[ends_[reach_.puller[q][k]].cut];
}

/**
 * Multipliers t_, t_cut_ are corrected by what their residuals say. Each round measures the error of the last: when the
 * error left after a round is as much smaller than the change it has made as that was than the change before, and this
 * is below the rounding, the multipliers are proven.
 */
void Subdomain::refine(const double *v, const double *f, bool with_forces) {
    std::vector<double> rho(lengths_.size()), parts, dt, dt_cut;
    processes.alone([&] {
        inner_right_hand_sides(v, f, with_forces);
        for (int q = 0; q < reach_.n_colours; ++q)
            for (int k = 0; k < n_bonds(); ++k)
                if (reach_.puller[q][k] >= 0) t_[k] -= columns_[q][k] * t_cut_[ends_[reach_.puller[q][k]].cut];
    });
    double before = 1;
    for (int round = 0;; ++round) {
        processes.alone([&] { residuals(rho, parts); });
        correct(rho, parts, dt, dt_cut);
        double change = 0;
        processes.alone([&] { change = change_of(dt, dt_cut); });
        change = last_change_ = processes.largest(change);
        ++n_refined_;
        for (std::size_t k = 0; k < t_.size(); ++k) t_[k] += dt[k];
        for (std::size_t k = 0; k < t_cut_.size(); ++k) t_cut_[k] += dt_cut[k];
        if (change <= 4 * eps || change * change <= eps * before) return;
        if (round + 1 == most_rounds || !(change < before / 4))
            throw Failure{HOL_ERR_DEGENERATE,
                          "multipliers of a divided molecule do not come to the rounding: its bonds "
                          "nearly depend on each other"};
        before = change;
    }
}

}  // namespace holonomic_subdomain
