// Projection of velocities: the sweep down, and a second solve for the rates that rounding leaves.
#pragma once

#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/eliminate/chain.hpp"
#include "core/kernels/eliminate/one_lane.hpp"

namespace holonomic::HOL_ISA {

// Working arrays of a projection.
struct Projection {
    ChainSystem s;
    vec3 *v;               // of the atoms
    vec *left;             // of the bonds: what rounding leaves of the rates, then the multipliers that correct it
    const double *strain;  // or nullptr
    Projection(long n, Arena &arena, const double *of_box)
        : s(n, arena), v(reinterpret_cast<vec3 *>(arena.vecs(3 * (n + 1 + W)))), left(arena.vecs(n + 1)),
          strain(of_box) {}
    Projection(const ChainSystem &system, vec3 *velocities, vec *rates)
        : s(system), v(velocities), left(rates), strain(nullptr) {}
    ChainSystem correction() const { return ChainSystem(s.D, left, s.L, s.pivots); }
    // Lanes in which nothing has overflowed. The backward sweep carries what is not finite to the first bond, the
    // substitution of the rates to the last one.
    mask finite(long n) const { return HOL_ISA::finite(s.t[0] + left[n - 1]); }
};

// The backward sweep from u to t. It also moves the velocities: v_k + w_k (t_{k+1} d_{k+1} - t_k d_k), rounded once.
template <bool uniform>
struct Pull {
    const Block &block;
    const Projection x;  // by value: its pointers stay in registers
    const vec *const u;
    vec t = {};
    vec3 after = {};  // t d of bond k + 1

    inline HOL_FORCED vec3 moved(long k, const vec3 &before) const {
        const vec w = w_at<uniform>(block, k);
        const vec3 v = x.v[k], g = after - before;
        return {mul_add(w, g.x, v.x), mul_add(w, g.y, v.y), mul_add(w, g.z, v.z)};
    }
    // Atom k + 1; the last is atom 0.
    inline HOL_FORCED vec3 step(long k) {
        t = mul_add(x.s.L[k + 1], t, u[k]);
        const vec3 before = t * x.s.D[k], v = moved(k + 1, before);
        after = before;
        return v;
    }
    inline HOL_FORCED vec3 finish() const { return moved(0, vec3{}); }
};

// The first one: u in s.t becomes t, and `left` gets the rates of the velocities as they are rounded now.
template <bool uniform>
struct FirstPull {
    Pull<uniform> pull;
    vec3 d = {}, v1 = {};  // bond k + 1, atom k + 2

    FirstPull(const Block &block, const Projection &x, long n) : pull{block, x, x.s.t} { x.s.L[n] = vec{}; }
    inline HOL_FORCED void step(long k) {
        keep_velocity(k + 1, pull.step(k));
        pull.x.s.t[k] = pull.t;
        d = pull.x.s.D[k];
    }
    inline HOL_FORCED void finish() { keep_velocity(0, pull.finish()); }
    inline HOL_FORCED void keep_velocity(long k, const vec3 &v) {
        pull.x.v[k] = v;
        pull.x.left[k] = rate_of(d, v, v1);
        v1 = v;
    }
};

#if HOL_FOURS
// The same of one lane: u becomes t, and put(component, value) gets the velocities.
template <bool uniform, class Put>
HOL_INLINE void move_velocities(const Block &block, const Projection &x, vec *u, const Put &put) {
    const double *const v = &x.v[0].x.element, *const w = uniform ? nullptr : block.w3[0];
    pull_down(block.n, x.s.D, u, x.s.L, [&](long e, auto g) HOL_FORCED {
        typedef decltype(g) V;
        const V before = load_any<V>(v + e);
        put(e, uniform ? g + before : mul_add(load_any<V>(w + e), g, before));
    });
}

// The first one, and the substitution of the rates that it leaves, which waits for each bond as long as the rates of
// the next ones take.
template <bool uniform>
HOL_INLINE void pull_and_substitute(const Block &block, const Projection &x, bool twice) {
    double *const v = &x.v[0].x.element;
    x.s.L[block.n] = vec{};  // for Pull
    move_velocities<uniform>(block, x, x.s.t, [&](long e, auto value) HOL_FORCED { store_any(v + e, value); });
    const long n = block.n;
    double y = 0;
    const auto substitute = [&](long k, double rate) HOL_FORCED {
        if (__builtin_expect(x.strain != nullptr, 0)) rate += stretching(x.strain, x.s.D[k]).element;
        y = k == 0 ? rate : mul_add(x.s.L[k].element, y, rate);
        x.left[k].element = twice ? y * x.s.pivots[k].element : 0.0;
    };
    long k = 0;
    for (; k + 4 <= n; k += 4) {
        const four rate = rates_of_four(k, x.s.D, v);
        HOL_UNROLL
        for (int i = 0; i < 4; ++i) substitute(k + i, rate[i]);
    }
    for (; k < n; ++k) substitute(k, rate_of(x.s.D[k], x.v[k], x.v[k + 1]).element);
}
#else
template <bool uniform>
HOL_INLINE void first_pull(const Block &block, const Projection &x) {
    long k = block.n;
    FirstPull<uniform> pull(block, x, k);
    while (k % 4 != 0) pull.step(--k);
    while (k > 0) {
        k -= 4;
        pull.step(k + 3);
        pull.step(k + 2);
        pull.step(k + 1);
        pull.step(k);
    }
    pull.finish();
}
#endif

// From u to the velocities. The recursion gives the multipliers to a few roundings of themselves. A second substitution
// removes the rates that this leaves, for the velocities as they are rounded. This function prepares it if `twice`,
// which pays unless the velocities become floats. Returns the lanes in which all is finite.
template <bool uniform>
HOL_NOINLINE mask pull_back(const Block &block, const Projection &x, bool twice) {
#if HOL_FOURS
    pull_and_substitute<uniform>(block, x, twice);
#else
    first_pull<uniform>(block, x);
    long k;
    for (k = 0; x.strain && k < block.n; ++k) x.left[k] = x.left[k] + stretching(x.strain, x.s.D[k]);
    for (k = twice ? block.n_min : 0; k < block.n; ++k) x.left[k] = twice ? keep(joint(block, k), x.left[k]) : vec{};
    if (twice) substitute(block.n, x.correction());
#endif
    return x.finite(block.n);
}

static inline mask pull_back(const Block &block, const Projection &x, bool twice) {
    return block.uniform_w ? pull_back<true>(block, x, twice) : pull_back<false>(block, x, twice);
}

}  // namespace holonomic::HOL_ISA
