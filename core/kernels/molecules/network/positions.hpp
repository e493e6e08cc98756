// Position level of a network.
#ifndef HOLONOMIC_KERNELS_MOLECULES_NETWORK_POSITIONS_HPP
#define HOLONOMIC_KERNELS_MOLECULES_NETWORK_POSITIONS_HPP

#include "core/kernels/molecules/network/newton.hpp"
#include "core/kernels/molecules/virial.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

struct NetPositions {
    const PositionsCall &call;
    const unsigned char *fixed;  // by local atom
    NetNewton newton;
    Tally &tally;
    double a_min = 1e300, a_max = 0, largest_coordinate = 0;

    NetPositions(const PositionsCall &c, const NetworkPlan &plan, const unsigned char *held, const MoleculeLane &lane,
                 bool packed, const LongTeam *team, Memory<double> memory, Tally &sum)
        : call(c), fixed(held), newton(plan, lane, packed, team, memory), tally(sum) {}

    __attribute__((noinline)) void load() {
        const Net &net = newton.net;
        const NetworkPlan &s = newton.s;
        net.read_masses();
        net.read_sites(call.r_ref, newton.r, false);
        net.find_bonds(call.box_ref, newton.r, newton.b);
        net.read_sites(call.r, newton.r, false);
        net.find_bonds(call.box, newton.r, newton.D);
        const double *const components[] = {newton.r.x, newton.r.y, newton.r.z};
        for (const double *x : components)
            for (int32_t i = 0; i < s.n_atoms; ++i) largest_coordinate = max(abs(x[i]), largest_coordinate);
        for (int32_t k = 0; k < s.n_bonds; ++k) {
            const double a = net.lane.length[s.bond_of[k]];
            a_min = min(a, a_min);
            a_max = max(a, a_max);
            newton.a2[k] = a * a;
            newton.per_a2[k] = 1 / (a * a);
            newton.tau[k] = call.guess ? 2 * call.dt * call.dt * call.lambda[net.lane.first_bond + s.bond_of[k]] : 0;
        }
        newton.opening = newton.measure_all<true>(newton.D);
    }

    // Whether a displacement is the difference of pulls whose rounding is more than the coordinates'.
    bool coarse_moves() const {
        const NetworkPlan &s = newton.s;
        double pull = 0;
        for (int32_t k = 0; k < s.n_bonds; ++k)
            pull = max(max(newton.net.w[s.from[k]], newton.net.w[s.to[k]]) * abs(newton.tau[k]), pull);
        return 0.25 * (largest_coordinate + a_min) < pull * a_max;
    }

    void write_atoms() const {
        const double per_dt = 1 / call.dt;
        const Net &net = newton.net;
        net.for_ranges_of(newton.s.n_atoms, [&](int32_t first, int32_t end) {
            for (int32_t i = first; i < end; ++i) {
                const int32_t atom = newton.s.atom_of[i];
                if (fixed[atom]) continue;
                const Vector3<double> move = newton.moves.get<double>(i);
                write(call.r, net.at, atom, newton.r.get<double>(i) + move, 1);
                if (call.v.x) write(call.v, net.at, atom, add_times(read(call.v, net.at, atom), per_dt, move), 1);
            }
        });
    }
    // The worst bond: the one with the smallest number among those.
    void note_worst(double error) {
        const MoleculeLane &lane = newton.net.lane;
        if (!is_worse(tally, error, lane.molecule)) return;
        tally.worst = error;
        tally.worst_chain = lane.molecule;
        int32_t bond = newton.s.n_bonds;
        for (int32_t k = 0; k < newton.s.n_bonds; ++k)
            if (newton.s.bond_of[k] < bond && newton.error_of(k) >= error) bond = newton.s.bond_of[k];
        tally.worst_bond = bond < newton.s.n_bonds ? bond : 0;
    }
    void write_results(bool moved) {
        const NetworkPlan &s = newton.s;
        const double per_dt2 = 1 / (call.dt * call.dt);
        for (int32_t k = 0; k < s.n_bonds && call.lambda; ++k)
            call.lambda[newton.net.lane.first_bond + s.bond_of[k]] = mul_add(newton.tau[k], 0.5 * per_dt2, 0.0);
        if (!moved) return;
        newton.displace();
        if (call.virial) {
            MoleculesVirial<double> virial;
            for (int32_t k = 0; k < s.n_bonds; ++k) {
                const Vector3<double> bond = newton.b.get<double>(k);
                virial.add(bond, newton.tau[k] * bond);
            }
            virial.count(1, per_dt2, tally);
        }
        write_atoms();
    }

    // Whether it is done; if not, nothing has been written.
    bool solve() {
        load();
        const Limits<double> limits(call, largest_coordinate, a_min);
        const Solved<double> out = iterate<double, false, true>(newton, limits, call, Flag{true});
        const bool moved = out.converged.set && !coarse_moves() && !newton.failed;
        if (!moved && !out.untouched.set) return false;
        if (call.report) note_worst(out.error);
        write_results(moved);
        tally.n_corrected += moved;
        if (moved && out.solves > tally.iterations) tally.iterations = out.solves;
        return true;
    }
};

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
