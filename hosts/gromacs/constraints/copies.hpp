// Copies of the atoms' vectors at the places of an Arrangement, in double precision.
#pragma once
#include "arrangement.hpp"
#include "gromacs.hpp"

namespace holonomic {

// Positions, each molecule whole: an atom stands at the image nearest to its parent. `pbc` null: they are whole.
void copy_whole(const Arrangement &, const t_pbc *, const real *from, double *to, int n_threads);
// Positions before and after a step. True if no component of an atom's has changed by more than `near`, which is less
// than half of the box: then x says which image an atom is.
bool copy_both_whole(const Arrangement &, const t_pbc *, const real *x, const real *q, double *to_x, double *to_q,
                     double near, int n_threads);
void copy(const Arrangement &, const real *from, double *to, int n_threads);

// q += d and, if there are velocities, v += d / dt; then d = 0, while it is in a cache. True if no d is longer than
// `near`.
bool move(const Arrangement &, double *d, double inverse_dt, real *q, real *v, double near, int n_threads);
// projected = p, or where it is other than q, projected += p - q.
void hand_back(const Arrangement &, const double *p, const real *q, real *projected, int n_threads);

}  // namespace holonomic
