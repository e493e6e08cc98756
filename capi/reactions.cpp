#include "core/reactions.hpp"

#include "boundary.hpp"
#include "mode.hpp"
#include "view.hpp"
#include "which_box.hpp"

using holonomic::adds;
using holonomic::AtomArray;
using holonomic::box_of;
using holonomic::guarded;
using holonomic::need;

int hol_reactions(const hol_chains *chains, const double *r, hol_which_box box, const double *lambda, double *tension,
                  double *g, hol_mode mode, double *bond_virial, double *virial) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(chains->n_atoms(), r, "r");
        need(chains->n_bonds(), lambda, "lambda");
        holonomic::reactions(chains->chains, holonomic::packed_array(r), box_of(chains, box), lambda,
                             {nullptr, tension, holonomic::packed_array(g), adds(mode), bond_virial, false}, virial);
    });
}

int hol_reactions_view(const hol_chains *chains, const hol_const_view *r, hol_which_box box, const double *lambda,
                       double *tension, const hol_view *g, hol_mode mode, double *bond_virial, double *virial) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(chains->n_atoms(), r, "r");
        need(chains->n_bonds(), lambda, "lambda");
        const AtomArray ar = holonomic::viewed_array(chains->n_atoms(), r, "r"),
                        ag = holonomic::viewed_array(chains->n_atoms(), g, "g");
        const AtomArray *const all[] = {&ar, &ag};
        holonomic::check_dimensions(all, 2);
        holonomic::reactions(chains->chains, ar, box_of(chains, box), lambda,
                             {nullptr, tension, ag, adds(mode), bond_virial, false}, virial);
    });
}
