// Constraint forces of molecules, and multipliers for given right-hand sides.
#ifndef HOLONOMIC_KERNELS_MOLECULES_FORCES_HPP
#define HOLONOMIC_KERNELS_MOLECULES_FORCES_HPP

#include "core/kernels/molecules/blocks.hpp"
#include "core/kernels/molecules/doubtful.hpp"
#include "core/kernels/molecules/list/flat_verbs.hpp"
#include "core/kernels/molecules/solve.hpp"
#include "core/kernels/molecules/store.hpp"
#include "core/kernels/molecules/triangle/triangle_blocks.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

template <class V>
static inline void write_outputs(Linear<V> &z, const Outputs &out, unsigned which, Tally &tally) {
    const Molecules<V> &x = z.x;
    if (out.lambda) write_bonds<false>(x, 0.5, out.lambda, which);
    if (out.tension) write_bonds<true>(x, 1, out.tension, which);
    if (out.virial) add_pulls_to_virial(x, which, tally);
    if (out.g->x) write_pulls(x, *out.g, out.add, which);
}
static inline void write_outputs(Linear<double> &z, const Outputs &out, unsigned which, Tally &tally) {
    write_outputs<double>(z, out, which, tally);
    if (which && z.x.pieces && z.x.pieces->arms.store) write_arms(z.x, false, out, tally);
}

struct ForcesWork {
    const ForcesCall &call;
    const Schedule &schedule;
    const bool packed;
    Tally &tally;
    const LongTeam *team;

    template <class V>
    void block(const MoleculeLane *lane, int used, bool masses_known, double *scratch) const {
        if (schedule.flat && schedule.type == Schedule::graph && used == 1) {
            if (solve_flat(call, schedule, *lane, packed, {scratch}, tally)) return;
            masses_known = false;
        }
        Memory<V> memory = {scratch};
        Linear<V> z(schedule, lane, used, packed, call.box, call.r, memory);
        open_pieces(z, team, memory);
        open_arms(z, scratch, memory);
        if (!call.v.x) z.equations.velocity = nullptr;
        if (!call.f.x) z.equations.force = nullptr;
        z.equations.given = nullptr;
        z.x.in = {&call.v, &call.f, nullptr, false};
        const unsigned good = load_and_solve(z, (call.v.x ? squares : 0) | (call.f.x ? pulls : 0), masses_known),
                       rest = bits(z.x.in_use()) & ~good;
        write_outputs(z, {&call.g, call.lambda, call.tension, call.add, call.virial}, good, tally);
        if (__builtin_expect(rest != 0, 0)) solve_doubtful(call, schedule, z.x.lane, rest, memory.next, tally);
    }
};

struct SolveWork {
    const SolveCall &call;
    const Schedule &schedule;
    const bool packed;
    Tally &tally;
    const LongTeam *team;

    template <class V>
    void block(const MoleculeLane *lane, int used, bool masses_known, double *scratch) const {
        if (schedule.flat && schedule.type == Schedule::graph && used == 1) {
            if (solve_flat(call, schedule, *lane, packed, {scratch}, tally)) return;
            masses_known = false;
        }
        Memory<V> memory = {scratch};
        Linear<V> z(schedule, lane, used, packed, call.box, call.r, memory);
        open_pieces(z, team, memory);
        z.equations.velocity = z.equations.force = nullptr;
        z.x.in = {nullptr, nullptr, call.rhs, false};
        const unsigned good = load_and_solve(z, given, masses_known), rest = bits(z.x.in_use()) & ~good;
        write_outputs(z, {&call.g, call.lambda, call.tension, call.add, call.virial}, good, tally);
        if (__builtin_expect(rest != 0, 0)) solve_doubtful(call, schedule, z.x.lane, rest, memory.next, tally);
    }
};

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
