// Blocks whose chains have lists of atoms in packed arrays.
#include "core/kernels/arithmetic/image.hpp"
#include "core/kernels/memory/load.hpp"

namespace holonomic::HOL_ISA {

// From lists: one bond after the other, in the order of the addresses in these.
template <int terms>
static void load_listed(const Reader &in, long k0, long end, vec3 *D, vec *B, vec3 *velocities) {
    constexpr bool has_v = terms & of_velocities, has_f = terms & force_difference, keeps = terms & kept_rate;
    const Block &block = in.block;
    const Box &box = in.box;
    const AtomLists at = *in.lists;
    const double *const r = in.of_r, *const v = in.of_v, *const f = in.of_f;
    const vec *const w = block.uniform_w ? nullptr : block.w;
    const vec mass = block.mass;
    const Box::Lattice shape = box.lattice;
    vec3 r0 = gather(r, at, k0), v0 = {}, f0 = {}, unused = {};
    if (has_v) v0 = gather(v, at, k0);
    if (has_f) f0 = gather(f, at, k0);
    if (keeps) velocities[k0] = v0;
    const auto bond = [&](long k) HOL_FORCED {
        at.fetch(k, block.list_ahead, r, v, f);
        const vec3 r1 = gather(r, at, k + 1);
        vec3 d = r1 - r0, dv = {}, df = {};
        r0 = r1;
        if (shape == Box::triclinic)
            d = triclinic_image(box, d);
        else if (shape == Box::orthorhombic)
            wrap<false>(box, d, unused);
        D[k - k0] = d;
        if (has_v) {
            const vec3 v1 = gather(v, at, k + 1);
            dv = v1 - v0;
            v0 = v1;
            if (keeps) velocities[k + 1] = v1;
        }
        if (has_f) {
            const vec3 f1 = gather(f, at, k + 1);
            df = w ? w[k + 1] * f1 - w[k] * f0 : f1 - f0;
            f0 = f1;
        }
        B[k - k0] = keeps ? dot(d, dv) : right_hand_side(terms, mass, d, dv, df);
    };
    long k = k0;
    for (; k + 2 <= end; k += 2) {  // so that what is carried to the next bond stays where it is
        bond(k);
        bond(k + 1);
    }
    if (k < end) bond(k);
}

void load_listed(const Reader &in, long k0, long end, vec3 *D, vec *B, vec3 *velocities) {
    constexpr int both = velocity_squared | force_difference;
    switch (in.terms) {
        case kept_rate:
            return load_listed<kept_rate>(in, k0, end, D, B, velocities);
        case force_difference:
            return load_listed<force_difference>(in, k0, end, D, B, velocities);
        case both:
            return load_listed<both>(in, k0, end, D, B, velocities);
    }
}

}  // namespace holonomic::HOL_ISA
