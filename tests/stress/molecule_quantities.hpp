/**
 * @file molecule_quantities.hpp
 * What is compared for molecules of any shape, with the bounds of tests/oracle/molecules/README.md.
 */
#ifndef STRESS_MOLECULE_QUANTITIES_HPP
#define STRESS_MOLECULE_QUANTITIES_HPP

#include "verdict.hpp"

namespace stress
{

enum molecule_quantity {
    M_LAMBDA,           ///< multipliers of hol_forces
    M_FORCE,            ///< constraint forces
    M_VIRIAL,           ///< of hol_forces
    M_SOLVE,            ///< multipliers of hol_solve
    M_KEPT,             ///< multipliers of hol_factors_forces
    M_KEPT_FORCE,       ///< constraint forces of it
    M_KEPT_SOLVE,       ///< multipliers of hol_factors_solve
    M_MU,               ///< multipliers of hol_project_velocities
    M_VELOCITY,         ///< the velocities themselves
    M_LOG_DET,          ///< ln det Z~
    M_LOG_DET_Z,        ///< ln det Z
    M_FIXMAN,           ///< Fixman force
    M_INVERSE,          ///< elements of Z~^-1, to K eps sqrt of the product of the diagonal elements
    M_POSITION,         ///< corrected positions
    M_POSITION_LAMBDA,  ///< their multipliers
    M_CHAIN_LAMBDA,     ///< those of linear parts, which fixed atoms cut off and chains' kernels solve; for information
    M_OTHER,            ///< another solution than the reference's: how much farther it is, over most_farther
    M_LENGTH,           ///< bond lengths that are left
    M_REFUSED_STEP,     ///< no convergence where the reference converges; for information
    M_REFUSED,          ///< an error for a molecule that has an answer
    M_ACCEPTED,         ///< no error for one that has none
    M_OUTPUTS,          ///< outputs of a failing molecule written to, or one not finite without an error
    M_SAME_BITS,        ///< alone, among others, bonds in another order and direction, in another layout, on threads
    M_UNITS,            ///< in units that are other powers of two, and mirrored: the same bits
    M_QUANTITIES
};

template <>
struct quantities<molecule_quantity> {
    static constexpr std::size_t count = M_QUANTITIES;
    static const char *name(molecule_quantity q)
    {
        static const char *const names[M_QUANTITIES] = {
            "lambda",       "G",         "virial",     "lambda (solve)", "kept lambda", "kept G",
            "kept solve",   "mu",        "velocities", "ln det",         "ln det Z",    "Fixman",
            "inverse",      "positions", "lambda (r)", "of chains",      "other one",   "bonds left",
            "refused step", "refused",   "accepted",   "outputs",        "same bits",   "units, mirror"};
        return names[q];
    }
    static bool for_information(molecule_quantity q)
    {
        return q == M_REFUSED_STEP || q == M_CHAIN_LAMBDA;
    }
};
using molecule_verdict = verdict_of<molecule_quantity>;

}  // namespace stress

#endif
