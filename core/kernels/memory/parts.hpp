// Arrays that are not packed, a part of a unit at a time: molecules that stand one behind the other are copied to rows
// of doubles, worked on there as a unit of packed arrays, and written back. Whole vectors are copied, into the first
// cache, so this takes less than to copy each lane by itself; and no kernel needs to know any other layout. A part with
// a molecule that is bad is left as it was, and comes once more as what it is.
#pragma once

#include <stddef.h>

#include "core/kernels/memory/stage.hpp"
#include "core/kernels/tally.hpp"
#include "core/plan/elimination.hpp"

namespace holonomic::HOL_ISA {

// Of a part that need not be a single block, and of any.
constexpr int64_t atoms_of_part = 256, most_atoms_of_part = 512;

// An array of a call, and what is done with it.
template <class Call>
struct PartArray {
    AtomArray Call::*array;
    bool read, written;
};
// All of a call. moves: it counts the molecules that it moves, and writes nothing if there are none.
template <class Call>
struct PartArrays;
template <>
struct PartArrays<ForcesCall> {
    static constexpr int n = 4;
    static constexpr bool moves = false;
    PartArray<ForcesCall> of[n];
    explicit PartArrays(const ForcesCall &call)
        : of{{&ForcesCall::r, true, false},
             {&ForcesCall::v, true, false},
             {&ForcesCall::f, true, false},
             {&ForcesCall::g, call.add, true}} {}
};
template <>
struct PartArrays<VelocitiesCall> {
    static constexpr int n = 2;
    static constexpr bool moves = false;
    PartArray<VelocitiesCall> of[n];
    explicit PartArrays(const VelocitiesCall &)
        : of{{&VelocitiesCall::r, true, false}, {&VelocitiesCall::v, true, true}} {}
};
template <>
struct PartArrays<PositionsCall> {
    static constexpr int n = 3;
    static constexpr bool moves = true;
    PartArray<PositionsCall> of[n];
    explicit PartArrays(const PositionsCall &)
        : of{{&PositionsCall::r_ref, true, false}, {&PositionsCall::r, true, true}, {&PositionsCall::v, true, true}} {}
};

HOL_INLINE int64_t atoms_of(const Unit &unit) { return unit.lanes[0].n_bonds + 1; }
HOL_INLINE int64_t atoms_of(const MoleculeUnit &unit) { return unit.elimination->n_atoms; }
HOL_INLINE int64_t bonds_of(const Unit &unit) { return unit.lanes[0].n_bonds; }
HOL_INLINE int64_t bonds_of(const MoleculeUnit &unit) { return unit.elimination->n_bonds; }
HOL_INLINE int64_t &number_of(Lane &lane) { return lane.chain; }
HOL_INLINE int64_t &number_of(MoleculeLane &lane) { return lane.molecule; }
HOL_INLINE bool comes_in_parts(const Unit &) { return true; }
HOL_INLINE bool comes_in_parts(const MoleculeUnit &unit) {
    return !unit.tree_batches && unit.elimination->way.forces != Way::network && !unit.lanes[0].shared;
}

// Calls work(call, unit, tally) for parts of a unit that has several molecules. Returns false, and has done nothing,
// where it has not.
template <class Call, class AnyUnit, class Work>
HOL_NOINLINE bool in_packed_parts(const Call &call, const AnyUnit &unit, Tally &tally, const Work &work) {
    constexpr int n = PartArrays<Call>::n;
    const int64_t n_atoms = atoms_of(unit);
    if (unit.count < 2 || !unit.regular || unit.lanes[0].atoms || W * n_atoms > most_atoms_of_part ||
        !comes_in_parts(unit))
        return false;
    const int64_t most = 2 * W * n_atoms <= atoms_of_part ? atoms_of_part / (2 * W * n_atoms) * 2 * W : W;
    const PartArrays<Call> arrays(call);
    double buffer[n][3 * (most_atoms_of_part + W)];
    auto lane = unit.lanes[0];
    AnyUnit part = unit;
    part.lanes = &lane;
    part.large = false;
    for (int64_t first = 0; first < unit.count; first += most) {
        part.count = unit.count - first < most ? unit.count - first : most;
        lane = unit.lanes[0];
        lane.first_bond += first * bonds_of(unit);
        number_of(lane) += first;
        auto there = lane;
        there.first_atom += first * n_atoms;
        lane.first_atom = 0;
        const int64_t count = part.count * n_atoms;
        Lane all = {};  // the atoms of all molecules as those of a chain
        all.first_atom = there.first_atom;
        Call of_part = call;
        for (int a = 0; a < n; ++a) {
            const AtomArray &array = call.*arrays.of[a].array;
            if (!array.x) continue;
            double *const rows = buffer[a];
            if (arrays.of[a].read) {
                if (array.packed)
                    __builtin_memcpy(rows, reinterpret_cast<const double *>(array.x) + 3 * all.first_atom,
                                     static_cast<size_t>(count) * (3 * sizeof(double)));
                else
                    stage(array, all, 0, count - 1, rows);
            }
            for (int e = 0; e < 3 * W; ++e) rows[3 * count + e] = 0;
            char *const x = reinterpret_cast<char *>(rows);
            of_part.*arrays.of[a].array = {
                x, x + sizeof(double), x + 2 * sizeof(double), 3 * sizeof(double), array.is_float, true};
        }
        const Tally before = tally;
        part.padded = true;
        work(of_part, part, tally);
        if (__builtin_expect(tally.n_bad > before.n_bad, 0)) {
            tally = before;
            AnyUnit same = part;
            same.lanes = &there;
            same.padded = false;
            work(call, same, tally);
            continue;
        }
        if (PartArrays<Call>::moves && tally.n_corrected == before.n_corrected) continue;
        for (int a = 0; a < n; ++a) {
            const AtomArray &array = call.*arrays.of[a].array;
            if (!array.x || !arrays.of[a].written) continue;
            if (array.packed)
                __builtin_memcpy(reinterpret_cast<double *>(array.x) + 3 * all.first_atom, buffer[a],
                                 static_cast<size_t>(count) * (3 * sizeof(double)));
            else
                unstage(array, all, 0, count - 1, buffer[a], false);
        }
    }
    return true;
}

}  // namespace holonomic::HOL_ISA
