// The linear equations of one large tree, tile by tile (core/plan/tree_batch.hpp): what is done with a tile is done
// while it is in a cache, and by any thread.
#pragma once

#include "core/kernels/atom.hpp"
#include "core/kernels/molecules/share_out.hpp"
#include "core/kernels/molecules/tree_batch/flagged.hpp"

namespace holonomic::HOL_ISA::graph {

struct LargeTree {
    typedef BatchTrees::Range Range;
    struct Tile {
        Cancelling cancelling;
        SmallDifferences small;
        double margin;
    };
    BatchLinear &z;
    const LongTeam *team;
    Tile *tile;  // [n_tiles + 1]

    static int64_t bytes(const TreeBatch &f) {
        return (f.n_tiles > 0 ? f.n_tiles + 1 : 0) * static_cast<int64_t>(sizeof(Tile));
    }
    // The memory behind that of z is taken, too.
    LargeTree(BatchLinear &linear, const LongTeam *threads, Memory<vec> &memory)
        : z(linear), team(threads), tile(reinterpret_cast<Tile *>(memory.next)) {
        static_assert(sizeof(Tile) % sizeof(double) == 0, "");
        memory.next += bytes(z.f) / static_cast<int64_t>(sizeof(double));
        for (int32_t p = 0; p <= top(); ++p) tile[p] = {};
        z.per_cancelled2 = 1 / most_cancelled2(z.f.elimination[0]->n_bonds);
    }

    int32_t top() const { return z.f.n_tiles; }
    Memory<vec> memory(int32_t p) const {
        Memory<vec> own = z.working;
        own.values(p * BatchLinear::joint_values(z.f));
        return own;
    }
    template <class Body>
    void for_tiles(const Body &body) const {
        share_out(team, top(), body);
    }

    TreeFlagged flagged(int32_t p) const { return {&tile[p].cancelling, &tile[p].small, &tile[p].margin}; }

    // The top is loaded before the tiles, which add to it.
    void load(int32_t p) const {
        z.load(z.tile(p));
        tile[p].cancelling.n_extended = tile[p].small.n = 0;
        tile[p].margin = 1;
    }
    void eliminate(int32_t p) const {
        const Range range = z.tile(p);
        Tile &own = tile[p];
        const vec margin = z.up(range, memory(p), splat(1), flagged(p));
        if (any(less(margin, vec{}))) own.margin = -1;
    }
    void substitute_back(int32_t p) const {
        Tile &own = tile[p];
        z.down<true>(z.tile(p), flagged(p));
        if (any(~z.finite_in(z.tile(p)))) own.margin = -1;
    }

    // Cancelling bonds have been found, and are to be looked at again.
    bool to_be_repeated() const {
        bool any_new = false;
        for (int32_t p = 0; p <= top(); ++p) {
            Cancelling &cancelling = tile[p].cancelling;
            any_new = any_new || (cancelling.n > 0 && !cancelling.again);
            cancelling.again = true;
        }
        return any_new && is_good();
    }
    bool is_good() const {
        for (int32_t p = 0; p <= top(); ++p)
            if (!(tile[p].margin >= 0)) return false;
        return true;
    }

    // The way of linear_level.hpp.
    unsigned in_use() const { return 1; }
    unsigned solve() const { return load_and_solve() && !(solved_twice(z.in) && any_overcorrected()) ? 1 : 0; }
    void write(const LinearOutputs &out, unsigned which, Tally &tally) const {
        for_ranges([&](const Range &range) { write_bonds_and_pulls(z, out, all_lanes, range); });
        if (out.virial) add_virial(which, tally);
    }
    void project(const LinearOutputs &out, bool twice, unsigned which, Tally &tally) const {
        write_all_but_atoms(*this, out, which, tally);
        project(twice);
        for_ranges([&](const Range &range) { z.write_velocities(range, *out.g, all_lanes); });
    }

    // Returns whether plain arithmetic answers for the tree.
    bool load_and_solve() const {
        do {
            load_and_solve_once();
        } while (to_be_repeated());
        if (!is_good() || !has_small()) return is_good();
        if (!are_small_beside_scales()) return false;
        load_and_solve_once();  // once more, as rows of the inverse have taken the place of the solution
        return is_good();
    }
    void load_and_solve_once() const {
        load(top());
        for_tiles([&](int32_t p) {
            load(p);
            eliminate(p);
        });
        eliminate(top());
        substitute_back(top());
        for_tiles([&](int32_t p) { substitute_back(p); });
    }

    bool has_small() const {
        for (int32_t p = 0; p <= top(); ++p)
            if (tile[p].small.n > 0) return true;
        return false;
    }
    // Whether bonds whose multipliers are small differences have scales that do, theory (53a): |A^-1| S, a row of the
    // inverse each.
    __attribute__((noinline)) bool are_small_beside_scales() const {
        for (int32_t p = 0; p <= top(); ++p)
            for (int i = 0; i < tile[p].small.n; ++i) {
                find_row_of_inverse(tile[p].small.element[i]);
                if (!(tile[p].small.least[i] <= terms_by_row())) return false;
            }
        return true;
    }
    // In t of the rows.
    void find_row_of_inverse(int32_t element) const {
        for (int32_t p = 0; p < z.f.n_bond_rows; ++p) z.row[p].t = vec{};
        z.row[element / W].t[element % W] = 1;
        for_tiles([&](int32_t p) { z.substitute(z.tile(p), memory(p)); });
        z.substitute(z.tile(top()), memory(top()));
        z.down<false>(z.tile(top()), flagged(top()));
        for_tiles([&](int32_t p) { z.down<false>(z.tile(p), flagged(p)); });
    }
    // sum |t| S over all bonds
    double terms_by_row() const {
        const BatchJoint joint(z, 0);
        double sum = 0;
        for (int32_t e = 0; e < z.f.n_bond_rows * W; ++e)
            if (z.f.held[e / W] >> e % W & 1) sum += abs(z.row[e / W].t[e % W]) * joint.terms_of_bond(e);
        return sum;
    }

    // Calls write(range) for all.
    template <class Write>
    void for_ranges(const Write &write) const {
        for_tiles([&](int32_t p) { write(z.tile(p)); });
        write(z.tile(top()));
    }
    // In the order of the indices, whatever lanes there are.
    void add_virial(unsigned which, Tally &tally) const {
        graph::add_virial<double>(
            0, z.f.elimination[0]->n_tree, [&](int32_t index) { return bond_at(z.f.element[index]).d; },
            [&](int32_t index) { return bond_at(z.f.element[index]).t; }, 1, which, tally);
    }
    BondRow<double> bond_at(int32_t element) const { return one_of(z.row[element / W], element % W); }

    void project(bool twice) const {
        z.add_pulls_to_velocities(z.tile(top()));
        if (!twice) return for_tiles([&](int32_t p) { z.add_pulls_to_velocities(z.tile(p)); });
        z.find_rates(z.tile(top()));
        for_tiles([&](int32_t p) {
            z.add_pulls_to_velocities(z.tile(p));
            z.find_rates(z.tile(p));
            z.substitute(z.tile(p), memory(p));
        });
        z.substitute(z.tile(top()), memory(top()));
        z.down<false>(z.tile(top()), BatchFlagged{z.margin});
        for_tiles([&](int32_t p) {
            z.down<false>(z.tile(p), BatchFlagged{z.margin});
            z.add_pulls_to_velocities(z.tile(p));
        });
        z.add_pulls_to_velocities(z.tile(top()));
    }

    // Returns whether any atom is overcorrected by the solution.
    bool any_overcorrected() const {
        for (int32_t p = 0; p <= top(); ++p) {
            const Cancelling &cancelling = tile[p].cancelling;
            const Range range = z.tile(p);
            if (cancelling.n_extended > Cancelling::most_extended) {
                for (int32_t atom = range.step * W; atom < range.inner_end() * W; ++atom)
                    if (z.f.held[z.f.step[atom / W].first] >> atom % W & 1)
                        if (is_overcorrected(atom)) return true;
                continue;
            }
            for (int32_t i = 0; i < cancelling.n_extended; ++i)
                if (is_overcorrected(cancelling.extended[i])) return true;
        }
        return false;
    }
    // An atom by its number in `cancelling`.
    __attribute__((noinline)) bool is_overcorrected(int32_t number) const {
        const BatchJoint joint(z, number / W);
        const int i = number % W;
        double v[3];
        read_atom(*z.in.v, z.at.number(i, z.atom_of(joint.step)[i]), v);
        Overcorrected overcorrected(bond_at(z.above_of(joint.step)[i]));
        for (int a = 0; a < joint.children(i); ++a)
            overcorrected.add_child(bond_at(joint.element(a, i, z.f.step[joint.step].children)));
        return overcorrected.is(joint.w()[i], v);
    }
};

}  // namespace holonomic::HOL_ISA::graph
