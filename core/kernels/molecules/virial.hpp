// The virial of a block of molecules, - sum t d (x) d over their bonds.
#pragma once

#include "core/kernels/arithmetic/virial.hpp"
#include "core/kernels/arithmetic/width.hpp"
#include "core/kernels/call.hpp"

namespace holonomic::HOL_ISA::graph {

// The counterpart of memory/outputs.hpp: what a molecule adds does not depend on which of the two widths it has.
template <class V>
struct MoleculesVirial : BondTensors<V> {
    // Counts factor times that of the lanes in `which`, in the order of the lanes.
    void count(unsigned which, double factor, Tally &tally) const {
        for (int c = 0; c < 6; ++c)
            for (int i = 0; i < Width<V>::lanes; ++i)
                if (which >> i & 1) tally.virial[c] -= factor * Width<V>::get(this->sum[c], i);
    }
};

// Counts factor times that of bonds k = first .. end - 1, of which d_of(k) and t_of(k) are known.
template <class V, class BondOf, class MultiplierOf>
HOL_INLINE void add_virial(int32_t first, int32_t end, const BondOf &d_of, const MultiplierOf &t_of, double factor,
                           unsigned which, Tally &tally) {
    MoleculesVirial<V> virial;
    for (int32_t k = first; k < end; ++k) {
        const Vector3<V> d = d_of(k);
        virial.add(d, t_of(k) * d);
    }
    virial.count(which, factor, tally);
}

// Of molecules of n bonds.
template <int n, class V>
HOL_NOINLINE void add_bonds_virial(const Vector3<V> *d, const V *t, double factor, unsigned which, Tally &tally) {
    MoleculesVirial<V> virial;
    HOL_UNROLL
    for (int k = 0; k < n; ++k) virial.add(d[k], t[k] * d[k]);
    virial.count(which, factor, tally);
}

}  // namespace holonomic::HOL_ISA::graph
