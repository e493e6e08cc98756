// Kept factors of chains of a number of bonds that the compiler knows, in registers.
#pragma once

#include "core/kernels/kept/block.hpp"
#include "core/kernels/memory/outputs.hpp"
#include "core/kernels/memory/small.hpp"
#include "core/kernels/memory/small_pulls.hpp"

namespace holonomic::HOL_ISA::kept {

// Factors of small molecules, read and eliminated in registers. Returns the first molecule that is not done.
template <class View, bool uniform, bool boxed>
static int64_t keep_small(const KeepCall &call, const Unit &unit, const Block &given, int64_t first) {
    constexpr int N = View::bonds;
    const double *const r = reinterpret_cast<const double *>(call.r.x);
    BlockMasses<View> masses(given);
    const int64_t end = View::end(unit, first);
    for (int64_t n; (n = View::next(first, end)) > 0; first += n) {
        const View view(unit, first, n);
        masses.take(view);
        vec e[vectors_of<N>], t[N] = {};
        double *const to = call.kept->room(call.kept->owner, view.chain_of(0), doubles(N));
        if (!to) break;
        const ChainSystem s = kept::system(to, N, t);
        load_bonds<boxed, false>(call.box, view, r, e, s.D);
        const Source source = view.source(r, call.box);
        Sweep<uniform, true> sweep{masses.block, source, s};
        HOL_UNROLL
        for (int k = 0; k < N; ++k)
            sweep.step(
                k, [&]() HOL_FORCED { return vec{}; }, k % 4 == 0, false);
        if (__builtin_expect(any(sweep.flag() | ~sweep.calm()), 0)) break;
        s.L[0] = s.L[N] = vec{};
        set_head(to, true, first_lanes(static_cast<int>(n)));
    }
    return first;
}

static int64_t keep_small_ones(const KeepCall &call, const Unit &unit, Block &block, int64_t first, Tally &) {
    return any_molecules(unit, block, first, call.box.lattice != Box::none, true,
                         [&](auto view, auto uniform, auto boxed) {
                             return keep_small<typename decltype(view)::type, uniform, boxed>(call, unit, block, first);
                         });
}

// Small molecules. Returns the first one that is not done.
template <class View, bool uniform>
static int64_t solve_small(const KeptCall &call, const Unit &unit, const Block &given, int64_t first, Tally &tally) {
    constexpr int N = View::bonds;
    const auto base = [](const AtomArray &a) { return reinterpret_cast<double *>(a.x); };
    BlockMasses<View> masses(given);
    const Block &block = masses.block;
    const int64_t end = View::end(unit, first);
    for (int64_t n; (n = View::next(first, end)) > 0; first += n) {
        const View view(unit, first, n);
        const double *const from = call.kept->block[view.chain_of(0)];
        if (!from || !is_small(from)) break;
        masses.take(view);
        const vec *const L = multipliers(from, N), *const P = pivots(from, N);
        const vec3 *const D = bonds(from);
        vec t[N] = {};
        if (call.rhs) {
            HOL_UNROLL
            for (int k = 0; k < N; ++k) {
                HOL_UNROLL
                for (int i = 0; i < W; ++i) t[k][i] = call.rhs[view.bond_of(i) + k];
                t[k] = (0.5 * block.mass) * t[k];
            }
        }
        if (!call.rhs && call.v.x) {
            vec e[vectors_of<N>];
            const vec3 *const v = reinterpret_cast<const vec3 *>(e);
            load_molecules(view, base(call.v), e);
            HOL_UNROLL
            for (int k = 0; k < N; ++k)
                t[k] = right_hand_side(velocity_squared, block.mass, D[k], v[k + 1] - v[k], vec3{});
        }
        if (!call.rhs && call.f.x) {
            vec e[vectors_of<N>];
            const vec3 *const f = reinterpret_cast<const vec3 *>(e);
            load_molecules(view, base(call.f), e);
            HOL_UNROLL
            for (int k = 0; k < N; ++k)
                t[k] =
                    t[k] + right_hand_side(force_difference, block.mass, D[k], vec3{},
                                           uniform ? f[k + 1] - f[k] : block.w[k + 1] * f[k + 1] - block.w[k] * f[k]);
        }
        vec y = t[0];
        t[0] = y * P[0];
        HOL_UNROLL
        for (int k = 1; k < N; ++k) {
            y = mul_add(L[k], y, t[k]);
            t[k] = y * P[k];
        }
        t[N - 1] = t[N - 1] + 0.0;  // zeros as +0
        HOL_UNROLL
        for (int k = N - 1; k > 0; --k) t[k - 1] = mul_add(L[k], t[k], t[k - 1]);
        if (__builtin_expect(any(~finite(t[0])), 0)) {
            for (int64_t i = 0; i < n; ++i) call.left[view.chain_of(static_cast<int>(i))] = 1;
            continue;
        }
        if (call.g.x) store_pulls(D, t, view, base(call.g), call.add);
        if (call.virial) count_virial<N>(D, t, n, splat(1.0), tally);
        if (call.lambda) store_multipliers(view, t, splat(0.5), call.lambda);
        if (call.tension) {
            HOL_UNROLL
            for (int k = 0; k < N; ++k) t[k] = t[k] * sqrt(dot(D[k], D[k]));
            store_multipliers(view, t, splat(1.0), call.tension);
        }
    }
    return first;
}

static int64_t solve_small_ones(const KeptCall &call, const Unit &unit, Block &block, int64_t first, Tally &tally) {
    return any_molecules(
        unit, block, first, call.kept->box->lattice != Box::none, true, [&](auto view, auto uniform, auto) {
            return solve_small<typename decltype(view)::type, uniform>(call, unit, block, first, tally);
        });
}

}  // namespace holonomic::HOL_ISA::kept
