#include "core/positions.hpp"

#include <cmath>

#include "boundary.hpp"
#include "view.hpp"

using holonomic::AtomArray;
using holonomic::guarded;
using holonomic::make_error;
using holonomic::need;
using holonomic::packed_array;
using holonomic::PositionsCall;
using holonomic::Status;
using holonomic::viewed_array;

namespace {

inline void set(PositionsCall &call, double dt, double *lambda, int guess) {
    if (!(dt > 0) || !std::isfinite(dt) || !(dt * dt > 0x1p-1024))  // else 1 / dt^2 is not finite
        throw make_error(Status::value, "dt is %g; it must be positive and finite, and so must dt^2 and 1/dt^2", dt);
    if (guess != 0 && guess != 1) throw make_error(Status::value, "guess is %d; it must be 0 or 1", guess);
    if (guess) need(lambda, "lambda, which holds the guess,");
    call.dt = dt;
    call.lambda = lambda;
    call.guess = guess == 1;
}

// Of the last reference that this thread's calls have compared with the lengths.
thread_local holonomic::WorstLength reference_error{0, -1, -1};

// The caller's report: written once there is one, also if the call fails then.
class ReportTo {
public:
    explicit ReportTo(hol_report *to) : to_(to) {}
    ~ReportTo() {
        if (!to_ || !found_.made) return;
        *to_ = {found_.iterations, found_.n_corrected, found_.n_failed, found_.chain, found_.bond, found_.max_error};
    }
    ReportTo(const ReportTo &) = delete;
    ReportTo &operator=(const ReportTo &) = delete;
    holonomic::Report *get() { return to_ ? &found_ : nullptr; }

private:
    hol_report *const to_;
    holonomic::Report found_{};
};

inline void project(const hol_chains *chains, PositionsCall &call, const AtomArray *bonds, double *virial,
                    hol_report *report) {
    ReportTo found(report);
    holonomic::project_positions(chains->chains, call, bonds, virial, found.get(), &reference_error);
}

}  // namespace

int hol_project_positions(const hol_chains *chains, const double *r_ref, double *r, double *v, double dt,
                          double *lambda, int guess, double *virial, hol_report *report) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(r_ref, "r_ref");
        need(r, "r");
        PositionsCall call;
        set(call, dt, lambda, guess);
        call.r_ref = packed_array(r_ref);
        call.r = packed_array(r);
        call.v = packed_array(v);
        project(chains, call, nullptr, virial, report);
    });
}

int hol_project_positions_view(const hol_chains *chains, const hol_view *r_ref, const hol_view *r, const hol_view *v,
                               double dt, double *lambda, int guess, double *virial, hol_report *report) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(r_ref, "r_ref");
        need(r, "r");
        PositionsCall call;
        set(call, dt, lambda, guess);
        call.r_ref = viewed_array(r_ref, "r_ref");
        call.r = viewed_array(r, "r");
        call.v = viewed_array(v, "v");
        const AtomArray *const all[] = {&call.r_ref, &call.r, &call.v};
        holonomic::check_dimensions(all, 3);
        project(chains, call, nullptr, virial, report);
    });
}

int hol_project_positions_along(const hol_chains *chains, const double *b, double *r, double *v, double dt,
                                double *lambda, int guess, double *virial, hol_report *report) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        if (chains->chains.n_bonds() != 0) need(b, "b");
        need(r, "r");
        PositionsCall call;
        set(call, dt, lambda, guess);
        call.r = packed_array(r);
        call.v = packed_array(v);
        const AtomArray bonds = packed_array(b);
        project(chains, call, &bonds, virial, report);
    });
}

int hol_project_positions_along_view(const hol_chains *chains, const hol_view *b, const hol_view *r, const hol_view *v,
                                     double dt, double *lambda, int guess, double *virial, hol_report *report) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(b, "b");
        need(r, "r");
        PositionsCall call;
        set(call, dt, lambda, guess);
        const AtomArray bonds = viewed_array(b, "b");
        call.r = viewed_array(r, "r");
        call.v = viewed_array(v, "v");
        const AtomArray *const all[] = {&bonds, &call.r, &call.v};
        holonomic::check_dimensions(all, 3);
        project(chains, call, &bonds, virial, report);
    });
}

void hol_reference_error(double *error, int64_t *molecule, int64_t *bond) {
    if (error) *error = reference_error.error;
    if (molecule) *molecule = reference_error.molecule;
    if (bond) *bond = reference_error.bond;
}
