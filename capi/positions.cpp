#include "core/positions.hpp"

#include "boundary.hpp"
#include "report.hpp"
#include "view.hpp"

using holonomic::array_of;
using holonomic::AtomArray;
using holonomic::guarded;
using holonomic::make_error;
using holonomic::need;
using holonomic::PositionsCall;
using holonomic::Status;

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

// Of packed doubles, or of views: from reference positions, or along the vectors of bonds.
template <bool along, class In, class Out>
__attribute__((always_inline)) inline void project(const hol_chains *chains, const In *given, Out *r, Out *v, double dt,
                                                   double *lambda, int guess, double *virial, hol_report *report) {
    constexpr const char *name = along ? "b" : "r_ref";
    const std::int64_t n_atoms = chains->n_atoms(), n_given = along ? chains->n_bonds() : n_atoms;
    need(n_given, given, name);
    need(n_atoms, r, "r");
    PositionsCall call;
    set(call, dt, lambda, guess);
    const AtomArray reference = array_of(n_given, given, name);
    call.r = array_of(n_atoms, r, "r");
    call.v = array_of(n_atoms, v, "v");
    holonomic::check_dimensions_of<In>({&reference, &call.r, &call.v});
    holonomic::need_apart(*chains, call.v, "v", call.r, "r");
    if (!along) {
        call.r_ref = reference;
        holonomic::need_apart(*chains, call.v, "v", call.r_ref, "r_ref");
    }
    holonomic::ReportTo to(report);
    holonomic::project_positions(chains->chains, call, along ? &reference : nullptr, virial, to.wanted(),
                                 chains->reference_error);
}

}  // namespace

int hol_project_positions(const hol_chains *chains, const double *r_ref, double *r, double *v, double dt,
                          double *lambda, int guess, double *virial, hol_report *report) {
    return guarded(__func__, chains, [&] { project<false>(chains, r_ref, r, v, dt, lambda, guess, virial, report); });
}

int hol_project_positions_view(const hol_chains *chains, const hol_const_view *r_ref, const hol_view *r,
                               const hol_view *v, double dt, double *lambda, int guess, double *virial,
                               hol_report *report) {
    return guarded(__func__, chains, [&] { project<false>(chains, r_ref, r, v, dt, lambda, guess, virial, report); });
}

int hol_project_positions_along(const hol_chains *chains, const double *b, double *r, double *v, double dt,
                                double *lambda, int guess, double *virial, hol_report *report) {
    return guarded(__func__, chains, [&] { project<true>(chains, b, r, v, dt, lambda, guess, virial, report); });
}

int hol_project_positions_along_view(const hol_chains *chains, const hol_const_view *b, const hol_view *r,
                                     const hol_view *v, double dt, double *lambda, int guess, double *virial,
                                     hol_report *report) {
    return guarded(__func__, chains, [&] { project<true>(chains, b, r, v, dt, lambda, guess, virial, report); });
}

int hol_reference_error(const hol_chains *chains, double *error, int64_t *molecule, int64_t *bond) {
    return guarded(__func__, chains, [&] {
        holonomic::WorstLength found;
        if (!chains->reference_error.get(&found))
            throw make_error(Status::state, "no reference has been compared with the lengths yet");
        if (error) *error = found.error;
        if (molecule) *molecule = found.molecule;
        if (bond) *bond = found.bond;
    });
}
