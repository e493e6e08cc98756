#include "core/impose.hpp"

#include "boundary.hpp"
#include "view.hpp"

using holonomic::AtomArray;
using holonomic::guarded;
using holonomic::need;

namespace {

void impose(const hol_chains *chains, const AtomArray &r, hol_report *report) {
    holonomic::Report found{};
    struct ToCaller {
        hol_report *to;
        const holonomic::Report &found;
        ~ToCaller() {
            if (to && found.made)
                *to = {found.iterations, found.n_corrected, found.n_failed, found.chain, found.bond, found.max_error};
        }
    } to_caller{report, found};
    holonomic::impose(chains->chains, r, &found);
}

}  // namespace

int hol_impose(const hol_chains *chains, double *r, hol_report *report) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(chains->n_atoms(), r, "r");
        impose(chains, holonomic::packed_array(r), report);
    });
}

int hol_impose_view(const hol_chains *chains, const hol_view *r, hol_report *report) {
    return guarded(__func__, [&] {
        need(chains, "chains");
        need(chains->n_atoms(), r, "r");
        impose(chains, holonomic::viewed_array(chains->n_atoms(), r, "r"), report);
    });
}
