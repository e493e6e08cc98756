#include "core/metric.hpp"

#include "boundary.hpp"
#include "mode.hpp"
#include "view.hpp"

using holonomic::adds;
using holonomic::AtomArray;
using holonomic::guarded;
using holonomic::need;
using holonomic::packed_array;
using holonomic::viewed_array;

int hol_metric(const hol_chains *chains, const double *r, double kT, double *log_det, double *log_det_z, double *energy,
               double *force, int mode) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(r, "r");
        holonomic::metric(chains->chains, packed_array(r), kT, log_det, log_det_z, energy, packed_array(force),
                          adds(mode));
    });
}

int hol_metric_view(const hol_chains *chains, const hol_view *r, double kT, double *log_det, double *log_det_z,
                    double *energy, const hol_view *force, int mode) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(r, "r");
        const AtomArray ar = viewed_array(r, "r"), af = viewed_array(force, "force");
        const AtomArray *const all[] = {&ar, &af};
        holonomic::check_dimensions(all, 2);
        holonomic::metric(chains->chains, ar, kT, log_det, log_det_z, energy, af, adds(mode));
    });
}
