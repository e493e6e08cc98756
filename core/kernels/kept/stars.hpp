// Kept factors of stars of three bonds, CH3 and NH3, in registers: bonds and S^-1 (theory (52)) are kept.
// star/linear.hpp has the equations and the test that plain products will do.
#pragma once

#include "core/kernels/kept/flagged.hpp"
#include "core/kernels/molecules/star/linear.hpp"

namespace holonomic::HOL_ISA::graph {

// A kept star of three bonds.
template <class V>
struct KeptStar {
    double lanes[most_lanes];  // the first one, bit by bit
    V d[9], q[3], adj[6], r;
    void keep(const Star<3, V> &star, unsigned good) {
        lanes[0] = static_cast<double>(good);
        for (int k = 0, e = 0; k < 3; ++k) {
            put(*reinterpret_cast<Vector3<V> *>(d + 3 * k), star.d[k]);
            q[k] = star.q[k];
            for (int l = k; l < 3; ++l, ++e) adj[e] = star.adj[k][l];
        }
        r = star.r;
    }
    inline HOL_FORCED void take(Star<3, V> &star) const {
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) {
            star.d[k] = {d[3 * k], d[3 * k + 1], d[3 * k + 2]};
            star.q[k] = q[k];
            HOL_UNROLL
            for (int l = k; l < 3; ++l) star.adj[k][l] = star.adj[l][k] = adj[k == 0 ? l : k + l + 1];
        }
        star.r = r;
        star.margin = V{};
    }
};

struct KeepStars {
    static constexpr bool in_steps = false;
    template <int N, class V>
    using Kind = StarMasses<N, V>;
    const KeepCall &call;

    template <Inlined where, class V>
    __attribute__((noinline)) unsigned solve(const StarAtoms<where, 3, V> &atoms, const MoleculeLane *lane,
                                             const StarMasses<3, V> &m, MaskOf<V> in_use) const {
        typedef KeptStar<V> Stored;
        double *const room =
            call.kept->room(call.kept->owner, lane[0].molecule, static_cast<int64_t>(sizeof(Stored) / sizeof(double)));
        if (!room) return 0;
        Vector3<V> r[4];
        const V nothing[3] = {};
        Star<3, V> star(m);
        atoms.read(call.r, r);
        atoms.take_bonds(r, call.box, star.d);
        star.invert();
        const unsigned good = bits(in_use & star.good(nothing, nothing));
        reinterpret_cast<Stored *>(room)->keep(star, good);
        return good;
    }
};

struct SolveStars {
    static constexpr bool in_steps = false;
    template <int N, class V>
    using Kind = StarMasses<N, V>;
    const KeptCall &call;
    const ForcesCall forces;
    Tally &tally;

    template <Inlined where, class V>
    __attribute__((noinline)) unsigned solve(const StarAtoms<where, 3, V> &atoms, const MoleculeLane *lane,
                                             const StarMasses<3, V> &m, MaskOf<V> in_use) const {
        const double *const from = call.kept->block[lane[0].molecule];
        if (!from) return bits(in_use);  // they are left already
        const KeptStar<V> &kept = *reinterpret_cast<const KeptStar<V> *>(from);
        const StarForcesVerb verb = {forces, tally};
        Star<3, V> star(m);
        V y[3];
        kept.take(star);
        if (call.rhs) {
            HOL_UNROLL
            for (int k = 0; k < 3; ++k) {
                HOL_UNROLL
                for (int i = 0; i < Width<V>::lanes; ++i) Width<V>::set(y[k], i, call.rhs[atoms.at.bond[i] + k]);
                y[k] = Width<V>::all(0.5) * y[k];
            }
        } else {
            verb.find_sides(atoms, star, y);
        }
        const unsigned lanes = static_cast<unsigned>(kept.lanes[0]);
        return verb.finish(atoms, star, y, in_use & Width<V>::of_bits(lanes)) | (bits(in_use) & ~lanes);
    }
};

// Stars that closed forms don't answer for.
struct LeaveStars {
    unsigned char *const left;
    NextMolecules &ahead;
    static constexpr bool packed = true;
    template <class V>
    void block(const MoleculeLane *lane, int, bool, double *) const {
        leave(lane, 1, left);
    }
};
struct ExtendedStars {
    const KeptCall &call;
    const EliminationPlan &elimination;
    NextMolecules &ahead;
    Tally &tally;
    static constexpr bool packed = true;
    template <class V>
    void block(const MoleculeLane *lane, int, bool, double *scratch) const {
        solve_extended(call, elimination, lane, 1, scratch, tally);
    }
};

}  // namespace holonomic::HOL_ISA::graph
