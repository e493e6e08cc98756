#include "velocities.hpp"

#include "diagnose.hpp"
#include "execute.hpp"
#include "forces.hpp"
#include "holonomic.h"

namespace holonomic {

void project_velocities(const Chains &chains, const AtomArray &r, const AtomArray &v, double *lambda, double *virial) {
    const VelocitiesCall call{r, v, lambda, virial != nullptr, chains.box};
    const Tally tally = execute(chains, kernels().velocities, call);
    if (tally.n_bad > 0) {
        const NamedArray arrays[] = {{"position", &r}, {"velocity", &v}};
        throw diagnose(chains, tally, arrays, 2, HOL_ERR_NOT_FINITE);
    }
    if (virial) write_virial(tally, virial);
}

}  // namespace holonomic
