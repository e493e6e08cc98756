#include "molecule_checks.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>

namespace stress
{

namespace
{

constexpr long double most_farther = 4;

constexpr long double eps = DBL_EPSILON;
// Rings whose bonds depend on each other to the rounding of coordinates, of which a sine is squared, are refused.
constexpr long double ring_limit = 1e-24L;
// Trees are refused where a bond's pivot is below 1e-80 once all others are eliminated, which is one over the condition
// number; the reference's least pivot is that of one order.
constexpr long double tree_limit = 1e80L;
constexpr long double graph_limit = 1e-20L;      // graphs with a pivot below it are promised nothing
constexpr long double any_order_limit = 1e-25L;  // those with one below it in another order may be refused
constexpr long double inverse_limit = 1e-16L;    // nor their inverse below this
constexpr long double inverse_of_tree = 1e-50L;  // nor that of trees
constexpr long double straight_sine2 = 1e-21L;   // triangles below it are straight but for rounding

long double k_eps(const hostile_molecule &m)
{
    return (16 + std::sqrt(static_cast<long double>(m.n_bonds()))) * eps;
}

/** The same for multipliers and forces. Trees take plain products where theory (53a) is at most so many scales. */
long double linear_eps(const hostile_molecule &m)
{
    const long double plain = std::max(64.0L, std::sqrt(static_cast<long double>(m.n_bonds())));
    return k_eps(m) + (m.shape == TREES ? plain * eps : 0);
}

/**
 * What the multipliers may be off by beside K eps times their scale: K eps times 1e-80 of the largest one. They die
 * away as products of many factors. In graphs that elimination has to subtract for, a multiplier that is zero because
 * its atom can't move comes out as the rounding of the residual in twice the precision: there 1e-40.
 */
long double margin(const hostile_molecule &m, const molecule_solution &s, long double bound)
{
    const long double least = m.shape == GRAPHS ? 1e-40L : 1e-80L;
    return bound * least * *std::max_element(s.lambda_scale, s.lambda_scale + s.n_bonds);
}

void check_multipliers(const hostile_molecule &m, const molecule_solution &s, const numbers &lambda,
                       molecule_quantity q, molecule_verdict &out)
{
    const long double k = linear_eps(m), tail = margin(m, s, k);
    for (std::size_t b = 0; b < m.length.size(); ++b)
        out.compare(q, lambda[b], s.lambda[b], k * s.lambda_scale[b] + (s.lambda_scale[b] > 0 ? tail : 0));
}

void check_pulls(const hostile_molecule &m, const molecule_solution &s, const numbers &g, molecule_quantity q,
                 molecule_verdict &out)
{
    const long double k = linear_eps(m),
                      pull = 2 * margin(m, s, k) * *std::max_element(m.length.begin(), m.length.end());
    for (std::size_t i = 0; i < m.r.size(); ++i)
        if (s.g_scale[i / 3] > 0 || !is_blank(g[i]))  // atoms without a constraint are not written
            out.compare(q, g[i], s.g[i], k * s.g_scale[i / 3] + (s.g_scale[i / 3] > 0 ? pull : 0));
}

void check_forces(const hostile_molecule &m, const molecule_reference &exact, const molecule_results &alone,
                  molecule_verdict &out)
{
    const bool kept = alone.kept == HOL_OK;
    if (alone.solve == HOL_OK && exact.solve.there) check_multipliers(m, exact.solve.s, alone.solved, M_SOLVE, out);
    if (kept && exact.solve.there) check_multipliers(m, exact.solve.s, alone.kept_solved, M_KEPT_SOLVE, out);
    if (alone.forces != HOL_OK || !exact.forces.there) return;
    const molecule_solution &s = exact.forces.s;
    check_multipliers(m, s, alone.lambda, M_LAMBDA, out);
    check_pulls(m, s, alone.g, M_FORCE, out);
    for (std::size_t i = 0; i < 9; ++i)
        out.compare(M_VIRIAL, alone.virial[i], s.virial[i], linear_eps(m) * s.virial_scale);
    if (!kept) return;
    check_multipliers(m, s, alone.kept_lambda, M_KEPT, out);
    check_pulls(m, s, alone.kept_g, M_KEPT_FORCE, out);
}

void check_velocities(const hostile_molecule &m, const molecule_reference &exact, const molecule_results &alone,
                      molecule_verdict &out)
{
    if (alone.velocities != HOL_OK || !exact.velocities.there) return;
    const molecule_solution &s = exact.velocities.s;
    check_multipliers(m, s, alone.mu, M_MU, out);
    for (std::size_t i = 0; i < m.r.size(); ++i)
        out.compare(M_VELOCITY, alone.v[i], s.moved[i], k_eps(m) * s.moved_scale[i / 3]);
}

/** The sum of values per molecule, which come per bond. */
long double sum_over_molecules(const numbers &of_bond, const std::vector<std::int64_t> &molecule)
{
    std::vector<bool> seen(of_bond.size(), false);
    long double sum = 0;
    for (std::size_t k = 0; k < of_bond.size(); ++k) {
        if (molecule[k] < 0 || seen[static_cast<std::size_t>(molecule[k])]) continue;
        seen[static_cast<std::size_t>(molecule[k])] = true;
        sum += of_bond[k];
    }
    return sum;
}

struct inverse_deleter {
    void operator()(hol_inverse *i) const
    {
        hol_inverse_destroy(i);
    }
};

/** A few elements of the inverse, if the whole is one molecule with its bonds in the library's order. */
void check_inverse(const placement &a, const hostile_molecule &m, const molecule_metric &exact, molecule_verdict &out)
{
    if (hol_chains_n_molecules(a.chains.get()) != 1) return;
    const std::int64_t n = m.n_bonds();
    std::vector<std::int64_t> order(m.length.size());
    if (std::count(a.molecule_of_bond.begin(), a.molecule_of_bond.end(), 0) != n) return;
    if (hol_chains_bonds(a.chains.get(), 0, order.data()) != HOL_OK) return;
    hol_inverse *made = nullptr;
    const int status = hol_inverse_create(a.chains.get(), 0, a.r.data(), &made);
    const std::unique_ptr<hol_inverse, inverse_deleter> inverse(made);
    out.note(M_REFUSED, status != HOL_OK);
    if (status != HOL_OK) return;
    for (std::int64_t i = 0; i < n; i += 1 + n / 6)
        for (std::int64_t j = 0; j < n; j += 1 + n / 6) {
            const auto at = [&](std::int64_t x, std::int64_t y) {
                return exact.inverse[order[static_cast<std::size_t>(x)] * n + order[static_cast<std::size_t>(y)]];
            };
            double value = 0;
            hol_inverse_entry(made, HOL_UNIT_DIAGONAL, i, j, &value);
            out.compare(M_INVERSE, value, at(i, j), k_eps(m) * std::sqrt(at(i, i) * at(j, j)));
        }
}

void check_metric(const placement &a, const hostile_molecule &m, const molecule_metric &exact,
                  const molecule_results &alone, bool inverse, molecule_verdict &out)
{
    if (alone.metric != HOL_OK) return;
    const long double k = k_eps(m);
    out.compare(M_LOG_DET, static_cast<double>(sum_over_molecules(alone.log_det, a.molecule_of_bond)), exact.log_det,
                k * std::fabs(exact.log_det));
    out.compare(M_LOG_DET_Z, static_cast<double>(sum_over_molecules(alone.log_det_z, a.molecule_of_bond)),
                exact.log_det_z, k * exact.log_det_z_scale);
    for (std::size_t i = 0; i < m.r.size(); ++i)
        if (exact.fixman_scale[i / 3] > 0 || !is_blank(alone.fixman[i]))
            out.compare(M_FIXMAN, alone.fixman[i], exact.fixman_force[i], 2 * k * exact.fixman_scale[i / 3]);
    if (inverse) check_inverse(a, m, exact, out);
}

void check_lengths(const hostile_molecule &m, const numbers &r, molecule_verdict &out)
{
    long double extent = 0;
    for (double x : r) extent = std::max(extent, std::fabs(static_cast<long double>(x)));
    const long double shortest = *std::min_element(m.length.begin(), m.length.end());
    for (std::size_t k = 0; k < m.length.size(); ++k) {
        const std::size_t i = static_cast<std::size_t>(m.pairs[2 * k]),
                          j = static_cast<std::size_t>(m.pairs[2 * k + 1]);
        if (m.w[i] == 0 && m.w[j] == 0) continue;
        const long double square = static_cast<long double>(m.length[k]) * m.length[k];
        long double error = -square;
        for (std::size_t x = 0; x < 3; ++x) {
            const long double d = static_cast<long double>(r[3 * j + x]) - r[3 * i + x];
            error += d * d;
        }
        out.note(M_LENGTH, std::fabs(error / square) / (8 * eps * (1 + extent / shortest)));
    }
}

/** Whether bond b is in a molecule that is a linear chain. */
bool is_linear(const placement &a, std::size_t b)
{
    int shape = HOL_SHAPE_OTHER;
    hol_chains_molecule(a.chains.get(), a.molecule_of_bond[b], &shape, nullptr, nullptr);
    return a.molecule_of_bond[b] >= 0 && shape == HOL_SHAPE_CHAIN;
}

void compare_positions(const placement &a, const hostile_molecule &m, const molecule_solution &s,
                       const molecule_results &alone, molecule_verdict &out)
{
    const long double k = k_eps(m), tail = margin(m, s, k);
    for (std::size_t b = 0; b < m.length.size(); ++b)
        out.compare(is_linear(a, b) ? M_CHAIN_LAMBDA : M_POSITION_LAMBDA, alone.position_lambda[b], s.lambda[b],
                    k * s.lambda_scale[b] + (s.lambda_scale[b] > 0 ? tail : 0));
    for (std::size_t i = 0; i < m.r.size(); ++i)
        out.compare(M_POSITION, alone.r[i], s.moved[i], k * s.moved_scale[i / 3]);
}

/** Angles that are nearly straight may bend to either side within a step: then there are two solutions, and which one a
 * method comes to is a matter of its first steps. Another one counts, if it is not much farther than the reference's.
 */
void compare_with_other(const placement &a, const hostile_molecule &m, const molecule_solution &s,
                        const molecule_results &alone, molecule_verdict &out)
{
    const molecule_problem p = m.problem();
    const std::vector<double> drifted = m.drifted();
    molecule_solution other;
    if (molecule_positions_near(&p, drifted.data(), nullptr, m.length.data(), m.dt, alone.position_lambda.data(),
                                &other) != 0)
        return;
    molecule_verdict found;
    compare_positions(a, m, other, alone, found);
    if (found.ratio[M_POSITION] <= 1) {
        found.note(M_OTHER, how_much_farther(drifted, other.moved, s.moved));
        out = found;
    }
    molecule_solution_free(&other);
}

void check_positions(const placement &a, const hostile_molecule &m, const molecule_level &exact,
                     const molecule_results &alone, molecule_verdict &out)
{
    if (m.dt == 0) return;
    out.note(M_REFUSED_STEP, alone.positions != HOL_OK && exact.there);
    if (alone.positions != HOL_OK) return;
    check_lengths(m, alone.r, out);
    if (!exact.there) return;
    molecule_verdict here;
    compare_positions(a, m, exact.s, alone, here);
    if (here.ratio[M_POSITION] > 1) compare_with_other(a, m, exact.s, alone, here);
    out.add(here);
}

bool all_finite(const numbers &x)
{
    return std::all_of(x.begin(), x.end(), [](double y) { return std::isfinite(y); });
}

bool finite_or_blank(const numbers &x)
{
    return std::all_of(x.begin(), x.end(), [](double y) { return std::isfinite(y) || is_blank(y); });
}

}  // namespace

/** A part may be several molecules for the library, if atoms of it are fixed: each is complete, or none of it written.
 */
long double how_much_farther(const std::vector<double> &drifted, const long double *other, const long double *exact)
{
    long double moves = 0, least = 0;
    for (std::size_t i = 0; i < drifted.size(); ++i) {
        moves = std::max(moves, std::fabs(other[i] - drifted[i]));
        least = std::max(least, std::fabs(exact[i] - drifted[i]));
    }
    return moves / (most_farther * least);
}

void check_outputs(const hostile_molecule &m, const molecule_results &part, molecule_verdict &out)
{
    for (const numbers *x : {&part.lambda, &part.solved, &part.mu, &part.position_lambda, &part.log_det, &part.g,
                             &part.fixman, &part.kept_lambda, &part.kept_solved, &part.kept_g})
        out.note(M_OUTPUTS, !finite_or_blank(*x));
    for (const numbers *x : {&part.v, &part.r, &part.moved}) out.note(M_OUTPUTS, !all_finite(*x));
    if (part.forces == HOL_OK) out.note(M_OUTPUTS, !all_finite(part.lambda));
    if (part.solve == HOL_OK) out.note(M_OUTPUTS, !all_finite(part.solved));
    if (part.kept == HOL_OK) out.note(M_OUTPUTS, !all_finite(part.kept_lambda) || !all_finite(part.kept_solved));
    if (part.velocities == HOL_OK) out.note(M_OUTPUTS, !all_finite(part.mu));
    if (part.positions == HOL_OK) out.note(M_OUTPUTS, !all_finite(part.position_lambda));
    const auto kept = [](const numbers &multipliers, const numbers &is, const numbers &was) {
        return !std::all_of(multipliers.begin(), multipliers.end(), is_blank) || identical(is, was);
    };
    out.note(M_OUTPUTS, !kept(part.mu, part.v, m.v) || !kept(part.position_lambda, part.r, m.drifted()) ||
                            !kept(part.position_lambda, part.moved, m.v));
}

namespace
{

/** Whether one of the molecules that the library finds in it is neither tree nor ring nor triangle. */
bool has_graph(const placement &a)
{
    return hol_chains_n_of_shape(a.chains.get(), HOL_SHAPE_OTHER) > 0;
}

bool is_straight_triangle(const hostile_molecule &m)
{
    if (m.shape != TRIANGLES) return false;
    long double least = 1;
    for (std::size_t i = 0; i < 3; ++i) {
        long double u[3], v[3], uu = 0, vv = 0, area = 0;
        for (std::size_t x = 0; x < 3; ++x) {
            u[x] = static_cast<long double>(m.r[3 * ((i + 1) % 3) + x]) - m.r[3 * i + x];
            v[x] = static_cast<long double>(m.r[3 * ((i + 2) % 3) + x]) - m.r[3 * i + x];
            uu += u[x] * u[x];
            vv += v[x] * v[x];
        }
        for (std::size_t x = 0; x < 3; ++x) {
            const std::size_t y = (x + 1) % 3, z = (x + 2) % 3;
            area += (u[y] * v[z] - u[z] * v[y]) * (u[y] * v[z] - u[z] * v[y]);
        }
        least = std::min(least, area / (uu * vv));
    }
    return least < straight_sine2;
}

/** Of all orders of elimination: a pivot is one over a diagonal element of the inverse of what is eliminated so far,
 * the least one of that of all. Z~ has ones on its diagonal. */
long double least_pivot_of_any_order(const molecule_metric &exact, std::size_t n)
{
    long double most = 1;
    for (std::size_t k = 0; k < n; ++k) most = std::max(most, exact.inverse[k * n + k]);
    return 1 / most;
}

}  // namespace

molecule_verdict check_alone(const hostile_molecule &m, const molecule_reference &exact, molecule_facts &facts)
{
    molecule_verdict out;
    const long double least_pivot = exact.metric.least_pivot;
    facts.regular = exact.regular;
    facts.least_pivot = least_pivot;
    facts.condition = exact.metric.condition;
    const placement a = place({&m}, 0);
    const bool graph = a.status == HOL_OK && has_graph(a), flagged = is_straight_triangle(m);
    facts.promised = facts.regular && !flagged && (!graph || least_pivot > graph_limit) &&
                     (m.shape != RINGS || least_pivot > ring_limit) &&
                     (m.shape != TREES || facts.condition < tree_limit);
    if (a.status != HOL_OK) {
        out.note(M_REFUSED, a.status != HOL_ERR_DEGENERATE || facts.regular);
        return out;
    }
    const molecule_results alone = compute(a, m.dt > 0 ? m.dt : 1);
    check_outputs(m, alone, out);
    const bool may_be_refused =
        facts.promised && graph && least_pivot_of_any_order(exact.metric, m.n_bonds()) <= any_order_limit;
    for (const int status : {alone.forces, alone.solve, alone.velocities, alone.metric, alone.kept}) {
        if (may_be_refused && status == HOL_ERR_DEGENERATE) facts.promised = false;
        if (facts.promised) out.note(M_REFUSED, status != HOL_OK);
        if (!facts.regular) out.note(M_ACCEPTED, status != HOL_ERR_DEGENERATE);
    }
    if (!facts.promised) return out;
    check_forces(m, exact, alone, out);
    check_velocities(m, exact, alone, out);
    check_metric(a, m, exact.metric, alone, least_pivot > (graph ? inverse_limit : inverse_of_tree), out);
    check_positions(a, m, exact.positions, alone, out);
    return out;
}

}  // namespace stress
