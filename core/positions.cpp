#include "positions.hpp"

#include "diagnose.hpp"
#include "execute.hpp"
#include "forces.hpp"
#include "holonomic.h"

namespace holonomic {

void project_positions(const Chains &chains, const AtomArray &r_ref, const AtomArray &r, const AtomArray &v, double dt,
                       double *lambda, bool guess, double *virial, hol_report *report) {
    const PositionsCall call{r_ref, r,     v, lambda, dt, guess, virial != nullptr, chains.tolerance,
                             chains.max_iterations, chains.box};
    const Tally tally = execute(chains, kernels().positions, call);
    if (report) {
        report->iterations = tally.iterations;
        report->n_corrected = tally.n_corrected;
        report->n_failed = tally.n_bad;
        report->chain = tally.worst_chain < 0 ? -1 : tally.worst_chain + chains.base;
        report->bond = tally.worst_chain < 0 ? -1 : tally.worst_bond + chains.base;
        report->max_error = tally.worst;
    }
    if (tally.n_bad > 0) {
        const NamedArray arrays[] = {{"reference position", &r_ref}, {"position", &r}, {"velocity", &v}};
        throw diagnose(chains, tally, arrays, 3, HOL_ERR_NO_CONVERGENCE);
    }
    if (virial) write_virial(tally, virial);
}

}  // namespace holonomic
