#include "core/forces.hpp"

#include "boundary.hpp"
#include "mode.hpp"
#include "view.hpp"

using holonomic::adds;
using holonomic::AtomArray;
using holonomic::ForcesCall;
using holonomic::guarded;
using holonomic::need;
using holonomic::need_apart;
using holonomic::packed_array;
using holonomic::refuse_same;
using holonomic::viewed_array;

namespace {

// Constraint forces may stand where forces stood, and nowhere else.
inline void run(const hol_chains *chains, ForcesCall &call, double *virial) {
    need_apart(*chains, call.v, "v", call.r, "r");
    need_apart(*chains, call.g, "g", call.r, "r");
    need_apart(*chains, call.g, "g", call.v, "v");
    if (call.lambda && call.lambda == call.tension && chains->n_bonds() > 0) refuse_same("tension", "lambda");
    holonomic::forces(chains->chains, call, virial);
}

}  // namespace

int hol_forces(const hol_chains *chains, const double *r, const double *v, const double *f, double *lambda,
               double *tension, double *g, hol_mode mode, double *virial) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(chains->n_atoms(), r, "r");
        ForcesCall call;
        call.r = packed_array(r);
        call.v = packed_array(v);
        call.f = packed_array(f);
        call.g = packed_array(g);
        call.lambda = lambda;
        call.tension = tension;
        call.add = adds(mode);
        run(chains, call, virial);
    });
}

int hol_forces_view(const hol_chains *chains, const hol_const_view *r, const hol_const_view *v, const hol_const_view *f,
                    double *lambda, double *tension, const hol_view *g, hol_mode mode, double *virial) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(chains->n_atoms(), r, "r");
        ForcesCall call;
        call.r = viewed_array(chains->n_atoms(), r, "r");
        call.v = viewed_array(chains->n_atoms(), v, "v");
        call.f = viewed_array(chains->n_atoms(), f, "f");
        call.g = viewed_array(chains->n_atoms(), g, "g");
        const AtomArray *const all[] = {&call.r, &call.v, &call.f, &call.g};
        holonomic::check_dimensions(all, 4);
        call.lambda = lambda;
        call.tension = tension;
        call.add = adds(mode);
        run(chains, call, virial);
    });
}
