/**
 * @file quantities.hpp
 * What is compared, and by how much it was off: each error over its bound, so that more than 1 is an exceedance.
 */
#ifndef STRESS_QUANTITIES_HPP
#define STRESS_QUANTITIES_HPP

#include <array>
#include <cfloat>
#include <cmath>

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

inline const char *quantity_name(int q)
{
    static const char *const names[N_QUANTITIES] = {
        "lambda",    "lambda, K",    "G",          "virial",     "ln det",       "Fixman force", "inverse",
        "condition", "error bound",  "lambda (v)", "velocities", "d.dv left",    "bond lengths", "bond by bond",
        "shift (r)", "refused step", "refused",    "accepted",   "outputs kept", "same bits",    "undecided"};
    return names[q];
}

/** The largest error over bound of each quantity; negative where it was not checked. */
struct verdict {
    std::array<long double, N_QUANTITIES> ratio;
    verdict()
    {
        ratio.fill(-1);
    }

    void note(quantity q, long double value)
    {
        if (!(value <= ratio[q])) ratio[q] = std::isnan(value) ? HUGE_VALL : value;
    }
    void note(quantity q, bool wrong)
    {
        note(q, wrong ? HUGE_VALL : 0.0L);
    }

    /** A number against its reference; allowed is the largest error that is right, 0: the number must be met exactly.
     */
    void compare(quantity q, double value, long double reference, long double allowed)
    {
        const long double error = std::fabs(value - reference);
        note(q, error == 0 ? 0 : error / allowed);
    }

    bool exceeded() const;
};

/** Quantities that are counted but promised nowhere. */
inline bool for_information(int q)
{
    return q == LAMBDA_NEAR || q == POSITION_LENGTH_LOCAL || q == REFUSED_STEP || q == UNDECIDED;
}

inline bool verdict::exceeded() const
{
    for (int q = 0; q < N_QUANTITIES; ++q)
        if (!for_information(q) && ratio[static_cast<std::size_t>(q)] > 1) return true;
    return false;
}

}  // namespace stress

#endif
