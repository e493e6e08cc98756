// The linear equations of W different trees (core/plan/tree_batch.hpp). The arithmetic is that of tree/joint.hpp, so
// that a tree's digits do not depend on whether it comes with others of its shape, with others, or alone.
#pragma once

#include <stddef.h>

#include "core/kernels/molecules/linear_level.hpp"
#include "core/kernels/molecules/tree_batch/lanes.hpp"

namespace holonomic::HOL_ISA::graph {

struct BatchLinear : BatchTrees {
    const Box &box;
    const AtomArray &r;
    Inputs in;
    const int terms;      // of right-hand sides: RightHandSide
    BondRow<vec> *row;    // [n_rows]
    vec3 *pull;           // [n_rows] G of the lower atom; at n_bond_rows, of the root
    vec3 *velocity;       // likewise, for rates
    vec *w, *lower_w;     // [n_steps], [n_bond_rows]
    vec *pair;            // [n_pairs] multipliers among the children of an atom
    vec margin;           // negative where plain products do not do
    Memory<vec> working;  // of a joint of many bonds
    double per_cancelled2 = 1 / (most_cancelled * most_cancelled);

    static int64_t joint_values(const TreeBatch &f) {
        return JointMemory<vec, 0>::values(f.most_children < most_decomposed ? f.most_children : most_decomposed);
    }
    static int64_t values(const TreeBatch &f) {
        const int64_t rows = f.n_rows(), row_values = sizeof(BondRow<vec>) / sizeof(vec);
        return (row_values + 6 + 1) * rows + f.n_steps + f.n_pairs + (1 + f.n_tiles) * joint_values(f);
    }

    BatchLinear(const TreeBatch &batch, const MoleculeLane *lanes, bool packed, const Box &b,
                const AtomArray &positions, const Inputs &inputs, int right_hand_side, Memory<vec> &memory)
        : BatchTrees(batch, lanes, packed), box(b), r(positions), in(inputs), terms(right_hand_side), margin(splat(1)) {
        const int64_t rows = f.n_rows();
        row = reinterpret_cast<BondRow<vec> *>(memory.values(rows * static_cast<int64_t>(sizeof *row / sizeof(vec))));
        pull = memory.vectors(rows);
        velocity = memory.vectors(rows);
        lower_w = memory.values(rows);
        w = memory.values(f.n_steps);
        pair = memory.values(f.n_pairs);
        working = memory;
        memory.values((1 + f.n_tiles) * joint_values(f));
        for (int64_t p = f.n_bond_rows; p < rows; ++p) {
            row[p] = BondRow<vec>{};
            pull[p] = velocity[p] = vec3{};
        }
    }

    bool has(int wanted) const { return (terms & wanted) != 0; }

    // The local atoms that the bond of an element joins. They are looked for in the batch of trees's own lists: the
    // elimination plans of different trees are seldom in a cache.
    void ends(int32_t element, int32_t *atom) const {
        const int32_t p = element / W;
        int32_t step = 0;
        for (int32_t end = f.n_steps; end - step > 1;) {
            const int32_t middle = step + (end - step) / 2;
            (f.step[middle].first <= p ? step : end) = middle;
        }
        atom[1] = lower_of(p)[element % W];
        atom[0] = atom_of(step)[element % W];
    }

    // What load.hpp does.
    template <bool packed, bool squared, bool pulled, bool rated>
    __attribute__((noinline)) void load_terms(const Range &range) {
        // Copies, which no store changes.
        const AtomArray none = {}, positions = r, velocities = squared || rated ? *in.v : none,
                        forces = pulled ? *in.f : none;
        const auto fetch_all = [&](const int32_t *numbers, int32_t i, int32_t n) HOL_FORCED {
            if (pulled && (squared || rated))
                fetch<packed, true>(numbers, i, n, positions, velocities, forces);
            else
                fetch<packed, true>(numbers, i, n, positions, pulled ? forces : velocities);
        };
        for (int32_t s = range.step; s < range.end_step; ++s) {
            fetch_all(f.atom, s, f.n_steps);
            const BatchAtom<packed> atom(at, atom_of(s));
            const vec3 r0 = atom.read(positions), v0 = squared || rated ? atom.read(velocities) : vec3{},
                       f0 = pulled ? atom.read(forces) : vec3{};
            const vec w0 = masses_of(lane, atom_of(s));
            w[s] = w0;
            for (int32_t p = f.step[s].first, end = p + f.step[s].children; p < end; ++p) {
                fetch_all(f.lower, p, f.n_bond_rows);
                const BatchAtom<packed> lower(at, lower_of(p));
                vec3 d = lower.read(positions) - r0, unused = {};
                take_image<false>(box, d, unused);
                const vec w1 = masses_of(lane, lower_of(p));
                vec b = {};
                if (squared || rated) {
                    const vec3 v = lower.read(velocities), dv = v - v0;
                    if (squared) b = dot(dv, dv);
                    if (rated) b = dot(d, dv);
                    if (rated) velocity[p] = v;
                }
                if (rated && in.strain) b = b + stretching(in.strain, d);
                if (pulled) b = Loader<vec>::with_pull(d, w0, f0, w1, lower.read(forces), b);
                if (!squared && !pulled && !rated && has(given)) b = given_value(p);
                BondRow<vec> &to = row[p];
                to.d = d;
                to.q = dot(d, d);
                to.E = select(lanes_of(f.held[p]), w1 * to.q, splat(1));  // of a leaf, or of no bond
                to.t = b;
                lower_w[p] = w1;
            }
            if (rated && s == f.n_steps - 1) velocity[f.n_bond_rows] = v0;
        }
    }
    void load(const Range &range) {
        choose(
            [&](auto packed, auto squared, auto pulled, auto rated) {
                if constexpr (!(rated && (squared || pulled))) load_terms<packed, squared, pulled, rated>(range);
            },
            at.layout != elements, has(squares), has(pulls), has(rates));
    }

    vec given_value(int32_t p) const {
        vec b = {};
        for (int i = 0; i < W; ++i)
            if (f.held[p] >> i & 1) b[i] = 0.5 * in.rhs[bond_of(i, p)];
        return b;
    }

    template <class Flagged>
    vec up(const Range &, Memory<vec> memory, vec least, const Flagged &);
    void substitute(const Range &, Memory<vec> memory);
    template <bool look, class Flagged>
    void down(const Range &, const Flagged &);
    unsigned solve();
    void solve_again();
    // As finite_solution() has it.
    __attribute__((noinline)) mask finite_in(const Range &range) const {
        vec sum = {}, sum_of_squares = {}, least = splat(1);
        for (int32_t p = range.row; p < range.end_row; ++p) {
            sum = mul_add(row[p].t, vec{}, sum);
            sum_of_squares = sum_of_squares + row[p].q;
            least = min(select(lanes_of(f.held[p]), row[p].q, splat(1)), least);
        }
        return finite(sum) & ordinary_squares(least, sum_of_squares);
    }

    __attribute__((noinline)) void add_pulls_to_velocities(const Range &range) {
        for (int32_t p = range.row; p < range.end_row + (range.root ? 1 : 0); ++p) {
            const vec mass = p < f.n_bond_rows ? lower_w[p] : w[f.n_steps - 1];
            velocity[p] = add_times(velocity[p], mass, pull[p]);
        }
    }
    // d . (v_j - v_i) into t of the rows.
    __attribute__((noinline)) void find_rates(const Range &range) {
        for (int32_t s = range.step; s < range.end_step; ++s) {
            const vec3 v0 = AtRows<vec3>(velocity, above_of(s)).get3(0);
            for (int32_t p = f.step[s].first, end = p + f.step[s].children; p < end; ++p) {
                row[p].t = dot(row[p].d, velocity[p] - v0);
                if (in.strain) row[p].t = row[p].t + stretching(in.strain, row[p].d);
            }
        }
    }

    __attribute__((noinline)) void write_pulls(const Range &range, const AtomArray &g, bool add, unsigned which) const {
        write_atoms(range, g, which, [&](int32_t p, const auto &atom) HOL_FORCED {
            return add ? add_times(atom.read(g), splat(1), pull[p]) : pull[p];
        });
    }
    __attribute__((noinline)) void write_velocities(const Range &range, const AtomArray &v, unsigned which) const {
        write_atoms(range, v, which, [&](int32_t p, const auto &) HOL_FORCED { return velocity[p]; });
    }
    // Writes factor t of the bonds, zeros as +0. with_length: |d| is the factor.
    template <bool with_length>
    __attribute__((noinline)) void write_bonds(const Range &range, double factor, double *out, unsigned which) const {
        for_held(range, which, [&](int32_t p, unsigned lanes) HOL_FORCED {
            if (f.n_tiles >= pieces_of_cache && p + rows_ahead / W < f.n_bond_rows)
                for (int i = 0; i < W; ++i) __builtin_prefetch(out + bond_of(i, p + rows_ahead / W), 1, 2);
            write_values(p, lanes, mul_add(row[p].t, with_length ? sqrt(row[p].q) : splat(factor), vec{}), out);
        });
    }
    __attribute__((noinline)) void add_virial(unsigned which, Tally &tally) const {
        graph::add_virial<vec>(
            0, f.n_bond_rows, [&](int32_t p) HOL_FORCED { return row[p].d; },
            [&](int32_t p) HOL_FORCED { return row[p].t; }, 1, which, tally);
    }
};

}  // namespace holonomic::HOL_ISA::graph
