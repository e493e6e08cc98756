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

void check(const hol_chains *chains, const AtomArray &r, hol_which_box box) {
    const holonomic::Cell &its = holonomic::box_of(chains, box);
    const holonomic::Chains &c = chains->chains;
    holonomic::Worst worst;
    holonomic::violation(c, r, AtomArray{}, &worst);  // finds what is not finite
    holonomic::check_reference(c, {&r, nullptr, &its}, "in the positions");
    if (c.bodies()) holonomic::rigid::check_reference(c, r, its, "in the positions");
}

}  // namespace

int hol_chains_check(const hol_chains *chains, const double *r, hol_which_box box) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(chains->n_atoms(), r, "r");
        check(chains, holonomic::packed_array(r), box);
    });
}

int hol_chains_check_view(const hol_chains *chains, const hol_const_view *r, hol_which_box box) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(chains->n_atoms(), r, "r");
        check(chains, holonomic::viewed_array(chains->n_atoms(), r, "r"), box);
    });
}
