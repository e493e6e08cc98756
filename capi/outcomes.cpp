#include "core/run/outcomes.hpp"

#include "boundary.hpp"

using holonomic::guarded;
using holonomic::make_error;
using holonomic::need;
using holonomic::OutcomeOf;
using holonomic::Status;

int hol_chains_set_outcomes(hol_chains *chains, int keep) {
    return guarded(__func__, chains, [&] {
        if (keep != 0 && keep != 1) throw make_error(Status::value, "keep is %d; it must be 0 or 1", keep);
        chains->chains.keeps_outcomes = keep == 1;
    });
}

int hol_outcomes(const hol_chains *chains, int *status, int *iterations) {
    return guarded(__func__, chains, [&] {
        const OutcomeOf *const outcomes = holonomic::last_outcomes(chains->chains);
        if (!outcomes)
            throw make_error(Status::state,
                             "nothing is known of the last call: outcomes were not kept (hol_chains_set_outcomes), or "
                             "it was another handle's, another thread's, or ended before it came to the molecules");
        for (std::int64_t m = 0; m < chains->chains.n_molecules(); ++m) {
            if (status) status[m] = outcomes[m].status;
            if (iterations) iterations[m] = outcomes[m].iterations;
        }
    });
}
