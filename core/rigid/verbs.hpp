// The verbs for molecules with rigid bodies. Each throws Error once everything that is due has been written; sums are
// added to the caller's, which already hold those of the other molecules.
#pragma once

#include "core/check.hpp"
#include "core/molecules/chains.hpp"
#include "core/positions.hpp"
#include "core/reactions.hpp"
#include "core/violation.hpp"

namespace holonomic::rigid {

void forces(const Chains &chains, const AtomArray &r, const AtomArray &v, const AtomArray &f, double *lambda,
            double *tension, const AtomArray &g, bool add, double *virial);
void solve(const Chains &chains, const AtomArray &r, const double *rhs, double *lambda, const AtomArray &g, bool add,
           double *virial);
void project_velocities(const Chains &chains, const AtomArray &r, const AtomArray &v, double *lambda, double *virial);
void project_positions(const Chains &chains, const AtomArray &r_ref, const AtomArray &r, const AtomArray &v, double dt,
                       double *lambda, double *virial, Report *report);
// Crude positions, in the box, onto the constraints, without checks.
void impose(const Chains &chains, const AtomArray &r, Report *report);

void reactions(const Chains &chains, const AtomArray &r, const Cell &box, const double *lambda, const Reactions &out,
               double *virial);

// Throws Error of Status::unsupported if there are bodies; molecules whose images are told have a metric determinant.
void need_metric(const Chains &chains);
// Adds to the force on atoms, or writes it; gives the sum of ln det.
double metric(const Chains &chains, const MetricCall &call);

// Throws Error of Status::lengths if a reference does not fit, or a trial is stretched beyond reason.
void check_reference(const Chains &chains, const AtomArray &r, const Cell &box, const char *what);
// The largest |d.d - a^2| / a^2 of bonds and of the bodies' own distances, where it is larger than what is there.
void worst_length(const Chains &chains, const AtomArray &r, const Cell &box, WorstLength *worst);
// Of bonds alone.
void residuals(const Chains &chains, const AtomArray &r, const AtomArray &v, double *length, double *rate);
void violation(const Chains &chains, const AtomArray &r, const AtomArray &v, Worst *worst);

}  // namespace holonomic::rigid
