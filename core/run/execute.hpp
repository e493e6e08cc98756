// Runs a kernel over all chains, on as many threads as the work is worth.
#pragma once

#include <algorithm>
#include <new>

#include "core/kernel_choice.hpp"
#include "core/kernels/tally.hpp"
#include "core/molecules/chains.hpp"
#include "core/run/thread_memory.hpp"

namespace holonomic {

// The threads that work on one long chain.
class Team {
public:
    Team(int n_threads, std::int64_t scratch_bytes) : n_threads_(n_threads), scratch_bytes_(scratch_bytes) {}

    enum Direction { forwards, backwards };

    // Calls body(j, scratch, tally) for j = 0 .. n-1, or from n-1 to 0, and adds the tallies in that order. A thread
    // has the same share in both, so that it finds in cache what it came to last, but for the first blocks of a chain.
    template <class Body>
    void for_each(std::int64_t n, Tally &total, const Body &body, Direction order = forwards) const {
        run(
            n, order, total,
            [](const void *b, std::int64_t j, double *scratch, Tally &tally) {
                (*static_cast<const Body *>(b))(j, scratch, tally);
            },
            &body);
    }

    // For kernels that go through phases of their own.
    LongTeam lent() const {
        return {this, [](const void *team, std::int64_t n, Tally &total,
                         void (*body)(const void *, std::int64_t, double *, Tally &), const void *context) {
                    static_cast<const Team *>(team)->run(n, forwards, total, body, context);
                }};
    }

private:
    void run(std::int64_t n, Direction order, Tally &total, void (*call)(const void *, std::int64_t, double *, Tally &),
             const void *body) const;
    int n_threads_;
    std::int64_t scratch_bytes_;
};

// What a call does with linear chains that fit into lanes, with molecules of other shapes, and with longer chains.
class Work {
public:
    virtual void unit(const Unit &unit, int where, double *scratch, Tally &tally) const = 0;
    virtual void unit(const MoleculeUnit &unit, int where, double *scratch, Tally &tally) const = 0;
    // Whether it has a way of its own for different trees side by side; else each comes as a unit.
    virtual bool walks_batches() const { return false; }
    // Scratch memory that it needs, if that is more than the plan says.
    virtual std::int64_t scratch_bytes() const { return 0; }
    // Whether threads share the work on one large molecule that has paths.
    virtual bool shares_paths() const { return false; }
    virtual std::int64_t long_blocks(std::int64_t n_bonds) const = 0;
    virtual std::int64_t long_bytes(std::int64_t n_bonds) const = 0;
    virtual void long_chain(const Lane &lane, int where, const Team &team, double *store, Tally &tally) const = 0;

    // Whether molecules are worked on in ordinary units where their own ones are too far from these (rescale.hpp). That
    // is what again() does with a unit of one molecule; it returns false where that is bad, too.
    virtual bool rescales() const { return false; }
    virtual bool again(const Unit &, int, double *, Tally &) const { return false; }
    virtual bool again(const MoleculeUnit &, int, double *, Tally &) const { return false; }
    virtual bool again(const Lane &, int, const Team &, double *, Tally &) const { return false; }

protected:
    ~Work() = default;
};

// The six sums of a tally as a symmetric [3][3]; or a sum [9]. Throws Error if one has overflowed.
void write_virial(const Tally &tally, double *virial);
void write_virial(const double *sum, double *virial);
// The same, added and not looked at.
void add_virial(const Tally &tally, double *virial);

// Throws std::bad_alloc.
inline double *scratch_of_this_thread(std::int64_t bytes) {
    void *const scratch = thread_memory(Keep::scratch, bytes);
    if (__builtin_expect(!scratch, 0)) throw std::bad_alloc();
    return static_cast<double *>(scratch);
}

// Adds to a tally that is empty. Throws std::bad_alloc before any work is done.
void execute(const Chains &chains, const Plan &plan, const Work &work, Tally &tally);

// Does those of a unit that have been found to be bad once more, in ordinary units: all of them, or those that are
// listed.
void work_again(const Work &work, const Unit &unit, int where, double *scratch, Tally &tally);

// The same by the plan of the molecules as they are.
template <class AnyWork>
inline Tally execute(const Chains &chains, const AnyWork &work) {
    const Plan &plan = chains.plan();
    Tally tally = empty_tally();
    if (plan.only.count == 0 || chains.keeps_outcomes) {
        execute(chains, plan, static_cast<const Work &>(work), tally);
    } else {
        double *const scratch = scratch_of_this_thread(plan.scratch_bytes);
        std::int64_t bad[most_listed];
        tally.bad = bad;
        work.unit(plan.only, plan.chunks[0].where, scratch, tally);
        if (tally.n_bad > 0) work_again(work, plan.only, plan.chunks[0].where, scratch, tally);
    }
    return tally;
}

// A long chain at the levels of forces and velocities: eliminate, join, finish; once more with compensated products
// where plain ones don't do.
template <class Call>
void solve_long_chain(const InSegments<Call> &phases, void (*)(const Call &, const Unit &, double *, Tally &),
                      const Call &call, const Lane &lane, const Team &team, double *store, Tally &tally) {
    const std::int64_t blocks = phases.blocks(lane.n_bonds);
    JoinResult result = join_flagged;
    for (int attempt = 0; attempt < 2 && result == join_flagged; ++attempt) {
        const bool extended = attempt == 1;
        // A few blocks before all others: a chain that is flagged there needs no plain products elsewhere.
        std::int64_t done = 0;
        for (const std::int64_t end : {std::min<std::int64_t>(blocks, 8), blocks}) {
            if (end == done) break;
            team.for_each(end - done, tally, [&](std::int64_t j, double *scratch, Tally &) {
                phases.eliminate(call, lane, done + j, extended, store, scratch);
            });
            done = end;
            result = phases.join(lane, end, extended, store);
            if (result == join_extreme && call.rescaled) result = join_flagged;  // nothing better is to be had
            if (result != join_good) break;
        }
    }
    if (result != join_good) return note_bad(lane.chain, tally);
    const auto finish = [&](std::int64_t j, double *scratch, Tally &part) {
        phases.finish(call, lane, j, store, scratch, part);
    };
    team.for_each(blocks, tally, finish, Team::backwards);
}

// Positions and metric: in windows, or in one lane where these won't do.
template <class Call>
void solve_long_chain(const InWindows<Call> &windows,
                      void (*in_one_lane)(const Call &, const Unit &, double *, Tally &), const Call &call,
                      const Lane &lane, const Team &team, double *store, Tally &tally) {
    if (!windows.solve(call, lane, team.lent(), store, tally))
        in_one_lane(call, Unit{&lane, 1, false, false}, store, tally);
}
template <class Call>
std::int64_t store_bytes(const InSegments<Call> &phases, std::int64_t n_bonds) {
    return phases.bytes(n_bonds);
}
template <class Call>
std::int64_t store_bytes(const InWindows<Call> &windows, std::int64_t n_bonds) {
    return std::max(windows.bytes(n_bonds), kernels_for_one_chain().scratch_bytes(n_bonds));
}

}  // namespace holonomic
