// Position level of one large molecule: positions.hpp along a list.
#ifndef HOLONOMIC_KERNELS_GRAPH_FLAT_POSITIONS_HPP
#define HOLONOMIC_KERNELS_GRAPH_FLAT_POSITIONS_HPP

#include "core/kernels/graph/flat_newton.hpp"
#include "core/kernels/graph/iterate.hpp"
#include "core/kernels/graph/schedule.hpp"
#include "core/kernels/graph/virial.hpp"
#include "core/kernels/tally.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

template <Layout layout>
struct FlatPositions {
    const PositionsCall &call;
    const Schedule &schedule;
    const MoleculeLane &lane;
    const Atoms<double> at;
    FlatNewton newton;
    Tally &tally;
    double a_min, a_max, largest_coordinate;

    FlatPositions(const PositionsCall &c, const Schedule &s, const MoleculeLane &l, Memory<double> memory, Tally &sum)
        : call(c), schedule(s), lane(l), at(&l, 1), newton(*s.flat, memory), tally(sum), a_min(), a_max(),
          largest_coordinate() {}

    __attribute__((noinline)) void load() {
        const FlatList &s = newton.s;
        for (int32_t i = 0; i < s.n_atoms; ++i) {
            newton.mass[2 * s.place_of[i]] = -lane.w[i];
            newton.mass[2 * s.place_of[i] + 1] = lane.w[i];
        }
        newton.mass[2 * s.n_atoms] = 0;
        const Rows r = newton.new_D;  // until the bonds are made
        read_atoms<layout>(call.r_ref, at, s, r);
        find_bonds(s.from, s.to, s.n_bonds, call.box_ref, r, newton.b);
        read_atoms<layout>(call.r, at, s, r);
        Row largest = {};
        for (int32_t i = 0; i < s.n_atoms; ++i) largest = larger(absolute(r[i]), largest);
        largest_coordinate = largest_of(largest);
        find_bonds(s.from, s.to, s.n_bonds, call.box, r, newton.D);
        load_lengths();
        for (int32_t k = 0; k < s.n_bonds && call.guess; ++k)
            newton.tau[k] = 2 * call.dt * call.dt * call.lambda[lane.first_bond + s.bond_of[k]];
    }
    void load_lengths() {
        const FlatList &s = newton.s;
        Row least = in_row(1e300), most = {};
        for (int64_t k = 0; k < s.n_bonds; k += 4) {
            const int32_t *const bond = s.bond_of + k;
            const Row a = {lane.length[bond[0]], lane.length[bond[1]], lane.length[bond[2]], lane.length[bond[3]]},
                      a2 = a * a;
            least = smaller(a, least);
            most = larger(a, most);
            *reinterpret_cast<Row *>(newton.a2 + k) = a2;
            *reinterpret_cast<Row *>(newton.per_a2 + k) = in_row(1) / a2;
            *reinterpret_cast<Row *>(newton.tau + k) = Row{};
        }
        for (int64_t k = s.n_bonds; k < in_fours(s.n_bonds); ++k) newton.a2[k] = newton.per_a2[k] = 0;  // inert
        a_min = smallest_of(least);
        a_max = largest_of(most);
    }

    // Whether an atom's displacement is the difference of pulls so large that their rounding is more than the
    // coordinates'.
    bool coarse_moves() const {
        double pull = 0;
        for (int32_t k = 0; k < newton.s.n_bonds; ++k) {
            const double w = max(newton.mass[newton.s.from[k] / 2 + 1], newton.mass[newton.s.to[k] / 2 + 1]);
            pull = max(w * abs(newton.tau[k]), pull);
        }
        return 0.25 * (largest_coordinate + a_min) < pull * a_max;
    }

    __attribute__((noinline)) void write_atoms() const {
        const double per_dt = 1 / call.dt;
        for (int32_t i = 0; i < newton.s.n_atoms; ++i) {
            if (schedule.fixed[i]) continue;
            const Row &move = newton.moves[newton.s.place_of[i]];
            write<layout>(call.r, at, i, vector_of(read_row_of<layout>(call.r, at, i) + move), 1);
            if (call.v.x)
                write<layout>(call.v, at, i,
                              vector_of(multiply_add(in_row(per_dt), move, read_row_of<layout>(call.v, at, i))), 1);
        }
    }

    void write_multipliers() const {
        const double factor = 0.5 / (call.dt * call.dt);
        for (int32_t k = 0; k < newton.s.n_bonds; ++k)
            call.lambda[lane.first_bond + newton.s.bond_of[k]] = mul_add(newton.tau[k], factor, 0.0);
    }

    void add_virial() const {
        MoleculesVirial<double> virial;
        for (int32_t k = 0; k < newton.s.n_bonds; ++k) {
            const Vector3<double> b = vector_of(newton.b[k]);
            virial.add(b, newton.tau[k] * b);
        }
        virial.count(1, 1 / (call.dt * call.dt), tally);
    }

    // The worst bond: the one with the smallest number among those.
    void note_worst(double error) {
        if (!is_worse(tally, error, lane.molecule)) return;
        tally.worst = error;
        tally.worst_chain = lane.molecule;
        int32_t bond = newton.s.n_bonds;
        for (int32_t k = 0; k < newton.s.n_bonds; ++k)
            if (newton.s.bond_of[k] < bond && newton.error_of(k) >= error) bond = newton.s.bond_of[k];
        tally.worst_bond = bond < newton.s.n_bonds ? bond : 0;
    }

    // Whether it is done; if not, nothing has been written.
    bool solve() {
        load();
        const Limits<double> limits(call, largest_coordinate, a_min);
        const Solved<double> out = iterate<double, false, true>(newton, limits, call, Flag{true});
        const bool moved = out.converged.set && !coarse_moves();
        if (!moved && !out.untouched.set) return false;
        if (call.report) note_worst(out.error);
        if (call.lambda) write_multipliers();
        if (!moved) return true;
        newton.displace();
        if (call.virial) add_virial();
        write_atoms();
        ++tally.n_corrected;
        if (out.solves > tally.iterations) tally.iterations = out.solves;
        return true;
    }
};

// The same in any layout.
static inline bool solve_flat(const PositionsCall &call, const Schedule &s, const MoleculeLane &lane, bool packed,
                              Memory<double> memory, Tally &tally) {
    return with_layout(Atoms<double>(&lane, 1), packed, [&](auto layout) {
        return FlatPositions<decltype(layout)::value>(call, s, lane, memory, tally).solve();
    });
}

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
