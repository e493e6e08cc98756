#include "core/reactions.hpp"

#include "boundary.hpp"
#include "mode.hpp"
#include "view.hpp"
#include "which_box.hpp"

using holonomic::array_of;
using holonomic::AtomArray;
using holonomic::guarded;
using holonomic::need;

namespace {

// Of packed doubles, or of views.
template <class In, class Out>
void run(const hol_chains *chains, const In *r, hol_which_box box, const double *lambda, double *tension, Out *g,
         hol_mode mode, double *bond_virial, double *virial) {
    need(chains->n_atoms(), r, "r");
    need(chains->n_bonds(), lambda, "lambda");
    const AtomArray ar = array_of(chains->n_atoms(), r, "r"), ag = array_of(chains->n_atoms(), g, "g");
    holonomic::check_dimensions_of<In>({&ar, &ag});
    holonomic::reactions(chains->chains, ar, holonomic::box_of(chains, box), lambda,
                         {nullptr, tension, ag, holonomic::adds(mode), bond_virial, false}, virial);
}

}  // namespace

int hol_reactions(const hol_chains *chains, const double *r, hol_which_box box, const double *lambda, double *tension,
                  double *g, hol_mode mode, double *bond_virial, double *virial) {
    return guarded(__func__, chains, [&] { run(chains, r, box, lambda, tension, g, mode, bond_virial, virial); });
}

int hol_reactions_view(const hol_chains *chains, const hol_const_view *r, hol_which_box box, const double *lambda,
                       double *tension, const hol_view *g, hol_mode mode, double *bond_virial, double *virial) {
    return guarded(__func__, chains, [&] { run(chains, r, box, lambda, tension, g, mode, bond_virial, virial); });
}
