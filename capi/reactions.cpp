#include "core/reactions.hpp"

#include "boundary.hpp"
#include "mode.hpp"
#include "view.hpp"

using holonomic::adds;
using holonomic::AtomArray;
using holonomic::guarded;
using holonomic::need;

namespace {

const holonomic::Box &box_of(const hol_chains *chains, int box) {
    if (box != HOL_BOX && box != HOL_REFERENCE_BOX)
        throw holonomic::make_error(holonomic::Status::value, "box is %d; it must be HOL_BOX or HOL_REFERENCE_BOX",
                                    box);
    return box == HOL_BOX ? chains->chains.box : chains->chains.box_of_reference();
}

}  // namespace

int hol_reactions(const hol_chains *chains, const double *r, int box, const double *lambda, double *tension, double *g,
                  int mode, double *bond_virial, double *virial) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(r, "r");
        need(lambda, "lambda");
        holonomic::reactions(chains->chains, holonomic::packed_array(r), box_of(chains, box), lambda,
                             {nullptr, tension, holonomic::packed_array(g), adds(mode), bond_virial, false}, virial);
    });
}

int hol_reactions_view(const hol_chains *chains, const hol_view *r, int box, const double *lambda, double *tension,
                       const hol_view *g, int mode, double *bond_virial, double *virial) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(r, "r");
        need(lambda, "lambda");
        const AtomArray ar = holonomic::viewed_array(r, "r"), ag = holonomic::viewed_array(g, "g");
        const AtomArray *const all[] = {&ar, &ag};
        holonomic::check_dimensions(all, 2);
        holonomic::reactions(chains->chains, ar, box_of(chains, box), lambda,
                             {nullptr, tension, ag, adds(mode), bond_virial, false}, virial);
    });
}
