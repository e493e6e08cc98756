#include "core/check.hpp"
#include "boundary.hpp"
#include "core/rigid/verbs.hpp"
#include "core/violation.hpp"
#include "view.hpp"
#include "which_box.hpp"

using holonomic::AtomArray;
using holonomic::guarded;
using holonomic::need;

namespace {

// Of packed doubles, or of a view.
template <class In>
void check(const hol_chains *chains, const In *given, hol_which_box box) {
    need(chains->n_atoms(), given, "r");
    const AtomArray r = holonomic::array_of(chains->n_atoms(), given, "r");
    const holonomic::Cell &its = holonomic::box_of(chains, box);
    const holonomic::Chains &c = chains->chains;
    holonomic::Worst worst;
    holonomic::violation(c, r, AtomArray{}, &worst);  // finds what is not finite
    holonomic::check_reference(c, {&r, nullptr, &its}, "in the positions");
    if (c.bodies()) holonomic::rigid::check_reference(c, r, its, "in the positions");
}

}  // namespace

int hol_chains_check(const hol_chains *chains, const double *r, hol_which_box box) {
    return guarded(__func__, chains, [&] { check(chains, r, box); });
}

int hol_chains_check_view(const hol_chains *chains, const hol_const_view *r, hol_which_box box) {
    return guarded(__func__, chains, [&] { check(chains, r, box); });
}
