#include "core/solve.hpp"

#include "boundary.hpp"
#include "mode.hpp"
#include "view.hpp"

using holonomic::adds;
using holonomic::AtomArray;
using holonomic::guarded;
using holonomic::need;
using holonomic::packed_array;
using holonomic::viewed_array;

int hol_solve(const hol_chains *chains, const double *r, const double *rhs, double *lambda, double *g, hol_mode mode,
              double *virial) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(chains->n_atoms(), r, "r");
        need(chains->n_bonds(), rhs, "rhs");
        const AtomArray ar = packed_array(r), ag = packed_array(g);
        holonomic::need_apart(*chains, ag, "g", ar, "r");
        holonomic::solve(chains->chains, ar, rhs, lambda, ag, adds(mode), virial);
    });
}

int hol_solve_view(const hol_chains *chains, const hol_const_view *r, const double *rhs, double *lambda,
                   const hol_view *g, hol_mode mode, double *virial) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(chains->n_atoms(), r, "r");
        need(chains->n_bonds(), rhs, "rhs");
        const AtomArray ar = viewed_array(chains->n_atoms(), r, "r"), ag = viewed_array(chains->n_atoms(), g, "g");
        const AtomArray *const all[] = {&ar, &ag};
        holonomic::check_dimensions(all, 2);
        holonomic::need_apart(*chains, ag, "g", ar, "r");
        holonomic::solve(chains->chains, ar, rhs, lambda, ag, adds(mode), virial);
    });
}
