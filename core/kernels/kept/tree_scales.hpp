// Bonds of kept trees that may be cancelling, looked at once more: by their scales themselves, and not by what these
// are at least (tree/siblings.hpp). A bond's scale |A^-1| S takes a row of the inverse, which is a solve with what is
// kept. Where right-hand sides are given, few multipliers are small differences by this, of hundred that seem to be.
#pragma once

#include "core/kernels/kept/trees.hpp"
#include "core/kernels/molecules/tree/siblings.hpp"

namespace holonomic::HOL_ISA::graph {

template <class V>
class KeptScales {
public:
    KeptScales(const Molecules<V> &molecules, const KeptTreesSolve<V> &solved, Memory<V> memory)
        : x_(molecules), solved_(solved), inverse_(solved.s, solved.kept, memory, solved.per_cancelled2),
          terms_(memory.values(solved.s.n_bonds)) {}

    // The lanes of `which` in which a bond is cancelling. shared: of an atom of the bond.
    __attribute__((noinline)) unsigned cancelling(int32_t bond_index, const V &shared, unsigned which) {
        const BondRow<V> row = this->row(bond_index);
        V margin = Width<V>::all(1);
        flag_cancelling_bond(x_, row, bond_index, shared, which, margin);
        const unsigned rest = bits(less(margin, V{}));
        if (!rest) return 0;
        const V scale = this->scale(bond_index);
        return rest & bits(less(mul_add(scale, scale, left_of(row, shared)), V{}));
    }
    BondRow<V> row(int32_t bond_index) const {
        const KeptBond<V> &bond = solved_.kept.bond[bond_index];
        return {bond.d, bond.q, solved_.value[bond_index].own, solved_.value[bond_index].t, bond.l, bond.r};
    }

private:
    V scale(int32_t of) {
        if (!knows_terms_) find_terms();
        inverse_.up([&](int32_t bond_index, int32_t, int32_t) HOL_FORCED { return Width<V>::all(bond_index == of); });
        inverse_.template down<false>(nullptr);
        V sum = {};
        for (int32_t k = 0; k < x_.s.n_bonds; ++k) sum = mul_add(abs(inverse_.value[k].t), terms_[k], sum);
        return sum;
    }
    void find_terms() {
        for (int32_t k = 0; k < x_.s.n_bonds; ++k) {
            terms_[k] = V{};
            for (int i = 0; i < x_.used; ++i) Width<V>::set(terms_[k], i, terms_of(x_, row(k), k, i));
        }
        knows_terms_ = true;
    }

    const Molecules<V> &x_;
    const KeptTreesSolve<V> &solved_, inverse_;
    V *const terms_;  // S of all bonds
    bool knows_terms_ = false;
};

// Looks again at the bonds of the n atoms that are flagged. Returns the lanes in which none is cancelling.
template <class V>
HOL_NOINLINE unsigned look_again(const KeptTreesSolve<V> &of, const Molecules<V> &x, int32_t n, Memory<V> memory) {
    KeptScales<V> scales(x, of, memory);
    unsigned left = bits(x.in_use());
    for (int32_t i = 0; i < n; ++i) {
        const int32_t index = of.flagged[i], k = of.children(index), first = of.first_child(index);
        const bool of_ring = index >= of.s.n_tree;
        const V shared = of.shared_error(index);
        for (int32_t a = of_ring ? -2 : -1; a < k; ++a) {
            const int32_t bond_index = a == -2 ? of.before(index) : a == -1 ? index : first + a;
            const unsigned which = left & bits(less(left_of(scales.row(bond_index), shared), V{}));
            if (which) left &= ~scales.cancelling(bond_index, shared, which);
        }
    }
    return left;
}

}  // namespace holonomic::HOL_ISA::graph
