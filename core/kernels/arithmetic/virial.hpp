// The sum of t d (x) d over bonds, of which a virial is made: six of its nine components.
#pragma once

#include "core/kernels/arithmetic/exact.hpp"

namespace holonomic::HOL_ISA {

// xx, xy, xz, yy, yz, zz, as in Tally::virial. V: a number, or one of each lane.
template <class V>
struct BondTensors {
    V sum[6] = {};

    inline HOL_FORCED void add(const Vector3<V> &d, const Vector3<V> &p) {  // p = t d
        sum[0] = mul_add(p.x, d.x, sum[0]);
        sum[1] = mul_add(p.x, d.y, sum[1]);
        sum[2] = mul_add(p.x, d.z, sum[2]);
        sum[3] = mul_add(p.y, d.y, sum[3]);
        sum[4] = mul_add(p.y, d.z, sum[4]);
        sum[5] = mul_add(p.z, d.z, sum[5]);
    }
};

}  // namespace holonomic::HOL_ISA
