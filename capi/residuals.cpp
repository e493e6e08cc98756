#include "core/residuals.hpp"

#include "boundary.hpp"
#include "view.hpp"

using holonomic::AtomArray;
using holonomic::guarded;
using holonomic::need;

int hol_residuals(const hol_chains *chains, const double *r, const double *v, double *length, double *rate) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(chains->n_atoms(), r, "r");
        const AtomArray ar = holonomic::packed_array(r), av = holonomic::packed_array(v);
        holonomic::need_apart(*chains, av, "v", ar, "r");
        holonomic::residuals(chains->chains, ar, av, length, rate);
    });
}

int hol_residuals_view(const hol_chains *chains, const hol_const_view *r, const hol_const_view *v, double *length,
                       double *rate) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(chains->n_atoms(), r, "r");
        const AtomArray ar = holonomic::viewed_array(chains->n_atoms(), r, "r"),
                        av = holonomic::viewed_array(chains->n_atoms(), v, "v");
        const AtomArray *const all[] = {&ar, &av};
        holonomic::check_dimensions(all, 2);
        holonomic::need_apart(*chains, av, "v", ar, "r");
        holonomic::residuals(chains->chains, ar, av, length, rate);
    });
}
