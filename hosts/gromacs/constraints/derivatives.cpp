// Velocities, and displacements and accelerations alike: d . (q_j - q_i) = 0, with the change of least kinetic energy.
#include "copies.hpp"
#include "rank.hpp"

namespace holonomic {

void Rank::derivatives(const Call &call, real *projected, gmx::ConstraintVariable what) {
    hol_chains *const chains = molecules.chains();
    if (chains == nullptr) return;
    if (what == gmx::ConstraintVariable::Force)
        gmx_fatal(0, __FILE__, __LINE__,
                  "Constraints by holonomic: forces are not projected here; GROMACS asks for it nowhere");
    const bool flexible_alone = what == gmx::ConstraintVariable::Deriv_FlexCon;
    const Arrangement &places = molecules.places();
    const int n_threads = molecules.n_threads();
    x.resize(3 * molecules.n_atoms());
    q.resize(x.size());
    copy_whole(places, call.pbc, call.x, x.data(), n_threads);
    copy(places, call.q, q.data(), n_threads);
    const bool by_shares = call.virial && molecules.cut();
    double *const lambda = multipliers_if(flexible_alone || by_shares || (call.dvdlambda && molecules.perturbed()));
    double *const virial = by_shares ? nullptr : call.virial;
    const auto project = [&] { return hol_project_velocities(chains, x.data(), q.data(), lambda, virial); };
    int status = project();
    if (status == HOL_OK && flexible_alone) {
        for (size_t k = 0; k < molecules.n_bonds(); k++)
            if (!molecules.flexible(k)) lambda[k] = 0;
        std::vector<double> force(x.size());
        status = hol_reactions(chains, x.data(), HOL_BOX, lambda, nullptr, force.data(), HOL_WRITE, nullptr, virial);
        copy(places, call.q, q.data(), n_threads);
        for (size_t i = 0; i < q.size(); i++) q[i] += molecules.inverse_mass(i / 3) * force[i];
    }
    if (status != HOL_OK) {
        molecules.message(project);
        molecules.end_run();
    }
    if (by_shares) add_own_virial(call.virial);
    hand_back(places, q.data(), call.q, projected, n_threads);
    if (call.dvdlambda && molecules.perturbed()) *call.dvdlambda += derivative_by_lambda();
}

}  // namespace holonomic
