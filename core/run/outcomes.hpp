// What a call has done with each molecule, for callers who ask for it (hol_chains_set_outcomes). It stands in memory of
// the calling thread, so that any number of threads may use a handle at once.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/error.hpp"
#include "core/kernels/tally.hpp"
#include "core/molecules/chains.hpp"

namespace holonomic {

struct OutcomeOf {
    std::int32_t status;  // a Status; below 0: bad, and it is not known yet why
    std::int32_t iterations;
};
constexpr std::int32_t bad_outcome = -1;

// Where the call under way notes them [n_molecules], or null: nobody asks. Of the calling thread; the threads that help
// it are handed this.
OutcomeOf *outcomes_under_way();

// From here on outcomes are noted, all good so far, until the end. Throws std::bad_alloc.
void begin_outcomes(const Chains &chains);
void end_outcomes(bool complete);

// Those of this thread's last call with the set, or null: there is none, or it ended before it had any.
const OutcomeOf *last_outcomes(const Chains &chains);

// Of a molecule that is found to be bad before anything is done.
inline void note_status(std::int64_t molecule, Status status) {
    if (OutcomeOf *const outcomes = outcomes_under_way()) outcomes[molecule].status = static_cast<std::int32_t>(status);
}

// Calls verb(), and notes outcomes if the set is to.
template <class Verb>
void with_outcomes(const Chains &chains, const Verb &verb) {
    if (!chains.keeps_outcomes) return verb();
    begin_outcomes(chains);
    try {
        verb();
    } catch (const Error &error) {
        const bool of_molecules = error.n_bad > 0 && error.chain >= 0;
        if (of_molecules) note_status(error.chain, error.status);
        end_outcomes(of_molecules);
        throw;
    } catch (...) {
        end_outcomes(false);
        throw;
    }
    end_outcomes(true);
}

// Takes what one molecule, or a part of one, has come to.
inline void note_outcome(OutcomeOf &of, bool good, std::int64_t iterations) {
    if (!good) of.status = bad_outcome;
    if (iterations > of.iterations) of.iterations = static_cast<std::int32_t>(iterations);
}

// Does one molecule, or a part of it: one(tally). Notes what has come of it, unless `of` is null. Sums go on as they do
// without.
template <class One>
void with_outcome(OutcomeOf *of, Tally &tally, const One &one) {
    if (!of) return one(tally);
    const std::int64_t n_bad = tally.n_bad, iterations = tally.iterations;
    tally.iterations = 0;
    one(tally);
    note_outcome(*of, tally.n_bad == n_bad, tally.iterations);
    tally.iterations = std::max<std::int64_t>(tally.iterations, iterations);
}

// Throws the error of a call that has bad molecules, error_of(tally). Before that each of them gets its status, that of
// error_of() for it alone; error_of() may throw the error, too.
template <class ErrorOf>
[[noreturn]] void throw_error(const Chains &chains, const Tally &tally, const ErrorOf &error_of) {
    OutcomeOf *const outcomes = outcomes_under_way();
    for (std::int64_t m = 0; outcomes && m < chains.n_chains(); ++m) {
        if (outcomes[m].status >= 0) continue;
        Tally alone = tally;
        alone.first_bad = m;
        alone.n_bad = 1;
        try {
            outcomes[m].status = static_cast<std::int32_t>(error_of(alone).status);
        } catch (const Error &error) {
            outcomes[m].status = static_cast<std::int32_t>(error.status);
        }
    }
    throw error_of(tally);
}

}  // namespace holonomic
