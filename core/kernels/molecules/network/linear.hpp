// Linear equations of a network: solved by factors and iteration, then looked at (proof.hpp). Where that proves too
// little, all residuals are found in twice the precision and solved for, until that changes nothing.
#pragma once

#include "core/kernels/molecules/linear_level.hpp"
#include "core/kernels/molecules/network/proof.hpp"
#include "core/kernels/molecules/network/residuals.hpp"
#include "core/kernels/molecules/refine.hpp"

namespace holonomic::HOL_ISA::graph {

struct NetLinear : NetProof {
    // What corrections may leave of residuals: of what rounding hides in each, over 16.
    static constexpr double part_of_rounding = 1. / 256;

    NetLinear(const NetworkPlan &plan, const MoleculeLane &l, bool packed, const LongTeam *team, const Box &b,
              const AtomArray &positions, const Inputs &inputs, int rhs_terms, Memory<double> memory)
        : NetProof(plan, l, packed, team, b, positions, inputs, rhs_terms, memory, memory) {}
    // Over the memory of factors that are kept.
    NetLinear(const NetworkPlan &plan, const MoleculeLane &l, bool packed, const LongTeam *team, const Box &b,
              const AtomArray &positions, const Inputs &inputs, int rhs_terms, Memory<double> of_factor,
              Memory<double> memory)
        : NetProof(plan, l, packed, team, b, positions, inputs, rhs_terms, of_factor, memory) {}

    __attribute__((noinline)) bool find_and_prove() const {
        if (!find()) return false;
        if (!unproven) {
            if (!flagged || correct()) return true;
            if (!find()) return false;  // once more, as correct() has taken its arrays
        }
        return refine();
    }

    // Solves for what is left in twice the precision; the multipliers so far are kept in `rhs`, whose terms are not
    // needed any more.
    __attribute__((noinline)) bool refine() const {
        double *const solution = rhs, *const alone = size_of_rhs;
        bool begun = false;
        const auto keep = [&](auto width, int32_t k, const auto &bond, const auto &mass,
                              const auto &tensions) HOL_FORCED {
            typedef decltype(width) V;
            if (begun) return;
            const Vector3<V> d_k = {bond.x.hi, bond.y.hi, bond.z.hi};
            store_any(alone + k, load_any<V>(rhs + k) / (mass * dot(d_k, d_k)));
            store_any(solution + k, load_any<V>(t + k));
            store_any(enough + k, Width<V>::all(part_of_rounding) * hidden_by_rounding(d_k, tensions));
        };
        const ScalarMask good = correct_until_right<double>(
            ScalarMask{true},
            [&]() {
                NetResiduals{*this, factor, begun ? solution : t}.find(tension, keep);
                begun = true;
                if (!solve_for(next_part, enough, t)) return ScalarMask{false};
                net.for_parts([&](const NetPart &part) { factor.take_down(part, t); });
                return ScalarMask{true};
            },
            [&](ScalarMask) {
                const auto bond = [&](int32_t k) {
                    const Vector3<double> one = d.get<double>(k);
                    return Correction<double>{t[k], alone[k], dot(one, one), solution[k]};
                };
                return add_corrections(0, s.n_bonds, largest_tension2<double>(0, s.n_bonds, bond), bond);
            },
            [&]() { return ScalarMask{false}; });
        if (!good.set) return false;
        double sum = 0;
        for (int32_t k = 0; k < s.n_bonds; ++k) {
            t[k] = solution[k];
            sum += abs(solution[k]);
        }
        if (!finite(sum).set) return false;
        factor.find_pulls_of_rest(t, G);
        return true;
    }
    // The way of linear_level.hpp.
    unsigned in_use() const { return 1; }
    unsigned solve() const { return find_and_prove() ? 1 : 0; }
    void write(const LinearOutputs &out, unsigned which, Tally &tally) const {
        net.for_rest_and_parts([&](const NetPart &part) { write_bonds_and_pulls(*this, out, which, part); });
        if (out.virial)
            add_virial<double>(
                0, s.n_bonds, [&](int32_t k) { return d.get<double>(k); }, [&](int32_t k) { return t[k]; }, 1, which,
                tally);
    }
    void project(const LinearOutputs &out, bool twice, unsigned which, Tally &tally) const {
        write_all_but_atoms(*this, out, which, tally);
        write_velocities(*out.g, twice);
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
        StrandPulls<V> along(net, t, d, g.bond_index);
        net.for_bonds(
            g, [&]() HOL_FORCED { return net.at_node<V>(g, 0, v); },
            [&](int32_t site, int32_t bond_index) HOL_FORCED {
                const Vector3<V> velocity = pushed(V{}, site, along.before(bond_index));
                v.set(site, velocity);
                return velocity;
            },
            [&]() HOL_FORCED { return net.at_node<V>(g, 1, v); },
            [&](int32_t bond_index, const Vector3<V> &from, const Vector3<V> &to)
                HOL_FORCED { find_rate(bond_index, from, to); });
    }
    // Pushes velocities, and finds multipliers of what that leaves: the pulls of the rest, and what is taken down.
    __attribute__((noinline)) bool project_again() const {
        for_pulls_of_rest([&](auto width, int32_t site, const auto &pull)
                              HOL_FORCED { v.set(site, pushed(width, site, pull)); });
        for (int32_t k = s.first_tree_bond; k < s.n_bonds; ++k)
            find_rate(k, v.get<double>(s.from[k]), v.get<double>(s.to[k]));
        factor.take_up_rest(t);
        net.for_parts([&](const NetPart &part) {
            net.for_strands(part, [&](auto width, const NetStrands &g) HOL_FORCED { push<decltype(width)>(g); });
            factor.take_up(part, t);
        });
        factor.add_pushes();
        if (!solve_for(next_part, nullptr, t)) return false;
        factor.find_pulls_of_rest(t, G);
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
        StrandPulls<V>(net, t, d, g.bond_index).for_sites(g, [&](int32_t site, const Vector3<V> &pull) HOL_FORCED {
            each(width, site, pull);
        });
    }

    template <bool with_length>
    void write_bonds(const NetPart &part, double scale, double *out, unsigned) const {
        for (int32_t k = part.first_index; k < part.end_index; ++k) {
            const Vector3<double> bond = d.get<double>(k);
            out[net.number_of_bond(k)] = mul_add(t[k], with_length ? sqrt(dot(bond, bond)) : scale, 0.0);
        }
    }
    __attribute__((noinline)) void write_pulls(const NetPart &part, const AtomArray &to, bool add, unsigned) const {
        const auto write = [&](auto width, int32_t site, const auto &pull)
                               HOL_FORCED { net.write_at<decltype(width)>(to, site, net.lane.shared, add, pull); };
        if (net.is_rest(part)) return for_pulls_of_rest(write);
        net.for_strands(part, [&](auto width, const NetStrands &g) HOL_FORCED { for_pulls(width, g, write); });
    }
};

}  // namespace holonomic::HOL_ISA::graph
