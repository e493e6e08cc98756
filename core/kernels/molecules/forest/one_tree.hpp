// The linear equations of one large tree, piece by piece (forest.hpp): what is done with a piece is done while it is in
// a cache, and by any thread.
#pragma once

#include "core/kernels/molecules/forest/tree_doubt.hpp"
#include "core/kernels/molecules/share_out.hpp"

namespace holonomic::HOL_ISA::graph {

struct OneTree {
    typedef ForestTrees::Range Range;
    struct Piece {
        Faint faint;
        double slack;
    };
    ForestLinear &z;
    const LongTeam *team;
    Piece *piece;  // [n_pieces + 1]

    static int64_t bytes(const Forest &f) {
        return (f.n_pieces > 0 ? f.n_pieces + 1 : 0) * static_cast<int64_t>(sizeof(Piece));
    }
    // The memory behind that of z is taken, too.
    OneTree(ForestLinear &linear, const LongTeam *threads, Memory<vec> &memory)
        : z(linear), team(threads), piece(reinterpret_cast<Piece *>(memory.next)) {
        static_assert(sizeof(Piece) % sizeof(double) == 0, "");
        memory.next += bytes(z.f) / static_cast<int64_t>(sizeof(double));
        for (int32_t p = 0; p <= top(); ++p) piece[p] = {};
        z.per_cancelled2 = 1 / most_cancelled2(z.f.schedule[0]->n_bonds);
    }

    int32_t top() const { return z.f.n_pieces; }
    Memory<vec> memory(int32_t p) const {
        Memory<vec> own = z.working;
        own.values(p * ForestLinear::joint_values(z.f));
        return own;
    }
    template <class Body>
    void for_pieces(const Body &body) const {
        share_out(team, top(), body);
    }

    // The top is loaded before the pieces, which add to it.
    void load(int32_t p) const {
        z.load(z.piece(p));
        piece[p].faint.n_careful = 0;
        piece[p].slack = 1;
    }
    void eliminate(int32_t p) const {
        const Range range = z.piece(p);
        Piece &own = piece[p];
        const vec slack = z.up(range, memory(p), splat(1), TreeDoubt{&own.faint, &own.slack});
        if (any(less(slack, vec{}))) own.slack = -1;
    }
    void substitute_back(int32_t p) const {
        Piece &own = piece[p];
        z.down<true>(z.piece(p), TreeDoubt{&own.faint, &own.slack});
        if (any(~z.finite_in(z.piece(p)))) own.slack = -1;
    }

    // Faint bonds have been found, and are to be looked at again.
    bool to_be_repeated() const {
        bool any_new = false;
        for (int32_t p = 0; p <= top(); ++p) {
            Faint &faint = piece[p].faint;
            any_new = any_new || (faint.n > 0 && !faint.again);
            faint.again = true;
        }
        return any_new && is_good();
    }
    bool is_good() const {
        for (int32_t p = 0; p <= top(); ++p)
            if (!(piece[p].slack >= 0)) return false;
        return true;
    }

    // Returns whether plain arithmetic answers for the tree.
    bool solve() const {
        do {
            load(top());
            for_pieces([&](int32_t p) {
                load(p);
                eliminate(p);
            });
            eliminate(top());
            substitute_back(top());
            for_pieces([&](int32_t p) { substitute_back(p); });
        } while (to_be_repeated());
        return is_good();
    }

    // Calls write(range) for all.
    template <class Write>
    void for_ranges(const Write &write) const {
        for_pieces([&](int32_t p) { write(z.piece(p)); });
        write(z.piece(top()));
    }
    // In the order of the slots, whatever lanes there are.
    void add_virial(Tally &tally) const {
        MoleculesVirial<double> virial;
        for (int32_t slot = 0; slot < z.f.schedule[0]->n_tree; ++slot) {
            const BondRow<double> bond = bond_at(z.f.element[slot]);
            virial.add(bond.d, bond.t * bond.d);
        }
        virial.count(1, 1, tally);
    }
    BondRow<double> bond_at(int32_t element) const { return one_of(z.row[element / W], element % W); }

    void project(bool twice) const {
        z.add_pulls_to_velocities(z.piece(top()));
        if (!twice) return for_pieces([&](int32_t p) { z.add_pulls_to_velocities(z.piece(p)); });
        z.find_rates(z.piece(top()));
        for_pieces([&](int32_t p) {
            z.add_pulls_to_velocities(z.piece(p));
            z.find_rates(z.piece(p));
            z.substitute(z.piece(p), memory(p));
        });
        z.substitute(z.piece(top()), memory(top()));
        z.down<false>(z.piece(top()), ForestDoubt{z.slack});
        for_pieces([&](int32_t p) {
            z.down<false>(z.piece(p), ForestDoubt{z.slack});
            z.add_pulls_to_velocities(z.piece(p));
        });
        z.add_pulls_to_velocities(z.piece(top()));
    }

    // Returns whether any atom is torn by the solution.
    bool any_torn() const {
        for (int32_t p = 0; p <= top(); ++p) {
            const Faint &faint = piece[p].faint;
            const Range range = z.piece(p);
            if (faint.n_careful > Faint::most_careful) {
                for (int32_t atom = range.step * W; atom < range.inner_end() * W; ++atom)
                    if (z.f.held[z.f.step[atom / W].first] >> atom % W & 1)
                        if (is_torn(atom)) return true;
                continue;
            }
            for (int32_t i = 0; i < faint.n_careful; ++i)
                if (is_torn(faint.careful[i])) return true;
        }
        return false;
    }
    // An atom by its number in `faint`.
    __attribute__((noinline)) bool is_torn(int32_t number) const {
        const ForestJoint joint(z, number / W);
        const int i = number % W;
        double v[3];
        read_row(*z.in.v, z.at.number(i, z.atom_of(joint.step)[i]), v);
        Torn torn(bond_at(z.above_of(joint.step)[i]));
        for (int a = 0; a < joint.children(i); ++a)
            torn.add_child(bond_at(joint.element(a, i, z.f.step[joint.step].children)));
        return torn.is(joint.w()[i], v);
    }
};

}  // namespace holonomic::HOL_ISA::graph
