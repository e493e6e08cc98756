// Newton's method for the positions of W different trees (core/plan/tree_batch.hpp): a system for iterate.hpp. The
// arithmetic is that of tree/newton.hpp, so that a tree's digits do not depend on whether it comes with others.
#pragma once

#include <stddef.h>

#include "core/kernels/molecules/tree/newton.hpp"
#include "core/kernels/molecules/tree_batch/lanes.hpp"

namespace holonomic::HOL_ISA::graph {

typedef NewtonRow<vec> BatchRow;

struct BatchNewton : BatchTrees {
    BatchRow *row;       // [n_rows]
    vec3 *new_D, *pull;  // [n_rows] of the bond, and on its lower atom; at n_bond_rows, on the root
    vec *w, *lower_w;    // [n_steps], [n_bond_rows + 1]
    vec *lower, *upper;  // [n_pairs]
    vec *kept;           // factors, while new ones are made for some lanes
    Memory<vec> working;
    bool pulled = false;  // atoms know their pulls by tau

    static int64_t joint_values(const TreeBatch &f) {
        return NewtonMemory<vec, 0>::values(f.most_children < most_decomposed ? f.most_children : most_decomposed);
    }
    static int64_t values(const TreeBatch &f) {
        const int64_t rows = f.n_rows(), row_values = sizeof(BatchRow) / sizeof(vec);
        return (row_values + 6 + 1 + 3) * rows + f.n_steps + 4 * static_cast<int64_t>(f.n_pairs) +
               (1 + f.n_tiles) * joint_values(f);
    }

    BatchNewton(const TreeBatch &batch, const MoleculeLane *lanes, bool packed, Memory<vec> &memory)
        : BatchTrees(batch, lanes, packed) {
        const int64_t rows = f.n_rows();
        row = reinterpret_cast<BatchRow *>(memory.values(rows * static_cast<int64_t>(sizeof *row / sizeof(vec))));
        new_D = memory.vectors(rows);
        pull = memory.vectors(rows);
        lower_w = memory.values(rows);
        w = memory.values(f.n_steps);
        lower = memory.values(f.n_pairs);
        upper = memory.values(f.n_pairs);
        kept = memory.values(3 * rows + 2 * f.n_pairs);
        working = memory;
        memory.values((1 + f.n_tiles) * joint_values(f));
        for (int64_t p = f.n_bond_rows; p < rows; ++p) {
            row[p] = BatchRow{};
            new_D[p] = pull[p] = vec3{};
        }
    }

    // Bonds of the reference positions and of the new ones; returns the latter's largest coordinate.
    template <bool packed>
    __attribute__((noinline)) vec load_bonds(const Range &range, const PositionsCall &call) {
        vec largest = {};
        const auto look_at = [&](const vec3 &r)
                                 HOL_FORCED { largest = max(max(abs(r.x), abs(r.y)), max(abs(r.z), largest)); };
        for (int32_t s = range.step; s < range.end_step; ++s) {
            fetch<packed, true>(f.atom, s, f.n_steps, call.r_ref, call.r);
            const BatchAtom<packed> atom(at, atom_of(s));
            const vec3 ref = atom.read(call.r_ref), r = atom.read(call.r);
            w[s] = masses_of(lane, atom_of(s));
            look_at(r);
            for (int32_t p = f.step[s].first, end = p + f.step[s].children; p < end; ++p) {
                fetch<packed, true>(f.lower, p, f.n_bond_rows, call.r_ref, call.r);
                const BatchAtom<packed> below(at, lower_of(p));
                const vec3 r1 = below.read(call.r);
                vec3 unused = {};
                look_at(r1);
                row[p].b = below.read(call.r_ref) - ref;
                row[p].D = r1 - r;
                take_image<false>(call.box_ref, row[p].b, unused);
                take_image<false>(call.box, row[p].D, unused);
                lower_w[p] = masses_of(lane, lower_of(p));
                row[p].tau = vec{};
            }
        }
        if (range.root) lower_w[f.n_bond_rows] = w[f.n_steps - 1];
        return largest;
    }
    // a^2 of all bonds: 0 where there is none.
    __attribute__((noinline)) void load_lengths(const Range &range, vec &least, vec &most) {
        least = splat(1e300);
        most = vec{};
        for (int32_t p = range.row; p < range.end_row; ++p) {
            const double *length[W];
            HOL_UNROLL
            for (int i = 0; i < W; ++i) length[i] = lane[i].length + f.bond[static_cast<int64_t>(p) * W + i];
            const vec a = numbers_at(length, 0);
            const mask there = lanes_of(f.held[p]);
            least = select(there, min(a, least), least);
            most = select(there, max(a, most), most);
            row[p].a2 = select(there, a * a, vec{});
            row[p].per_a2 = select(there, splat(1) / (a * a), vec{});
        }
    }

    // What Newton has, by these names.
    typedef TreeNewton<vec>::Errors Errors;
    __attribute__((noinline)) vec open(const Range &range) {
        Errors errors = {};
        for (int32_t p = range.row; p < range.end_row; ++p) {
            new_D[p] = row[p].D;
            TreeNewton<vec>::measure<true>(row[p], row[p].D, errors);
        }
        return errors.largest();
    }
    vec open() { return open(all()); }
    void first_factors() { make_all_factors(); }
    void make_all_factors() {
        begin_factors(all());
        make_factors(all(), working);
    }
    void forget(mask which) {
        for (int32_t p = 0; p < f.n_bond_rows; ++p) row[p].tau = select(which, vec{}, row[p].tau);
        pulled = false;
    }
    void factorize(mask which) {
        Errors unused = {};
        for (int32_t p = 0; p < f.n_bond_rows; ++p) {
            BatchRow &bond = row[p];
            const vec stretch = bond.stretch, t = bond.t;
            TreeNewton<vec>::measure<true>(bond, new_D[p], unused);
            bond.stretch = select(which, bond.stretch, stretch);
            bond.t = select(which, bond.t, t);
        }
        if (bits(which) == all_lanes) return make_all_factors();
        vec *to = kept;
        const vec *from = kept;
        for_factors([&](vec &value) HOL_FORCED { *to++ = value; });
        make_all_factors();
        for_factors([&](vec &value) HOL_FORCED { value = select(which, value, *from++); });
    }
    template <class Body>
    HOL_FORCED void for_factors(const Body &body) const {
        for (int32_t p = 0; p < f.n_bond_rows; ++p) {
            body(row[p].r);
            body(row[p].up);
            body(row[p].down);
        }
        for (int32_t p = 0; p < f.n_pairs; ++p) {
            body(lower[p]);
            body(upper[p]);
        }
    }

    void begin_factors(const Range &);
    void make_factors(const Range &, Memory<vec> memory);
    void substitute(const Range &, Memory<vec> memory);
    template <bool corrected>
    __attribute__((noinline)) void go_down(const Range &, mask active);
    void solve(mask active) {
        substitute(all(), working);
        go_down<true>(all(), active);
        pulled = true;
    }
    vec move() {
        if (!pulled) go_down<false>(all(), mask{});
        pulled = true;
        return move_bonds(all());
    }
    // The displacement of the lower atom of a row, or of the root.
    HOL_FORCED vec3 displacement(int32_t p) const { return add_times(vec3{}, lower_w[p], pull[p]); }
    __attribute__((noinline)) vec move_bonds(const Range &range) {
        Errors errors = {};
        for (int32_t s = range.step; s < range.end_step; ++s) {
            const vec3 above = AtRows<vec3>(pull, above_of(s)).get3(0);
            for (int32_t p = f.step[s].first, end = p + f.step[s].children; p < end; ++p) {
                vec3 turned = difference(lower_w[p], pull[p], w[s], above);
                if (f.held[p] != all_lanes) {
                    const mask there = lanes_of(f.held[p]);
                    turned = {keep(there, turned.x), keep(there, turned.y), keep(there, turned.z)};
                }
                new_D[p] = row[p].D + turned;
                TreeNewton<vec>::measure<false>(row[p], new_D[p], errors);
            }
        }
        return errors.largest();
    }
    // |D.D - a^2| / a^2 of the bonds of a row.
    vec left_of(int32_t p) const { return abs(excess(new_D[p], row[p].a2)) * row[p].per_a2; }
};

// The bonds of an atom in each lane, as NewtonAtom has them: those to its children at the rows of a step, and a copy
// of the one above.
struct BatchNewtonJoint {
    const BatchNewton &x;
    const int32_t step;
    const AtRows<BatchRow> row_above;
    BatchRow *const child;
    const vec3 *const child_D;
    const int64_t first;
    const Memory<vec> memory;
    mutable BatchRow top;
    vec3 top_D;

    HOL_FORCED BatchNewtonJoint(const BatchNewton &z, int32_t s, Memory<vec> m)
        : x(z), step(s), row_above(z.row, z.above_of(s)), child(z.row + z.f.step[s].first),
          child_D(z.new_D + z.f.step[s].first), first(z.f.step[s].pairs), memory(m) {}
    HOL_FORCED vec w() const { return x.w[step]; }
    HOL_FORCED BatchRow &bond(int a) const { return child[a]; }
    HOL_FORCED const vec3 &D(int a) const { return child_D[a]; }
    HOL_FORCED BatchRow &above() const { return top; }
    HOL_FORCED const vec3 &D_above() const { return top_D; }
    HOL_FORCED vec *lower() const { return x.lower + first; }
    HOL_FORCED vec *upper() const { return x.upper + first; }
    HOL_FORCED Memory<vec> working() const { return memory; }
    HOL_FORCED void read_t() const { top.t = row_above.get(offsetof(BatchRow, t)); }
};

inline __attribute__((noinline)) void BatchNewton::begin_factors(const Range &range) {
    for (int32_t p = range.row; p < range.end_row; ++p)
        row[p].r = select(lanes_of(f.held[p]), lower_w[p] * dot(new_D[p], row[p].b), splat(1));  // of a leaf
}

inline __attribute__((noinline)) void BatchNewton::make_factors(const Range &range, Memory<vec> memory) {
    for (int32_t s = range.step; s < range.inner_end(); ++s) {
        const int k = f.step[s].children;
        choose_few<3>(k, [&](auto known) HOL_FORCED {
            BatchNewtonJoint joint(*this, s, memory);
            joint.top.b = joint.row_above.get3(offsetof(BatchRow, b));
            joint.top_D = AtRows<vec3>(new_D, above_of(s)).get3(0);
            factorize_joint<known, false, vec>(joint, k);
            joint.row_above.put(offsetof(BatchRow, r), joint.top.r);
        });
    }
    if (range.root) factorize_joint<1, true, vec>(BatchNewtonJoint(*this, f.n_steps - 1, memory), 1);
}

inline __attribute__((noinline)) void BatchNewton::substitute(const Range &range, Memory<vec> memory) {
    for (int32_t s = range.step; s < range.inner_end(); ++s) {
        const int k = f.step[s].children;
        choose_few<3>(k, [&](auto known) HOL_FORCED {
            const BatchNewtonJoint joint(*this, s, memory);
            joint.read_t();
            substitute_newton_joint<known, false, vec>(joint, k);
            joint.row_above.put(offsetof(BatchRow, t), joint.top.t);
        });
    }
    if (range.root) substitute_newton_joint<1, true, vec>(BatchNewtonJoint(*this, f.n_steps - 1, memory), 1);
}

// As Newton::go_down(). An atom gets its pull of the bond above when its parent is dealt with, those of the bonds below
// at its own step.
template <bool corrected>
void BatchNewton::go_down(const Range &range, mask active) {
    if (range.root) pull[f.n_bond_rows].x = pull[f.n_bond_rows].y = pull[f.n_bond_rows].z = vec{};
    for (int32_t s = range.end_step; s-- > range.step;) {
        const vec t_above = AtRows<BatchRow>(row, above_of(s)).get(offsetof(BatchRow, t));
        const bool inner = s < range.inner_end();
        const AtRows<vec3> own(pull, above_of(s));
        vec3 sum = own.get3(0);
        const int32_t first = f.step[s].first;
        for (int32_t p = first + f.step[s].children; p-- > first;) {
            BatchRow &bond = row[p];
            if (corrected) {
                if (inner) bond.t = mul_add(bond.down, t_above, bond.t);
                bond.tau = bond.tau + keep(active, bond.t);
            }
            pull[p] = -bond.tau * bond.b;
            sum = add_times(sum, bond.tau, bond.b);
        }
        own.put3(0, sum);
    }
}

}  // namespace holonomic::HOL_ISA::graph
