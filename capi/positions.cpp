#include "core/positions.hpp"

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
    if (!(dt > 0x1p-512) || !(dt < 0x1p512))  // else dt^2 or 1 / dt^2 is not finite
        throw make_error(Status::value, "dt is %g; it must be positive and finite, and so must dt^2 and 1/dt^2", dt);
    if (guess != 0 && guess != 1) throw make_error(Status::value, "guess is %d; it must be 0 or 1", guess);
    if (guess) need(lambda, "lambda, which holds the guess,");
    call.dt = dt;
    call.lambda = lambda;
    call.guess = guess != 0;
}

// The caller's report: written once there is one, also if the call fails then.
class ReportTo {
public:
    explicit ReportTo(hol_report *to) : to_(to) { found_.made = false; }
    ~ReportTo() {
        if (!to_ || !found_.made) return;
        *to_ = {found_.iterations, found_.n_corrected, found_.n_failed, found_.chain, found_.bond, found_.max_error};
    }
    ReportTo(const ReportTo &) = delete;
    ReportTo &operator=(const ReportTo &) = delete;
    holonomic::Report *get() { return to_ ? &found_ : nullptr; }

private:
    hol_report *const to_;
    holonomic::Report found_;
};

inline void project(const hol_chains *chains, PositionsCall &call, const AtomArray *bonds, double *virial,
                    hol_report *report) {
    holonomic::need_apart(*chains, call.v, "v", call.r, "r");
    if (!bonds) holonomic::need_apart(*chains, call.v, "v", call.r_ref, "r_ref");
    ReportTo found(report);
    holonomic::project_positions(chains->chains, call, bonds, virial, found.get(), chains->reference_error);
}

}  // namespace

int hol_project_positions(const hol_chains *chains, const double *r_ref, double *r, double *v, double dt,
                          double *lambda, int guess, double *virial, hol_report *report) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(chains->n_atoms(), r_ref, "r_ref");
        need(chains->n_atoms(), r, "r");
        PositionsCall call;
        set(call, dt, lambda, guess);
        call.r_ref = packed_array(r_ref);
        call.r = packed_array(r);
        call.v = packed_array(v);
        project(chains, call, nullptr, virial, report);
    });
}

int hol_project_positions_view(const hol_chains *chains, const hol_const_view *r_ref, const hol_view *r,
                               const hol_view *v, double dt, double *lambda, int guess, double *virial,
                               hol_report *report) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(chains->n_atoms(), r_ref, "r_ref");
        need(chains->n_atoms(), r, "r");
        PositionsCall call;
        set(call, dt, lambda, guess);
        call.r_ref = viewed_array(chains->n_atoms(), r_ref, "r_ref");
        call.r = viewed_array(chains->n_atoms(), r, "r");
        call.v = viewed_array(chains->n_atoms(), v, "v");
        const AtomArray *const all[] = {&call.r_ref, &call.r, &call.v};
        holonomic::check_dimensions(all, 3);
        project(chains, call, nullptr, virial, report);
    });
}

int hol_project_positions_along(const hol_chains *chains, const double *b, double *r, double *v, double dt,
                                double *lambda, int guess, double *virial, hol_report *report) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        if (chains->n_bonds() != 0) need(b, "b");
        need(chains->n_atoms(), r, "r");
        PositionsCall call;
        set(call, dt, lambda, guess);
        call.r = packed_array(r);
        call.v = packed_array(v);
        const AtomArray bonds = packed_array(b);
        project(chains, call, &bonds, virial, report);
    });
}

int hol_project_positions_along_view(const hol_chains *chains, const hol_const_view *b, const hol_view *r,
                                     const hol_view *v, double dt, double *lambda, int guess, double *virial,
                                     hol_report *report) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(b, "b");
        need(chains->n_atoms(), r, "r");
        PositionsCall call;
        set(call, dt, lambda, guess);
        const AtomArray bonds = viewed_array(chains->n_bonds(), b, "b");
        call.r = viewed_array(chains->n_atoms(), r, "r");
        call.v = viewed_array(chains->n_atoms(), v, "v");
        const AtomArray *const all[] = {&bonds, &call.r, &call.v};
        holonomic::check_dimensions(all, 3);
        project(chains, call, &bonds, virial, report);
    });
}

int hol_reference_error(const hol_chains *chains, double *error, int64_t *molecule, int64_t *bond) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        holonomic::WorstLength found;
        if (!chains->reference_error.get(&found))
            throw make_error(Status::state, "no reference has been compared with the lengths yet");
        if (error) *error = found.error;
        if (molecule) *molecule = found.molecule;
        if (bond) *bond = found.bond;
    });
}
