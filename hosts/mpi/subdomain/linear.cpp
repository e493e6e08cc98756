// Forces and velocities: two solutions, of which the second corrects the first.
#include <cmath>
#include <limits>

#include "subdomain.hpp"

namespace holonomic_subdomain {

/** What this process knows of the atoms of cut bonds: three numbers of each array, zeros where it is NULL. */
std::vector<double> Subdomain::of_ends(std::initializer_list<const double *> arrays) const {
    const std::size_t each = 3 * arrays.size();
    std::vector<double> numbers(2 * each * cut_lengths_.size(), 0.0);
    for (const End &end : ends_) {
        double *to = numbers.data() + each * (2 * static_cast<std::size_t>(end.cut) + end.side);
        for (const double *x : arrays) {
            if (x) std::copy_n(x + 3 * static_cast<std::size_t>(end.atom), 3, to);
            to += 3;
        }
    }
    return numbers;
}

HOL_SUBDOMAIN_CLONES void Subdomain::find_vectors() {
    d_.resize(graph_.n_rows);
    accelerations_.resize(graph_.w.size());
    for (int k = 0; k < n_bonds(); ++k)
        d_[k] = box_.between(&r_[3 * static_cast<std::size_t>(graph_.bonds[k].from)],
                             &r_[3 * static_cast<std::size_t>(graph_.bonds[k].to)]);
    for (const End &end : ends_) d_[end.row] = cut_d_[end.cut];
}

/** What this process's atoms make of A: its diagonal, then pairs as Graph::for_pairs gives them. */
HOL_SUBDOMAIN_CLONES void Subdomain::matrix_inside(std::vector<double> &values) const {
    values.assign(inside_.n_values(), 0.0);
    for (int atom = 0; atom < n_atoms(); ++atom)
        for (const Graph::At *at = graph_.begin(atom); at != graph_.end(atom); ++at)
            values[at->row] += graph_.w[atom] * plain_dot(d_[at->row], d_[at->row]);
    for (int k = 0; k < n_bonds(); ++k)
        if (is_fixed(k)) values[k] = 1;  // no constraint: its right-hand side is 0
    double *pair = values.data() + graph_.n_rows;
    graph_.for_pairs([&](int atom, const Graph::At &a, const Graph::At &b) {
        *pair++ = graph_.w[atom] * a.sign * b.sign * plain_dot(d_[a.row], d_[b.row]);
    });
}

void Subdomain::factorize(const double *r) {
    factorized_ = false;
    r_.assign(r, r + 3 * static_cast<std::size_t>(n_atoms()));
    reference_box_ = box_;
    std::vector<double> shared = of_ends({r});
    processes.add_up(shared);
    cut_d_.resize(cut_lengths_.size());
    for (int k = 0; k < n_cut(); ++k)
        cut_d_[k] =
            box_.between(&shared[6 * static_cast<std::size_t>(k)], &shared[6 * static_cast<std::size_t>(k) + 3]);
    std::vector<double> all(interface_.n_values(), 0.0), values;
    processes.alone([&] {
        find_vectors();
        matrix_inside(values);
        if (!inside_.factorize(values.data()))
            throw Failure{HOL_ERR_DEGENERATE, "bonds of a divided molecule depend on each other"};
        for (int k = 0; k < inside_.n_rest(); ++k) all[row_of_rest_[k]] += inside_.rest_diagonal(k);
        for (std::size_t p = 0; p < pair_of_rest_.size(); ++p) all[pair_of_rest_[p]] += inside_.rest_element(p);
    });
    processes.add_up(all);
    for (int k = 0; k < n_cut(); ++k)
        if (cut_is_fixed(k)) all[k] = 1;
    if (!interface_.factorize(all.data()))
        throw Failure{HOL_ERR_DEGENERATE, "bonds of a divided molecule depend on each other"};
    factorized_ = true;
}

/** v_j - v_i, and what the box's rate adds. */
HOL_SUBDOMAIN_INLINE TwiceVector Subdomain::rate_of(const TwiceVector &d, const double *i, const double *j) const {
    TwiceVector u;
    if (i && j) u = difference(j, i);
    for (int x = 0; has_rate_ && x < 3; ++x) {
        const double column[3] = {rate_[x], rate_[3 + x], rate_[6 + x]};
        u = u + multiple(d.hi[x], column);
        u.lo += multiple(d.lo[x], column).hi;
    }
    return u;
}

/** The acceleration level asks for d.a + u.u = 0, the velocity level for d.u = 0. */
HOL_SUBDOMAIN_CLONES void Subdomain::right_hand_sides(const double *v, const double *f, bool with_forces, double *x) {
    b_.assign(lengths_.size(), {});
    for (int i = 0; with_forces && f && i < n_atoms(); ++i)
        accelerations_[i] = multiple(graph_.w[i], f + 3 * static_cast<std::size_t>(i));
    for (int k = 0; k < n_bonds(); ++k) {
        const std::size_t i = graph_.bonds[k].from, j = graph_.bonds[k].to;
        if (is_fixed(k)) continue;
        const TwiceVector u = rate_of(d_[k], v ? v + 3 * i : nullptr, v ? v + 3 * j : nullptr);
        b_[k] = with_forces ? dot(u, u) : dot(d_[k], u);
        if (with_forces && f) b_[k] = b_[k] + dot(d_[k], accelerations_[j] - accelerations_[i]);
        x[k] = b_[k].hi;
    }
}

/** The same of cut bonds, from velocities and forces of either atom. */
void Subdomain::cut_right_hand_sides(const double *shared, bool with_forces) {
    b_cut_.assign(cut_lengths_.size(), {});
    for (int k = 0; k < n_cut(); ++k, shared += 12) {
        if (cut_is_fixed(k)) continue;
        const TwiceVector u = rate_of(cut_d_[k], shared, shared + 6);
        const TwiceVector a = multiple(cut_w_[2 * k + 1], shared + 9) - multiple(cut_w_[2 * k], shared + 3);
        b_cut_[k] = with_forces ? dot(cut_d_[k], a) + dot(u, u) : dot(cut_d_[k], u);
    }
}

/** rho = b - A t, from the accelerations that the multipliers give each atom; parts: d.a of cut bonds at either atom.
 */
HOL_SUBDOMAIN_CLONES void Subdomain::residuals(double *rho, double *parts) {
    for (int i = 0; i < n_atoms(); ++i) {
        TwiceVector sum;
        for (const Graph::At *at = graph_.begin(i); at != graph_.end(i); ++at)
            sum = sum + (-at->sign * t_[at->row]) * d_[at->row];
        accelerations_[i] = graph_.w[i] * sum;
    }
    for (int k = 0; k < n_bonds(); ++k)
        rho[k] =
            is_fixed(k)
                ? 0
                : (b_[k] + dot(d_[k], accelerations_[graph_.bonds[k].to] - accelerations_[graph_.bonds[k].from])).hi;
    for (const End &end : ends_) {
        const Twice part = dot(d_[end.row], accelerations_[end.atom]);
        double *to = parts + 4 * static_cast<std::size_t>(end.cut) + 2 * end.side;
        to[0] = end.sign() * part.hi, to[1] = end.sign() * part.lo;
        rho[end.row] = 0;
    }
}

/** Eliminates what is inside, and gives what that makes of the interface's right-hand side. */
void Subdomain::gather(const std::vector<double> &x, double *sums) {
    inside_.forward(x.data());
    for (int k = 0; k < inside_.n_rest(); ++k) sums[row_of_rest_[k]] = inside_.rest(k);
    ++n_solves_;
}

void Subdomain::scatter(const double *sums, std::vector<double> &x) {
    for (int k = 0; k < inside_.n_rest(); ++k) inside_.rest(k) = sums[row_of_rest_[k]];
    inside_.backward(x.data());
}

/** The largest change of a multiplier, relative to itself and those beside it, and to what its own pull amounts to. */
HOL_SUBDOMAIN_CLONES double Subdomain::change_of(const std::vector<double> &dt) {
    at_atoms_.assign(graph_.w.size(), 0.0);
    for (int i = 0; i < n_atoms(); ++i)
        for (const Graph::At *at = graph_.begin(i); at != graph_.end(i); ++at)
            at_atoms_[i] = std::max(at_atoms_[i], std::fabs(t_[at->row]));
    double worst = 0;
    const auto take = [&](double change, double around, double b, double w, const TwiceVector &d) {
        const double diagonal = w * plain_dot(d, d);
        const double scaled = std::fabs(change) * diagonal, scale = around * diagonal + std::fabs(b);
        if (!(scaled <= worst * scale)) worst = scaled / scale;  // a NaN is taken, and stays
    };
    for (int k = 0; k < n_bonds(); ++k) {
        const Graph::Bond &bond = graph_.bonds[k];
        take(dt[k], std::max(at_atoms_[bond.from], at_atoms_[bond.to]), b_[k].hi,
             graph_.w[bond.from] + graph_.w[bond.to], d_[k]);
    }
    for (const End &end : ends_)
        take(dt[end.row], at_atoms_[end.atom], b_cut_[end.cut].hi, cut_w_[2 * end.cut] + cut_w_[2 * end.cut + 1],
             d_[end.row]);
    return worst;
}

Found Subdomain::solve(const double *v, const double *f, bool with_forces) {
    const std::size_t n = cut_lengths_.size();
    t_.assign(graph_.n_rows, 0.0);
    std::vector<double> shared = of_ends({v, f});
    shared.resize(12 * n + n_interface_, 0.0);
    processes.alone([&] {
        right_hand_sides(v, f, with_forces, t_.data());
        gather(t_, shared.data() + 12 * n);
    });
    processes.add_up(shared);
    cut_right_hand_sides(shared.data(), with_forces);
    double *solution = shared.data() + 12 * n;
    for (std::size_t k = 0; k < n; ++k) solution[k] += b_cut_[k].hi;
    interface_.solve(solution);
    t_cut_.assign(solution, solution + n);

    dt_.assign(graph_.n_rows, 0.0);
    std::vector<double> parts(4 * n + n_interface_, 0.0);
    processes.alone([&] {
        scatter(solution, t_);
        residuals(dt_.data(), parts.data());
        gather(dt_, parts.data() + 4 * n);
    });
    processes.add_up(parts);
    double *correction = parts.data() + 4 * n;
    for (std::size_t k = 0; k < n; ++k) {
        const double *p = parts.data() + 4 * k;
        correction[k] += (b_cut_[k] + Twice{p[0], p[1]} + Twice{p[2], p[3]}).hi;
    }
    interface_.solve(correction);
    for (std::size_t k = 0; k < n; ++k) t_cut_[k] += correction[k];

    Found found;
    double change = 0;
    processes.alone([&] {
        scatter(correction, dt_);
        change = change_of(dt_);
        for (std::size_t k = 0; k < t_.size(); ++k) t_[k] += dt_[k];
        react(found);
        if (with_forces) return;
        found.v.assign(v, v + r_.size());
        for (int i = 0; i < n_atoms(); ++i)
            for (int c = 3 * i; c < 3 * i + 3; ++c) found.v[c] += graph_.w[i] * found.g[c];
    });
    // The correction has measured the error of the first solution; its own is as much smaller again.
    last_change_ = processes.largest(change);
    if (!(last_change_ * last_change_ <= std::numeric_limits<double>::epsilon()))
        throw Failure{HOL_ERR_DEGENERATE,
                      "multipliers of a divided molecule do not come to the rounding: its bonds "
                      "nearly depend on each other"};
    return found;
}

Found Subdomain::forces(const double *v, const double *f) { return solve(v, f, true); }

Found Subdomain::velocities(const double *v) { return solve(v, nullptr, false); }

void Subdomain::violation(const double *r, const double *v, double *worst) {
    std::vector<double> shared = of_ends({r, v});
    processes.add_up(shared);
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
        if (cut_is_fixed(k)) continue;
        worst[0] = std::max(worst[0], std::fabs((dot(d, d) - product_of(a, a)).hi) / (a * a));
        if (v) worst[1] = std::max(worst[1], std::fabs(dot(d, rate_of(d, ends + 3, ends + 9)).hi));
    }
    for (double *x : {worst, worst + 1}) *x = processes.largest(*x);
}

/** What the multipliers t_ do. A cut bond's virial is its first atom's. */
HOL_SUBDOMAIN_CLONES void Subdomain::react(Found &found) const {
    found.g.assign(r_.size(), 0.0);
    for (int i = 0; i < n_atoms(); ++i) {
        Four g = {0, 0, 0, 0};
        for (const Graph::At *at = graph_.begin(i); at != graph_.end(i); ++at)
            g -= at->sign * t_[at->row] * d_[at->row].hi;
        for (int c = 0; c < 3; ++c) found.g[3 * i + c] = g[c];
    }
    Four virial[3] = {};
    const auto add = [&](int row) {
        const Four &d = d_[row].hi, force = t_[row] * d;
        for (int a = 0; a < 3; ++a) virial[a] -= force[a] * d;
    };
    for (int k = 0; k < n_bonds(); ++k) add(k);
    for (const End &end : ends_)
        if (end.side == 0) add(end.row);
    for (int k = 0; k < 9; ++k) found.virial[k] = virial[k / 3][k % 3];
    found.lambda.assign(t_.begin(), t_.begin() + n_bonds());
    found.cut_lambda = t_cut_;
    for (std::vector<double> *lambdas : {&found.lambda, &found.cut_lambda})
        for (double &lambda : *lambdas) lambda /= 2;
}

}  // namespace holonomic_subdomain
