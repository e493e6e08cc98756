// Atoms of a large tree at which plain arithmetic won't do. Nothing else of the tree needs to be done again for them.
#pragma once

#include "core/kernels/molecules/molecules.hpp"

namespace holonomic::HOL_ISA::graph {

// One with at most three children, at which plain products have lost too much: copies of its bonds.
struct FlaggedAtom {
    static constexpr int most = 4;
    int k;  // children: bonds 0 .. k - 1; the one above is bond k
    double w;
    BondRow<double> bond[most];
    Vector3<double> d[most], low[most];  // the bonds with the low words that the differences of coordinates leave
    double pair[most];                   // multipliers among the children
};

// Eliminates it in twice the precision (flagged_joint.hpp): does what up_joint() does. Returns false, with nothing
// changed, if its bonds depend on each other.
bool up_flagged(FlaggedAtom &);

// Atoms at which a bond is cancelling (siblings.hpp): found in a first solution, then eliminated in extended precision
// in a second one. And all that have been eliminated in extended precision, or more than fit.
struct Cancelling {
    static constexpr int most = 31, most_extended = 20;
    int32_t n, index[most];
    int32_t n_extended, extended[most_extended];
    bool again;  // the second solution
    void note_extended(int32_t s) {
        if (n_extended < most_extended) extended[n_extended] = s;
        ++n_extended;
    }
    bool holds(int32_t s) const {
        for (int i = 0; i < n && again; ++i)
            if (index[i] == s) return true;
        return false;
    }
    bool note(int32_t s) {
        for (int i = 0; i < n; ++i)
            if (index[i] == s) return true;
        if (n == most) return false;
        index[n++] = s;
        return true;
    }
};

// Light atoms between heavy ones in line are pulled from both sides with much more than what moves them. Then the
// rounding of multipliers moves them by more than their velocity's, and when that is projected away, their neighbours,
// too. All such atoms have been eliminated in extended precision.
struct Overcorrected {
    static constexpr double part = 0x1p10;
    Vector3<double> pull;
    double sizes;
    explicit Overcorrected(const BondRow<double> &above)
        : pull(-above.t * above.d), sizes(abs(above.t) * sqrt(above.q)) {}
    void add_child(const BondRow<double> &bond) {
        pull = add_times(pull, bond.t, bond.d);
        sizes += abs(bond.t) * sqrt(bond.q);
    }
    // Whether the atom is overcorrected, which has the velocity v before.
    bool is(double w, const double *v) const {
        const Vector3<double> before = {v[0], v[1], v[2]}, after = add_times(before, w, pull);
        const auto size_of = [](const Vector3<double> &a) { return abs(a.x) + abs(a.y) + abs(a.z); };
        return !(w * sizes <= part * (size_of(before) + size_of(after)));
    }
};

}  // namespace holonomic::HOL_ISA::graph
