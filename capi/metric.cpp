#include "core/metric.hpp"

#include "boundary.hpp"
#include "mode.hpp"
#include "view.hpp"

using holonomic::array_of;
using holonomic::guarded;
using holonomic::need;

namespace {

// Of packed doubles, or of views.
template <class In, class Out>
void run(const hol_chains *chains, const In *r, double kT, double *log_det, double *log_det_z, double *energy,
         Out *force, hol_mode mode) {
    need(chains->n_atoms(), r, "r");
    holonomic::MetricCall call;
    call.r = array_of(chains->n_atoms(), r, "r");
    call.force = array_of(chains->n_atoms(), force, "force");
    holonomic::check_dimensions_of<In>({&call.r, &call.force});
    holonomic::need_apart(*chains, call.force, "force", call.r, "r");
    call.kT = kT;
    call.log_det = log_det;
    call.log_det_z = log_det_z;
    call.add = holonomic::adds(mode);
    holonomic::metric(chains->chains, call, energy);
}

}  // namespace

int hol_metric(const hol_chains *chains, const double *r, double kT, double *log_det, double *log_det_z, double *energy,
               double *force, hol_mode mode) {
    return guarded(__func__, chains, [&] { run(chains, r, kT, log_det, log_det_z, energy, force, mode); });
}

int hol_metric_view(const hol_chains *chains, const hol_const_view *r, double kT, double *log_det, double *log_det_z,
                    double *energy, const hol_view *force, hol_mode mode) {
    return guarded(__func__, chains, [&] { run(chains, r, kT, log_det, log_det_z, energy, force, mode); });
}
