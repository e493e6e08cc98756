#include "core/velocities.hpp"

#include "boundary.hpp"
#include "view.hpp"

using holonomic::AtomArray;
using holonomic::guarded;
using holonomic::need;

int hol_project_velocities(const hol_chains *chains, const double *r, double *v, double *lambda, double *virial) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(r, "r");
        need(v, "v");
        holonomic::project_velocities(chains->chains, holonomic::packed_array(r), holonomic::packed_array(v), lambda,
                                      virial);
    });
}

int hol_project_velocities_view(const hol_chains *chains, const hol_view *r, const hol_view *v, double *lambda,
                                double *virial) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(r, "r");
        need(v, "v");
        const AtomArray ar = holonomic::viewed_array(r, "r"), av = holonomic::viewed_array(v, "v");
        const AtomArray *const all[] = {&ar, &av};
        holonomic::check_dimensions(all, 2);
        holonomic::project_velocities(chains->chains, ar, av, lambda, virial);
    });
}
