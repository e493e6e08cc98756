// The virial of a block of molecules, - sum t d (x) d over their bonds.
#ifndef HOLONOMIC_KERNELS_MOLECULES_VIRIAL_HPP
#define HOLONOMIC_KERNELS_MOLECULES_VIRIAL_HPP

#include "core/kernels/call.hpp"
#include "core/kernels/molecules/width.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

// The counterpart of memory/outputs.hpp: what a molecule adds does not depend on which of the two widths it has.
template <class V>
struct MoleculesVirial {
    V sum[6] = {};

    inline HOL_FORCED void add(const Vector3<V> &d, const Vector3<V> &p) {  // p = t d
        sum[0] = mul_add(p.x, d.x, sum[0]);
        sum[1] = mul_add(p.x, d.y, sum[1]);
        sum[2] = mul_add(p.x, d.z, sum[2]);
        sum[3] = mul_add(p.y, d.y, sum[3]);
        sum[4] = mul_add(p.y, d.z, sum[4]);
        sum[5] = mul_add(p.z, d.z, sum[5]);
    }
    // Counts factor times that of the lanes in `which`, in the order of the lanes.
    void count(unsigned which, double factor, Tally &tally) const {
        for (int c = 0; c < 6; ++c)
            for (int i = 0; i < Width<V>::lanes; ++i)
                if (which >> i & 1) tally.virial[c] -= factor * Width<V>::get(sum[c], i);
    }
};

// Of molecules of n bonds.
template <int n, class V>
HOL_NOINLINE void add_bonds_virial(const Vector3<V> *d, const V *t, double factor, unsigned which, Tally &tally) {
    MoleculesVirial<V> virial;
    HOL_UNROLL
    for (int k = 0; k < n; ++k) virial.add(d[k], t[k] * d[k]);
    virial.count(which, factor, tally);
}

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
