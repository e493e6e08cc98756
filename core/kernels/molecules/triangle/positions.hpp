// Position level of rigid water and other triangles: three atoms, all three distances. Reads a block, hands its
// three equations to Newton's method (theory (15)-(17), equations.hpp), and writes the moves, multipliers and
// virial. It needs no memory but registers; lanes that it can't do go to the extended-precision solver.
#pragma once

#include "core/kernels/molecules/triangle/model.hpp"

namespace holonomic::HOL_ISA::graph {

// A block at the position level: what is read, and how it is written.
template <Inlined where, class V, class Lanes>
struct TrianglePositions {
    const PositionsCall &call;
    const Lanes &lanes;
    const Atoms<V> &at;
    const TriangleMasses<V> &m;
    const TriangleLengths<V> &a;
    Tally &tally;
    V largest;  // coordinate

    TrianglePositions(const PositionsCall &c, const Lanes &list, const Atoms<V> &atoms, const TriangleMasses<V> &masses,
                      const TriangleLengths<V> &lengths, Tally &sums)
        : call(c), lanes(list), at(atoms), m(masses), a(lengths), tally(sums) {}

    inline HOL_FORCED void read_bonds(TriangleNewton<V> &x) {
        Vector3<V> r[3];
        read_all<where, 3>(call.r_ref, at, r);
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) x.b[k] = r[(k + 1) % 3] - r[k];
        take_images<3>(call.box_ref, x.b);
        read_all<where, 3>(call.r, at, r);
        V size[3];
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) {
            x.D[k] = r[(k + 1) % 3] - r[k];
            size[k] = max(max(abs(r[k].x), abs(r[k].y)), abs(r[k].z));
        }
        take_images<3>(call.box, x.D);
        largest = max(size[0], max(size[1], size[2]));
    }

    // Of copies: if the address of any part of x were passed on, all of x would go to memory in every block.
    inline HOL_FORCED void add_virial(const TriangleNewton<V> &x, unsigned which) {
        Vector3<V> bonds[3];
        V tau[3];
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) {
            bonds[k] = x.b[k];
            tau[k] = x.tau[k];
        }
        add_bonds_virial<3>(bonds, tau, 1 / (call.dt * call.dt), which, tally);
    }

    // The lanes of `good` have their multipliers, those of `moved` are written.
    inline HOL_FORCED void write(const TriangleNewton<V> &x, V error, unsigned good, unsigned moved, int64_t solves) {
        if (call.report) {
            V left[3];
            for (int k = 0; k < 3; ++k) left[bond_number(k)] = abs(x.left[k]) * a.per_a2[k];
            note_worst_bond<3>(left, lanes, error, good, tally);
        }
        if (call.lambda)
            write_triangle_bonds<where>(at, x.tau, Width<V>::all(0.5 / (call.dt * call.dt)), call.lambda, good);
        if (!moved) return;
        if (call.virial) add_virial(x, moved);
        Vector3<V> shift[3];
        HOL_UNROLL
        for (int i = 0; i < 3; ++i) shift[i] = x.shift[i];
        move_all<where, 3>(call, at, shift, moved);
        count_moved(tally, __builtin_popcount(moved), solves);
    }

    // Any lanes, from a guess if there is one: as other molecules are done. Returns those that are.
    __attribute__((noinline)) unsigned solve_step_by_step(unsigned wanted) {
        TriangleNewton<V> x(m, a);
        x.inverse = TriangleInverse<V>{};
        for (int k = 0; k < 3; ++k) {
            x.tau[k] = V{};
            x.shift[k] = Vector3<V>{};
        }
        read_bonds(x);
        if (call.guess) read_triangle_bonds(at, call.lambda, 2 * call.dt * call.dt, x.tau);
        const Limits<V> limits(call, largest * a.per_a_min);
        const Solved<V> out = iterate<V, true>(x, limits, call, Width<V>::of_bits(wanted));
        const unsigned moved = bits(out.converged & ~x.coarse_moves(largest)), good = moved | bits(out.untouched);
        write(x, out.error, good, moved, out.solves);
        return good;
    }

    // The lanes of `in_use`. Returns those that are done.
    inline HOL_FORCED unsigned solve(MaskOf<V> in_use) {
        TriangleNewton<V> x(m, a);
        read_bonds(x);
        const Limits<V> limits(call, largest * a.per_a_min);
        V error = x.open();
        const MaskOf<V> untouched = in_use & less_equal(error, limits.accepted);
        if (__builtin_expect(bits(untouched) == bits(in_use), 0)) {
            for (int k = 0; k < 3; ++k) x.tau[k] = V{};
            write(x, error, bits(untouched), 0, 0);
            return bits(untouched);
        }
        const TriangleModel<V> model(x);
        const MaskOf<V> near = less_equal(error, Width<V>::all(call.far_trial));
        const MaskOf<V> wanted = in_use & ~untouched & near & model.open_angle();
        MaskOf<V> unsure = wanted;
        const int64_t solves = solve_for_multipliers<3>(model, x.tau, unsure, call.max_iterations);
        // Bits from here on: masks of vectors take registers that the moves need.
        const unsigned solved = bits(wanted & ~unsure), as_they_came = bits(untouched);
        if (__builtin_expect(bits(wanted) != all_of<V>, 0))
            for (int k = 0; k < 3; ++k) x.tau[k] = keep(wanted, x.tau[k]);
        error = x.move();
        const unsigned moved = solved & bits(less_equal(error, limits.enough())) & ~bits(x.coarse_moves(largest));
        const unsigned good = moved | as_they_came;
        write(x, error, good, moved, solves);
        return good;
    }
};

}  // namespace holonomic::HOL_ISA::graph
