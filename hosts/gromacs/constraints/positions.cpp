// Positions: lengths at the end of a step, along the bonds at its beginning.
#include <climits>
#include <cmath>

#include "copies.hpp"
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
        total -= 2 * molecules.share(k) * multipliers[k] * molecules.length(k) * molecules.change_with_lambda(k);
    return total;
}

// - 2 lambda b (x) b, of each bond the rank's share.
void Rank::add_own_virial(double *virial) const {
    for (size_t k = 0; k < molecules.n_bonds(); k++) {
        const Bond &bond = molecules.places().bonds[k];
        const double *const i = x.data() + 3 * static_cast<ptrdiff_t>(bond.first);
        const double *const j = x.data() + 3 * static_cast<ptrdiff_t>(bond.second);
        for (int n = 0; n < 9; n++)
            virial[n] -= 2 * molecules.share(k) * multipliers[k] * (j[n / 3] - i[n / 3]) * (j[n % 3] - i[n % 3]);
    }
}

// Coordinates of a builder, or of a model with other lengths: along their own bonds a third of a length can be mended.
int Rank::move_crude_start() {
    const std::string why = hol_error_message();
    const int status = hol_impose(molecules.chains(), q.data(), nullptr);
    for (size_t i = 0; i < q.size(); i++) change[i] = q[i] - x[i];
    if (status == HOL_OK)
        fprintf(stderr, "\nConstraints by holonomic: %s\nMolecules were moved onto their lengths.\n", why.c_str());
    return status;
}

bool Rank::positions(const Call &call, bool wants_rmsd) {
    int status = HOL_OK;
    if (hol_chains *const chains = molecules.chains()) {
        const Arrangement &places = molecules.places();
        const int n_threads = molecules.n_threads();
        x.resize(3 * molecules.n_atoms());
        q.resize(x.size());
        change.resize(x.size());
        const double near = no_turn(molecules, call);
        bool may_turn = !copy_both_whole(places, call.pbc, call.x, call.q, x.data(), q.data(), near / 2, n_threads);
        molecules.set_flexible(x.data());
        const bool by_shares = call.virial && molecules.cut();
        double *const lambda = multipliers_if(by_shares || (call.dvdlambda && molecules.perturbed()));
        // In a step of length 1 the change of velocities is that of positions.
        const auto project = [&](double *sum_of_virials) {
            return hol_project_positions(chains, x.data(), q.data(), change.data(), 1, lambda, 0, sum_of_virials,
                                         nullptr);
        };
        status = project(by_shares ? nullptr : call.virial);
        if (status == HOL_ERR_LENGTHS && call.x == call.q) status = move_crude_start();
        if (by_shares && status == HOL_OK) add_own_virial(call.virial);
        if (call.dvdlambda && molecules.perturbed() && status == HOL_OK) *call.dvdlambda += derivative_by_lambda();
        may_turn |= !move(places, change.data(), call.inverse_dt, call.q, call.v, near / 8, n_threads);
        const auto turned = [&] { return may_turn && any_turned(molecules, call, x.data(), q.data()); };
        if (call.max_warnings < INT_MAX && (status != HOL_OK || turned())) {
            std::string words;
            int64_t n_unsolved = 0;
            if (status != HOL_OK) {
                hol_error_location(nullptr, nullptr, nullptr, &n_unsolved);
                words = molecules.message([&] { project(nullptr); });
            }
            warn(molecules, call, words, n_unsolved, x.data(), q.data());
        }
    }
    if (wants_rmsd) measure(call);
    return status == HOL_OK;
}

void Rank::measure(const Call &call) {
    const Deviation left = deviation(molecules, call.pbc, call.q);
    const double n_bonds = left.n_bonds;
    if (!ask_for_sum) {
        rmsd = n_bonds > 0 ? std::sqrt(left.sum_of_squares / n_bonds) : 0;
        return;
    }
    sum[0] = n_bonds;
    sum[1] = left.sum_of_squares;
    ask_for_sum(gmx::ReductionRequirement::Soon);
}

}  // namespace holonomic
