#include "core/solve.hpp"

#include "boundary.hpp"
#include "mode.hpp"
#include "view.hpp"

using holonomic::array_of;
using holonomic::AtomArray;
using holonomic::guarded;
using holonomic::need;

namespace {

// Of packed doubles, or of views.
template <class In, class Out>
void run(const hol_chains *chains, const In *r, const double *rhs, double *lambda, Out *g, hol_mode mode,
         double *virial) {
    need(chains->n_atoms(), r, "r");
    need(chains->n_bonds(), rhs, "rhs");
    const AtomArray ar = array_of(chains->n_atoms(), r, "r"), ag = array_of(chains->n_atoms(), g, "g");
    holonomic::check_dimensions_of<In>({&ar, &ag});
    holonomic::need_apart(*chains, ag, "g", ar, "r");
    holonomic::solve(chains->chains, ar, rhs, lambda, ag, holonomic::adds(mode), virial);
}

}  // namespace

int hol_solve(const hol_chains *chains, const double *r, const double *rhs, double *lambda, double *g, hol_mode mode,
              double *virial) {
    return guarded(__func__, chains, [&] { run(chains, r, rhs, lambda, g, mode, virial); });
}

int hol_solve_view(const hol_chains *chains, const hol_const_view *r, const double *rhs, double *lambda,
                   const hol_view *g, hol_mode mode, double *virial) {
    return guarded(__func__, chains, [&] { run(chains, r, rhs, lambda, g, mode, virial); });
}
