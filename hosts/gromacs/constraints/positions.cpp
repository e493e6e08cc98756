// Positions: lengths at the end of a step, along the bonds at its beginning.
#include <algorithm>
#include <climits>
#include <cmath>

#include "rank.hpp"

namespace holonomic {

double *Rank::multipliers_if(bool wanted) {
    if (!wanted) return nullptr;
    multipliers.resize(molecules.n_bonds());
    return multipliers.data();
}

// dH/dlambda of the lengths: with sigma = d.d - a^2, a bond pulls with the tension 2 lambda a, against which a grows.
double Rank::derivative_by_lambda() const {
    double total = 0;
    for (size_t k = 0; k < molecules.n_bonds(); k++)
        total -= 2 * multipliers[k] * molecules.length(k) * molecules.change_with_lambda(k);
    return total;
}

// Coordinates of a builder, or of a model with other lengths: along their own bonds a third of a length can be mended.
int Rank::move_crude_start(const Call &call) {
    const hol_view q = view(call.q);
    const std::string why = hol_error_message();
    const int status = hol_impose_view(molecules.chains(), &q, nullptr);
    if (status == HOL_OK)
        fprintf(stderr, "\nConstraints by holonomic: %s\nMolecules were moved onto their lengths.\n", why.c_str());
    return status;
}

bool Rank::positions(const Call &call, bool wants_rmsd) {
    int status = HOL_OK;
    if (hol_chains *const chains = molecules.chains()) {
        const hol_view x = view(call.x), q = view(call.q), v = view(call.v);
        molecules.set_flexible(x);
        double *const lambda = multipliers_if(call.dvdlambda && molecules.perturbed());
        status = hol_project_positions_view(chains, &x, &q, call.v ? &v : nullptr, call.dt, lambda, 0, call.virial,
                                            nullptr);
        if (status == HOL_ERR_LENGTHS && call.x == call.q) status = move_crude_start(call);
        const double dt2 = call.dt * call.dt;
        for (int i = 0; call.virial && i < 9; i++) call.virial[i] *= dt2;
        if (lambda && status == HOL_OK) *call.dvdlambda += dt2 * derivative_by_lambda();
        if (call.max_warnings < INT_MAX && (status != HOL_OK || any_turned(molecules, call)))
            warn(molecules, call, status);
    }
    if (wants_rmsd) measure(call);
    return status == HOL_OK;
}

void Rank::measure(const Call &call) {
    const Deviation left = deviation(molecules, call.q);
    const auto n_bonds = static_cast<double>(molecules.n_bonds());
    if (!ask_for_sum) {
        rmsd = n_bonds > 0 ? std::sqrt(left.sum_of_squares / n_bonds) : 0;
        return;
    }
    sum[0] = n_bonds;
    sum[1] = left.sum_of_squares;
    ask_for_sum(gmx::ReductionRequirement::Soon);
}

}  // namespace holonomic
