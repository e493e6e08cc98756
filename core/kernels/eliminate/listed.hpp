// Up and down the chains of a block that have lists of atoms. What needs more than plain arithmetic goes the general
// way, which copies such chains into staging buffers.
#ifndef HOLONOMIC_KERNELS_ELIMINATE_LISTED_HPP
#define HOLONOMIC_KERNELS_ELIMINATE_LISTED_HPP

#include "core/kernels/arithmetic/image.hpp"
#include "core/kernels/eliminate/chain.hpp"
#include "core/kernels/memory/atom_rows.hpp"
#include "core/kernels/memory/outputs.hpp"
#include "core/kernels/memory/packed.hpp"

namespace holonomic::HOL_ISA {

// As forward() in verbs/forces.cpp, from the lists. For rates it keeps the velocities in `velocities`. Returns the
// lanes that plain arithmetic can answer for and in which nothing overflows.
template <int terms, bool uniform>
HOL_NOINLINE mask forward_gathered(const Block &block, const Box &box, const AtomLists &at, const double *r,
                                   const double *v, const double *f, const System &s, vec3 *velocities) {
    const Source source = {&box, nullptr, r, at.atoms};
    Sweep<uniform, terms == rate> sweep{block, source, s};
    const bool boxed = box.shape != Box::none;
    vec3 r0 = gather(r, at, 0), v0 = {}, f0 = {};
    if (terms & (velocity_squared | rate)) v0 = gather(v, at, 0);
    if (terms & force_difference) f0 = gather(f, at, 0);
    if (terms & rate) velocities[0] = v0;
    const auto bond = [&](long k, bool starts_group) HOL_FORCED {
        at.fetch(k, block.list_ahead, r, terms & (velocity_squared | rate) ? v : nullptr,
                 terms & force_difference ? f : nullptr);
        const vec3 r1 = gather(r, at, k + 1);
        vec3 d = r1 - r0, dv = {}, df = {}, unused = {};
        if (boxed) wrap<false>(box, d, unused);
        s.D[k] = d;
        r0 = r1;
        if (terms & (velocity_squared | rate)) {
            const vec3 v1 = gather(v, at, k + 1);
            dv = v1 - v0;
            v0 = v1;
            if (terms & rate) velocities[k + 1] = v1;
        }
        if (terms & force_difference) {
            const vec3 f1 = gather(f, at, k + 1);
            const vec w0 = w_at<uniform>(block, k), w1 = w_at<uniform>(block, k + 1);
            df = {w1 * f1.x - w0 * f0.x, w1 * f1.y - w0 * f0.y, w1 * f1.z - w0 * f0.z};
            f0 = f1;
        }
        sweep.step(k, right_hand_side<terms>(box.shape == Box::triclinic, block.mass, d, dv, df), starts_group, false);
    };
    long k = 0;
    for (; k + 4 <= block.n; k += 4) {
        HOL_UNROLL
        for (int i = 0; i < 4; ++i) bond(k + i, i == 0);
    }
    for (; k < block.n; ++k) bond(k, k % 4 == 0);
    return ~sweep.doubt() & sweep.calm();
}

// As substitute_and_store(), to the lists.
template <Update update>
HOL_NOINLINE void substitute_and_scatter(const Block &block, const System &s, const AtomLists &at, double *out,
                                         double *value_out, vec factor) {
    vec t = {}, values[W];
    vec3 after = {};
    s.L[block.n] = vec{};
    const auto pull = [&](long k, const vec3 &before) HOL_FORCED {
        if (out) scatter<update>(out, at, k, after - before);
    };
    const auto bond = [&](long k) HOL_FORCED {
        t = mul_add(s.L[k + 1], t, s.t[k]);
        const vec3 p = t * s.D[k];
        pull(k + 1, p);
        after = p;
        return mul_add(factor, t, vec{});  // zeros as +0
    };
    const long full = block.n / W * W;
    for (long k = block.n - 1; k >= full; --k) {
        const vec value = bond(k);
        for (int i = 0; value_out && i < W; ++i) value_out[block.first_bond[i] + k] = value[i];
    }
    for (long k0 = full - W; k0 >= 0; k0 -= W) {
        HOL_UNROLL
        for (long b = W - 1; b >= 0; --b) values[b] = bond(k0 + b);
        if (!value_out) continue;
        store_values<false>(block, k0, values, all_lanes, value_out);
    }
    if (out) scatter<update>(out, at, 0, after);
}

template <int terms>
static inline mask forward_listed(const Block &block, const Box &box, const AtomLists &at, const AtomArray &r,
                                  const AtomArray &v, const AtomArray &f, const System &s, vec3 *velocities) {
    return choose(
        [&](auto uniform) {
            return forward_gathered<terms, uniform>(block, box, at, base_of(r), base_of(v), base_of(f), s, velocities);
        },
        block.uniform_w);
}

}  // namespace holonomic::HOL_ISA
#endif
