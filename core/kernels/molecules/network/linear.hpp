// Linear equations of a network: solved by factors and iteration, then looked at. What multipliers leave of each
// equation, with what rounding can hide there, is compared with the terms that it is made of; where it is too much the
// residual is found in twice the precision and solved for, until that changes nothing.
#pragma once

#include "core/kernels/molecules/network/residuals.hpp"
#include "core/kernels/molecules/proof.hpp"
#include "core/kernels/molecules/refine.hpp"
#include "core/kernels/molecules/virial.hpp"

namespace holonomic::HOL_ISA::graph {

struct NetLinear : NetEquations {
    // Of residuals that are corrected: of all, and of what rounding hides in each over 16. All together say nothing of
    // an equation between heavy atoms beside those of light ones.
    static constexpr double any_part = 1e100, next_part = 1e-6, part_of_rounding = 1. / 256;

    double *enough;   // what corrections may leave of a residual, over 16 roundings
    double *tension;  // of the rest, by site, sum of |t| |d|
    NetFactor factor;
    mutable int64_t rounds = 0;     // that the unknowns have taken so far
    mutable bool unproven = false;  // of some part; then what others leave is not looked for

    static int64_t values(const NetworkPlan &s) {
        return NetEquations::values(s) + in_fours(s.n_bonds) + in_fours(n_rest(s)) + NetFactor::values(s, true);
    }
    NetLinear(const NetworkPlan &plan, const MoleculeLane &l, bool packed, const LongTeam *team, const Box &b,
              const AtomArray &positions, const Inputs &inputs, int sides, Memory<double> memory)
        : NetEquations(plan, l, packed, team, b, positions, inputs, sides, memory),
          enough(memory.values(in_fours(s.n_bonds))), tension(memory.values(in_fours(n_rest(s))) - s.first_node),
          factor(net, d, true, memory) {}

    // Calls rest(part), then each(part) for the others: the nodes' values, which these need, first. One part after the
    // other goes through all that it needs, in cache.
    template <class Rest, class Each>
    HOL_FORCED void for_rest_and_parts(const Rest &rest, const Each &each) const {
        rest(net.rest());
        net.for_parts(each);
    }
    // Of a part's sites, once its positions and forces are not needed any more.
    Net3 G_of(const NetPart &part) const { return net.is_rest(part) ? G : part.of_sites(0); }
    double *tension_of(const NetPart &part) const { return net.is_rest(part) ? tension : part.of_sites(1).x; }
    void find_pulls(const NetPart &part, bool with_tensions) const {
        if (net.is_rest(part))
            factor.find_pulls_of_rest(t, G, with_tensions ? tension : nullptr);
        else
            net.find_pulls(part, t, d, G_of(part), false, with_tensions ? tension_of(part) : nullptr);
    }

    void load() const {
        for_rest_and_parts(
            [&](const NetPart &rest) {
                net.for_ranges(rest.first_site, rest.end_site,
                               [&](int32_t first, int32_t end) { read_atoms(rest, first, end); });
                find_equations(rest);
                factor.factorize_rest(d, t);
            },
            [&](const NetPart &part) {
                read_atoms(part, part.first_site, part.end_site);
                find_equations(part);
                factor.factorize(part, d, t);
            });
        factor.close();
    }
    // Multipliers for what is in t, as far up as it has been taken; what they do to atoms, if `pulls`; then each(part).
    template <class Each>
    HOL_FORCED bool solve_for(double part_left, const double *sizes, bool with_pulls, bool with_tensions,
                              const Each &each) const {
        const int32_t taken = factor.unknowns.solve(part_left, sizes);
        if (taken < 0) return false;
        rounds += taken;
        for_rest_and_parts(
            [&](const NetPart &rest) {
                factor.take_down_rest(t);
                if (with_pulls) find_pulls(rest, with_tensions);
                each(rest);
            },
            [&](const NetPart &part) {
                factor.take_down(part, t);
                if (with_pulls) find_pulls(part, with_tensions);
                each(part);
            });
        return true;
    }
    __attribute__((noinline)) bool solve() const {
        load();
        return solve_for(any_part, size_of_side, true, true, [&](const NetPart &part) { prove(part); }) &&
               (!unproven || refine());
    }

    // What may be left of equations, of their terms: half of what counts as right (proof.hpp).
    double most_left() const { return 0.5 * epsilon * (16 + __builtin_sqrt(static_cast<double>(s.n_bonds))); }
    // Whether an equation is left with more than rounding. The terms of right-hand sides alone, and a
    // bound on what rounding hides, do for most.
    __attribute__((noinline)) void prove(const NetPart &part) const {
        const double most = most_left();
        if (__atomic_load_n(&unproven, __ATOMIC_RELAXED)) return;
        bool good = true;
        const Net3 G_here = G_of(part);
        const double *const tension_here = tension_of(part);
        net.for_strands(part, [&](auto width, const NetStrands &g) HOL_FORCED {
            typedef decltype(width) V;
            V w = net.at_node<V>(g, 0, net.w), T = net.at_node<V>(g, 0, tension);
            Vector3<V> pull = net.at_node<V>(g, 0, G);
            for (int32_t k = 0; k < g.length; ++k) {
                const bool last = k + 1 == g.length;
                const int32_t place = g.place + k * g.step, site = g.site + k * g.step;
                const V wn = last ? net.at_node<V>(g, 1, net.w) : load_any<V>(net.w + site);
                const V Tn = last ? net.at_node<V>(g, 1, tension) : load_any<V>(tension_here + site);
                const Vector3<V> next = last ? net.at_node<V>(g, 1, G) : G_here.get<V>(site), bond = d.get<V>(place);
                const V tensions = mul_add(w, T, wn * Tn);
                const V over = excess_of(bond, w * pull, wn * next, tensions, load_any<V>(side + place),
                                         load_any<V>(size_of_side + place), most);
                const MaskOf<V> bad = ~less_equal(over, V{});
                if (__builtin_expect(any(bad), 0))
                    for (int i = 0; i < Width<V>::lanes; ++i)
                        if ((bits(bad) >> i & 1) && good) good = holds(place + i, Width<V>::get(tensions, i));
                w = wn;
                T = Tn;
                pull = next;
            }
        });
        for (int32_t k = part.first_place; part.share == s.n_shares && k < part.end_place; ++k) {
            const int32_t i = s.from[k], j = s.to[k];
            const double tensions = mul_add(net.w[i], tension[i], net.w[j] * tension[j]),
                         over = excess_of(d.get<double>(k), net.w[i] * G.get<double>(i), net.w[j] * G.get<double>(j),
                                          tensions, side[k], size_of_side[k], most);
            if (!(over <= 0) && good) good = holds(k, tensions);
        }
        if (!good) __atomic_store_n(&unproven, true, __ATOMIC_RELAXED);
    }
    // Of one bond, in twice the precision, with all terms of its equation: the accelerations of its two atoms too. Only
    // the rounding of bonds is left; that of images, which is no more than their own, counts in no test of bonds.
    __attribute__((noinline)) bool holds(int32_t k, double tensions) const {
        const int32_t i = s.from[k], j = s.to[k];
        const Pair3<double> from = acceleration_of(i, t, false), to = acceleration_of(j, t, false), bond = exact(k);
        const double left = residual_of(k, bond, from, to),
                     terms_of_b = size_of_side[k] + abs(dot_pairs(bond, from).hi) + abs(dot_pairs(bond, to).hi);
        return abs(left) + epsilon * hidden_by_rounding(d.get<double>(k), tensions) <= most_left() * terms_of_b;
    }
    // What a rounding of the multipliers, and of what adds up, does to an equation, in roundings. tensions: of its two
    // atoms, times their inverse masses.
    template <class V>
    HOL_STATIC V hidden_by_rounding(const Vector3<V> &bond, const V &tensions) {
        return sqrt(dot(bond, bond)) * tensions;
    }
    // What is left of an equation, and what rounding can hide there, beyond what may be left.
    template <class V>
    HOL_STATIC V excess_of(const Vector3<V> &bond, const Vector3<V> &from, const Vector3<V> &to, const V &tensions,
                           const V &b, const V &terms_of_b, double most) {
        const V left = abs(b + dot(bond, to - from)) + (4 * epsilon) * hidden_by_rounding(bond, tensions);
        return left - most * terms_of_b;
    }

    // Solves for what is left in twice the precision; the multipliers so far are kept in `side`, whose terms are not
    // needed any more.
    __attribute__((noinline)) bool refine() const {
        double *const solution = side, *const alone = size_of_side;
        bool begun = false;
        const auto keep = [&](auto width, int32_t k, const auto &bond, const auto &mass,
                              const auto &tensions) HOL_FORCED {
            typedef decltype(width) V;
            if (begun) return;
            const Vector3<V> d_k = {bond.x.hi, bond.y.hi, bond.z.hi};
            store_any(alone + k, load_any<V>(side + k) / (mass * dot(d_k, d_k)));
            store_any(solution + k, load_any<V>(t + k));
            store_any(enough + k, Width<V>::all(part_of_rounding) * hidden_by_rounding(d_k, tensions));
        };
        const Flag good = correct_until_right<double>(
            Flag{true},
            [&]() {
                NetResiduals{*this, factor, begun ? solution : t}.find(tension, keep);
                begun = true;
                if (!solve_for(next_part, enough, false, false, [](const NetPart &) {}))
                    t[0] = 0 / (t[0] - t[0]);  // not a number, which is no contraction
            },
            [&](Flag) {
                return add_corrections<double>(s.n_bonds, [&](int32_t k) {
                    const Vector3<double> bond = d.get<double>(k);
                    return Correction<double>{t[k], alone[k], dot(bond, bond), solution[k]};
                });
            },
            [&]() { return Flag{false}; });
        if (!good.set) return false;
        for (int32_t k = 0; k < s.n_bonds; ++k) t[k] = solution[k];
        find_pulls(net.rest(), false);
        return true;
    }
    // Velocities v + w G; with `again` once more projected: what their rounding leaves.
    __attribute__((noinline)) void write_velocities(const AtomArray &to, bool again) const {
        const auto write = [&](const NetPart &part) {
            const Net3 pull = G_of(part);
            write_sites(part, to, false,
                        [&](auto width, int32_t i) HOL_FORCED { return pushed<decltype(width)>(pull, i); });
        };
        if (!again)
            return for_rest_and_parts(write, [&](const NetPart &part) {
                find_pulls(part, false);
                write(part);
            });
        for_rest_and_parts(
            [&](const NetPart &rest) {
                push_on(rest);
                find_sides(rest);
                factor.take_up_rest(t);
            },
            [&](const NetPart &part) {
                find_pulls(part, false);
                push_on(part);
                find_sides(part);
                factor.take_up(part, t);
            });
        factor.unknowns.add_pushes();
        if (solve_for(next_part, nullptr, true, false, write)) return;
        const auto write_once_projected = [&](const NetPart &part) {
            write_sites(part, to, false, [&](auto width, int32_t i) HOL_FORCED { return v.get<decltype(width)>(i); });
        };
        for_rest_and_parts(write_once_projected, write_once_projected);
    }
    void push_on(const NetPart &part) const {
        const Net3 pull = G_of(part);
        net.for_all(part.first_site, part.end_site,
                    [&](auto width, int32_t i) HOL_FORCED { v.set(i, pushed<decltype(width)>(pull, i)); });
    }
    template <class V>
    HOL_FORCED Vector3<V> pushed(const Net3 &pull, int32_t i) const {
        return add_times(v.get<V>(i), load_any<V>(net.w + i), pull.get<V>(i));
    }

    void write_bonds(const NetPart &part, double scale, bool sizes, double *out) const {
        for (int32_t k = part.first_place; k < part.end_place; ++k) {
            const Vector3<double> bond = d.get<double>(k);
            out[net.lane.first_bond + s.bond_of[k]] = mul_add(t[k], sizes ? sqrt(dot(bond, bond)) : scale, 0.0);
        }
    }
    // To the atoms that this molecule may write.
    template <class Value>
    HOL_FORCED void write_sites(const NetPart &part, const AtomArray &to, bool add, const Value &value) const {
        net.write_sites(part, to, net.lane.shared, add, value);
    }
    void write_pulls(const NetPart &part, const AtomArray &to, bool add) const {
        if (!net.is_rest(part)) find_pulls(part, false);
        const Net3 pull = G_of(part);
        write_sites(part, to, add, [&](auto width, int32_t i) HOL_FORCED { return pull.get<decltype(width)>(i); });
    }
    void add_virial(Tally &tally) const {
        MoleculesVirial<double> virial;
        for (int32_t k = 0; k < s.n_bonds; ++k) {
            const Vector3<double> bond = d.get<double>(k);
            virial.add(bond, t[k] * bond);
        }
        virial.count(1, 1, tally);
    }
};

}  // namespace holonomic::HOL_ISA::graph
