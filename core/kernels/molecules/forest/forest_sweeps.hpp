// Goes up and down W different trees: the sweeps of tree/joint.hpp, step by step.
#ifndef HOLONOMIC_KERNELS_MOLECULES_FOREST_FOREST_SWEEPS_HPP
#define HOLONOMIC_KERNELS_MOLECULES_FOREST_FOREST_SWEEPS_HPP

#include "core/kernels/molecules/forest/forest_linear.hpp"
#include "core/kernels/molecules/tree/joint.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

// The bonds of an atom in each lane: those to its children at the places of a step, and a copy of the one above.
struct ForestJoint {
    const ForestLinear &x;
    const int32_t step;
    const AtPlaces<BondRow<vec>> place;
    BondRow<vec> *const child;
    vec *const pairs;
    mutable BondRow<vec> top;

    HOL_FORCED ForestJoint(const ForestLinear &z, int32_t s, vec *m)
        : x(z), step(s), place(z.row, z.above_of(s)), child(z.row + z.f.step[s].first), pairs(m) {}
    HOL_FORCED vec w() const { return x.w[step]; }
    HOL_FORCED BondRow<vec> &bond(int a) const { return child[a]; }
    HOL_FORCED BondRow<vec> &above() const { return top; }
    HOL_FORCED vec *multipliers() const { return pairs; }

    // Lanes whose atom has one child, in a step of k.
    unsigned single(int k) const {
        const uint16_t *const held = x.f.held + x.f.step[step].first;
        return k == 1 ? held[0] : held[0] & ~static_cast<unsigned>(held[1]);
    }
    HOL_FORCED vec product(int a, int k) const {
        const vec g = dot(child[a].d, top.d);
        if (a > 0 || k > 3) return g;
        const mask small = nearly_orthogonal(g, child[a].q, top.q);
        if (__builtin_expect(any(small), 0)) return products_anew(bits(small) & single(k), g);
        return g;
    }
    __attribute__((noinline)) vec products_anew(unsigned which, vec g) const {
        const auto exact = [&](int i, int32_t bond, Vector3<double> &d, Vector3<double> &low) {
            int32_t atom[2];
            double end[2][3];
            x.ends(i, bond, atom);
            for (int e = 0; e < 2; ++e) read_row(x.r, x.at.number(i, atom[e]), end[e]);
            unrounded_bond(x.box, end[0], end[1], d, low);
        };
        for (; which; which &= which - 1) {
            const int i = __builtin_ctz(which);
            Vector3<double> d[2], low[2];
            exact(i, x.f.step[step].first, d[0], low[0]);
            exact(i, x.above_of(step)[i], d[1], low[1]);
            g[i] = dot_compensated(d[0], low[0], d[1], low[1]);
        }
        return g;
    }
    HOL_FORCED void read_t() const { top.t = place.get(offsetof(BondRow<vec>, t)); }
    HOL_FORCED void write_t() const { place.put(offsetof(BondRow<vec>, t), top.t); }

    // What doubt_faint_bonds() does, in the lanes of `which`.
    __attribute__((noinline)) void doubt_faint(int k, unsigned which, vec &slack) const {
        const vec shared = shared_error<vec>(*this, k);
        for (int a = -1; a < k; ++a) {
            const vec left = left_of(a < 0 ? top : child[a], shared);
            for (unsigned rest = which & bits(less(left, vec{})); rest; rest &= rest - 1) {
                const int i = __builtin_ctz(rest);
                const int32_t bond = a < 0 ? x.above_of(step)[i] : x.f.step[step].first + a;
                const double own = terms_of_bond(bond, i);
                if (!(left[i] + own * own >= 0)) slack[i] = -1;
            }
        }
    }
    // Of its right-hand side in absolute values, in units of its diagonal element.
    double terms_of_bond(int32_t bond, int i) const {
        const BondRow<vec> &its = x.row[bond];
        int32_t atom[2];
        x.ends(i, bond, atom);
        const int64_t number[2] = {x.at.number(i, atom[0]), x.at.number(i, atom[1])};
        const double mass[2] = {x.lane[i].w[atom[0]], x.lane[i].w[atom[1]]},
                     d[3] = {its.d.x[i], its.d.y[i], its.d.z[i]};
        const double A = (mass[0] + mass[1]) * its.q[i];
        if (x.has(given)) return __builtin_fabs(0.5 * x.in.rhs[x.bond_of(i, bond)]) / A;
        return terms_of(x.in, d, number, mass) / A;
    }
};

inline __attribute__((noinline)) void ForestLinear::factorize_and_solve() {
    vec least = slack;  // in a register
    for_steps_up([&](int32_t s, int64_t first) HOL_FORCED {
        const int k = f.step[s].children;
        least = choose_few<3>(k, [=](auto known) HOL_FORCED {
            const ForestJoint joint(*this, s, pair + first);
            vec own = least;
            joint.top.d = joint.place.get3(offsetof(BondRow<vec>, d));
            joint.top.q = joint.place.get(offsetof(BondRow<vec>, q));
            joint.read_t();
            up_joint<known, false>(joint, k, working, own);
            joint.write_t();
            joint.place.put(offsetof(BondRow<vec>, E), joint.top.E);
            return own;
        });
    });
    slack = least;
    up_joint<1, true>(ForestJoint(*this, f.n_steps - 1, pair), 1, working, slack);
}

inline __attribute__((noinline)) void ForestLinear::substitute() {
    for_steps_up([&](int32_t s, int64_t first) HOL_FORCED {
        const int k = f.step[s].children;
        choose_few<3>(k, [&](auto known) HOL_FORCED {
            const ForestJoint joint(*this, s, pair + first);
            joint.read_t();
            substitute_joint<known, false>(joint, k, working);
            joint.write_t();
        });
    });
    substitute_joint<1, true>(ForestJoint(*this, f.n_steps - 1, pair), 1, working);
}

// u of the children becomes t, and the sum of t d what they pull. `look`: tests the result.
template <bool look>
inline __attribute__((noinline)) void ForestLinear::down() {
    const auto step = [&](int32_t s, vec *pairs, auto known, auto top) HOL_FORCED {
        const int k = known > 0 ? known : f.step[s].children;
        const ForestJoint joint(*this, s, pairs);
        if (!top) joint.read_t();
        vec3 sum = {};
        HOL_UNROLL_FEW
        for (int a = 0; a < k; ++a) {
            BondRow<vec> &bond = joint.child[a];
            if (!top) bond.t = mul_add(bond.l, joint.top.t, bond.t);
            sum = add_times(sum, bond.t, bond.d);
        }
        AtPlaces<vec3>(pull, above_of(s)).put3(0, sum);
        if (!look || known == 1) return;
        joint.top.q = joint.place.get(offsetof(BondRow<vec>, q));
        joint.top.E = joint.place.get(offsetof(BondRow<vec>, E));
        joint.top.r = joint.place.get(offsetof(BondRow<vec>, r));
        const unsigned faint = bits(faint_bonds<vec>(joint, k)) & f.held[f.step[s].first + 1];
        if (__builtin_expect(faint != 0, 0)) joint.doubt_faint(k, faint, slack);
    };
    step(f.n_steps - 1, pair, Constant<int, 1>{}, Constant<bool, true>{});
    for_steps_down([&](int32_t s, int64_t first) HOL_FORCED {
        vec *const pairs = pair + first;
        choose_few<3>(f.step[s].children,
                      [&](auto known) HOL_FORCED { step(s, pairs, known, Constant<bool, false>{}); });
    });
}

// From what load() has left to the solution, in t of the rows. Returns the lanes that plain arithmetic answers for.
inline unsigned ForestLinear::solve() {
    factorize_and_solve();
    down<true>();
    vec sum = {};
    for (int32_t p = 0; p < f.n_places; ++p) sum = sum + abs(row[p].t);
    return bits(first_lanes(f.n_trees) & ~less(slack, vec{}) & finite(sum));
}
inline void ForestLinear::solve_again() {
    substitute();
    down<false>();
}

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
