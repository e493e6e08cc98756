// The pieces of one large molecule (schedule.hpp), shared among threads.
#pragma once

#include "core/kernels/molecules/large_tree/arm_store.hpp"
#include "core/kernels/molecules/schedule.hpp"
#include "core/kernels/molecules/scratch.hpp"
#include "core/kernels/tally.hpp"

namespace holonomic::HOL_ISA::graph {

// Joints of more bonds would take too much memory in each piece.
constexpr int32_t most_children_in_pieces = 64;

HOL_INLINE bool has_pieces(const Schedule &s) { return s.n_pieces > 0 && s.max_joint <= most_children_in_pieces; }

// Atoms at which a bond is faint (siblings.hpp): found in a first solution, then eliminated carefully in a second one.
// And all that have been eliminated carefully, or more than fit.
struct Faint {
    static constexpr int most = 7, most_careful = 20;
    int32_t n, slot[most];
    int32_t n_careful, careful[most_careful];
    bool again;  // the second solution
    void note_careful(int32_t s) {
        if (n_careful < most_careful) careful[n_careful] = s;
        ++n_careful;
    }
    bool holds(int32_t s) const {
        for (int i = 0; i < n && again; ++i)
            if (slot[i] == s) return true;
        return false;
    }
    bool note(int32_t s) {
        for (int i = 0; i < n; ++i)
            if (slot[i] == s) return true;
        if (n == most) return false;
        slot[n++] = s;
        return true;
    }
};

struct Pieces {
    const LongTeam *team;  // or nullptr
    double *slack;         // [n_pieces]
    Faint *faint;          // [n_pieces + 1], the last one's of the top
    double *working;       // of a joint of many bonds, one behind the other
    int64_t working_values;
    Arms arms = {};
    const Schedule::Runs &runs(const Schedule &s) const { return arms.store ? s.runs_of_arms : s.runs; }
    Memory<double> memory(int32_t piece) const { return {working + piece * working_values}; }
};

// Calls body(i) for i = 0 .. n - 1, on the threads that there are.
template <class Body>
HOL_INLINE void share_out(const LongTeam *team, int32_t n, const Body &body) {
    if (!team) {
        for (int32_t i = 0; i < n; ++i) body(i);
        return;
    }
    Tally unused = empty_tally();
    team->run(
        team->threads, n, unused,
        [](const void *context, int64_t i, double *, Tally &) {
            (*static_cast<const Body *>(context))(static_cast<int32_t>(i));
        },
        &body);
}

// Calls body(piece) for all but the top.
template <class Body>
HOL_INLINE void for_pieces(const Schedule &s, const LongTeam *team, const Body &body) {
    share_out(team, s.n_pieces, body);
}

// The slots of trees in a piece.
HOL_INLINE int32_t first_of_piece(int32_t p) { return p * slots_of_piece; }
HOL_INLINE int32_t end_of_piece(const Schedule &s, int32_t p) {
    return p + 1 < s.n_pieces ? (p + 1) * slots_of_piece : s.n_tree;
}

// Calls body(first, end) for ranges of the numbers below n, places or slots, each of a thread where there are some.
template <class Body>
HOL_INLINE void for_ranges(const Schedule &s, const Pieces *pieces, int32_t n, const Body &body) {
    if (!pieces) return body(0, n);
    for_pieces(s, pieces->team, [&](int32_t p) { body(first_of_piece(p), end_of_piece(s, p)); });
    body(s.n_tree, n);
}

// Calls body(stretch) for all that is between the arms, on the threads that there are.
template <class Body>
HOL_INLINE void for_stretches(const Schedule &s, const LongTeam *team, const Body &body) {
    for_pieces(s, team, [&](int32_t p) {
        for (int32_t i = s.stretch_start[p]; i < s.stretch_start[p + 1]; ++i) body(s.stretch[i]);
    });
}

// As for_ranges, of all slots or of all places but those that arms stand for.
template <class Body>
HOL_INLINE void for_slots(const Schedule &s, const Pieces *pieces, const Body &body) {
    if (!pieces || !pieces->arms.store) return for_ranges(s, pieces, s.n_atoms, body);
    for_stretches(s, pieces->team, [&](const Schedule::Stretch &x) { body(x.first, x.end); });
    body(s.n_tree, s.n_atoms);
}
template <class Body>
HOL_INLINE void for_places(const Schedule &s, const Pieces *pieces, const Body &body) {
    if (!pieces || !pieces->arms.store) return for_ranges(s, pieces, s.n_bonds, body);
    for_stretches(s, pieces->team, [&](const Schedule::Stretch &x) { body(x.first_place, x.end_place); });
}
// One behind the other.
template <class Body>
HOL_INLINE void for_places_in_order(const Schedule &s, const Pieces *pieces, const Body &body) {
    if (!pieces || !pieces->arms.store) return body(0, s.n_bonds);
    for_stretches(s, nullptr, [&](const Schedule::Stretch &x) { body(x.first_place, x.end_place); });
}

}  // namespace holonomic::HOL_ISA::graph
