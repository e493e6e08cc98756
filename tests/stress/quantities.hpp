/**
 * @file quantities.hpp
 * What is compared for chains.
 */
#ifndef STRESS_QUANTITIES_HPP
#define STRESS_QUANTITIES_HPP

#include <cfloat>

#include "verdict.hpp"

namespace stress
{

enum quantity {
    LAMBDA,       ///< multipliers of hol_forces
    LAMBDA_NEAR,  ///< the same against K eps of its scale alone; for information
    FORCE,        ///< constraint forces
    VIRIAL,       ///< of hol_forces
    LOG_DET,      ///< ln det Z~
    FIXMAN_FORCE,
    INVERSE,                ///< elements of Z~^-1
    CONDITION,              ///< condition number of Z~
    ERROR_BOUND,            ///< the true error of lambda over what hol_inverse_error_bound guarantees
    VELOCITY_LAMBDA,        ///< multipliers of hol_project_velocities
    VELOCITY,               ///< the velocities themselves
    VELOCITY_RESIDUAL,      ///< d . dv that is left
    POSITION_LENGTH,        ///< bond lengths after hol_project_positions
    POSITION_LENGTH_LOCAL,  ///< each against its own coordinates' rounding; for information
    POSITION_SHIFT,         ///< that the shift is what the multipliers say, along the old bonds
    REFUSED_STEP,           ///< no convergence where the reference converges; for information
    REFUSED,                ///< an error for a chain that has an answer
    ACCEPTED,               ///< no error for a chain that has none
    OUTPUTS_KEPT,           ///< outputs of a failing chain written to, or one not finite without an error
    SAME_BITS,              ///< alone, among others, in another layout and on several threads
    UNDECIDED,              ///< the reference's arithmetic is not enough for this chain; for information
    N_QUANTITIES
};

template <>
struct quantities<quantity> {
    static constexpr std::size_t count = N_QUANTITIES;
    static const char *name(quantity q)
    {
        static const char *const names[N_QUANTITIES] = {
            "lambda",    "lambda, K",    "G",          "virial",     "ln det",       "Fixman force", "inverse",
            "condition", "error bound",  "lambda (v)", "velocities", "d.dv left",    "bond lengths", "bond by bond",
            "shift (r)", "refused step", "refused",    "accepted",   "outputs kept", "same bits",    "undecided"};
        return names[q];
    }
    static bool for_information(quantity q)
    {
        return q == LAMBDA_NEAR || q == POSITION_LENGTH_LOCAL || q == REFUSED_STEP || q == UNDECIDED;
    }
};
using verdict = verdict_of<quantity>;

}  // namespace stress

#endif
