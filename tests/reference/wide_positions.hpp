/**
 * @file wide_positions.hpp
 * The position level in wide arithmetic: Newton's method with the whole Jacobian.
 */
#ifndef REFERENCE_WIDE_POSITIONS_HPP
#define REFERENCE_WIDE_POSITIONS_HPP

#include "molecule_step.hpp"
#include "wide_levels.hpp"

namespace reference
{

template <class REAL>
struct newton_state {
    exact_molecule<REAL> m;
    std::vector<vector3<REAL>> start;  // drifted bonds
    std::vector<REAL> square;          // a_k^2
    std::vector<REAL> tau;             // 2 dt^2 lambda

    newton_state(const molecule_problem &p, const molecule_step &s) : m(p)
    {
        for (const auto &b : m.bonds) {
            using molecule = exact_molecule<REAL>;
            start.push_back(molecule::image(difference(molecule::row(s.drifted, b.j), molecule::row(s.drifted, b.i)),
                                            s.drifted_box));
            square.push_back(REAL(s.length[b.number]) * REAL(s.length[b.number]));
        }
        for (const auto &b : m.bonds)
            tau.push_back(s.lambda ? REAL(2) * REAL(s.dt) * REAL(s.dt) * REAL(s.lambda[b.number]) : REAL(0));
    }

    /** Bonds with the present multipliers. */
    std::vector<vector3<REAL>> vectors() const
    {
        const auto g = m.forces(tau);
        auto d = start;
        for (std::size_t k = 0; k < d.size(); ++k) {
            add_times(d[k], m.w[m.bonds[k].j], g[m.bonds[k].j]);
            add_times(d[k], -m.w[m.bonds[k].i], g[m.bonds[k].i]);
        }
        return d;
    }
};

/** Number of solves until all bonds have their lengths, or -1. */
template <class REAL>
int newton(newton_state<REAL> &s)
{
    const int limit = 60;
    const REAL done = REAL(1).scaled(-REAL::bits * 3 / 4);
    for (int solves = 0; solves <= limit; ++solves) {
        const auto d = s.vectors();
        std::vector<REAL> error(d.size());
        REAL worst(0);
        for (std::size_t k = 0; k < d.size(); ++k) {
            error[k] = (product(d[k], d[k]) - s.square[k]).scaled(-1);
            const REAL relative = absolute(error[k]) / s.square[k];
            if (relative > worst) worst = relative;
        }
        if (worst < done) return solves;
        if (worst > REAL(1e30)) return -1;
        const sparse_factor<REAL> factor(s.m.matrix(d));  // those before lose the way of triangles that are nearly flat
        if (!factor.regular()) return -1;
        const auto change = factor.solve(error);
        for (std::size_t k = 0; k < d.size(); ++k) s.tau[k] += change[k];
    }
    return -1;
}

/** The corrected positions come out in `moved`; not regular: no convergence. */
template <class REAL>
wide_solution<REAL> wide_positions(const molecule_problem &p, const molecule_step &step)
{
    using molecule = exact_molecule<REAL>;
    newton_state<REAL> s(p, step);
    wide_solution<REAL> out;
    if (newton(s) < 0) return out;
    const REAL dt2 = REAL(step.dt) * REAL(step.dt);
    const auto g = s.m.forces(s.tau);
    std::vector<vector3<REAL>> moved;
    REAL extent(0), shortest(0);
    for (std::size_t i = 0; i < g.size(); ++i) {
        moved.push_back(molecule::row(step.drifted, i));
        add_times(moved[i], s.m.w[i], g[i]);
        if (largest_component(moved[i]) > extent) extent = largest_component(moved[i]);
    }
    for (const REAL &q : s.square)
        if (shortest == REAL(0) || q < shortest) shortest = q;
    shortest = square_root(shortest);
    std::vector<REAL> x, t;
    for (const REAL &q : s.square) x.push_back(q * (REAL(1) + extent / shortest));
    const sparse_factor<REAL> factor(s.m.matrix(s.vectors()));
    if (!factor.regular()) return out;
    std::vector<REAL> scale = amplified(factor, x);
    for (std::size_t k = 0; k < scale.size(); ++k) {
        scale[k] += absolute(s.tau[k]);
        t.push_back(s.tau[k] / dt2);
    }
    std::vector<REAL> t_scale = scale;
    for (REAL &y : t_scale) y /= dt2;
    out = from_multipliers(s.m, p, t, t_scale);
    out.moved = moved;
    for (std::size_t i = 0; i < g.size(); ++i)
        out.moved_scale.push_back(largest_component(moved[i]) + s.m.w[i] * out.g_scale[i] * dt2);
    out.least_pivot = bond_system<REAL>(s.m).least_pivot;
    return out;
}

}  // namespace reference

#endif
