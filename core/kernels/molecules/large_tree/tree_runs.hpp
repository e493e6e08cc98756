// The sweeps of joint.hpp over one large tree whose atoms do not fill lanes, with the same digits: piece by piece, arms
// as chains. Others go as a forest (forest/one_tree.hpp).
#pragma once

#include "core/kernels/molecules/large_tree/doubtful_atom.hpp"
#include "core/kernels/molecules/tree/joint.hpp"

namespace holonomic::HOL_ISA::graph {

// In twice the precision. False: that doesn't do either.
HOL_NOINLINE bool up_carefully(const Molecules<double> &x, int32_t slot, int k) {
    const AtomRows<double> rows(x, slot);
    DoubtfulAtom atom = {};
    atom.k = k;
    atom.w = rows.w();
    for (int a = 0; a <= k; ++a) {
        atom.bond[a] = a < k ? rows.bond(a) : rows.above();
        exact_bond(x, 0, a < k ? rows.child[a] : slot, atom.d[a], atom.low[a]);
    }
    if (!up_doubtful(atom)) return false;
    for (int a = 0; a <= k; ++a) (a < k ? rows.bond(a) : rows.above()) = atom.bond[a];
    for (int p = 0; p < k * (k - 1) / 2; ++p) rows.multipliers()[p] = atom.pair[p];
    return true;
}

// Goes up at one atom, with careful arithmetic where plain arithmetic does not do.
HOL_NOINLINE void up_one(const Molecules<double> &x, int32_t slot, Faint &faint, Memory<double> memory, double &slack) {
    const AtomRows<double> rows(x, slot);
    const int k = x.s.child_start[slot + 1] - x.s.child_start[slot];
    if (__builtin_expect(faint.holds(slot), 0)) {
        if (k > 3 || !up_carefully(x, slot, k)) slack = -1;
        return faint.note_careful(slot);
    }
    if (k > 3) return up_joint<0, false>(rows, k, memory, slack);
    double before[8], own = 1;
    for (int a = 0; a <= k; ++a) {
        const BondRow<double> &row = a < k ? rows.bond(a) : rows.above();
        before[2 * a] = row.E;
        before[2 * a + 1] = row.t;
    }
    choose_number<1, 3>(k, [&](auto known) { up_joint<known, false>(rows, k, memory, own); });
    if (__builtin_expect(own >= 0, 1)) return;
    for (int a = 0; a <= k; ++a) {
        BondRow<double> &row = a < k ? rows.bond(a) : rows.above();
        row.E = before[2 * a];
        row.t = before[2 * a + 1];
    }
    if (!up_carefully(x, slot, k)) slack = -1;
    faint.note_careful(slot);
}

// Deals with an atom with faint bonds. The first time it notes the atom, to be eliminated carefully the next time. Then
// products are right, and a result must not be a small difference of what comes up and what comes down.
HOL_NOINLINE void note_faint(const Molecules<double> &x, int32_t slot, int k, Faint &faint, double &slack) {
    double own = 1;
    doubt_faint_bonds(x, slot, k, 1, own);
    if (own >= 0) return;
    if (!faint.again) {
        if (!faint.note(slot)) slack = -1;
        return;
    }
    if (!faint.holds(slot)) slack = -1;
    const double above = x.row[slot].t;
    for (int a = 0; a < k; ++a) {
        const int32_t place = x.s.child[x.s.child_start[slot] + a];
        const BondRow<double> &row = x.row[place];
        const double down = row.l * above, A = (x.w[slot] + x.w[place]) * row.q;
        const double size = abs(row.t) + terms_of(x, place, 0) / A;
        if (!(abs(row.t - down) + abs(down) <= sqrt(most_cancelled2(x.s.n_bonds)) * size)) slack = -1;
    }
}

HOL_INLINE void down_atom(const Molecules<double> &x, int32_t slot, Faint &faint, double &slack, bool look) {
    const int k = x.s.child_start[slot + 1] - x.s.child_start[slot];
    double own = 1;
    if (look && k > 1) {
        down_one<true>(x, slot, own);
        if (__builtin_expect(own < 0, 0)) note_faint(x, slot, k, faint, slack);
    } else {
        down_one<false>(x, slot, own);
    }
}

// What is done at an arm, work(context, arm, faint, slack). By its address, so that pieces are compiled once for all.
struct ArmWork {
    const void *context = nullptr;
    void (*work)(const void *, int32_t, Faint &, double &) = nullptr;
    ArmWork() = default;  // there are no arms
    template <class Body>
    explicit ArmWork(const Body &body)
        : context(&body), work([](const void *c, int32_t arm, Faint &faint, double &slack) {
              (*static_cast<const Body *>(c))(arm, faint, slack);
          }) {}
};

// Does the arms of a run.
HOL_INLINE bool do_arms(const Schedule::Runs &runs, const Schedule::Run &run, const ArmWork &arm, Faint &faint,
                        double &slack) {
    if (run.children != Schedule::arms_in_run) return false;
    for (int32_t i = 0; i < run.count; ++i) arm.work(arm.context, runs.slot[run.first + i], faint, slack);
    return true;
}

// A piece, or the top.
static inline double up_piece(const Molecules<double> &x, int32_t piece, Memory<double> memory, const ArmWork &arm) {
    const Schedule::Runs &s = x.pieces->runs(x.s);
    Faint &faint = x.pieces->faint[piece];
    faint.n_careful = 0;
    double slack = 1;
    for (int32_t r = s.piece_start[piece]; r < s.piece_start[piece + 1]; ++r) {
        const Schedule::Run &run = s.run[r];
        if (do_arms(s, run, arm, faint, slack)) continue;
        for (int32_t i = run.first; i < run.first + run.count; ++i) up_one(x, s.slot[i], faint, memory, slack);
    }
    return slack;
}

static inline void substitute_piece(const Molecules<double> &x, int32_t piece, Memory<double> memory) {
    const Schedule::Runs &s = x.pieces->runs(x.s);
    for (int32_t r = s.piece_start[piece]; r < s.piece_start[piece + 1]; ++r)
        for (int32_t i = 0; i < s.run[r].count; ++i) substitute_one(x, s.slot[s.run[r].first + i], memory);
}

static inline double down_piece(const Molecules<double> &x, int32_t piece, const ArmWork &arm, bool look) {
    const Schedule::Runs &s = x.pieces->runs(x.s);
    Faint &faint = x.pieces->faint[piece];
    double slack = 1;
    for (int32_t r = s.piece_start[piece + 1]; r-- > s.piece_start[piece];) {
        const Schedule::Run &run = s.run[r];
        if (do_arms(s, run, arm, faint, slack)) continue;
        for (int32_t i = run.first; i < run.first + run.count; ++i) down_atom(x, s.slot[i], faint, slack, look);
    }
    return slack;
}

static inline void collect_slack(Molecules<double> &x) {
    for (int32_t p = 0; p < x.s.n_pieces; ++p) x.slack = min(x.pieces->slack[p], x.slack);
}

// Goes up behind the pieces.
static inline void up_top(Molecules<double> &x, Memory<double> memory, const ArmWork &arm) {
    x.slack = min(up_piece(x, x.s.n_pieces, memory, arm), x.slack);
    up_joint<1, true>(AtomRows<double>(x, x.s.n_tree), 1, memory, x.slack);
}

// Light atoms between heavy ones in line are pulled from both sides with much more than what moves them. Then the
// rounding of multipliers moves them by more than their velocity's, and when that is projected away, their neighbours,
// too. All such atoms have been eliminated carefully. Returns whether this one is torn so.
constexpr double torn_part = 0x1p10;
HOL_NOINLINE bool is_torn(const Molecules<double> &x, int32_t slot) {
    double v[3];
    read_row(*x.in.v, x.at.number(0, x.s.atom_of[slot]), v);
    Vector3<double> pull = -x.row[slot].t * x.row[slot].d;
    double sizes = abs(x.row[slot].t) * sqrt(x.row[slot].q);
    for (int32_t c = x.s.child_start[slot]; c < x.s.child_start[slot + 1]; ++c) {
        const BondRow<double> &row = x.row[x.s.child[c]];
        pull = add_times(pull, row.t, row.d);
        sizes += abs(row.t) * sqrt(row.q);
    }
    const Vector3<double> before = {v[0], v[1], v[2]}, after = add_times(before, x.w[slot], pull);
    const auto size_of = [](const Vector3<double> &a) { return abs(a.x) + abs(a.y) + abs(a.z); };
    return !(x.w[slot] * sizes <= torn_part * (size_of(before) + size_of(after)));
}

// Returns whether any atom is torn by the solution, of a molecule in pieces.
static inline bool any_torn_atom(const Molecules<double> &x) {
    bool torn = false, all = false;
    for (int32_t p = 0; x.pieces && p <= x.s.n_pieces; ++p) {
        const Faint &faint = x.pieces->faint[p];
        all = all || faint.n_careful > Faint::most_careful;
        for (int32_t i = 0; i < faint.n_careful && !all; ++i) torn = torn || is_torn(x, faint.careful[i]);
    }
    if (!all) return torn;
    const auto look = [&](int32_t first, int32_t end) {
        for (int32_t slot = first; slot < end && !torn; ++slot) torn = is_torn(x, slot);
    };
    const Arms &arms = x.pieces->arms;
    if (!arms.store) look(0, x.s.n_tree);
    for (int32_t i = 0; arms.store && i < x.s.stretch_start[x.s.n_pieces]; ++i)
        look(x.s.stretch[i].first, x.s.stretch[i].end);
    for (int32_t a = 0; arms.store && a < x.s.n_arms; ++a)
        if (arms.alone[a]) look(x.s.arm[a].bottom + 1, x.s.arm[a].top() + 1);
    return torn;
}

// The sweeps of joint.hpp, in pieces where there are any.
static inline void substitute_trees(const Molecules<double> &x, Memory<double> memory) {
    if (!x.pieces) return substitute_trees<double>(x, memory);
    for_pieces(x.s, x.pieces->team, [&](int32_t p) { substitute_piece(x, p, x.pieces->memory(p)); });
    substitute_piece(x, x.s.n_pieces, memory);
    substitute_joint<1, true>(AtomRows<double>(x, x.s.n_tree), 1, memory);
}
static inline void down_pieces(Molecules<double> &x, const ArmWork &arm, bool look) {
    x.slack = min(down_piece(x, x.s.n_pieces, arm, look), x.slack);
    for_pieces(x.s, x.pieces->team, [&](int32_t p) { x.pieces->slack[p] = down_piece(x, p, arm, look); });
    collect_slack(x);
}
template <bool look>
static inline void down_trees(Molecules<double> &x) {
    if (!x.pieces) return down_trees<look, double>(x);
    down_pieces(x, ArmWork(), look);
}

}  // namespace holonomic::HOL_ISA::graph
