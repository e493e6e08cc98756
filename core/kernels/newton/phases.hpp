// The phases of Newton's method on one long chain: each goes through the chain's blocks or windows in any order, on any
// thread. verbs/positions_segments.cpp and verbs/positions_windows.cpp have them, verbs/positions_long.cpp calls them.
#ifndef HOLONOMIC_KERNELS_NEWTON_PHASES_HPP
#define HOLONOMIC_KERNELS_NEWTON_PHASES_HPP

#include "core/kernels/call.hpp"
#include "core/kernels/isa/target.hpp"

namespace holonomic {
namespace HOL_ISA {

// Largest coordinate and largest relative error of a chain or block; the error is NaN if anything is not finite.
struct LongTally {
    double extent, error;
};

// In segments. `store` has what passes from phase to phase: segments_bytes(n_bonds).
int64_t segments_bytes(int64_t n_bonds);
void load_segments(const PositionsCall &, const Lane &, int64_t block, double *store, double *scratch, LongTally &);
void start_from_guess(const PositionsCall &, const Lane &, int64_t block, double *store);
void forget_guess(const Lane &, int64_t block, double *store);
void factorize_segments(const PositionsCall &, const Lane &, int64_t block, bool careful, double *store,
                        double *scratch);
bool join_segments(const Lane &, bool renewed, double *store);
double step_segments(const PositionsCall &, const Lane &, int64_t block, bool substitute, double *store,
                     double *scratch);
double largest_pull(const Lane &, int64_t block, double *store);
void finish_segments(const PositionsCall &, const Lane &, int64_t block, bool moved, double *store, double *scratch,
                     Tally &);

// In windows, which know nothing of each other: tau is [n_bonds].
enum WindowResult { window_failed, window_untouched, window_solved };
int64_t count_windows(int64_t n_bonds);
WindowResult solve_window(const PositionsCall &, const Lane &, int64_t window, double *tau, double *scratch, Tally &);
bool windows_fit(const PositionsCall &, const Lane &, const double *tau, double *scratch, Tally &);
void finish_window(const PositionsCall &, const Lane &, int64_t window, bool moved, const double *tau, double *scratch,
                   Tally &);

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
