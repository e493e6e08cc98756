// Atoms of one large tree at which plain products lose too much, or whose bonds are cancelling (tree/siblings.hpp).
// Nothing else of it needs to be done again: such an atom is eliminated in twice the precision.
#pragma once

#include "core/kernels/molecules/tree/flagged_atom.hpp"
#include "core/kernels/molecules/tree_batch/sweeps.hpp"

namespace holonomic::HOL_ISA::graph {

// Of a bond in one lane.
inline BondRow<double> one_of(const BondRow<vec> &row, int i) {
    return {one_of(row.d, i), row.q[i], row.E[i], row.t[i], row.l[i], row.r[i]};
}

// Bonds, by element, whose multipliers are small differences as far as their atoms can tell, with the least scales that
// would do.
struct SmallDifferences {
    static constexpr int most = 4;
    int32_t n, element[most];
    double least[most];
    bool note(int32_t e, double scale) {
        if (n == most) return false;
        element[n] = e;
        least[n++] = scale;
        return true;
    }
};

// Of a tile, or of the top. An atom's number in `cancelling` is that of its step times that of lanes, plus its lane.
struct TreeFlagged {
    Cancelling *cancelling;
    SmallDifferences *small;
    double *margin;  // negative if the tree is to be left to the extended-precision solver

    template <int k>
    struct Values {
        vec E[k + 1], t[k + 1];
        HOL_FORCED void keep(const BatchJoint &joint) {
            HOL_UNROLL
            for (int a = 0; a < k; ++a) {
                E[a] = joint.child[a].E;
                t[a] = joint.child[a].t;
            }
            t[k] = joint.top.t;
        }
    };
    HOL_FORCED vec begin(vec) const { return splat(1); }
    template <int k>
    HOL_FORCED vec end(const BatchJoint &joint, const Values<k> &before, vec own, vec margin_so_far) const {
        const mask lost = less(own, vec{});
        if (__builtin_expect(any(lost) || (cancelling->again && cancelling->n > 0), 0))
            repair(joint, before.E, before.t, bits(lost));
        return margin_so_far;
    }
    // Atoms of more than three children have no other way.
    HOL_FORCED vec end(const BatchJoint &joint, const Values<0> &, vec own, vec margin_so_far) const {
        return held_lanes(joint.step) ? splat(-1) : min(own, margin_so_far);
    }
    void note_small(int32_t element, double least, double size) const {
        if (!(least <= size) && !small->note(element, least)) *margin = -1;
    }
    // The lanes of a step that have been noted.
    unsigned held_lanes(int32_t step) const {
        unsigned lanes = 0;
        for (int i = 0; cancelling->again && cancelling->n > 0 && i < W; ++i)
            lanes |= cancelling->holds(step * W + i) ? 1u << i : 0u;
        return lanes;
    }

    // E, t: of the children as they were, then t of the bond above.
    __attribute__((noinline)) void repair(const BatchJoint &joint, const vec *E, const vec *t, unsigned lost) const {
        const TreeBatch::Step &step = joint.x.f.step[joint.step];
        const unsigned lanes = (lost | held_lanes(joint.step)) & joint.x.f.held[step.first];
        for (unsigned left = lanes; left; left &= left - 1) {
            const int i = __builtin_ctz(left);
            FlaggedAtom atom = {};
            const int k = atom.k = joint.children(i);
            atom.w = joint.w()[i];
            for (int a = 0; a <= k; ++a) {
                atom.bond[a] = one_of(a < k ? joint.child[a] : joint.top, i);
                if (a < k) atom.bond[a].E = E[a][i];
                atom.bond[a].t = t[a < k ? a : step.children][i];
                joint.exact(joint.element(a, i, k), atom.d[a], atom.low[a]);
            }
            if (!up_flagged(atom)) *margin = -1;
            for (int a = 0; a <= k; ++a) {
                BondRow<vec> &row = a < k ? joint.child[a] : joint.top;
                row.E[i] = atom.bond[a].E;
                row.t[i] = atom.bond[a].t;
                row.l[i] = atom.bond[a].l;
                row.r[i] = atom.bond[a].r;
            }
            for (int p = 0; p < k * (k - 1) / 2; ++p) joint.pairs[p][i] = atom.pair[p];
            cancelling->note_extended(joint.step * W + i);
        }
    }

    // The first time an atom is noted, to be eliminated in extended precision the next time. Then products are right,
    // and a result must not be a small difference of what comes up and what comes down, beside its scale.
    __attribute__((noinline)) void note_cancelling(const BatchJoint &joint, int k, unsigned which) const {
        vec own = splat(1);
        joint.flag_cancelling(k, which, own);
        for (unsigned left = which & bits(less(own, vec{})); left; left &= left - 1) {
            const int i = __builtin_ctz(left);
            if (!cancelling->again) {
                if (!cancelling->note(joint.step * W + i)) *margin = -1;
                continue;
            }
            if (!cancelling->holds(joint.step * W + i)) *margin = -1;
            for (int a = 0; a < joint.children(i); ++a) {
                const BondRow<vec> &row = joint.child[a];
                const int32_t element = joint.element(a, i, k);
                const double t = row.t[i], down = row.l[i] * joint.top.t[i],
                             size = abs(t) + joint.terms_of_bond(element) / joint.diagonal_of(element),
                             terms = abs(t - down) + abs(down);
                note_small(element, sqrt(joint.x.per_cancelled2) * terms, size);
            }
        }
    }
};

}  // namespace holonomic::HOL_ISA::graph
