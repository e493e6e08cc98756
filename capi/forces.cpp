#include "core/forces.hpp"

#include "boundary.hpp"
#include "mode.hpp"
#include "view.hpp"

using holonomic::array_of;
using holonomic::guarded;
using holonomic::need;
using holonomic::need_apart;

namespace {

// Of packed doubles, or of views. Constraint forces may stand where forces stood, and nowhere else.
template <class In, class Out>
__attribute__((always_inline)) inline void run(const hol_chains *chains, const In *r, const In *v, const In *f,
                                               double *lambda, double *tension, Out *g, hol_mode mode, double *virial) {
    need(chains->n_atoms(), r, "r");
    holonomic::ForcesCall call;
    call.r = array_of(chains->n_atoms(), r, "r");
    call.v = array_of(chains->n_atoms(), v, "v");
    call.f = array_of(chains->n_atoms(), f, "f");
    call.g = array_of(chains->n_atoms(), g, "g");
    holonomic::check_dimensions_of<In>({&call.r, &call.v, &call.f, &call.g});
    call.lambda = lambda;
    call.tension = tension;
    call.add = holonomic::adds(mode);
    need_apart(*chains, call.v, "v", call.r, "r");
    need_apart(*chains, call.g, "g", call.r, "r");
    need_apart(*chains, call.g, "g", call.v, "v");
    if (lambda && lambda == tension && chains->n_bonds() > 0) holonomic::refuse_same("tension", "lambda");
    holonomic::forces(chains->chains, call, virial);
}

}  // namespace

int hol_forces(const hol_chains *chains, const double *r, const double *v, const double *f, double *lambda,
               double *tension, double *g, hol_mode mode, double *virial) {
    return guarded(__func__, chains, [&] { run(chains, r, v, f, lambda, tension, g, mode, virial); });
}

int hol_forces_view(const hol_chains *chains, const hol_const_view *r, const hol_const_view *v, const hol_const_view *f,
                    double *lambda, double *tension, const hol_view *g, hol_mode mode, double *virial) {
    return guarded(__func__, chains, [&] { run(chains, r, v, f, lambda, tension, g, mode, virial); });
}
