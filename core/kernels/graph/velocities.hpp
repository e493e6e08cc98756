// Velocity level of molecules: the same equations with d . (v_j - v_i) on the right, v_i += w_i G_i. A second solve,
// for the rates of the velocities as they are rounded after the first, leaves d . (v_j - v_i) at their rounding.
#ifndef HOLONOMIC_KERNELS_GRAPH_VELOCITIES_HPP
#define HOLONOMIC_KERNELS_GRAPH_VELOCITIES_HPP

#include "core/kernels/graph/arms_velocities.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

struct VelocitiesWork {
    const VelocitiesCall &call;
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
        Linear<V> z(schedule, lane, used, call.box, call.r, memory);
        open_pieces(z, team, memory);
        open_arms(z, scratch, memory);
        z.equations.force = nullptr;
        z.equations.given = nullptr;
        with_layout(z.x.at, packed, [&](auto layout) { solve<decltype(layout)::value>(z, masses_known, memory); });
    }

    template <Layout layout>
    void solve(Linear<double> &z, bool masses_known, Memory<double> memory) const {
        if (!z.pieces.arms.store) return solve<layout, double>(z, masses_known, memory);
        if (!project_with_arms<layout>(z, call, tally)) solve_doubtful(call, schedule, z.x.lane, 1, memory.next, tally);
    }
    template <Layout layout, class V>
    void solve(Linear<V> &z, bool masses_known, Memory<V> memory) const {
        z.x.in = {&call.v, nullptr, nullptr, true, call.strain};
        const unsigned solved = load_and_solve<layout, rates, true>(z, masses_known);
        const unsigned good = solved && !call.v.is_float && has_torn_atoms(z.x) ? 0 : solved;
        const unsigned rest = bits(z.x.in_use()) & ~good;
        if (good) {
            if (call.lambda) write_bonds<false>(z.x, 0.5, call.lambda, good);
            if (call.virial) add_pulls_to_virial(z.x, good, tally);
            Vector3<V> *const v = z.equations.start;
            if (!call.v.is_float) {
                add_pulls_to(z.x, v);
                find_rates(z.x, v);
                z.solve_again();
            }
            write_velocities<layout>(z.x, v, good);
        }
        if (__builtin_expect(rest != 0, 0)) solve_doubtful(call, schedule, z.x.lane, rest, memory.next, tally);
    }

    template <class V>
    __attribute__((noinline)) void add_pulls_to(const Molecules<V> &x, Vector3<V> *v) const {
        if (with_pulls_along(x, [&](auto pulls) HOL_FORCED {
                for (int32_t slot = 0; slot < x.s.n_atoms; ++slot)
                    v[slot] = add_times(v[slot], x.w[slot], pulls.next(slot));
            }))
            return;
        for_ranges(x.s, x.pieces, x.s.n_atoms, [&](int32_t first, int32_t end) {
            for (int32_t slot = end; slot-- > first;) v[slot] = add_times(v[slot], x.w[slot], pull_on(x, slot));
        });
    }

    // d . (v_j - v_i) into t of the rows.
    template <class V>
    __attribute__((noinline)) void find_rates(const Molecules<V> &x, const Vector3<V> *v) const {
        for_ranges(x.s, x.pieces, x.s.n_bonds, [&](int32_t first, int32_t end) {
            for (int32_t k = first; k < end; ++k) {
                int32_t from, to;
                ends_of(x.s, k, from, to);
                x.row[k].t = dot(x.row[k].d, v[to] - v[from]);
                if (x.in.strain) x.row[k].t = x.row[k].t + stretching(x.in.strain, x.row[k].d);
            }
        });
    }

    template <Layout layout, class V>
    __attribute__((noinline)) void write_velocities(const Molecules<V> &x, const Vector3<V> *v, unsigned which) const {
        if (with_pulls_along(x, [&](auto pulls) HOL_FORCED {
                write_along<layout>(x, call.v, which, [&](int32_t slot) HOL_FORCED {
                    return add_times(v[slot], x.w[slot], pulls.next(slot));
                });
            }))
            return;
        write_atoms<layout>(x, call.v, which,
                            [&](int32_t slot) HOL_FORCED { return add_times(v[slot], x.w[slot], pull_on(x, slot)); });
    }
};

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
