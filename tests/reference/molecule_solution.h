/**
 * @file molecule_solution.h
 * Independent solutions for molecules of any shape: the matrix from the gradients of the constraints, elimination in
 * 448 bits, and in 1280 where pivots are so small that 448 might not do.
 */
#ifndef REFERENCE_MOLECULE_SOLUTION_H
#define REFERENCE_MOLECULE_SOLUTION_H

#include "molecule_problem.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Z lambda = K + C. Returns 0, or -1 if Z is singular (a pivot of Z~ below 1e-200) or there is no memory. */
int molecule_forces(const molecule_problem *p, molecule_solution *out);

/** Z lambda = 2 d.dv; g is the impulse m dv and `moved` the projected velocities. v must be given. */
int molecule_velocities(const molecule_problem *p, molecule_solution *out);

/** Z lambda = rhs. The scale of lambda is |Z^-1| (|rhs| + |Z| |lambda|), products w d_k.d_l of Z one by one. */
int molecule_solve(const molecule_problem *p, const double *rhs, molecule_solution *out);

/**
 * Position level, from the reference positions p->r in p->box to lengths [n_bonds].
 * @param[in] drifted  [n_atoms][3], in drifted_box (NULL: none)
 * `moved` are the constrained positions. Returns 0, or -1: no convergence.
 */
int molecule_positions(const molecule_problem *p, const double *drifted, const double *drifted_box,
                       const double *length, double dt, molecule_solution *out);

/** The same, but the solution that Newton's method comes to from these multipliers [n_bonds]: there may be several. */
int molecule_positions_near(const molecule_problem *p, const double *drifted, const double *drifted_box,
                            const double *length, double dt, const double *lambda, molecule_solution *out);

void molecule_solution_free(molecule_solution *s);

/** Determinants, Fixman force and the whole inverse. Returns 0, or -1 if Z is singular; least_pivot is then set all the
 * same. */
int molecule_metric_make(const molecule_problem *p, molecule_metric *out);

void molecule_metric_free(molecule_metric *m);

#ifdef __cplusplus
}
#endif
#endif
