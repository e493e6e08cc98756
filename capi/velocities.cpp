#include "core/velocities.hpp"

#include "boundary.hpp"
#include "view.hpp"

using holonomic::array_of;
using holonomic::guarded;
using holonomic::need;

namespace {

// Of packed doubles, or of views.
template <class In, class Out>
__attribute__((always_inline)) inline void project(const hol_chains *chains, const In *r, Out *v, double *lambda,
                                                   double *virial) {
    need(chains->n_atoms(), r, "r");
    need(chains->n_atoms(), v, "v");
    holonomic::VelocitiesCall call;
    call.r = array_of(chains->n_atoms(), r, "r");
    call.v = array_of(chains->n_atoms(), v, "v");
    holonomic::check_dimensions_of<In>({&call.r, &call.v});
    holonomic::need_apart(*chains, call.v, "v", call.r, "r");
    call.lambda = lambda;
    holonomic::project_velocities(chains->chains, call, virial);
}

}  // namespace

int hol_project_velocities(const hol_chains *chains, const double *r, double *v, double *lambda, double *virial) {
    return guarded(__func__, chains, [&] { project(chains, r, v, lambda, virial); });
}

int hol_project_velocities_view(const hol_chains *chains, const hol_const_view *r, const hol_view *v, double *lambda,
                                double *virial) {
    return guarded(__func__, chains, [&] { project(chains, r, v, lambda, virial); });
}
