#include "core/forces.hpp"

#include "boundary.hpp"
#include "mode.hpp"
#include "view.hpp"

using holonomic::adds;
using holonomic::AtomArray;
using holonomic::guarded;
using holonomic::need;
using holonomic::packed_array;
using holonomic::viewed_array;

int hol_forces(const hol_chains *chains, const double *r, const double *v, const double *f, double *lambda,
               double *tension, double *g, int mode, double *virial) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(r, "r");
        holonomic::forces(chains->chains, packed_array(r), packed_array(v), packed_array(f), lambda, tension,
                          packed_array(g), adds(mode), virial);
    });
}

int hol_forces_view(const hol_chains *chains, const hol_view *r, const hol_view *v, const hol_view *f, double *lambda,
                    double *tension, const hol_view *g, int mode, double *virial) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(r, "r");
        const AtomArray ar = viewed_array(r, "r"), av = viewed_array(v, "v"), af = viewed_array(f, "f"),
                        ag = viewed_array(g, "g");
        const AtomArray *const all[] = {&ar, &av, &af, &ag};
        holonomic::check_dimensions(all, 4);
        holonomic::forces(chains->chains, ar, av, af, lambda, tension, ag, adds(mode), virial);
    });
}
