// Goes up and down W different trees: the sweeps of tree/joint.hpp, step by step.
#pragma once

#include "core/kernels/atom.hpp"
#include "core/kernels/molecules/tree/joint.hpp"
#include "core/kernels/molecules/tree_batch/linear.hpp"

namespace holonomic::HOL_ISA::graph {

// The bonds of an atom in each lane: those to its children at the rows of a step, and a copy of the one above.
struct BatchJoint {
    const BatchLinear &x;
    const int32_t step;
    const AtRows<BondRow<vec>> row_above;
    BondRow<vec> *const child;
    vec *const pairs;
    mutable BondRow<vec> top;

    HOL_FORCED BatchJoint(const BatchLinear &z, int32_t s)
        : x(z), step(s), row_above(z.row, z.above_of(s)), child(z.row + z.f.step[s].first),
          pairs(z.pair + z.f.step[s].pairs) {}
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
    // Of the atom in a lane.
    int children(int i) const {
        const TreeBatch::Step &its = x.f.step[step];
        int k = 0;
        while (k < its.children && (x.f.held[its.first + k] >> i & 1)) ++k;
        return k;
    }
    // The element of bond a of k in a lane; bond k is the one above.
    int32_t element(int a, int i, int k) const {
        return a == k ? x.above_of(step)[i] : (x.f.step[step].first + a) * W + i;
    }
    // The bond of an element, with the low word that the difference of the coordinates leaves.
    void exact(int32_t element, Vector3<double> &d, Vector3<double> &low) const {
        int32_t atom[2];
        double end[2][3];
        x.ends(element, atom);
        for (int e = 0; e < 2; ++e) read_atom(x.r, x.at.number(element % W, atom[e]), end[e]);
        unrounded_bond(x.box, end[0], end[1], d, low);
    }
    __attribute__((noinline)) vec products_anew(unsigned which, vec g) const {
        for (; which; which &= which - 1) {
            const int i = __builtin_ctz(which);
            Vector3<double> d[2], low[2];
            exact(element(0, i, 1), d[0], low[0]);
            exact(element(1, i, 1), d[1], low[1]);
            g[i] = dot_compensated(d[0], low[0], d[1], low[1]);
        }
        return g;
    }
    HOL_FORCED void read_t() const { top.t = row_above.get(offsetof(BondRow<vec>, t)); }
    HOL_FORCED void write_t() const { row_above.put(offsetof(BondRow<vec>, t), top.t); }

    // What flag_cancelling_bonds() does, in the lanes of `which`.
    __attribute__((noinline)) void flag_cancelling(int k, unsigned which, vec &margin) const {
        const vec shared = shared_error<vec>(*this, k);
        for (int a = -1; a < k; ++a) {
            const vec left = left_of(a < 0 ? top : child[a], shared);
            for (unsigned rest = which & bits(less(left, vec{})); rest; rest &= rest - 1) {
                const int i = __builtin_ctz(rest);
                const int32_t e = element(a < 0 ? k : a, i, k);
                const double own = terms_of_bond(e) / diagonal_of(e);
                if (!(left[i] + own * own >= 0)) margin[i] = -1;
            }
        }
    }
    // Of its right-hand side in absolute values.
    double terms_of_bond(int32_t element) const {
        const int i = element % W;
        if (x.has(given)) return __builtin_fabs(0.5 * x.in.rhs[x.bond_of(i, element / W)]);
        const vec3 &its = x.row[element / W].d;
        int32_t atom[2];
        x.ends(element, atom);
        const int64_t number[2] = {x.at.number(i, atom[0]), x.at.number(i, atom[1])};
        const double mass[2] = {x.lane[i].w[atom[0]], x.lane[i].w[atom[1]]}, d[3] = {its.x[i], its.y[i], its.z[i]};
        return terms_of(x.in, d, number, mass);
    }
    double diagonal_of(int32_t element) const {
        int32_t atom[2];
        x.ends(element, atom);
        const double *const w = x.lane[element % W].w;
        return (w[atom[0]] + w[atom[1]]) * x.row[element / W].q[element % W];
    }
};

// A tree of which nothing but the joints' tests is kept: where they fail, it is flagged.
struct BatchFlagged {
    template <int k>
    struct Values {
        HOL_FORCED void keep(const BatchJoint &) {}
    };
    HOL_FORCED vec begin(vec least) const { return least; }
    template <class Before>
    HOL_FORCED vec end(const BatchJoint &, const Before &, vec own, vec) const {
        return own;
    }
    void note_cancelling(const BatchJoint &joint, int k, unsigned which) const {
        joint.flag_cancelling(k, which, margin);
    }
    vec &margin;
};

template <class Flagged>
inline __attribute__((noinline)) vec BatchLinear::up(const Range &range, Memory<vec> memory, vec least,
                                                     const Flagged &flag) {
    for (int32_t s = range.step; s < range.inner_end(); ++s) {
        const int k = f.step[s].children;
        least = choose_few<3>(k, [=](auto known) HOL_FORCED {
            const BatchJoint joint(*this, s);
            joint.top.d = joint.row_above.get3(offsetof(BondRow<vec>, d));
            joint.top.q = joint.row_above.get(offsetof(BondRow<vec>, q));
            joint.read_t();
            typename Flagged::template Values<known> before;
            before.keep(joint);
            vec own = flag.begin(least);
            up_joint<known, false>(joint, k, memory, own);
            own = flag.end(joint, before, own, least);
            joint.write_t();
            joint.row_above.put(offsetof(BondRow<vec>, E), joint.top.E);
            return own;
        });
    }
    if (range.root) up_joint<1, true>(BatchJoint(*this, f.n_steps - 1), 1, memory, least);
    return least;
}

inline __attribute__((noinline)) void BatchLinear::substitute(const Range &range, Memory<vec> memory) {
    for (int32_t s = range.step; s < range.inner_end(); ++s) {
        const int k = f.step[s].children;
        choose_few<3>(k, [&](auto known) HOL_FORCED {
            const BatchJoint joint(*this, s);
            joint.read_t();
            substitute_joint<known, false>(joint, k, memory);
            joint.write_t();
        });
    }
    if (range.root) substitute_joint<1, true>(BatchJoint(*this, f.n_steps - 1), 1, memory);
}

// u of the children becomes t, and atoms get their pulls, as in down_joint(). `look`: tests the result.
template <bool look, class Flagged>
inline __attribute__((noinline)) void BatchLinear::down(const Range &range, const Flagged &flag) {
    const auto step = [&](int32_t s, auto known, auto top) HOL_FORCED {
        const int k = known > 0 ? known : f.step[s].children;
        const BatchJoint joint(*this, s);
        if (!top) joint.read_t();
        const AtRows<vec3> own(pull, above_of(s));
        vec3 sum = top ? vec3{} : own.get3(0);
        HOL_UNROLL_FEW
        for (int a = k - 1; a >= 0; --a) {
            BondRow<vec> &bond = joint.child[a];
            if (!top) bond.t = mul_add(bond.l, joint.top.t, bond.t);
            put(pull[f.step[s].first + a], add_times(vec3{}, -bond.t, bond.d));
            sum = add_times(sum, bond.t, bond.d);
        }
        own.put3(0, sum);
        if (!look || known == 1) return;
        joint.top.q = joint.row_above.get(offsetof(BondRow<vec>, q));
        joint.top.E = joint.row_above.get(offsetof(BondRow<vec>, E));
        joint.top.r = joint.row_above.get(offsetof(BondRow<vec>, r));
        const unsigned cancelling = bits(cancelling_bonds<vec>(joint, k)) & f.held[f.step[s].first + 1];
        if (__builtin_expect(cancelling != 0, 0)) flag.note_cancelling(joint, k, cancelling);
    };
    if (range.root) step(f.n_steps - 1, Constant<int, 1>{}, Constant<bool, true>{});
    for (int32_t s = range.inner_end(); s-- > range.step;)
        choose_few<3>(f.step[s].children, [&](auto known) HOL_FORCED { step(s, known, Constant<bool, false>{}); });
}

// From what load() has left to the solution, in t of the rows. Returns the lanes that plain arithmetic answers for.
inline unsigned BatchLinear::solve() {
    const BatchFlagged flag{margin};
    margin = up(all(), working, margin, flag);
    down<true>(all(), flag);
    return bits(first_lanes(f.n_trees) & ~less(margin, vec{}) & finite_in(all()));
}
inline void BatchLinear::solve_again() {
    substitute(all(), working);
    down<false>(all(), BatchFlagged{margin});
}

// The way of linear_level.hpp.
struct BatchWay {
    BatchLinear &z;
    NextMolecules &ahead;

    unsigned in_use() const { return bits(first_lanes(z.f.n_trees)); }
    unsigned solve() const {
        z.load(z.all());
        ahead.fetch();
        return z.solve();
    }
    void write(const LinearOutputs &out, unsigned which, Tally &tally) const {
        write_bonds_and_pulls(z, out, which, z.all());
        if (out.virial) z.add_virial(which, tally);
    }
    void project(const LinearOutputs &out, bool twice, unsigned which, Tally &tally) const {
        write_all_but_atoms(*this, out, which, tally);
        z.add_pulls_to_velocities(z.all());
        if (twice) {
            z.find_rates(z.all());
            z.solve_again();
            z.add_pulls_to_velocities(z.all());
        }
        z.write_velocities(z.all(), *out.g, which);
    }
};

}  // namespace holonomic::HOL_ISA::graph
