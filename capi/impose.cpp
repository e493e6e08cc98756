#include "core/impose.hpp"

#include "boundary.hpp"
#include "report.hpp"
#include "view.hpp"

using holonomic::guarded;
using holonomic::need;

namespace {

// Of packed doubles, or of a view.
template <class Out>
void impose(const hol_chains *chains, Out *r, hol_report *report) {
    need(chains->n_atoms(), r, "r");
    holonomic::ReportTo to(report);
    holonomic::impose(chains->chains, holonomic::array_of(chains->n_atoms(), r, "r"), &to.found);
}

}  // namespace

int hol_impose(const hol_chains *chains, double *r, hol_report *report) {
    return guarded(__func__, chains, [&] { impose(chains, r, report); });
}

int hol_impose_view(const hol_chains *chains, const hol_view *r, hol_report *report) {
    return guarded(__func__, chains, [&] { impose(chains, r, report); });
}
