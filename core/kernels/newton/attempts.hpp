// What Newton's method takes from the caller, a guess, and what it writes: moves of atoms, multipliers, the worst bond,
// the virial; and the attempts at the positions of a block of chains. Compiled once, in attempts.cpp.
#pragma once

#include "core/kernels/memory/open.hpp"
#include "core/kernels/memory/outputs.hpp"
#include "core/kernels/newton/criterion.hpp"
#include "core/kernels/newton/iterate.hpp"
#include "core/kernels/tally.hpp"

namespace holonomic::HOL_ISA {

// The largest errors among the bonds first .. end-1 of each lane, all of them < n, and the first bonds that have them.
struct WorstBonds {
    vec error, bond;
};
WorstBonds find_worst(const Newton &, long n, vec first, vec end);

// Notes the worst bond of the lanes in `which`, if a report is wanted.
void note_worst(const Block &, const Newton &, const PositionsCall &, mask which, vec error, Tally &);

// Lanes in which the pulls on an atom are so large that their rounding exceeds that of the coordinates. This happens to
// light atoms between heavy ones in a taut chain. In all other lanes the move costs one rounding of the coordinates.
// `part`: of the coordinates, which pulls exceed.
constexpr double coarse_part = 0.25;
template <Same masses, int fixed = 0>
HOL_INLINE mask coarse_moves(const Block &block, const Newton &x, Carried &carried, mask which, double part) {
    vec pull = {};
    go_up<fixed>(block, [&](long k, bool) HOL_FORCED {
        const vec tau = abs(x.tau[k]);
        pull = max(masses == same ? tau : max(x.w[k], x.w[k + 1]) * tau, pull);
    });
    pull = pull * x.a_max;
    if (!any(which & less(part * x.a_min, pull))) return none();
    return which & less(part * (carried.largest_coordinate() + x.a_min), pull);
}
mask coarse_moves(const Block &, const Newton &, Carried &, mask which, double part = coarse_part);

// Moves the atoms first .. n of the lanes in `which` by the multipliers: those in `r`, and as a rate those in `v`; one
// of them may have no rows. `before`: t b of the bond before atom `first`.
void move_atoms(const Block &, const Newton &, mask which, const Packed &r, const Packed &v, double per_dt,
                long first = 0, const vec3 &before = vec3{});
// The same of atom 0 alone; chosen: bits of the lanes.
void move_first(const Newton &, unsigned chosen, const Packed &r, const Packed &v, double per_dt);

// Counts the virial of the moves, - sum tau b (x) b / dt^2.
void add_virial(const Block &, const Newton &, mask which, double dt, Tally &);

// A block of chains whose positions are sought.
struct Positions {
    const Block &block;
    const Lane *const lane;
    const PositionsCall &call;
    Arena arena;
    Tally &tally;
    Packed r_ref, r, v;
    Newton x;

    Positions(const Block &, const Lane *, const PositionsCall &, const BondLengths &, Arena, Tally &);
    void load() const;  // bond vectors
    void solve();

private:
    mask extended_lanes = {};  // done by the extended-precision solver
    mask settle(mask coarse, Carried &, NewtonOutcome &);
    mask solve_extended(mask coarse, Carried &);
    void finish(NewtonOutcome &, Carried &, bool moved);
};

// Chains that have lists of atoms in packed arrays: the same, on atoms read where the lists say. True if the block is
// done. On false nothing was written: a lane needs more than the first attempt, or no move at all.
bool listed_positions(const Block &, const Lane *, const PositionsCall &, const BondLengths &, Arena, Tally &);

}  // namespace holonomic::HOL_ISA
