// Position level of a network.
#pragma once

#include "core/kernels/molecules/network/newton.hpp"
#include "core/kernels/molecules/virial.hpp"

namespace holonomic::HOL_ISA::graph {

struct NetPositions {
    const PositionsCall &call;
    const unsigned char *fixed;  // by local atom
    NetNewton newton;
    Tally &tally;
    double a_min = 1e300, a_max = 0, largest_coordinate = 0;
    double *largest;  // [n_shares + 1] of parts: coordinates, then squares of lengths, then their inverses

    static int64_t values(const NetworkPlan &s) { return NetNewton::values(s) + 3 * in_fours(s.n_shares + 1); }

    NetPositions(const PositionsCall &c, const NetworkPlan &plan, const unsigned char *held, const MoleculeLane &lane,
                 bool packed, const LongTeam *team, Memory<double> memory, Tally &sum)
        : call(c), fixed(held), newton(plan, lane, packed, team, memory), tally(sum),
          largest(memory.next + NetNewton::values(plan)) {}

    Net3 r_of(const NetPart &part) const { return newton.net.is_rest(part) ? newton.r : part.of_sites(1); }
    // Reference positions stand where moves will, until bonds are made of them.
    void read_atoms(const NetPart &part, int32_t first, int32_t end) const {
        const NetReading all[] = {{&call.r_ref, newton.moves_of(part), false}, {&call.r, r_of(part), false}};
        newton.net.read_sites(first, end, all, 2);
    }
    void read_part(const NetPart &part) const {
        const Net &net = newton.net;
        const Net3 r = r_of(part);
        net.find_bonds(part, call.box_ref, newton.moves, newton.moves_of(part), newton.b);
        net.find_bonds(part, call.box, newton.r, r, newton.D);
        for (int32_t k = part.first_place; k < part.end_place; ++k) {
            const double a = net.lane.length[newton.s.bond_of[k]];
            newton.a2[k] = a * a;
            newton.per_a2[k] = 1 / (a * a);
            newton.tau[k] =
                call.guess ? 2 * call.dt * call.dt * call.lambda[net.lane.first_bond + newton.s.bond_of[k]] : 0;
        }
        const double *const components[] = {r.x, r.y, r.z};
        double coordinate = 0;
        for (const double *x : components)
            coordinate = max(largest_of(x + part.first_site, part.end_site - part.first_site), coordinate);
        const int32_t n = newton.s.n_shares + 1, n_places = part.end_place - part.first_place;
        largest[part.share] = coordinate;
        largest[n + part.share] = largest_of(newton.a2 + part.first_place, n_places);
        largest[2 * n + part.share] = largest_of(newton.per_a2 + part.first_place, n_places);
        newton.worst[part.share] = newton.measure_fresh(part, newton.D);
        if (!call.guess) newton.factorize_part(part, newton.D);
    }
    __attribute__((noinline)) void load() {
        const Net &net = newton.net;
        const NetworkPlan &s = newton.s;
        const NetPart rest = net.rest();
        net.for_ranges(rest.first_site, rest.end_site,
                       [&](int32_t first, int32_t end) { read_atoms(rest, first, end); });
        read_part(rest);
        net.for_parts([&](const NetPart &part) {
            read_atoms(part, part.first_site, part.end_site);
            read_part(part);
        });
        newton.opening = newton.worst_of_all();
        const int32_t n = s.n_shares + 1;
        largest_coordinate = largest_of(largest, n);
        a_max = sqrt(largest_of(largest + n, n));
        a_min = 1 / sqrt(largest_of(largest + 2 * n, n));
    }
    static double largest_of(const double *x, int32_t n) {
        vec most = {};
        int32_t i = 0;
        for (; i + W <= n; i += W) most = max(abs(load_any<vec>(x + i)), most);
        double all = 0;
        for (int j = 0; j < W; ++j) all = max(Width<vec>::get(most, j), all);
        for (; i < n; ++i) all = max(abs(x[i]), all);
        return all;
    }

    // Whether a displacement is the difference of pulls whose rounding is more than the coordinates'.
    bool coarse_moves() const {
        const NetworkPlan &s = newton.s;
        const double most = 0.25 * (largest_coordinate + a_min);
        double pull = largest_of(newton.net.w, s.n_atoms) * largest_of(newton.tau, s.n_bonds);
        if (pull * a_max <= most) return false;
        pull = 0;
        for (int32_t k = 0; k < s.n_bonds; ++k)
            pull = max(max(newton.net.w[s.from[k]], newton.net.w[s.to[k]]) * abs(newton.tau[k]), pull);
        return most < pull * a_max;
    }

    void write_atoms() const {
        const double per_dt = 1 / call.dt;
        newton.for_all_parts([&](const NetPart &part) {
            newton.find_moves(part);
            const Net3 moves = newton.moves_of(part);
            newton.net.write_sites(part, call.r, fixed, true,
                                   [&](auto width, int32_t i) HOL_FORCED { return moves.get<decltype(width)>(i); });
            if (!call.v.x) return;
            newton.net.write_sites(part, call.v, fixed, true, [&](auto width, int32_t i) HOL_FORCED {
                typedef decltype(width) V;
                return Width<V>::all(per_dt) * moves.get<V>(i);
            });
        });
    }
    void write_results(bool moved) {
        const NetworkPlan &s = newton.s;
        const double per_dt2 = 1 / (call.dt * call.dt);
        newton.net.for_ranges(0, call.lambda ? s.n_bonds : 0, [&](int32_t first, int32_t end) {
            for (int32_t k = first; k < end; ++k)
                call.lambda[newton.net.lane.first_bond + s.bond_of[k]] = mul_add(newton.tau[k], 0.5 * per_dt2, 0.0);
        });
        if (!moved) return;
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
        if (out.converged.set) newton.correct();
        const bool moved = out.converged.set && !coarse_moves() && !newton.failed;
        if (!moved && !out.untouched.set) return false;
        if (call.report)
            note_worst_bond(
                newton.s, 1, out.error, &newton.net.lane, [&](int32_t k) { return newton.error_of(k); },
                [&](const auto &each) { newton.for_worst_parts(out.error, each); }, tally);
        write_results(moved);
        if (moved) count_moved(tally, 1, out.solves);
        return true;
    }
};

}  // namespace holonomic::HOL_ISA::graph
