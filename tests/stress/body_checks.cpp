#include "body_checks.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <limits>

#include "random.h"

namespace stress
{

namespace
{

constexpr long double eps = DBL_EPSILON;
constexpr long double least_promised = 1e-22L;  // pivots below it are promised nothing

using reference::rigid_level;
using reference::rigid_solution;

void check_level(const numbers &found, const std::vector<long double> &exact, const std::vector<long double> &scale,
                 std::size_t per, long double k, molecule_quantity q, molecule_verdict &out)
{
    for (std::size_t i = 0; i < found.size(); ++i) out.compare(q, found[i], exact[i], k * scale[i / per]);
}

bool all_finite(const numbers &x)
{
    return std::all_of(x.begin(), x.end(), [](double y) { return std::isfinite(y); });
}

bool all_blank(const numbers &x)
{
    return std::all_of(x.begin(), x.end(), is_blank);
}

/** Fixed atoms may belong to other molecules: theirs is the sum over those that are good, be it none. */
bool forces_are_kept(const hostile_body &m, const numbers &g)
{
    for (std::size_t i = 0; i < g.size(); ++i)
        if (!is_blank(g[i]) && !(m.p.mass[i / 3] < 0 && g[i] == 0)) return false;
    return true;
}

/** What failed keeps its outputs bit for bit; what did not has only finite ones. */
void check_kept(const hostile_body &m, const molecule_results &alone, molecule_verdict &out)
{
    const bool forces = alone.forces == HOL_OK
                            ? all_finite(alone.lambda) && all_finite(alone.g)
                            : all_blank(alone.lambda) && forces_are_kept(m, alone.g) && all_blank(alone.virial);
    const bool solve = alone.solve == HOL_OK ? all_finite(alone.solved) : all_blank(alone.solved);
    const bool velocities = alone.velocities == HOL_OK ? all_finite(alone.mu) && all_finite(alone.v)
                                                       : all_blank(alone.mu) && identical(alone.v, m.p.v);
    const bool positions =
        alone.positions == HOL_OK
            ? all_finite(alone.position_lambda) && all_finite(alone.r) && all_finite(alone.moved)
            : all_blank(alone.position_lambda) && identical(alone.r, m.drifted()) && identical(alone.moved, m.p.v);
    out.note(M_OUTPUTS, !(forces && solve && velocities && positions));
}

/**
 * Bodies alone are solved in plain doubles unless they are thinner than 1e-3: a rounding of the longest axis is that
 * many of the shortest.
 */
long double thinness(const hostile_body &m)
{
    if (m.p.bodies.size() != 1 || m.p.n_atoms() > m.p.bodies[0].size()) return 0;
    const std::vector<double> axes = reference::shape_of_body(m.p, m.p.bodies[0]).length;
    const auto ends = std::minmax_element(axes.begin(), axes.end());
    const double ratio = *ends.second / *ends.first;
    return ratio < 1000 ? ratio : 0;
}

long double largest_length(const hostile_body &m)
{
    return m.p.length.empty() ? 0 : *std::max_element(m.p.length.begin(), m.p.length.end());
}

void check_lengths(const hostile_body &m, const numbers &r, molecule_verdict &out)
{
    long double extent = 0;
    for (double x : r) extent = std::max(extent, std::fabs(static_cast<long double>(x)));
    for (std::size_t k = 0; k < m.p.length.size(); ++k) {
        const long double a = m.p.length[k];
        long double error = -a * a;
        for (std::size_t x = 0; x < 3; ++x) {
            const long double d = static_cast<long double>(r[3 * m.p.pairs[k][1] + x]) - r[3 * m.p.pairs[k][0] + x];
            error += d * d;
        }
        out.note(M_LENGTH, std::fabs(error) / (8 * eps * a * (a + extent)));
    }
}

void compare_positions(const hostile_body &m, const rigid_level &s, const molecule_results &alone, long double k,
                       molecule_verdict &out)
{
    if (m.shape != LISTED) check_level(alone.position_lambda, s.lambda, s.lambda_scale, 1, k, M_POSITION_LAMBDA, out);
    check_level(alone.r, s.moved, s.moved_scale, 3, k, M_POSITION, out);
}

/** Bodies that are taut between fixed atoms may bend to either side within a step: then there are two solutions, and
 * which one a method comes to is a matter of its first steps. Another one counts, if it is not much farther than the
 * reference's. */
void check_positions(const hostile_body &m, const rigid_level &exact, const molecule_results &alone, long double k,
                     molecule_verdict &out)
{
    molecule_verdict here;
    compare_positions(m, exact, alone, k, here);
    if (here.ratio[M_POSITION] > 1) {
        const numbers drifted = m.drifted();
        const rigid_level other = reference::solve_rigid(m.p, {}, drifted, m.dt, alone.r).positions;
        molecule_verdict there;
        if (other.there) compare_positions(m, other, alone, k, there);
        if (other.there && there.ratio[M_POSITION] <= 1) {
            there.note(M_OTHER, how_much_farther(drifted, other.moved.data(), exact.moved.data()));
            here = there;
        }
    }
    out.add(here);
}

/** Of what depends on each other multipliers are not unique. */
void check_listed(const hostile_body &m, const rigid_solution &exact, const molecule_results &alone, long double k,
                  molecule_verdict &out)
{
    if (alone.forces == HOL_OK) check_level(alone.g, exact.forces.g, exact.forces.g_scale, 3, k, M_FORCE, out);
    if (alone.velocities == HOL_OK)
        check_level(alone.v, exact.velocities.moved, exact.velocities.moved_scale, 3, k, M_VELOCITY, out);
    if (m.dt == 0) return;
    out.note(M_REFUSED_STEP, alone.positions != HOL_OK && exact.positions.there);
    if (alone.positions != HOL_OK || !exact.positions.there) return;
    check_positions(m, exact.positions, alone, k, out);
}

/** What an atom may be: a site that is no atom of a body is there in no case. */
numbers masses_of(const hostile_body &m)
{
    numbers mass = m.p.mass;
    for (double &x : mass)
        if (x < 0) x = std::numeric_limits<double>::infinity();
    return mass;
}

}  // namespace

placement place(const std::vector<const hostile_body *> &parts, std::uint64_t shuffle)
{
    placement a;
    random_stream stream = random_seed(shuffle);
    std::vector<std::size_t> owner;
    for (std::size_t m = 0; m < parts.size(); ++m) owner.insert(owner.end(), parts[m]->p.n_atoms(), m);
    if (shuffle) {
        owner.insert(owner.end(), static_cast<std::size_t>(random_integer(&stream, 0, 9)), parts.size());
        for (std::size_t i = owner.size(); i-- > 1;)
            std::swap(owner[i],
                      owner[static_cast<std::size_t>(random_integer(&stream, 0, static_cast<std::int64_t>(i)))]);
    }
    a.atoms.resize(parts.size());
    a.bonds.resize(parts.size());
    numbers mass(owner.size(), 1.0), length, places;
    a.r.assign(3 * owner.size(), blank());
    a.v = a.f = a.drift = a.r;
    std::vector<numbers> drifted;
    for (const hostile_body *m : parts) drifted.push_back(m->drifted());
    for (std::size_t i = 0; i < owner.size(); ++i) {
        if (owner[i] == parts.size()) continue;
        const hostile_body &m = *parts[owner[i]];
        const std::size_t own = a.atoms[owner[i]].size();
        a.atoms[owner[i]].push_back(i);
        mass[i] = masses_of(m)[own];
        for (std::size_t x = 0; x < 3; ++x) {
            a.r[3 * i + x] = m.p.r[3 * own + x];
            a.v[3 * i + x] = m.p.v[3 * own + x];
            a.f[3 * i + x] = m.p.f[3 * own + x];
            a.drift[3 * i + x] = drifted[owner[i]][3 * own + x];
        }
    }
    std::vector<std::int64_t> sizes, atoms, pairs, terms, of_terms;
    numbers coefficients;
    struct listed {
        std::size_t molecule, number;
    };
    std::vector<listed> bonds, bodies;
    for (std::size_t m = 0; m < parts.size(); ++m) {
        a.bonds[m].resize(parts[m]->p.length.size());
        for (std::size_t k = 0; k < parts[m]->p.length.size(); ++k) bonds.push_back({m, k});
        for (const reference::loose_part &part : parts[m]->p.parts)
            for (const std::vector<double> &row : part.relations) {
                terms.push_back(0);
                for (std::size_t i = 0; i < row.size(); ++i) {
                    if (row[i] == 0) continue;
                    of_terms.push_back(static_cast<std::int64_t>(a.atoms[m][part.atoms[i]]));
                    coefficients.push_back(row[i]);
                    ++terms.back();
                }
            }
        for (std::size_t b = 0; b < parts[m]->p.bodies.size(); ++b) {
            bodies.push_back({m, b});
            for (const std::size_t i : parts[m]->p.bodies[b]) {
                atoms.push_back(static_cast<std::int64_t>(a.atoms[m][i]));
                places.insert(places.end(), &parts[m]->p.place[3 * i], &parts[m]->p.place[3 * i] + 3);
            }
            sizes.push_back(static_cast<std::int64_t>(parts[m]->p.bodies[b].size()));
        }
    }
    const bool mixed =
        shuffle && parts[0]->shape != LISTED;  // which bonds of a list are its base depends on their order
    for (std::size_t i = bonds.size(); mixed && i-- > 1;)
        std::swap(bonds[i], bonds[static_cast<std::size_t>(random_integer(&stream, 0, static_cast<std::int64_t>(i)))]);
    for (std::size_t k = 0; k < bonds.size(); ++k) {
        const hostile_body &m = *parts[bonds[k].molecule];
        const std::size_t own = bonds[k].number;
        std::size_t ends[2] = {m.p.pairs[own][0], m.p.pairs[own][1]};
        if (mixed && random_uniform(&stream) < 0.5) std::swap(ends[0], ends[1]);
        for (const std::size_t e : ends) pairs.push_back(static_cast<std::int64_t>(a.atoms[bonds[k].molecule][e]));
        length.push_back(m.listed.empty() ? m.p.length[own] : m.listed[own]);
        a.bonds[bonds[k].molecule][own] = k;
        a.rhs.push_back(m.right_hand_side()[own]);
    }
    hol_chains *chains = nullptr;
    a.status = hol_chains_create(static_cast<std::int64_t>(owner.size()), mass.data(), &chains);
    a.chains.reset(chains);
    const std::int64_t n_bonds = static_cast<std::int64_t>(bonds.size());
    if (a.status != HOL_OK) {
    } else if (parts[0]->shape == LISTED) {
        a.status = hol_chains_add_bonds(chains, n_bonds, pairs.data(), length.data());
    } else if (parts[0]->shape == RELATED) {
        a.status = hol_chains_add_linear(chains, static_cast<std::int64_t>(terms.size()), terms.data(), of_terms.data(),
                                         coefficients.data(), n_bonds, pairs.data(), length.data());
    } else
        a.status = hol_chains_add_rigid(chains, static_cast<std::int64_t>(sizes.size()), sizes.data(), atoms.data(),
                                        places.data(), n_bonds, pairs.data(), length.data());
    a.molecule_of_bond.assign(bonds.size(), -1);
    return a;
}

molecule_verdict check_alone(const hostile_body &m, const rigid_solution &exact, molecule_facts &facts)
{
    molecule_verdict out;
    const placement a = place({&m}, 0);
    facts.regular = exact.regular && !m.refused;
    facts.least_pivot = exact.least_pivot;
    facts.condition = exact.least_pivot > 0 ? 1 / exact.least_pivot : HUGE_VALL;
    facts.promised = facts.regular && exact.least_pivot > least_promised;
    if (m.refused || a.status != HOL_OK) {
        out.note(M_REFUSED, a.status != (m.refused ? HOL_ERR_VALUE : HOL_ERR_DEGENERATE) || facts.regular);
        out.note(M_ACCEPTED, m.refused && a.status == HOL_OK);
        return out;
    }
    const molecule_results alone = compute(a, m.dt > 0 ? m.dt : 1);
    check_kept(m, alone, out);
    // Without a bond there is nothing to be solved for, and no array to give.
    for (const int status : {alone.forces, m.p.length.empty() ? alone.forces : alone.solve, alone.velocities}) {
        if (facts.promised) out.note(M_REFUSED, status != HOL_OK);
        if (!facts.regular) out.note(M_ACCEPTED, status != HOL_ERR_DEGENERATE);
    }
    if (!facts.regular) return out;
    // Below what is promised an answer may be refused, but none may be wrong.
    const long double k = (16 + std::sqrt(static_cast<long double>(exact.n_constraints)) + thinness(m)) * eps;
    if (m.shape == LISTED) {
        out.note(M_REFUSED, hol_chains_degrees_of_freedom(a.chains.get(), 3) != m.freedoms);
        return check_listed(m, exact, alone, k, out), out;
    }
    if (alone.forces == HOL_OK) {
        // A bond that nothing pulls, beside relations that take up a force: twice the precision leaves a rounding of
        // that.
        const auto &of_atoms = exact.forces.g_scale;
        const long double left = of_atoms.empty() ? 0 : eps * *std::max_element(of_atoms.begin(), of_atoms.end());
        std::vector<long double> scale = exact.forces.lambda_scale;
        for (std::size_t b = 0; b < scale.size(); ++b)
            if (m.p.length[b] > 0) scale[b] = std::max(scale[b], left / static_cast<long double>(m.p.length[b]));
        check_level(alone.lambda, exact.forces.lambda, scale, 1, k, M_LAMBDA, out);
        check_level(alone.g, exact.forces.g, exact.forces.g_scale, 3, k, M_FORCE, out);
        for (std::size_t i = 0; i < 9; ++i)
            out.compare(M_VIRIAL, alone.virial[i], exact.forces.virial[i],
                        k * std::max(exact.forces.virial_scale, left * largest_length(m)));
    }
    if (alone.solve == HOL_OK && exact.solve.there)
        check_level(alone.solved, exact.solve.lambda, exact.solve.lambda_scale, 1, k, M_SOLVE, out);
    if (alone.velocities == HOL_OK) {
        check_level(alone.mu, exact.velocities.lambda, exact.velocities.lambda_scale, 1, k, M_MU, out);
        check_level(alone.v, exact.velocities.moved, exact.velocities.moved_scale, 3, k, M_VELOCITY, out);
    }
    if (m.dt == 0) return out;
    out.note(M_REFUSED_STEP, alone.positions != HOL_OK && exact.positions.there);
    if (alone.positions != HOL_OK) return out;
    check_lengths(m, alone.r, out);
    if (!exact.positions.there) return out;
    check_positions(m, exact.positions, alone, k, out);
    return out;
}

namespace
{

/** Lists without bodies are ordinary molecules, which number their bonds in an order of their own, and have a metric
 * where no other molecule of the set has bodies: these are left out. */
molecule_results comparable(const hostile_body &m, molecule_results x)
{
    if (m.shape == LISTED)
        for (numbers *of : {&x.lambda, &x.solved, &x.mu, &x.position_lambda, &x.fixman, &x.log_det, &x.log_det_z})
            of->clear();
    return x;
}

/** Units of mass, length and time that are 2^m, 2^l and 2^t of the old ones. `alone` was made with a step of 1. */
void check_units(const hostile_body &c, molecule_results alone, int m, int l, int t, molecule_verdict &out)
{
    hostile_body other = c;
    const double mass = std::ldexp(1, m), length = std::ldexp(1, l), time = std::ldexp(1, t);
    const double force = mass * length / (time * time), velocity = length / time;
    for (double &x : other.p.mass)
        if (x > 0) x *= mass;
    scale(other.p.place, length), scale(other.p.length, length), scale(other.p.r, length);
    scale(other.p.v, velocity), scale(other.p.f, force);
    other.dt = c.dt * time;
    placement a = place({&other}, 0);
    scale(a.rhs, 1 / (length * length));  // it was made from the lengths
    molecule_results there = comparable(c, compute(a, time));
    scale(there.lambda, length / force), scale(there.g, 1 / force);
    scale(there.solved, length * length / mass);
    scale(there.mu, length / (force * time));
    scale(there.v, 1 / velocity);
    scale(there.position_lambda, length / force), scale(there.r, 1 / length), scale(there.moved, 1 / velocity);
    without_signs_of_zeros(alone);
    without_signs_of_zeros(there);
    check_same(alone, there, M_UNITS, out);
}

void check_mirror(const hostile_body &c, molecule_results alone, molecule_verdict &out)
{
    hostile_body other = c;
    mirror(other.p.r), mirror(other.p.v), mirror(other.p.f);
    for (std::size_t b = 0; b < c.p.bodies.size(); ++b) mirror_if_it_matters(other.p, b);
    molecule_results there = comparable(c, compute(place({&other}, 0), 1));
    for (numbers *x : {&there.g, &there.v, &there.r, &there.moved}) mirror(*x);
    without_signs_of_zeros(alone);
    without_signs_of_zeros(there);
    check_same(alone, there, M_UNITS, out);
}

}  // namespace

void check_invariances(const std::vector<hostile_body> &molecules, std::uint64_t shuffle,
                       std::vector<molecule_verdict> &out)
{
    std::vector<const hostile_body *> parts;
    std::vector<std::size_t> number;
    for (std::size_t k = 0; k < molecules.size(); ++k) {
        if (molecules[k].refused || place({&molecules[k]}, 0).status != HOL_OK) continue;
        parts.push_back(&molecules[k]);
        number.push_back(k);
    }
    if (parts.empty()) return;
    const placement together = place(parts, shuffle);
    out[number[0]].note(M_REFUSED, together.status != HOL_OK);
    if (together.status != HOL_OK) return;
    const molecule_results first = compute(together, 1), again = compute(together, 1),
                           views = compute_in_views(together, 1);
    hol_chains_set_threads(together.chains.get(), 3);
    const molecule_results threads = compute(together, 1);
    random_stream stream = random_seed(shuffle);
    for (std::size_t k = 0; k < parts.size(); ++k) {
        molecule_verdict &verdict = out[number[k]];
        const molecule_results alone = comparable(*parts[k], compute(place({parts[k]}, 0), 1));
        for (const molecule_results *other : {&first, &again, &views, &threads})
            check_same(alone, comparable(*parts[k], part_of(*other, together, k)), M_SAME_BITS, verdict);
        const auto exponent = [&] { return static_cast<int>(random_integer(&stream, -20, 20)); };
        const int m = exponent(), drawn = exponent(), t = exponent();
        const int l = parts[k]->shape == LISTED ? 0 : drawn;  // decimals are of one unit
        check_units(*parts[k], alone, m, l, t, verdict);
        check_mirror(*parts[k], alone, verdict);
    }
    for (const molecule_results *other : {&again, &views, &threads})
        out[number[0]].note(M_SAME_BITS, !identical(first.virial, other->virial));
}

}  // namespace stress
