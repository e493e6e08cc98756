// Velocity level of molecules: the same equations with d . (v_j - v_i) on the right, v_i += w_i G_i. A second solve,
// for the rates of the velocities as they are rounded after the first, leaves d . (v_j - v_i) at their rounding.
#ifndef HOLONOMIC_KERNELS_MOLECULES_VELOCITIES_HPP
#define HOLONOMIC_KERNELS_MOLECULES_VELOCITIES_HPP

#include "core/kernels/molecules/blocks.hpp"
#include "core/kernels/molecules/large_tree/arms_velocities.hpp"
#include "core/kernels/molecules/store.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

template <class V>
HOL_NOINLINE void add_pulls_to(const Molecules<V> &x, Vector3<V> *v) {
    if (x.s.type == Schedule::ring) {
        Vector3<V> last = x.row[x.s.n_bonds - 1].t * x.row[x.s.n_bonds - 1].d;
        for (int32_t k = 0; k < x.s.n_bonds; ++k) {
            const Vector3<V> next = x.row[k].t * x.row[k].d;
            v[k] = add_times(v[k], x.w[k], next - last);
            last = next;
        }
        return;
    }
    for_ranges(x.s, x.pieces, x.s.n_atoms, [&](int32_t first, int32_t end) {
        for (int32_t slot = end; slot-- > first;) v[slot] = add_times(v[slot], x.w[slot], pull_on(x, slot));
    });
}

// d . (v_j - v_i) into t of the rows.
template <class V>
HOL_NOINLINE void find_rates(const Molecules<V> &x, const Vector3<V> *v) {
    for_ranges(x.s, x.pieces, x.s.n_bonds, [&](int32_t first, int32_t end) {
        for (int32_t k = first; k < end; ++k) {
            int32_t from, to;
            ends_of(x.s, k, from, to);
            x.row[k].t = dot(x.row[k].d, v[to] - v[from]);
            if (x.in.strain) x.row[k].t = x.row[k].t + stretching(x.in.strain, x.row[k].d);
        }
    });
}

template <class V>
static inline void write_velocities(const VelocitiesCall &call, const Molecules<V> &x, Vector3<V> *v, unsigned which) {
    write_vectors(call.v, x.at, x.s.slot_of, x.s.n_atoms, Slots<V>(v), Written<V>{which, nullptr, x.lane});
}
static inline void write_velocities(const VelocitiesCall &call, const Molecules<double> &x, Vector3<double> *v,
                                    unsigned which) {
    if (!x.pieces) return write_velocities<double>(call, x, v, which);
    for_slots(x.s, x.pieces, [&](int32_t first, int32_t end) {
        write_slots(x, call.v, first, end, [&](int32_t slot) { return v[slot]; });
    });
}

HOL_INLINE bool project_with_arms(Linear<vec> &, const VelocitiesCall &, Tally &) { return false; }  // has none

// Solves a block and writes.
template <class V>
static inline unsigned solve_block(const VelocitiesCall &call, Linear<V> &z, bool masses_known, Tally &tally) {
    z.equations.force = nullptr;
    z.equations.given = nullptr;
    if (has_arms(z)) return project_with_arms(z, call, tally) ? 0 : 1;
    z.x.in = {&call.v, nullptr, nullptr, true, call.strain};
    const unsigned solved = load_and_solve(z, rates, masses_known);
    const unsigned good = solved && !call.v.is_float && has_torn_atoms(z.x) ? 0 : solved;
    if (!good) return bits(z.x.in_use());
    if (call.lambda) write_bonds<false>(z.x, 0.5, call.lambda, good);
    if (call.virial) add_pulls_to_virial(z.x, good, tally);
    Vector3<V> *const v = z.equations.start;
    add_pulls_to(z.x, v);
    if (!call.v.is_float) {
        find_rates(z.x, v);
        solve_again(z);
        add_pulls_to(z.x, v);
    }
    write_velocities(call, z.x, v, good);
    return bits(z.x.in_use()) & ~good;
}

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
