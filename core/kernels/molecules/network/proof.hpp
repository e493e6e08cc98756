// Whether multipliers solve the equations of a network. What they leave of each, with what rounding can hide there, is
// compared with the terms that it is made of. Where that does not do for a few equations these are looked at in twice
// the precision, and what is left of them alone is solved for, theory (55b).
#pragma once

#include "core/kernels/molecules/network/equations.hpp"
#include "core/kernels/molecules/network/factor.hpp"

namespace holonomic::HOL_ISA::graph {

struct NetProof : NetEquations {
    // What may be left when all unknowns are taken together, which says nothing of an equation between heavy atoms
    // beside those of light ones.
    static constexpr double any_part = 1e100, next_part = 1e-6;
    static constexpr int32_t bonds_of_look = 8;  // so many for each equation that is looked at

    double *enough;    // room for equations flagged, for their corrections, and then for what refinement may leave
    double *tension;   // of the rest, by site, sum of |t| |d|
    int32_t *n_flags;  // [n_shares + 1] of parts
    NetFactor factor;
    bool is_kept = false;        // the factors are those of an earlier call
    mutable int64_t rounds = 0;  // that the unknowns have taken so far
    mutable bool unproven = false,
                 flagged = false;  // of some part; after the first, what others leave is not looked for

    // An equation flagged: what is left of it, at first with what rounding may hide there; of its two atoms, what
    // bonds do to them, times the bond; the sum of T times inverse masses.
    struct Flagged {
        double left, at_from, at_to, tensions;
        int32_t bond_index;
    };
    // Those of a part; lost: where there are more than `most`.
    struct Flaggeds {
        Flagged *const first;
        const int32_t most;
        int32_t n;
        bool lost;
        void note(const Flagged &one) {
            lost = lost || n == most;
            if (!lost) first[n++] = one;
        }
    };
    // An atom's inverse mass, its bonds' sum of |t| |d|, and what they do to it.
    template <class V>
    struct Atom {
        V w, T;
        Vector3<V> pull;
    };
    // Along strands, what multipliers do to the atoms between the bonds, right to a rounding of that; and |t| |d|.
    template <class V>
    struct ExactPulls {
        const NetProof &of;
        const double *const t;
        Pair3<V> of_bond;
        HOL_FORCED ExactPulls(const NetProof &proof, const double *multipliers, int32_t bond_index)
            : of(proof), t(multipliers), of_bond(product_pairs(load_any<V>(t + bond_index), of.d.get<V>(bond_index))) {}
        HOL_FORCED Vector3<V> before(int32_t bond_index) {
            const Pair3<V> last = of_bond;
            of.net.fetch_ahead(bond_index, t, of.d.x, of.d.y, of.d.z);
            of_bond = product_pairs(load_any<V>(t + bond_index), of.d.get<V>(bond_index));
            return {(of_bond.x.hi - last.x.hi) + (of_bond.x.lo - last.x.lo),
                    (of_bond.y.hi - last.y.hi) + (of_bond.y.lo - last.y.lo),
                    (of_bond.z.hi - last.z.hi) + (of_bond.z.lo - last.z.lo)};
        }
        HOL_FORCED V tension() const {
            const Vector3<V> p = {of_bond.x.hi, of_bond.y.hi, of_bond.z.hi};
            return sqrt(dot(p, p));
        }
    };

    static int64_t values_of_factor(const NetworkPlan &s) {
        return NetEquations::values_of_factor(s) + NetFactor::values_of_factor(s);
    }
    static int64_t values(const NetworkPlan &s) {
        return NetEquations::values(s) + in_fours(s.n_bonds) + in_fours(n_rest(s)) + in_fours(s.n_shares / 2 + 1) +
               NetFactor::values(s, true);
    }
    NetProof(const NetworkPlan &plan, const MoleculeLane &l, bool packed, const LongTeam *team, const Box &b,
             const AtomArray &positions, const Inputs &inputs, int rhs_terms, Memory<double> &of_factor,
             Memory<double> &memory)
        : NetEquations(plan, l, packed, team, b, positions, inputs, rhs_terms, of_factor, memory),
          enough(memory.values(in_fours(s.n_bonds))), tension(memory.values(in_fours(n_rest(s))) - s.first_node),
          n_flags(reinterpret_cast<int32_t *>(memory.values(in_fours(s.n_shares / 2 + 1)))),
          factor(net, d, true, of_factor, memory) {}

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
    // The same where the factors are kept.
    void load_rhs() const {
        find_rhs_of_rest();
        factor.take_up_rest(t);
        net.for_parts([&](const NetPart &part) {
            net.for_strands(
                part, [&](auto width, const NetStrands &g) HOL_FORCED { find_rhs_of_strands<decltype(width)>(g); });
            factor.take_up(part, t);
        });
        factor.add_pushes();
    }
    // Multipliers of the rest, for what is in y, as far up as it has been taken.
    bool solve_for(double part_left, const double *sizes, double *y) const {
        const int32_t taken = factor.unknowns.solve(part_left, sizes);
        if (taken < 0) return false;
        rounds += taken;
        factor.take_down_rest(y);
        return true;
    }
    __attribute__((noinline)) bool has_ordinary_squares() const {
        vec sum = {}, least = splat(1);
        int32_t k = 0;
        for (; k + W <= s.n_bonds; k += W) {
            const Vector3<vec> bond = d.get<vec>(k);
            const vec q = dot(bond, bond);
            sum = sum + q;
            least = min(q, least);
        }
        double rest = 0, least_of_rest = 1;
        for (; k < s.n_bonds; ++k) {
            const Vector3<double> bond = d.get<double>(k);
            rest += dot(bond, bond);
            least_of_rest = min(dot(bond, bond), least_of_rest);
        }
        return !any(~ordinary_squares(least, sum, most_ordinary_pivot)) &&
               ordinary_squares(least_of_rest, rest, most_ordinary_pivot).set;
    }
    // Factors and right-hand sides; false where nothing can be made of the bonds.
    bool make() const {
        load();
        return has_ordinary_squares();
    }
    // All multipliers, and whether they are proven.
    __attribute__((noinline)) bool find() const {
        if (is_kept)
            load_rhs();
        else if (!make())
            return false;
        if (!solve_for(any_part, size_of_rhs, t)) return false;
        prove_all(t, most_left(), true, [](const NetPart &) {});
        return true;
    }

    // What may be left of equations, of their terms: half of what counts as right (thresholds.hpp).
    double most_left() const { return 0.5 * epsilon * (16 + __builtin_sqrt(static_cast<double>(s.n_bonds))); }
    // What a rounding of the multipliers, or of the bonds, does to an equation, in roundings. tensions: of its two
    // atoms, times their inverse masses.
    template <class V>
    HOL_STATIC V hidden_by_rounding(const Vector3<V> &bond, const V &tensions) {
        return sqrt(dot(bond, bond)) * tensions;
    }

    // Takes `multipliers` down, and looks at what they leave of `rhs`; after(part) follows. look: at what is not
    // proven, in twice the precision.
    template <class After>
    HOL_FORCED void prove_all(double *multipliers, double most, bool look, const After &after) const {
        const auto note = [&](const NetPart &part, const Flaggeds &flags) {
            n_flags[part.share] = flags.n;
            if (flags.n > 0) __atomic_store_n(&flagged, true, __ATOMIC_RELAXED);
            if (flags.lost) __atomic_store_n(&unproven, true, __ATOMIC_RELAXED);
        };
        factor.find_pulls_of_rest(multipliers, G, tension, low());
        const NetPart rest = net.rest();
        Flaggeds flags = flags_of(rest, look);
        prove_trees(most, flags);
        look_at(flags);
        note(rest, flags);
        after(rest);
        net.for_parts([&](const NetPart &part) {
            factor.take_down(part, multipliers);
            Flaggeds own = flags_of(part, look);
            if (!__atomic_load_n(&unproven, __ATOMIC_RELAXED)) {
                prove(part, multipliers, most, own);
                look_at(own);
            }
            note(part, own);
            after(part);
        });
    }
    // Solves for what is left of equations flagged alone. False if that is not proven to leave the others as they are.
    __attribute__((noinline)) bool correct() const {
        double *const change = enough;
        const auto begin = [&](const NetPart &part) {
            for (int32_t k = part.first_index; k < part.end_index; ++k) rhs[k] = 0;
            const Flagged *const flag = flags_of(part, false).first;
            for (int32_t i = 0; i < n_flags[part.share]; ++i) rhs[flag[i].bond_index] = flag[i].left;
            for (int32_t k = part.first_index; k < part.end_index; ++k) change[k] = rhs[k];
        };
        begin(net.rest());
        factor.take_up_rest(change);
        net.for_parts([&](const NetPart &part) {
            begin(part);
            factor.take_up(part, change);
        });
        factor.add_pushes();
        if (!solve_for(next_part, size_of_rhs, change)) return false;
        // A change that is a part of its multiplier leaves the terms of the equations what they are.
        prove_all(change, 0.5 * most_left(), false, [&](const NetPart &part) {
            bool small = true;
            for (int32_t k = part.first_index; k < part.end_index; ++k) {
                small = small && 8 * abs(change[k]) <= abs(t[k]);
                t[k] += change[k];
            }
            if (!small) __atomic_store_n(&unproven, true, __ATOMIC_RELAXED);
        });
        factor.find_pulls_of_rest(t, G);
        return !unproven;
    }

private:
    Net3 low() const {  // in the place of accelerations
        Memory<double> memory = {reinterpret_cast<double *>(a)};
        return Net3::take(memory, n_rest(s), s.first_node);
    }
    Flaggeds flags_of(const NetPart &part, bool look) const {
        return {reinterpret_cast<Flagged *>(enough + part.first_index),
                look ? (part.end_index - part.first_index) / bonds_of_look : 0, 0, false};
    }
    // Of one equation, or of W: terms are S and what the atoms' accelerations are multiplied by; of these, what the
    // bonds do is no more than S greater.
    template <class V>
    HOL_FORCED void prove(int32_t bond_index, const Atom<V> &from, const Atom<V> &to, double most,
                          Flaggeds &flags) const {
        net.fetch_ahead(bond_index, rhs, size_of_rhs);
        const Vector3<V> bond = d.get<V>(bond_index), x = from.w * from.pull, y = to.w * to.pull;
        const V at_x = dot(bond, x), at_y = dot(bond, y), tensions = mul_add(from.w, from.T, to.w * to.T),
                size = max(load_any<V>(size_of_rhs + bond_index), abs(at_x) + abs(at_y)),
                rounding =
                    0.5 * hidden_by_rounding(bond, tensions) + 4.0 * dot(absolute(bond), absolute(x) + absolute(y)),
                left = mul_add(Width<V>::all(epsilon), rounding, abs(load_any<V>(rhs + bond_index) + (at_y - at_x)));
        const MaskOf<V> bad = ~less_equal(left, most * size);
        if (__builtin_expect(!any(bad), 1)) return;
        const auto of_lane = [](const V &all, int i) HOL_FORCED { return Width<V>::get(all, i); };
        for (int i = 0; i < Width<V>::lanes; ++i) {
            if (!(bits(bad) >> i & 1)) continue;
            __builtin_prefetch(s.from + bond_index + i);
            __builtin_prefetch(s.to + bond_index + i);
            flags.note({of_lane(left, i), of_lane(at_x, i), of_lane(at_y, i), of_lane(tensions, i), bond_index + i});
        }
    }
    __attribute__((noinline)) void prove_trees(double most, Flaggeds &flags) const {
        const auto atom = [&](int32_t i) { return Atom<double>{net.w[i], tension[i], G.get<double>(i)}; };
        for (int32_t k = s.first_tree_bond; k < s.n_bonds; ++k)
            prove<double>(k, atom(s.from[k]), atom(s.to[k]), most, flags);
    }
    __attribute__((noinline)) void prove(const NetPart &part, const double *multipliers, double most,
                                         Flaggeds &flags) const {
        net.for_strands(part, [&](auto width, const NetStrands &g) HOL_FORCED {
            typedef decltype(width) V;
            const auto at_node = [&](int end) HOL_FORCED {
                return Atom<V>{net.at_node<V>(g, end, net.w), net.at_node<V>(g, end, tension),
                               net.at_node<V>(g, end, G)};
            };
            ExactPulls<V> along(*this, multipliers, g.bond_index);
            V last = along.tension();
            net.for_bonds(
                g, [&]() HOL_FORCED { return at_node(0); },
                [&](int32_t site, int32_t bond_index) HOL_FORCED {
                    const Vector3<V> pull = along.before(bond_index);
                    const V next = along.tension(), T = last + next;
                    last = next;
                    return Atom<V>{load_any<V>(net.w + site), T, pull};
                },
                [&]() HOL_FORCED { return at_node(1); },
                [&](int32_t bond_index, const Atom<V> &from, const Atom<V> &to)
                    HOL_FORCED { prove<V>(bond_index, from, to, most, flags); });
        });
    }
    // Keeps those that are left with too much. What they need is all over memory, so it is fetched for all of them
    // first.
    __attribute__((noinline)) void look_at(Flaggeds &flags) const {
        const int32_t n = flags.lost ? 0 : flags.n;
        flags.n = 0;
        const auto for_ends = [&](const auto &each) {
            for (int32_t i = 0; i < n; ++i)
                each(s.from[flags.first[i].bond_index]), each(s.to[flags.first[i].bond_index]);
        };
        for_ends([&](int32_t site) { __builtin_prefetch(s.atom_of + site); });
        for_ends([&](int32_t site) {
            net.fetch(coordinates, site);
            if (has(pulls)) net.fetch(*in.f, site);
            if (has(squares)) net.fetch(*in.v, site);
        });
        for (int32_t i = 0; i < n && !flags.lost; ++i) look_at(flags.first[i], flags);
    }
    // With all terms of the equation, the accelerations of its two atoms too; then in twice the precision, from
    // unrounded bonds.
    void look_at(const Flagged &flag, Flaggeds &flags) const {
        const int32_t k = flag.bond_index, i = s.from[k], j = s.to[k];
        const Vector3<double> rounded_bond = d.get<double>(k);
        const double terms_of_all = size_of_rhs[k] + abs(flag.at_from + dot(rounded_bond, input_of(i))) +
                                    abs(flag.at_to + dot(rounded_bond, input_of(j))),
                     may_be_left = most_left() * terms_of_all,
                     rounding = 16 * (epsilon * epsilon) * hidden_by_rounding(rounded_bond, flag.tensions);
        if (flag.left <= may_be_left) return;
        const double left = residual_of(k, exact(k), acceleration_of(i, t), acceleration_of(j, t));
        if (abs(left) + rounding <= may_be_left) return;
        flags.lost = !(abs(left) < 1e300 && rounding <= may_be_left);
        flags.note({left, 0, 0, 0, k});
    }
};

}  // namespace holonomic::HOL_ISA::graph
