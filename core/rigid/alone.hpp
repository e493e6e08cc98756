// A body without bonds, as most are: the same equations in plain doubles, for bodies that are not thin.
//
// With U the 3 x R matrix of the vectors u_p, S = U^T U, which is all but diagonal, and a symmetric Lambda:
//
//     forces       U'' = W/M - U Lambda,       S Lambda + Lambda S = U^T W/M + (..)^T + 2 U'^T U'
//     velocities   U'  = U'_in - U Lambda,     S Lambda + Lambda S = U^T U'_in + (..)^T
//     positions    U   = U_in - U_ref Lambda,  U^T U = L^2
//
// Where anything does not come out, nothing has been written, and the general solver (system.hpp) has its turn.
#ifndef HOLONOMIC_RIGID_ALONE_HPP
#define HOLONOMIC_RIGID_ALONE_HPP

#include "core/rigid/system.hpp"

namespace holonomic::rigid {

struct Lone {
    const Shape &shape;
    const Body &body;
    double *x;  // [n_atoms][3] memory
    const std::int64_t *atoms;
};

// Each returns whether it has done its work; virial: six sums, or null.
bool forces_alone(const Lone &lone, const AtomArray &r, const Box &box, const AtomArray &v, const AtomArray &f,
                  const AtomArray &g, bool add, double *virial);
bool velocities_alone(const Lone &lone, const AtomArray &r, const Box &box, const AtomArray &v, double *virial);
bool positions_alone(const Lone &lone, const AtomArray &r_ref, const Box &box_ref, const AtomArray &r, const Box &box,
                     const AtomArray &v, double dt, double *virial, int *iterations, double *error);

inline Lone System::lone(const Place &place) const { return {s_, bodies_[s_.parts[0].body], raw, place.atoms}; }

}  // namespace holonomic::rigid
#endif
