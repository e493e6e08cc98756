/**
 * @file molecule_quantities.hpp
 * What is compared for molecules of any shape, each error over its bound (tests/oracle/molecules/README.md), so that
 * more than 1 is an exceedance.
 */
#ifndef STRESS_MOLECULE_QUANTITIES_HPP
#define STRESS_MOLECULE_QUANTITIES_HPP

#include <array>
#include <cmath>
#include <cstdio>
#include <string>

namespace stress
{

enum molecule_quantity {
    M_LAMBDA,           ///< multipliers of hol_forces
    M_FORCE,            ///< constraint forces
    M_VIRIAL,           ///< of hol_forces
    M_SOLVE,            ///< multipliers of hol_solve
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

inline const char *molecule_quantity_name(int q)
{
    static const char *const names[M_QUANTITIES] = {
        "lambda",    "G",         "virial",       "lambda (solve)", "mu",        "velocities",
        "ln det",    "ln det Z",  "Fixman",       "inverse",        "positions", "lambda (r)",
        "of chains", "other one", "bonds left",   "refused step",   "refused",   "accepted",
        "outputs",   "same bits", "units, mirror"};
    return names[q];
}

/** The largest error over bound of each quantity; negative where it was not checked. */
struct molecule_verdict {
    std::array<long double, M_QUANTITIES> ratio;
    molecule_verdict()
    {
        ratio.fill(-1);
    }

    void note(molecule_quantity q, long double value)
    {
        if (!(value <= ratio[q])) ratio[q] = std::isnan(value) ? HUGE_VALL : value;
    }
    void note(molecule_quantity q, bool wrong)
    {
        note(q, wrong ? HUGE_VALL : 0.0L);
    }
    /** allowed 0: the number must be met exactly. */
    void compare(molecule_quantity q, double value, long double reference, long double allowed)
    {
        const long double error = std::fabs(value - reference);
        note(q, error == 0 ? 0 : error / allowed);
    }
    void add(const molecule_verdict &other)
    {
        for (std::size_t q = 0; q < ratio.size(); ++q)
            if (other.ratio[q] > ratio[q]) ratio[q] = other.ratio[q];
    }
};

/** Quantities that are counted but promised nowhere. */
inline bool is_information(int q)
{
    return q == M_REFUSED_STEP || q == M_CHAIN_LAMBDA;
}

/** What exceeds its bound, for people. */
inline std::string exceeded_words(const molecule_verdict &v)
{
    std::string words;
    char text[64];
    for (int q = 0; q < M_QUANTITIES; ++q) {
        const long double x = v.ratio[static_cast<std::size_t>(q)];
        if (!(x > 1) || is_information(q)) continue;
        std::snprintf(text, sizeof text, " %s %.3Lg times its bound;", molecule_quantity_name(q), x);
        words += text;
    }
    return words;
}

}  // namespace stress

#endif
