#include "core/violation.hpp"

#include "boundary.hpp"
#include "view.hpp"

using holonomic::array_of;
using holonomic::AtomArray;
using holonomic::guarded;
using holonomic::need;

namespace {

// Of packed doubles, or of views.
template <class In>
void measure(const hol_chains *chains, const In *r, const In *v, hol_worst *worst) {
    need(chains->n_atoms(), r, "r");
    need(worst, "worst");
    const AtomArray ar = array_of(chains->n_atoms(), r, "r"), av = array_of(chains->n_atoms(), v, "v");
    holonomic::check_dimensions_of<In>({&ar, &av});
    holonomic::need_apart(*chains, av, "v", ar, "r");
    holonomic::Worst found;
    holonomic::violation(chains->chains, ar, av, &found);
    *worst = {found.length, found.length_molecule, found.length_bond, found.rate, found.rate_molecule, found.rate_bond};
}

}  // namespace

int hol_violation(const hol_chains *chains, const double *r, const double *v, hol_worst *worst) {
    return guarded(__func__, chains, [&] { measure(chains, r, v, worst); });
}

int hol_violation_view(const hol_chains *chains, const hol_const_view *r, const hol_const_view *v, hol_worst *worst) {
    return guarded(__func__, chains, [&] { measure(chains, r, v, worst); });
}
