#include "core/metric.hpp"

#include "boundary.hpp"
#include "mode.hpp"
#include "view.hpp"

using holonomic::adds;
using holonomic::AtomArray;
using holonomic::guarded;
using holonomic::MetricCall;
using holonomic::need;
using holonomic::packed_array;
using holonomic::viewed_array;

int hol_metric(const hol_chains *chains, const double *r, double kT, double *log_det, double *log_det_z, double *energy,
               double *force, hol_mode mode) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(chains->n_atoms(), r, "r");
        MetricCall call;
        call.r = packed_array(r);
        call.force = packed_array(force);
        holonomic::need_apart(*chains, call.force, "force", call.r, "r");
        call.kT = kT;
        call.log_det = log_det;
        call.log_det_z = log_det_z;
        call.add = adds(mode);
        holonomic::metric(chains->chains, call, energy);
    });
}

int hol_metric_view(const hol_chains *chains, const hol_const_view *r, double kT, double *log_det, double *log_det_z,
                    double *energy, const hol_view *force, hol_mode mode) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(chains->n_atoms(), r, "r");
        MetricCall call;
        call.r = viewed_array(chains->n_atoms(), r, "r");
        call.force = viewed_array(chains->n_atoms(), force, "force");
        const AtomArray *const all[] = {&call.r, &call.force};
        holonomic::check_dimensions(all, 2);
        holonomic::need_apart(*chains, call.force, "force", call.r, "r");
        call.kT = kT;
        call.log_det = log_det;
        call.log_det_z = log_det_z;
        call.add = adds(mode);
        holonomic::metric(chains->chains, call, energy);
    });
}
