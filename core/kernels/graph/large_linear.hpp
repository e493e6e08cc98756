// Linear equations of one molecule that is large, in its pieces (schedule.hpp): each is read and eliminated by itself,
// W atoms at a time and by any thread, then the top. The digits are those of linear.hpp.
#ifndef HOLONOMIC_KERNELS_GRAPH_LARGE_LINEAR_HPP
#define HOLONOMIC_KERNELS_GRAPH_LARGE_LINEAR_HPP

#include "core/kernels/graph/load_lanes.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

// Molecules in lanes are small.
template <class V>
HOL_INLINE void open_pieces(Linear<V> &, const LongTeam *, Memory<V> &) {}
HOL_INLINE void open_pieces(Linear<double> &z, const LongTeam *team, Memory<double> &memory) {
    if (has_pieces(z.x.s)) z.take_pieces(team, memory);
}

// Reads what the pieces hold, and eliminates it.
template <Layout layout, int terms, bool keep>
HOL_INLINE void load_and_eliminate(Linear<double> &z) {
    Molecules<double> &x = z.x;
    const Schedule &s = x.s;
    for_pieces(s, x.pieces->team, [&](int32_t p) {
        const int32_t first = first_of_piece(p), end = end_of_piece(s, p);
        load_slots<layout, terms>(z, first, end, (terms & rates) != 0);
        x.pieces->slack[p] = up_piece<keep>(x, p, x.pieces->memory(p));
    });
    collect_slack(x);
    Loader<layout, terms, double>{z}.load_core();
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

// Reads, and solves what has been read. `keep`: for more than one right-hand side.
template <Layout layout, int terms, bool keep>
HOL_NOINLINE void solve_in_pieces(Linear<double> &z) {
    Molecules<double> &x = z.x;
    const Schedule &s = x.s;
    for (int32_t slot = s.n_tree; slot < s.n_atoms; ++slot) x.w[slot] = x.lane[0].w[s.atom_of[slot]];
    do {
        load_and_eliminate<layout, terms, keep>(z);
        up_top<keep>(x, z.working);
        down_trees<true>(x);
    } while (to_be_repeated(x));
}

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
