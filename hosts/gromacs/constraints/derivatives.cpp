// Velocities, and displacements and accelerations alike: d . (q_j - q_i) = 0, with the change of least kinetic energy.
#include "rank.hpp"

namespace holonomic {

void Rank::derivatives(const Call &call, real *projected, gmx::ConstraintVariable what) {
    hol_chains *const chains = molecules.chains();
    if (chains == nullptr) return;
    if (what == gmx::ConstraintVariable::Force)
        gmx_fatal(0, __FILE__, __LINE__, "Constraints by holonomic: forces are not projected here; GROMACS asks for it nowhere");
    const bool flexible_alone = what == gmx::ConstraintVariable::Deriv_FlexCon;
    double *const lambda = multipliers_if(flexible_alone || (call.dvdlambda && molecules.perturbed()));
    const hol_view x = view(call.x);
    int status;
    if (projected == call.q) {
        const hol_view q = view(call.q);
        status = hol_project_velocities_view(chains, &x, &q, lambda, call.virial);
    } else {  // what is projected stays, and the change is added elsewhere
        const size_t n = 3 * static_cast<size_t>(molecules.n_atoms());
        scratch.assign(call.q, call.q + n);
        const hol_view change = view(scratch.data());
        status = hol_project_velocities_view(chains, &x, &change, lambda, call.virial);
        for (size_t i = 0; i < n; i++) scratch[i] -= call.q[i];
        if (status == HOL_OK && flexible_alone) {
            for (size_t k = 0; k < molecules.n_bonds(); k++)
                if (!molecules.flexible(k)) lambda[k] = 0;
            scratch.assign(n, 0);
            status = hol_reactions_view(chains, &x, HOL_BOX, lambda, nullptr, &change, HOL_WRITE, nullptr, call.virial);
            for (size_t i = 0; i < n; i++) scratch[i] *= molecules.inverse_mass(static_cast<int>(i / 3));
        }
        for (size_t i = 0; status == HOL_OK && i < n; i++) projected[i] += static_cast<real>(scratch[i]);
    }
    if (status != HOL_OK) end_run("");
    if (call.dvdlambda && molecules.perturbed()) *call.dvdlambda += derivative_by_lambda();
}

}  // namespace holonomic
