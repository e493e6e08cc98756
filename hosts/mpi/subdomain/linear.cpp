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

HOL_SUBDOMAIN_CLONES void Subdomain::find_vectors(const double *r) {
    d_.resize(graph_.n_rows);
    accelerations_.resize(graph_.w.size());
    for (int k = 0; k < n_bonds(); ++k)
        d_[k] = box_.between(r + 3 * static_cast<std::size_t>(graph_.bonds[k].from),
                             r + 3 * static_cast<std::size_t>(graph_.bonds[k].to));
    for (const End &end : ends_) d_[end.row] = cut_d_[end.cut];
}

/**
 * What this process's atoms make of a matrix: its diagonal, pairs as Graph::for_pairs gives them, and their transposed.
 * Rows have the vectors of `now`, columns those of the reference: A where both are the same.
 */
HOL_SUBDOMAIN_CLONES void Subdomain::matrix_inside(const std::vector<TwiceVector> &now, std::vector<double> &values,
                                                   std::vector<double> *lower) const {
    values.assign(reference_.inside.n_values(), 0.0);
    for (int atom = 0; atom < n_atoms(); ++atom)
        for (const Graph::At *at = graph_.begin(atom); at != graph_.end(atom); ++at)
            values[at->row] += graph_.w[atom] * plain_dot(now[at->row], d_[at->row]);
    for (int k = 0; k < n_bonds(); ++k)
        if (is_fixed(k)) values[k] = 1;  // no constraint: its right-hand side is 0
    double *pair = values.data() + graph_.n_rows;
    graph_.for_pairs([&](int atom, const Graph::At &a, const Graph::At &b) {
        *pair++ = graph_.w[atom] * a.sign * b.sign * plain_dot(now[a.row], d_[b.row]);
    });
    if (!lower) return;
    lower->resize(values.size() - graph_.n_rows);
    pair = lower->data();
    graph_.for_pairs([&](int atom, const Graph::At &a, const Graph::At &b) {
        *pair++ = graph_.w[atom] * a.sign * b.sign * plain_dot(now[b.row], d_[a.row]);
    });
}

/** Factors of such a matrix, in one sum. x, or NULL: a right-hand side; gives what it makes of the interface's. */
std::vector<double> Subdomain::factorize(Factors &factors, const std::vector<TwiceVector> &now,
                                         const std::vector<double> *x) {
    const bool symmetric = &now == &d_;
    const std::size_t n_values = factors.interface.n_values(), n_lower = symmetric ? 0 : n_values - n_interface_;
    const Failure failure = symmetric
                                ? Failure{HOL_ERR_DEGENERATE, "bonds of a divided molecule depend on each other"}
                                : Failure{HOL_ERR_NO_CONVERGENCE,
                                          "bond lengths of a divided molecule can't be reached from these positions"};
    std::vector<double> all(n_values + n_lower + (x ? n_interface_ : 0), 0.0);
    processes.alone([&] {
        std::vector<double> values, lower;
        matrix_inside(now, values, symmetric ? nullptr : &lower);
        const int bad = factors.inside.factorize(values.data(), symmetric ? nullptr : lower.data());
        if (bad >= 0) throw Failure{failure.status, failure.message + ": " + name_of(bad)};
        for (int k = 0; k < factors.inside.n_rest(); ++k) all[row_of_rest_[k]] += factors.inside.rest_diagonal(k);
        for (std::size_t p = 0; p < pair_of_rest_.size(); ++p) {
            all[pair_of_rest_[p]] += factors.inside.rest_element(p);
            if (!symmetric) all[n_values + pair_of_rest_[p] - n_interface_] += factors.inside.rest_lower(p);
        }
        if (x) gather(factors, *x, all.data() + n_values + n_lower);
    });
    processes.add_up(all);
    for (int k = 0; k < n_cut(); ++k)
        if (cut_is_fixed(k)) all[k] = 1;
    if (factors.interface.factorize(all.data(), symmetric ? nullptr : all.data() + n_values) >= 0) throw failure;
    return {all.begin() + static_cast<std::ptrdiff_t>(n_values + n_lower), all.end()};
}

void Subdomain::factorize(const double *r) {
    factorized_ = false;
    std::vector<double> shared = of_ends({r});
    processes.add_up(shared);
    cut_d_.resize(cut_lengths_.size());
    for (int k = 0; k < n_cut(); ++k)
        cut_d_[k] =
            box_.between(&shared[6 * static_cast<std::size_t>(k)], &shared[6 * static_cast<std::size_t>(k) + 3]);
    processes.alone([&] { find_vectors(r); });
    factorize(reference_, d_, nullptr);
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
void Subdomain::gather(Factors &factors, const std::vector<double> &x, double *sums) {
    factors.inside.forward(x.data());
    for (int k = 0; k < factors.inside.n_rest(); ++k) sums[row_of_rest_[k]] = factors.inside.rest(k);
    ++n_solves_;
}

void Subdomain::scatter(Factors &factors, const double *sums, std::vector<double> &x) {
    for (int k = 0; k < factors.inside.n_rest(); ++k) factors.inside.rest(k) = sums[row_of_rest_[k]];
    factors.inside.backward(x.data());
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

/** Forces and virial of the multipliers t_. A cut bond's virial is its first atom's. */
HOL_SUBDOMAIN_CLONES void Subdomain::pull(Found &found) const {
    found.g.assign(3 * graph_.w.size(), 0.0);
    for (int i = 0; i < n_atoms(); ++i) {
        Four g = {0, 0, 0, 0};
        for (const Graph::At *at = graph_.begin(i); at != graph_.end(i); ++at)
            g -= at->sign * t_[at->row] * d_[at->row].hi;
        for (int c = 0; c < 3; ++c) found.g[3 * i + c] = g[c];
    }
    Four virial[3] = {};
    const auto add = [&](int row) {
        const Four d = d_[row].hi, force = t_[row] * d;
        for (int a = 0; a < 3; ++a) virial[a] -= force[a] * d;
    };
    for (int k = 0; k < n_bonds(); ++k) add(k);
    for (const End &end : ends_)
        if (end.side == 0) add(end.row);
    for (int k = 0; k < 9; ++k) found.virial[k] = virial[k / 3][k % 3];
}

/** What the multipliers do. Not compiled for several processors itself: other files can't call such with all compilers.
 */
void Subdomain::react(Found &found) const {
    pull(found);
    found.lambda.assign(t_.begin(), t_.begin() + n_bonds());
    found.cut_lambda = t_cut_;
    for (std::vector<double> *lambdas : {&found.lambda, &found.cut_lambda})
        for (double &lambda : *lambdas) lambda /= 2;
}

Found Subdomain::solve(const double *v, const double *f, bool with_forces) {
    const std::size_t n = cut_lengths_.size();
    t_.assign(graph_.n_rows, 0.0);
    std::vector<double> shared = of_ends({v, f});
    shared.resize(12 * n + n_interface_, 0.0);
    processes.alone([&] {
        right_hand_sides(v, f, with_forces, t_.data());
        gather(reference_, t_, shared.data() + 12 * n);
    });
    processes.add_up(shared);
    cut_right_hand_sides(shared.data(), with_forces);
    double *solution = shared.data() + 12 * n;
    for (std::size_t k = 0; k < n; ++k) solution[k] += b_cut_[k].hi;
    reference_.interface.solve(solution);
    t_cut_.assign(solution, solution + n);

    dt_.assign(graph_.n_rows, 0.0);
    std::vector<double> parts(4 * n + n_interface_, 0.0);
    processes.alone([&] {
        scatter(reference_, solution, t_);
        residuals(dt_.data(), parts.data());
        gather(reference_, dt_, parts.data() + 4 * n);
    });
    processes.add_up(parts);
    double *correction = parts.data() + 4 * n;
    for (std::size_t k = 0; k < n; ++k) {
        const double *p = parts.data() + 4 * k;
        correction[k] += (b_cut_[k] + Twice{p[0], p[1]} + Twice{p[2], p[3]}).hi;
    }
    reference_.interface.solve(correction);
    for (std::size_t k = 0; k < n; ++k) t_cut_[k] += correction[k];

    Found found;
    double change = 0;
    processes.alone([&] {
        scatter(reference_, correction, dt_);
        change = change_of(dt_);
        for (std::size_t k = 0; k < t_.size(); ++k) t_[k] += dt_[k];
        react(found);
        if (with_forces) return;
        found.v.assign(v, v + 3 * graph_.w.size());
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
    worst[0] = worst[1] = 0;
    const auto take = [&](const double *i, const double *j, const double *vi, const double *vj, double a) {
        const TwiceVector d = box_.between(i, j);
        worst[0] = std::max(worst[0], std::fabs((dot(d, d) - product_of(a, a)).hi) / (a * a));
        if (v) worst[1] = std::max(worst[1], std::fabs(dot(d, rate_of(d, vi, vj)).hi));
    };
    for (int k = 0; k < n_bonds(); ++k) {
        const std::size_t i = 3 * static_cast<std::size_t>(graph_.bonds[k].from),
                          j = 3 * static_cast<std::size_t>(graph_.bonds[k].to);
        if (!is_fixed(k)) take(r + i, r + j, v ? v + i : nullptr, v ? v + j : nullptr, lengths_[k]);
    }
    for (int k = 0; k < n_cut(); ++k) {
        const double *ends = shared.data() + 12 * static_cast<std::size_t>(k);
        if (!cut_is_fixed(k)) take(ends, ends + 6, ends + 3, ends + 9, cut_lengths_[k]);
    }
    for (double *x : {worst, worst + 1}) *x = processes.largest(*x);
}

}  // namespace holonomic_subdomain
