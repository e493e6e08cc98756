// Position level: Newton's method back onto the constraints.
#ifndef HOLONOMIC_POSITIONS_HPP
#define HOLONOMIC_POSITIONS_HPP

#include "core/molecules/chains.hpp"

struct hol_report;

namespace holonomic {

// virial [9], report: or nullptr. Throws Error once everything that is due has been written.
void project_positions(const Chains &chains, const AtomArray &r_ref, const AtomArray &r, const AtomArray &v, double dt,
                       double *lambda, bool guess, double *virial, hol_report *report);

}  // namespace holonomic
#endif
