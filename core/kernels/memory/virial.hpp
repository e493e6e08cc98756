// The virial of constraint forces: - sum t d (x) d over bonds.
#ifndef HOLONOMIC_KERNELS_MEMORY_VIRIAL_HPP
#define HOLONOMIC_KERNELS_MEMORY_VIRIAL_HPP

#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/call.hpp"

namespace holonomic::HOL_ISA {

// Of W lanes.
struct VirialSum {
    vec xx = {}, xy = {}, xz = {}, yy = {}, yz = {}, zz = {};

    HOL_FORCED void add(const vec3 &d, const vec3 &p) {  // p = t d
        xx = mul_add(p.x, d.x, xx);
        xy = mul_add(p.x, d.y, xy);
        xz = mul_add(p.x, d.z, xz);
        yy = mul_add(p.y, d.y, yy);
        yz = mul_add(p.y, d.z, yz);
        zz = mul_add(p.z, d.z, zz);
    }
    // Counts factor times that of the lanes in `which`.
    void count(mask which, vec factor, Tally &tally) const {
        const vec sum[6] = {xx, xy, xz, yy, yz, zz};
        for (int c = 0; c < 6; ++c) tally.virial[c] -= sum_lanes(keep(which, factor * sum[c]));
    }
};

static inline void add_virial(long n, const vec3 *d, const vec *t, mask which, vec factor, Tally &tally) {
    VirialSum sum;
    for (long k = 0; k < n; ++k) sum.add(d[k], t[k] * d[k]);
    sum.count(which, factor, tally);
}

}  // namespace holonomic::HOL_ISA
#endif
