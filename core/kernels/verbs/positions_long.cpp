// Position level of one long chain: Newton's method, in windows where that will do, else in segments. The decisions are
// those of a block of chains, newton/criterion.hpp.
#include "core/kernels/memory/cut.hpp"
#include "core/kernels/memory/stage.hpp"
#include "core/kernels/newton/criterion.hpp"
#include "core/kernels/newton/phases.hpp"
#include "core/kernels/tally.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic {
namespace HOL_ISA {

namespace {

// In more solves than ordinary chains take, tau may have been much larger than it ends: its sum is rounded in that
// size, and the bonds have been moved by the summands.
constexpr int64_t most_solves = 5;

// How often the method goes on from coordinates as they are rounded.
constexpr int most_settlings = 4;

// Makes `largest` at least e, whatever other threads do to it; NaN stays.
static inline void raise(double &largest, double e) {
    double seen;
    __atomic_load(&largest, &seen, __ATOMIC_RELAXED);
    while ((e > seen || (e != e && seen == seen)) &&
           !__atomic_compare_exchange(&largest, &seen, &e, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
    }
}

static inline double value_of(const double &largest) {
    double seen;
    __atomic_load(&largest, &seen, __ATOMIC_RELAXED);
    return seen;
}

static inline bool is_finite(double a) { return a - a == 0; }

// What a chain's positions, velocities and multipliers were; and multipliers of their own for each settling.
struct Saved {
    double *r, *v, *lambda, *more;
    int64_t n;
    static int64_t doubles(int64_t n) { return 6 * (n + 1) + n + most_settlings * n; }
    Saved(double *memory, int64_t n_bonds)
        : r(memory), v(r + 3 * (n_bonds + 1)), lambda(v + 3 * (n_bonds + 1)), more(lambda + n_bonds), n(n_bonds) {}
    double *more_of(int depth) const { return more + depth * n; }
    void keep(const PositionsCall &call, const Lane &lane) const {
        stage(call.r, lane, 0, n, r);
        if (call.v.x) stage(call.v, lane, 0, n, v);
        for (int64_t k = 0; call.lambda && k < n; ++k) lambda[k] = call.lambda[lane.first_bond + k];
    }
    void restore(const PositionsCall &call, const Lane &lane) const {
        unstage(call.r, lane, 0, n, r, false);
        if (call.v.x) unstage(call.v, lane, 0, n, v, false);
        for (int64_t k = 0; call.lambda && k < n; ++k) call.lambda[lane.first_bond + k] = lambda[k];
    }
};

class LongNewton {
public:
    LongNewton(const PositionsCall &call, const Lane &lane, const LongTeam &team, double *store, int depth = 0)
        : call_(call), lane_(lane), team_(team), store_(store), blocks_(Cut(lane.n_bonds).blocks), depth_(depth) {}

    bool in_windows(Tally &tally) const;
    bool attempt(bool careful, bool guess, Tally &tally) const;

private:
    // Calls body(j, scratch, part) for j = 0 .. n-1.
    template <class Body>
    void for_each(int64_t n, Tally &total, const Body &body) const {
        team_.run(
            team_.threads, n, total,
            [](const void *b, int64_t j, double *scratch, Tally &part) {
                (*static_cast<const Body *>(b))(j, scratch, part);
            },
            &body);
    }
    template <class Body>
    void for_each_block(const Body &body) const {
        Tally unused = empty_tally();
        for_each(blocks_, unused, [&](int64_t j, double *scratch, Tally &) { body(j, scratch); });
    }
    // Largest of what body(j, scratch) returns; NaN if any is.
    template <class Body>
    double largest(const Body &body) const {
        double worst = 0;
        for_each_block([&](int64_t j, double *scratch) { raise(worst, body(j, scratch)); });
        return worst;
    }

    double load(double &error) const;
    double step(bool substitute) const {
        return largest(
            [&](int64_t j, double *scratch) { return step_segments(call_, lane_, j, substitute, store_, scratch); });
    }
    bool iterate(bool careful, double error, double extent, double shortest, double accepted, Tally &tally) const;
    bool finish(bool moved, int64_t solves, double reach, Tally &tally) const;
    bool settle(int64_t solves, Tally &tally) const;
    void write(bool moved, int64_t solves, Tally &tally) const;

    const PositionsCall &call_;
    const Lane &lane_;
    const LongTeam &team_;
    double *const store_;
    const int64_t blocks_;
    const int depth_;
};

// In windows that know nothing of each other; false, with nothing written, where that does not do.
bool LongNewton::in_windows(Tally &tally) const {
    if (call_.r_ref.x == call_.r.x) return false;  // the bonds of the reference are needed while atoms are moved
    const int64_t n = count_windows(lane_.n_bonds);
    int seen[3] = {0, 0, 0};  // of each WindowResult
    double worst = 0;
    Tally part = empty_tally();
    for_each(n, part, [&](int64_t j, double *scratch, Tally &own) {
        if (__atomic_load_n(&seen[window_failed], __ATOMIC_RELAXED)) return;
        // Which bond has a window's largest error is looked for only if no other's is known to be larger.
        const double most = value_of(worst), known = most > 0 ? most * (1 - epsilon) : -4.9e-324;
        own.worst = known;
        own.worst_chain = lane_.chain;
        const WindowResult result = solve_window(call_, lane_, j, store_, scratch, own);
        if (own.worst == known)
            own.worst_chain = -1;
        else
            raise(worst, own.worst);
        __atomic_store_n(&seen[result], 1, __ATOMIC_RELAXED);
    });
    const bool solved = seen[window_solved];
    if (seen[window_failed] || (solved && seen[window_untouched])) return false;
    bool fit = true;
    Tally unused = empty_tally();
    if (solved)
        for_each(1, unused,
                 [&](int64_t, double *scratch, Tally &) { fit = windows_fit(call_, lane_, store_, scratch, part); });
    if (!fit) return false;
    for_each(n, part, [&](int64_t j, double *scratch, Tally &own) {
        finish_window(call_, lane_, j, solved, store_, scratch, own);
    });
    part.n_corrected = solved;
    add(tally, part);
    return true;
}

// Returns the largest coordinate.
double LongNewton::load(double &error) const {
    double extent = 0;
    error = largest([&](int64_t j, double *scratch) {
        LongTally part{0, 0};
        load_segments(call_, lane_, j, store_, scratch, part);
        raise(extent, part.extent);
        return part.error;
    });
    return extent;
}

void LongNewton::write(bool moved, int64_t solves, Tally &tally) const {
    for_each(blocks_, tally, [&](int64_t j, double *scratch, Tally &part) {
        finish_segments(call_, lane_, j, moved, store_, scratch, part);
    });
    tally.n_corrected += moved;
    if (solves > tally.iterations) tally.iterations = solves;
}

// Writes the results. Single pulls may move an atom so far that their rounding is more than the coordinates' (light
// atoms between heavy ones in a taut chain), or may have done so on the way. Then goes on from the coordinates as they
// are rounded; if that does not end within the tolerance, everything is put back.
bool LongNewton::finish(bool moved, int64_t solves, double reach, Tally &tally) const {
    const bool unusual = depth_ == 0 && solves > most_solves;
    const auto pull = [&](int64_t j, double *) { return largest_pull(lane_, j, store_); };
    if (moved && (unusual || !(largest(pull) <= 0.25 * reach))) return settle(solves, tally);
    write(moved, solves, tally);
    return true;
}

bool LongNewton::settle(int64_t solves, Tally &tally) const {
    if (depth_ >= most_settlings) return false;
    const Saved saved(store_ + segments_bytes(lane_.n_bonds) / static_cast<int64_t>(sizeof(double)), lane_.n_bonds);
    if (depth_ == 0) saved.keep(call_, lane_);
    // The next time the multipliers start at 0 in an array of their own, and are added.
    PositionsCall again = call_;
    Lane alone = lane_;
    alone.first_bond = 0;
    again.lambda = call_.lambda ? saved.more_of(depth_) : nullptr;
    again.guess = again.virial = false;
    Tally part = empty_tally(), settled = empty_tally();
    write(true, solves, part);
    if (!LongNewton(again, alone, team_, store_, depth_ + 1).attempt(true, false, settled)) {
        if (depth_ == 0) saved.restore(call_, lane_);
        return false;
    }
    for (int64_t k = 0; call_.lambda && k < lane_.n_bonds; ++k) call_.lambda[lane_.first_bond + k] += again.lambda[k];
    part.worst = settled.worst;
    part.worst_bond = settled.worst_bond;
    add(tally, part);
    return true;
}

bool LongNewton::attempt(bool careful, bool guess, Tally &tally) const {
    double error;
    const double extent = load(error);
    double shortest = lane_.length_uniform;
    for (int64_t k = 0; lane_.length && k < lane_.n_bonds; ++k)
        if (k == 0 || lane_.length[k] < shortest) shortest = lane_.length[k];
    const double carried = carried_error(unit_roundoff(call_.r), extent, shortest);
    const double accepted = call_.tolerance > carried ? call_.tolerance : carried;
    if (!is_finite(error)) return false;
    if (error <= accepted) {
        write(false, 0, tally);
        return true;
    }
    if (guess) {
        for_each_block([&](int64_t j, double *) { start_from_guess(call_, lane_, j, store_); });
        const double with_guess = step(false);
        if (!(with_guess <= error)) return attempt(careful, false, tally);
        error = with_guess;
        if (error <= wanted_error(call_)) return finish(true, 0, extent + shortest, tally);
    } else if (call_.guess) {  // tau holds the guess that is not to be used
        for_each_block([&](int64_t j, double *) { forget_guess(lane_, j, store_); });
    }
    return iterate(careful, error, extent, shortest, accepted, tally);
}

bool LongNewton::iterate(bool careful, double error, double extent, double shortest, double accepted,
                         Tally &tally) const {
    bool renew = true;
    double rate = error;  // new factors square the error
    for (int64_t i = 0; i < call_.max_iterations; ++i) {
        if (renew)
            for_each_block(
                [&](int64_t j, double *scratch) { factorize_segments(call_, lane_, j, careful, store_, scratch); });
        if (!join_segments(lane_, renew, store_)) return false;
        const double before = error, expected = rate * before;
        error = step(true);
        if (!is_finite(error)) return false;
        if (error <= wanted_error(call_) || (at_floor(expected, before, error) && error <= accepted))
            return finish(true, i + 1, extent + shortest, tally);
        rate = error / before;
        renew = careful || worth_renewing(error, rate, i);
        if (renew) rate = error;
    }
    return false;
}

}  // namespace

int64_t long_positions_bytes(int64_t n_bonds) {
    return segments_bytes(n_bonds) + Saved::doubles(n_bonds) * static_cast<int64_t>(sizeof(double));
}

void long_positions(const PositionsCall &call, const Lane &lane, const LongTeam &team, double *store, Tally &tally) {
    const LongNewton newton(call, lane, team, store);
    if (newton.in_windows(tally) || newton.attempt(false, call.guess, tally) || newton.attempt(true, false, tally))
        return;
    note_bad(lane, tally);
}

}  // namespace HOL_ISA
}  // namespace holonomic
