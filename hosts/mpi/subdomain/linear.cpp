// Forces and velocities: the interface's equations between two calls of the library.
#include <cmath>
#include <limits>

#include "subdomain.hpp"

namespace holonomic_subdomain {

/** All processes get what their owners know of the atoms of cut bonds: three numbers of x. */
void Subdomain::share(const double *x, std::vector<double> &shared) {
    shared.assign(6 * cut_lengths_.size(), 0.0);
    for (const End &end : ends_)
        std::copy_n(x + 3 * static_cast<std::size_t>(end.atom), 3,
                    shared.data() + 3 * (2 * static_cast<std::size_t>(end.cut) + end.side));
    processes.add_up(shared);
}

/** The same with three numbers of x, then of y; what is NULL is zero. */
void Subdomain::share(const double *x, const double *y, std::vector<double> &shared) {
    shared.assign(12 * cut_lengths_.size(), 0.0);
    for (const End &end : ends_) {
        double *to = shared.data() + 6 * (2 * static_cast<std::size_t>(end.cut) + end.side);
        if (x) std::copy_n(x + 3 * static_cast<std::size_t>(end.atom), 3, to);
        if (y) std::copy_n(y + 3 * static_cast<std::size_t>(end.atom), 3, to + 3);
    }
    processes.add_up(shared);
}

TwiceVector Subdomain::bond_vector(int bond) const {
    return reference_box_.between(&r_[3 * static_cast<std::size_t>(graph_.bonds[bond].from)],
                                  &r_[3 * static_cast<std::size_t>(graph_.bonds[bond].to)]);
}

/** An end's part of A_CI t. */
Subdomain::Pull Subdomain::pull_at(const End &end, const std::vector<double> &t) const {
    Pull pull{0, 0};
    const double factor = end.sign() * graph_.w[end.atom];
    for (const Graph::At *at = graph_.begin(end.atom); at != graph_.end(end.atom); ++at) {
        const double term = factor * at->sign * t[at->bond] * dot(cut_d_[end.cut], bond_vector(at->bond)).hi;
        pull.sum += term, pull.size += std::fabs(term);
    }
    return pull;
}

/** What multipliers of cut bonds do: x += G on their atoms, or w G. */
void Subdomain::pull(std::vector<double> &x, const std::vector<double> &t_cut, bool with_masses) const {
    for (const End &end : ends_)
        for (int c = 0; c < 3; ++c)
            x[3 * static_cast<std::size_t>(end.atom) + c] -=
                (with_masses ? graph_.w[end.atom] : 1.0) * end.sign() * t_cut[end.cut] * cut_d_[end.cut].c[c].hi;
}

void Subdomain::factorize(const double *r) {
    factorized_ = false;
    r_.assign(r, r + 3 * static_cast<std::size_t>(n_atoms()));
    reference_box_ = box_;
    std::vector<double> shared;
    share(r, shared);
    cut_d_.resize(cut_lengths_.size());
    for (int k = 0; k < n_cut(); ++k) {
        const double *ends = shared.data() + 6 * static_cast<std::size_t>(k);
        cut_d_[k] = box_.between(ends, ends + 3);
    }
    // Elements, and the sums of their terms in absolute values
    std::vector<double> values(2 * static_cast<std::size_t>(n_entries_), 0.0);
    processes.alone([&] {
        find_columns();
        for (int q = 0; q < reach_.n_colours; ++q)
            for (int c = reach_.first_coupling[q]; c < reach_.first_coupling[q + 1]; ++c) {
                if (entry_[c] < 0) continue;
                const End &from = ends_[reach_.couplings[c].from], &to = ends_[reach_.couplings[c].to];
                double sum = 0, size = 0;
                const auto add = [&](double term) { sum += term, size += std::fabs(term); };
                if (from.atom == to.atom) add(from.sign() * dot(cut_d_[to.cut], cut_d_[from.cut]).hi);
                for (const Graph::At *at = graph_.begin(to.atom); at != graph_.end(to.atom); ++at)
                    if (reach_.puller[q][at->bond] == reach_.couplings[c].from)
                        add(-at->sign * columns_[q][at->bond] * dot(cut_d_[to.cut], bond_vector(at->bond)).hi);
                values[entry_[c]] += to.sign() * graph_.w[to.atom] * sum;
                values[n_entries_ + entry_[c]] += graph_.w[to.atom] * size;
            }
    });
    processes.add_up(values);
    for (int k = 0; k < n_cut(); ++k)
        if (cut_w_[2 * k] == 0 && cut_w_[2 * k + 1] == 0) values[k] = 1;  // no constraint: its right-hand side is 0
    if (!factors_.factorize(values.data()))
        throw Failure{HOL_ERR_DEGENERATE, "bonds of a divided molecule depend on each other"};
    diagonal_.assign(values.begin(), values.begin() + n_cut());
    size_.assign(values.begin() + n_entries_, values.end());
    for (int e = n_cut(); e < n_entries_; ++e) values[e] = -std::fabs(values[e]);
    bounded_ = exact_ && comparison_.factorize(values.data());
    factorized_ = true;
}

/** What the interface pulls inside: A_II^-1 A_IC, ends of one colour together. */
void Subdomain::find_columns() {
    columns_.resize(reach_.n_colours);
    if (!chains_) return;
    check(hol_chains_set_reference_box(chains_.get(), nullptr));
    check(hol_chains_set_box(chains_.get(), box_.rows()));
    check(hol_chains_set_box_rate(chains_.get(), nullptr));
    std::vector<double> f(r_.size(), 0.0);
    for (int q = 0; q < reach_.n_colours; ++q) {
        std::vector<double> &column = columns_[q];
        column.resize(lengths_.size());
        for (int e : reach_.of_colour[q])
            for (int c = 0; c < 3; ++c)
                f[3 * static_cast<std::size_t>(ends_[e].atom) + c] += ends_[e].sign() * cut_d_[ends_[e].cut].c[c].hi;
        check(hol_forces(chains_.get(), r_.data(), nullptr, f.data(), column.data(), nullptr, nullptr, HOL_WRITE,
                         nullptr));
        ++n_solves_;
        for (double &t : column) t *= 2;
        for (int e : reach_.of_colour[q]) std::fill_n(&f[3 * static_cast<std::size_t>(ends_[e].atom)], 3, 0.0);
    }
}

/** Of the acceleration level, or of the velocity level without f; i, j: velocity and force of either atom. */
Subdomain::RightHandSide Subdomain::right_hand_side(const TwiceVector &d, const double *w, const double *i,
                                                    const double *j, bool with_forces) const {
    if (w[0] == 0 && w[1] == 0) return {{}, 0};
    TwiceVector u = difference(j, i), a{};
    if (has_rate_)
        for (int c = 0; c < 3; ++c)
            for (int x = 0; x < 3; ++x) u.c[c] = u.c[c] + Twice{rate_[3 * c + x], 0} * d.c[x];
    double size = 0;
    if (!with_forces) {
        for (int c = 0; c < 3; ++c) size += std::fabs(d.c[c].hi) * (std::fabs(i[c]) + std::fabs(j[c]));
        return {dot(d, u), size};
    }
    for (int c = 0; c < 3; ++c) {
        a.c[c] = product_of(w[1], j[3 + c]) - product_of(w[0], i[3 + c]);
        size += std::fabs(d.c[c].hi) * (w[0] * std::fabs(i[3 + c]) + w[1] * std::fabs(j[3 + c]));
    }
    const Twice square = dot(u, u);
    return {dot(d, a) + square, size + square.hi};
}

void Subdomain::cut_right_hand_sides(const double *v, const double *f, bool with_forces) {
    std::vector<double> shared;
    share(v, f, shared);
    b_cut_.resize(cut_lengths_.size());
    for (int k = 0; k < n_cut(); ++k) {
        const double *ends = shared.data() + 12 * static_cast<std::size_t>(k);
        b_cut_[k] = right_hand_side(cut_d_[k], &cut_w_[2 * static_cast<std::size_t>(k)], ends, ends + 6, with_forces);
    }
}

/** t_cut_ from what t_ is without it; gives whether its rounding is no more than what the library promises. */
bool Subdomain::solve_interface() {
    const std::size_t n = cut_lengths_.size();
    std::vector<double> pulls(4 * n, 0.0);
    processes.alone([&] {
        for (const End &end : ends_) {
            const Pull pull = pull_at(end, t_);
            pulls[4 * static_cast<std::size_t>(end.cut) + 2 * end.side] = pull.sum;
            pulls[4 * static_cast<std::size_t>(end.cut) + 2 * end.side + 1] = pull.size;
        }
    });
    processes.add_up(pulls);
    for (std::size_t k = 0; k < n; ++k) t_cut_[k] = (b_cut_[k].b.hi - pulls[4 * k]) - pulls[4 * k + 2];
    factors_.solve(t_cut_.data());
    if (!bounded_) return false;
    // One rounding of each term that enters, through the inverse's bound, against the promise's scale: of that, the
    // parts of the bond itself and of either end.
    std::vector<double> error(n);
    for (std::size_t k = 0; k < n; ++k)
        error[k] = b_cut_[k].size + pulls[4 * k + 1] + pulls[4 * k + 3] + size_[k] * std::fabs(t_cut_[k]);
    const auto &pairs = factors_.pairs();
    for (std::size_t p = 0; p < pairs.size(); ++p) {
        error[pairs[p][0]] += size_[n + p] * std::fabs(t_cut_[pairs[p][1]]);
        error[pairs[p][1]] += size_[n + p] * std::fabs(t_cut_[pairs[p][0]]);
    }
    comparison_.solve(error.data());
    constexpr double roundings = 16;
    for (std::size_t k = 0; k < n; ++k) {
        const double scale = b_cut_[k].size + std::fabs(pulls[4 * k]) + std::fabs(pulls[4 * k + 2]);
        if (!(error[k] <= roundings * (std::fabs(t_cut_[k]) + scale / diagonal_[k]))) return false;
    }
    return true;
}

/** Multipliers and forces inside, or velocities and impulses, as the library finds them. */
void Subdomain::solve_inside(const double *v, const double *f, Found &found, bool with_forces, bool multipliers_alone) {
    found.lambda.resize(lengths_.size());
    std::fill(found.virial, found.virial + 9, 0.0);
    if (!chains_) return;
    ++n_solves_;
    check(hol_chains_set_box_rate(chains_.get(), has_rate_ ? rate_ : nullptr));
    double *virial = multipliers_alone ? nullptr : found.virial;
    if (with_forces) {
        check(hol_forces(chains_.get(), r_.data(), v, f, found.lambda.data(), nullptr,
                         multipliers_alone ? nullptr : found.g.data(), HOL_ADD, virial));
    } else {
        found.v.assign(v, v + r_.size());
        if (!multipliers_alone) pull(found.v, t_cut_, true);
        check(hol_project_velocities(chains_.get(), r_.data(), found.v.data(), found.lambda.data(), virial));
    }
}

Found Subdomain::solve(const double *v, const double *f, bool with_forces) {
    Found found;
    cut_right_hand_sides(v, f, with_forces);
    processes.alone([&] {
        solve_inside(v, f, found, with_forces, true);
        t_ = found.lambda;
        for (double &t : t_) t *= 2;
    });
    const bool proven = solve_interface();
    if (!proven) refine(v, f, with_forces);
    processes.alone([&] {
        found.g.assign(r_.size(), 0.0);
        if (!proven) {
            react(found);
            if (!with_forces) {
                found.v.assign(v, v + r_.size());
                for (std::size_t k = 0; k < r_.size(); ++k) found.v[k] += graph_.w[k / 3] * found.g[k];
            }
        } else if (with_forces) {
            pull(found.g, t_cut_, false);
            std::vector<double> all = found.g;
            for (std::size_t k = 0; f && k < all.size(); ++k) all[k] += f[k];
            solve_inside(v, all.data(), found, true, false);
        } else {
            if (!chains_) found.v.assign(v, v + r_.size()), pull(found.v, t_cut_, true);
            solve_inside(v, nullptr, found, false, false);
        }
        for (const End &end : ends_)
            if (end.side == 0) add_virial(end.cut, found.virial);
    });
    processes.largest(0);  // whether all are through
    found.cut_lambda = t_cut_;
    for (double &lambda : found.cut_lambda) lambda /= 2;
    return found;
}

Found Subdomain::forces(const double *v, const double *f) { return solve(v, f, true); }

Found Subdomain::velocities(const double *v) { return solve(v, nullptr, false); }

void Subdomain::violation(const double *r, const double *v, double *worst) {
    std::vector<double> shared;
    share(r, v, shared);
    hol_worst inside{};
    processes.alone([&] {
        if (!chains_) return;
        check(hol_chains_set_box(chains_.get(), box_.rows()));
        check(hol_chains_set_box_rate(chains_.get(), has_rate_ ? rate_ : nullptr));
        check(hol_violation(chains_.get(), r, v, &inside));
    });
    worst[0] = inside.length, worst[1] = inside.rate;
    for (int k = 0; k < n_cut(); ++k) {
        const double *ends = shared.data() + 12 * static_cast<std::size_t>(k), a = cut_lengths_[k];
        const TwiceVector d = box_.between(ends, ends + 6);
        const double *w = &cut_w_[2 * static_cast<std::size_t>(k)];
        if (w[0] == 0 && w[1] == 0) continue;
        worst[0] = std::max(worst[0], std::fabs((dot(d, d) - product_of(a, a)).hi) / (a * a));
        if (v) worst[1] = std::max(worst[1], std::fabs(right_hand_side(d, w, ends + 3, ends + 9, false).b.hi));
    }
    for (double *x : {worst, worst + 1}) *x = processes.largest(*x);
}

/** What the multipliers t_ and t_cut_ do. The virial is without cut bonds. */
void Subdomain::react(Found &found) const {
    found.g.assign(r_.size(), 0.0);
    found.lambda.resize(t_.size());
    std::fill(found.virial, found.virial + 9, 0.0);
    for (int k = 0; k < n_bonds(); ++k) {
        const TwiceVector vector = bond_vector(k);
        double *from = &found.g[3 * static_cast<std::size_t>(graph_.bonds[k].from)];
        double *to = &found.g[3 * static_cast<std::size_t>(graph_.bonds[k].to)];
        const double d[3] = {vector.c[0].hi, vector.c[1].hi, vector.c[2].hi};
        for (int a = 0; a < 3; ++a) {
            from[a] += t_[k] * d[a];
            to[a] -= t_[k] * d[a];
            for (int b = 0; b < 3; ++b) found.virial[3 * a + b] -= t_[k] * d[a] * d[b];
        }
        found.lambda[k] = t_[k] / 2;
    }
    pull(found.g, t_cut_, false);
}

void Subdomain::add_virial(int cut, double *virial) const {
    const TwiceVector &d = cut_d_[cut];
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) virial[3 * a + b] -= t_cut_[cut] * d.c[a].hi * d.c[b].hi;
}

}  // namespace holonomic_subdomain
