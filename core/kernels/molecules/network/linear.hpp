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

    // An atom's inverse mass, its bonds' sum of |t| |d|, and what they do to it.
    template <class V>
    struct Atom {
        V w, T;
        Vector3<V> pull;
    };

    static int64_t values(const NetworkPlan &s) {
        return NetEquations::values(s) + in_fours(s.n_bonds) + in_fours(n_rest(s)) + NetFactor::values(s, true);
    }
    NetLinear(const NetworkPlan &plan, const MoleculeLane &l, bool packed, const LongTeam *team, const Box &b,
              const AtomArray &positions, const Inputs &inputs, int sides, Memory<double> memory)
        : NetEquations(plan, l, packed, team, b, positions, inputs, sides, memory),
          enough(memory.values(in_fours(s.n_bonds))), tension(memory.values(in_fours(n_rest(s))) - s.first_node),
          factor(net, d, true, memory) {}

    // Strands need what has been found for the rest. One part of them after the other goes through all that it needs,
    // in cache, one vector of strands in registers.
    void load() const {
        net.for_ranges(s.first_node, s.n_atoms, [&](int32_t first, int32_t end) { read_atoms(first, end); });
        find_equations_of_trees();
        factor.factorize_rest(d, t);
        net.for_parts([&](const NetPart &part) {
            net.for_strands(part,
                            [&](auto width, const NetStrands &g) HOL_FORCED { find_equations<decltype(width)>(g); });
            factor.factorize(part, d, t);
        });
        factor.close();
    }
    // Multipliers of the rest, for what is in t, as far up as it has been taken.
    bool solve_for(double part_left, const double *sizes) const {
        const int32_t taken = factor.unknowns.solve(part_left, sizes);
        if (taken < 0) return false;
        rounds += taken;
        factor.take_down_rest(t);
        return true;
    }
    __attribute__((noinline)) bool solve() const {
        load();
        if (!solve_for(any_part, size_of_side)) return false;
        factor.find_pulls_of_rest(t, G, tension);
        prove_trees();
        net.for_parts([&](const NetPart &part) { take_down_and_prove(part); });
        return !unproven || refine();
    }

    // What may be left of equations, of their terms: half of what counts as right (proof.hpp).
    double most_left() const { return 0.5 * epsilon * (16 + __builtin_sqrt(static_cast<double>(s.n_bonds))); }
    // Whether an equation is left with more than rounding. The terms of right-hand sides alone, and a
    // bound on what rounding hides, do for most.
    template <class V>
    HOL_FORCED void prove(int32_t place, const Atom<V> &from, const Atom<V> &to, bool &good) const {
        const double most = most_left();
        net.fetch_ahead(place, side, size_of_side);
        const V tensions = mul_add(from.w, from.T, to.w * to.T);
        const V over = excess_of(d.get<V>(place), from.w * from.pull, to.w * to.pull, tensions,
                                 load_any<V>(side + place), load_any<V>(size_of_side + place), most);
        const MaskOf<V> bad = ~less_equal(over, V{});
        if (__builtin_expect(!any(bad), 1)) return;
        for (int i = 0; i < Width<V>::lanes; ++i)
            if ((bits(bad) >> i & 1) && good) good = holds(place + i, Width<V>::get(tensions, i));
    }
    void note(bool good) const {
        if (!good) __atomic_store_n(&unproven, true, __ATOMIC_RELAXED);
    }
    __attribute__((noinline)) void prove_trees() const {
        bool good = true;
        const auto atom = [&](int32_t i) { return Atom<double>{net.w[i], tension[i], G.get<double>(i)}; };
        for (int32_t k = s.first_tree_place; k < s.n_bonds; ++k) prove<double>(k, atom(s.from[k]), atom(s.to[k]), good);
        note(good);
    }
    __attribute__((noinline)) void take_down_and_prove(const NetPart &part) const {
        factor.take_down(part, t);
        bool good = !__atomic_load_n(&unproven, __ATOMIC_RELAXED);
        if (!good) return;
        net.for_strands(part, [&](auto width, const NetStrands &g) HOL_FORCED {
            typedef decltype(width) V;
            const auto at_node = [&](int end) HOL_FORCED {
                return Atom<V>{net.at_node<V>(g, end, net.w), net.at_node<V>(g, end, tension),
                               net.at_node<V>(g, end, G)};
            };
            StrandPulls<V> along(net, t, d, g.place);
            V last = along.tension();
            net.for_bonds(
                g, [&]() HOL_FORCED { return at_node(0); },
                [&](int32_t site, int32_t place) HOL_FORCED {
                    const Vector3<V> pull = along.before(place);
                    const V next = along.tension(), T = last + next;
                    last = next;
                    return Atom<V>{load_any<V>(net.w + site), T, pull};
                },
                [&]() HOL_FORCED { return at_node(1); },
                [&](int32_t place, const Atom<V> &from, const Atom<V> &to)
                    HOL_FORCED { prove<V>(place, from, to, good); });
        });
        note(good);
    }
    // Of one bond, in twice the precision, with all terms of its equation: the accelerations of its two atoms too. Only
    // the rounding of bonds is left; that of images, which is no more than their own, counts in no test of bonds.
    __attribute__((noinline)) bool holds(int32_t k, double tensions) const {
        const int32_t i = s.from[k], j = s.to[k];
        const Pair3<double> from = acceleration_of(i, t), to = acceleration_of(j, t), bond = exact(k);
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
                if (!solve_for(next_part, enough)) t[0] = 0 / (t[0] - t[0]);  // not a number, which is no contraction
                net.for_parts([&](const NetPart &part) { factor.take_down(part, t); });
            },
            [&](Flag) {
                const auto bond = [&](int32_t k) {
                    const Vector3<double> one = d.get<double>(k);
                    return Correction<double>{t[k], alone[k], dot(one, one), solution[k]};
                };
                return add_corrections(0, s.n_bonds, largest_tension2<double>(0, s.n_bonds, bond), bond);
            },
            [&]() { return Flag{false}; });
        if (!good.set) return false;
        for (int32_t k = 0; k < s.n_bonds; ++k) t[k] = solution[k];
        factor.find_pulls_of_rest(t, G, nullptr);
        return true;
    }
    // Velocities v + w G; with `again` once more projected: what their rounding leaves.
    __attribute__((noinline)) void write_velocities(const AtomArray &to, bool again) const {
        const bool solved = !again || project_again();
        const auto write = [&](auto width, int32_t site, const auto &pull) HOL_FORCED {
            typedef decltype(width) V;
            net.write_at<V>(to, site, net.lane.shared, false, solved ? pushed(width, site, pull) : v.get<V>(site));
        };
        for_pulls_of_rest(write);
        net.for_parts([&](const NetPart &part) {
            if (again && solved) factor.take_down(part, t);
            net.for_strands(part, [&](auto width, const NetStrands &g) HOL_FORCED { for_pulls(width, g, write); });
        });
    }
    template <class V>
    HOL_FORCED Vector3<V> pushed(const V &, int32_t site, const Vector3<V> &pull) const {
        net.fetch_ahead(site, v.x, v.y, v.z, net.w);
        return add_times(v.get<V>(site), load_any<V>(net.w + site), pull);
    }
    // Velocities of strands, and their right-hand sides.
    template <class V>
    HOL_FORCED void push(const NetStrands &g) const {
        StrandPulls<V> along(net, t, d, g.place);
        net.for_bonds(
            g, [&]() HOL_FORCED { return net.at_node<V>(g, 0, v); },
            [&](int32_t site, int32_t place) HOL_FORCED {
                const Vector3<V> velocity = pushed(V{}, site, along.before(place));
                v.set(site, velocity);
                return velocity;
            },
            [&]() HOL_FORCED { return net.at_node<V>(g, 1, v); },
            [&](int32_t place, const Vector3<V> &from, const Vector3<V> &to)
                HOL_FORCED { find_rate(place, from, to); });
    }
    // Pushes velocities, and finds multipliers of what that leaves: the pulls of the rest, and what is taken down.
    __attribute__((noinline)) bool project_again() const {
        for_pulls_of_rest([&](auto width, int32_t site, const auto &pull)
                              HOL_FORCED { v.set(site, pushed(width, site, pull)); });
        for (int32_t k = s.first_tree_place; k < s.n_bonds; ++k)
            find_rate(k, v.get<double>(s.from[k]), v.get<double>(s.to[k]));
        factor.take_up_rest(t);
        net.for_parts([&](const NetPart &part) {
            net.for_strands(part, [&](auto width, const NetStrands &g) HOL_FORCED { push<decltype(width)>(g); });
            factor.take_up(part, t);
        });
        factor.unknowns.add_pushes();
        if (!solve_for(next_part, nullptr)) return false;
        factor.find_pulls_of_rest(t, G, nullptr);
        return true;
    }
    // Calls each(width, site, pull): of the rest, of the atoms between the ends of strands.
    template <class Each>
    HOL_FORCED void for_pulls_of_rest(const Each &each) const {
        net.for_all(s.first_node, s.n_atoms,
                    [&](auto width, int32_t site) HOL_FORCED { each(width, site, G.get<decltype(width)>(site)); });
    }
    template <class V, class Each>
    HOL_FORCED void for_pulls(const V &width, const NetStrands &g, const Each &each) const {
        StrandPulls<V>(net, t, d, g.place).for_sites(g, [&](int32_t site, const Vector3<V> &pull) HOL_FORCED {
            each(width, site, pull);
        });
    }

    void write_bonds(const NetPart &part, double scale, bool sizes, double *out) const {
        for (int32_t k = part.first_place; k < part.end_place; ++k) {
            const Vector3<double> bond = d.get<double>(k);
            out[net.number_of_bond(k)] = mul_add(t[k], sizes ? sqrt(dot(bond, bond)) : scale, 0.0);
        }
    }
    __attribute__((noinline)) void write_pulls(const NetPart &part, const AtomArray &to, bool add) const {
        const auto write = [&](auto width, int32_t site, const auto &pull)
                               HOL_FORCED { net.write_at<decltype(width)>(to, site, net.lane.shared, add, pull); };
        if (net.is_rest(part)) return for_pulls_of_rest(write);
        net.for_strands(part, [&](auto width, const NetStrands &g) HOL_FORCED { for_pulls(width, g, write); });
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
