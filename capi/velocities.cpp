#include "core/velocities.hpp"

#include "boundary.hpp"
#include "view.hpp"

using holonomic::AtomArray;
using holonomic::guarded;
using holonomic::need;
using holonomic::VelocitiesCall;

int hol_project_velocities(const hol_chains *chains, const double *r, double *v, double *lambda, double *virial) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(chains->n_atoms(), r, "r");
        need(chains->n_atoms(), v, "v");
        VelocitiesCall call;
        call.r = holonomic::packed_array(r);
        call.v = holonomic::packed_array(v);
        holonomic::need_apart(*chains, call.v, "v", call.r, "r");
        call.lambda = lambda;
        holonomic::project_velocities(chains->chains, call, virial);
    });
}

int hol_project_velocities_view(const hol_chains *chains, const hol_const_view *r, const hol_view *v, double *lambda,
                                double *virial) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(chains->n_atoms(), r, "r");
        need(chains->n_atoms(), v, "v");
        VelocitiesCall call;
        call.r = holonomic::viewed_array(chains->n_atoms(), r, "r");
        call.v = holonomic::viewed_array(chains->n_atoms(), v, "v");
        const AtomArray *const all[] = {&call.r, &call.v};
        holonomic::check_dimensions(all, 2);
        holonomic::need_apart(*chains, call.v, "v", call.r, "r");
        call.lambda = lambda;
        holonomic::project_velocities(chains->chains, call, virial);
    });
}
