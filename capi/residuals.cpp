#include "core/residuals.hpp"

#include "boundary.hpp"
#include "view.hpp"

using holonomic::array_of;
using holonomic::AtomArray;
using holonomic::guarded;
using holonomic::need;

namespace {

// Of packed doubles, or of views.
template <class In>
void measure(const hol_chains *chains, const In *r, const In *v, double *length, double *rate) {
    need(chains->n_atoms(), r, "r");
    const AtomArray ar = array_of(chains->n_atoms(), r, "r"), av = array_of(chains->n_atoms(), v, "v");
    holonomic::check_dimensions_of<In>({&ar, &av});
    holonomic::need_apart(*chains, av, "v", ar, "r");
    holonomic::residuals(chains->chains, ar, av, length, rate);
}

}  // namespace

int hol_residuals(const hol_chains *chains, const double *r, const double *v, double *length, double *rate) {
    return guarded(__func__, chains, [&] { measure(chains, r, v, length, rate); });
}

int hol_residuals_view(const hol_chains *chains, const hol_const_view *r, const hol_const_view *v, double *length,
                       double *rate) {
    return guarded(__func__, chains, [&] { measure(chains, r, v, length, rate); });
}
