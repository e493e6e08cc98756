#include "core/violation.hpp"

#include "boundary.hpp"
#include "view.hpp"

using holonomic::AtomArray;
using holonomic::guarded;
using holonomic::need;

namespace {

void write(hol_worst *to, const holonomic::Worst &found) {
    *to = {found.length, found.length_molecule, found.length_bond, found.rate, found.rate_molecule, found.rate_bond};
}

}  // namespace

int hol_violation(const hol_chains *chains, const double *r, const double *v, hol_worst *worst) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(chains->n_atoms(), r, "r");
        need(worst, "worst");
        const AtomArray ar = holonomic::packed_array(r), av = holonomic::packed_array(v);
        holonomic::need_apart(*chains, av, "v", ar, "r");
        holonomic::Worst found;
        holonomic::violation(chains->chains, ar, av, &found);
        write(worst, found);
    });
}

int hol_violation_view(const hol_chains *chains, const hol_const_view *r, const hol_const_view *v, hol_worst *worst) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(chains->n_atoms(), r, "r");
        need(worst, "worst");
        const AtomArray ar = holonomic::viewed_array(chains->n_atoms(), r, "r"),
                        av = holonomic::viewed_array(chains->n_atoms(), v, "v");
        const AtomArray *const all[] = {&ar, &av};
        holonomic::check_dimensions(all, 2);
        holonomic::need_apart(*chains, av, "v", ar, "r");
        holonomic::Worst found;
        holonomic::violation(chains->chains, ar, av, &found);
        write(worst, found);
    });
}
