// Linear equations of one molecule that is large, in its pieces (schedule.hpp): each is read and eliminated by itself,
// W atoms at a time and by any thread, then the top. The digits are those of linear.hpp.
#pragma once

#include "core/kernels/molecules/large_tree/arms.hpp"

namespace holonomic::HOL_ISA::graph {

// Reads what the pieces hold, and eliminates it; up_arm does so at an arm.
HOL_INLINE void load_and_eliminate(Linear<double> &z, int terms, const ArmWork &up_arm) {
    Molecules<double> &x = z.x;
    const Schedule &s = x.s;
    const bool keep_all = terms & rates;
    for_pieces(s, x.pieces->team, [&](int32_t p) {
        if (x.pieces->arms.store)
            for (int32_t i = s.stretch_start[p]; i < s.stretch_start[p + 1]; ++i)
                load_slots(z, terms, s.stretch[i].first, s.stretch[i].end, keep_all);
        else
            load_slots(z, terms, first_of_piece(p), end_of_piece(s, p), keep_all);
        x.pieces->slack[p] = up_piece(x, p, x.pieces->memory(p), up_arm);
    });
    collect_slack(x);
    Loader<double>{z, terms}.load_core();
}

// Faint bonds have been found, and are to be looked at again.
static inline bool to_be_repeated(Molecules<double> &x) {
    bool any = false;
    for (int32_t p = 0; p <= x.s.n_pieces; ++p) {
        Faint &faint = x.pieces->faint[p];
        any = any || (faint.n > 0 && !faint.again);
        faint.again = true;
    }
    return any && x.slack >= 0;
}

static inline void solve_all_pieces(Linear<double> &z, int terms, bool look) {
    Molecules<double> &x = z.x;
    const Schedule &s = x.s;
    for (int32_t slot = s.n_tree; slot < s.n_atoms; ++slot) x.w[slot] = x.lane[0].w[s.atom_of[slot]];
    const auto solve = [&](const ArmWork &up, const ArmWork &down) {
        do {
            load_and_eliminate(z, terms, up);
            up_top(x, z.working, up);
            down_pieces(x, down, look);
        } while (to_be_repeated(x));
    };
    if ((terms & given) || !x.pieces->arms.store) return solve(ArmWork(), ArmWork());
    eliminate_arms(x, terms);
    const auto up = [&](int32_t a, Faint &faint, double &slack) { up_arm(z, terms, a, faint, z.working, slack); };
    const auto down = [&](int32_t a, Faint &faint, double &slack) { down_arm(x, a, faint, slack, look); };
    solve(ArmWork(up), ArmWork(down));
}

}  // namespace holonomic::HOL_ISA::graph
