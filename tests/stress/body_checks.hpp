/**
 * @file body_checks.hpp
 * Compares what the library says about molecules with rigid bodies with the reference solution. docs/stability.md has
 * the bounds: 16 + sqrt(number of constraints), those between the points of a body included, eps of each scale.
 */
#ifndef STRESS_BODY_CHECKS_HPP
#define STRESS_BODY_CHECKS_HPP

#include <vector>

#include "hostile_body.hpp"
#include "molecule_checks.hpp"

namespace stress
{

/** As place() of hostile molecules; the bodies of one keep their order and their atoms. */
placement place(const std::vector<const hostile_body *> &parts, std::uint64_t shuffle);

/** Everything about one molecule on its own. */
molecule_verdict check_alone(const hostile_body &m, const reference::rigid_solution &exact, molecule_facts &facts);

/** To the bit, as for hostile molecules: alone, among others, in another layout, on threads; other units, mirrored. */
void check_invariances(const std::vector<hostile_body> &molecules, std::uint64_t shuffle,
                       std::vector<molecule_verdict> &out);

}  // namespace stress

#endif
