/**
 * @file wide_levels.hpp
 * The levels of accelerations, velocities and given right-hand sides in wide arithmetic, with the scales of
 * tests/oracle/molecules/README.md.
 */
#ifndef REFERENCE_WIDE_LEVELS_HPP
#define REFERENCE_WIDE_LEVELS_HPP

#include <array>
#include <vector>

#include "exact_molecule.hpp"

namespace reference
{

/** molecule_solution in wide arithmetic; rows of bonds that are no constraints are zero. */
template <class REAL>
struct wide_solution {
    bool regular = false;  // false: nothing else is set
    std::vector<REAL> lambda, lambda_scale, tension;
    std::vector<vector3<REAL>> g, moved;
    std::vector<REAL> g_scale, moved_scale;
    std::array<REAL, 9> virial{};
    REAL virial_scale{0}, least_pivot{0};
};

template <class REAL>
vector3<REAL> size_of(const vector3<REAL> &x)
{
    return {absolute(x[0]), absolute(x[1]), absolute(x[2])};
}

template <class REAL>
REAL largest_component(const vector3<REAL> &x)
{
    REAL largest(0);
    for (const REAL &c : x)
        if (absolute(c) > largest) largest = absolute(c);
    return largest;
}

/** What is a scale needs few digits: enough to stay right where a pivot is so small that more bits are taken for all.
 */
template <class REAL>
using scale_float = wide_float<(REAL::bits > 448 ? REAL::bits : 192)>;

/** |A^-1| s. */
template <class REAL>
std::vector<REAL> amplified(const sparse_factor<REAL> &exact, const std::vector<REAL> &s)
{
    using few = scale_float<REAL>;
    const sparse_factor<few> factor(exact);
    const std::vector<few> size(s.begin(), s.end());
    std::vector<few> sum(s.size());
    for (std::size_t l = 0; l < s.size(); ++l) {
        std::vector<few> column(s.size());
        column[l] = few(1);
        column = factor.solve(column, factor.symmetric() ? l : factor.all);
        for (std::size_t k = 0; k < s.size(); ++k) {
            if (column[k] == few(0)) continue;
            const few x = absolute(column[k]);
            sum[k] += x * size[l];
            if (factor.symmetric() && k != l) sum[l] += x * size[k];
        }
    }
    return std::vector<REAL>(sum.begin(), sum.end());
}

/** Everything that follows from t = 2 lambda and the scale of t. */
template <class REAL>
wide_solution<REAL> from_multipliers(const exact_molecule<REAL> &m, const molecule_problem &p,
                                     const std::vector<REAL> &t, const std::vector<REAL> &scale)
{
    wide_solution<REAL> s;
    const std::size_t n = static_cast<std::size_t>(p.n_bonds);
    s.regular = true;
    s.lambda.resize(n), s.lambda_scale.resize(n), s.tension.resize(n);
    s.g = m.forces(t);
    s.g_scale.resize(m.w.size());
    for (std::size_t k = 0; k < m.bonds.size(); ++k) {
        const auto &b = m.bonds[k];
        const REAL size = length(b.d), pull = scale[k] * size;
        s.lambda[b.number] = t[k].scaled(-1);
        s.lambda_scale[b.number] = scale[k].scaled(-1);
        s.tension[b.number] = t[k] * size;
        s.g_scale[b.i] += pull;
        s.g_scale[b.j] += pull;
        s.virial_scale += pull * size;
        for (std::size_t x = 0; x < 3; ++x)
            for (std::size_t y = 0; y < 3; ++y) s.virial[3 * x + y] -= t[k] * b.d[x] * b.d[y];
    }
    return s;
}

/** sigma'' = 0: the forces of the constraints. */
template <class REAL>
wide_solution<REAL> wide_forces(const molecule_problem &p)
{
    using molecule = exact_molecule<REAL>;
    const molecule m(p);
    const bond_system<REAL> system(m);
    wide_solution<REAL> out;
    if (!system.factor.regular()) return out;
    std::vector<REAL> b, scale;
    for (const auto &k : m.bonds) {
        const auto fi = molecule::row(p.f, k.i), fj = molecule::row(p.f, k.j);
        const auto dv = difference(molecule::row(p.v, k.j), molecule::row(p.v, k.i));
        b.push_back(m.w[k.j] * product(k.d, fj) - m.w[k.i] * product(k.d, fi) + product(dv, dv));
        scale.push_back(m.w[k.j] * product_of_sizes(k.d, fj) + m.w[k.i] * product_of_sizes(k.d, fi) + product(dv, dv));
    }
    const std::vector<REAL> t = system.factor.solve(b);
    auto a = m.forces(t);
    for (std::size_t i = 0; i < a.size(); ++i) {
        add_times(a[i], REAL(1), molecule::row(p.f, i));
        for (REAL &x : a[i]) x *= m.w[i];
    }
    for (std::size_t k = 0; k < m.bonds.size(); ++k)
        scale[k] += absolute(product(m.bonds[k].d, a[m.bonds[k].i])) + absolute(product(m.bonds[k].d, a[m.bonds[k].j]));
    out = from_multipliers(m, p, t, amplified(system.factor, scale));
    out.least_pivot = system.least_pivot;
    return out;
}

/** d.dv = 0: the projection of the velocities, which come out in `moved`. */
template <class REAL>
wide_solution<REAL> wide_velocities(const molecule_problem &p)
{
    using molecule = exact_molecule<REAL>;
    const molecule m(p);
    const bond_system<REAL> system(m);
    wide_solution<REAL> out;
    if (!system.factor.regular()) return out;
    std::vector<REAL> b, scale;
    for (const auto &k : m.bonds) {
        const auto vi = molecule::row(p.v, k.i), vj = molecule::row(p.v, k.j);
        b.push_back(product(k.d, difference(vj, vi)));
        scale.push_back(product_of_sizes(k.d, vi) + product_of_sizes(k.d, vj));
    }
    const std::vector<REAL> t = system.factor.solve(b);
    auto after = m.forces(t);
    for (std::size_t i = 0; i < after.size(); ++i) {
        const auto impulse = after[i];
        after[i] = molecule::row(p.v, i);
        add_times(after[i], m.w[i], impulse);
    }
    for (std::size_t k = 0; k < m.bonds.size(); ++k)
        scale[k] +=
            absolute(product(m.bonds[k].d, after[m.bonds[k].i])) + absolute(product(m.bonds[k].d, after[m.bonds[k].j]));
    out = from_multipliers(m, p, t, amplified(system.factor, scale));
    out.moved = after;
    for (std::size_t i = 0; i < after.size(); ++i)
        out.moved_scale.push_back(largest_component(molecule::row(p.v, i)) + m.w[i] * out.g_scale[i]);
    out.least_pivot = system.least_pivot;
    return out;
}

/**
 * Z lambda = rhs. The scale of lambda is |Z^-1| (|rhs| + |Z| |lambda|): what relative changes of one rounding in the
 * right-hand side and in every product w d_k.d_l of the matrix can do.
 */
template <class REAL>
wide_solution<REAL> wide_solve(const molecule_problem &p, const double *rhs)
{
    const exact_molecule<REAL> m(p);
    const bond_system<REAL> system(m);
    wide_solution<REAL> out;
    if (!system.factor.regular()) return out;
    std::vector<REAL> b, scale;
    for (const auto &k : m.bonds) b.push_back(REAL(rhs[k.number]).scaled(-1));
    const std::vector<REAL> t = system.factor.solve(b);
    for (const REAL &x : b) scale.push_back(absolute(x));
    for (std::size_t atom = 0; atom < m.w.size(); ++atom)
        for (const auto &k : m.ends[atom])
            for (const auto &l : m.ends[atom])
                scale[k.bond] += m.w[atom] * absolute(product(m.bonds[k.bond].d, m.bonds[l.bond].d) * t[l.bond]);
    out = from_multipliers(m, p, t, amplified(system.factor, scale));
    out.least_pivot = system.least_pivot;
    return out;
}

}  // namespace reference

#endif
