#include "core/check.hpp"
#include "boundary.hpp"
#include "core/rigid/verbs.hpp"
#include "core/violation.hpp"
#include "view.hpp"

using holonomic::AtomArray;
using holonomic::guarded;
using holonomic::make_error;
using holonomic::need;
using holonomic::Status;

namespace {

void check(const hol_chains *chains, const AtomArray &r, int box) {
    if (box != HOL_BOX && box != HOL_REFERENCE_BOX)
        throw make_error(Status::value, "box is %d; it must be HOL_BOX or HOL_REFERENCE_BOX", box);
    const holonomic::Chains &c = chains->chains;
    holonomic::Worst worst;
    holonomic::violation(c, r, AtomArray{}, &worst);  // finds what is not finite
    const holonomic::Box &its = box == HOL_BOX ? c.box : c.box_of_reference();
    holonomic::check_reference(c, {&r, nullptr, &its}, "in the positions");
    if (c.bodies()) holonomic::rigid::check_reference(c, r, its, "in the positions");
}

}  // namespace

int hol_chains_check(const hol_chains *chains, const double *r, int box) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(r, "r");
        check(chains, holonomic::packed_array(r), box);
    });
}

int hol_chains_check_view(const hol_chains *chains, const hol_view *r, int box) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(r, "r");
        check(chains, holonomic::viewed_array(r, "r"), box);
    });
}
