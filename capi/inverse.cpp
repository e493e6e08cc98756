#include "core/inverse/inverse.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "boundary.hpp"
#include "view.hpp"

using holonomic::array_of;
using holonomic::AtomArray;
using holonomic::guarded;
using holonomic::make_error;
using holonomic::need;
using holonomic::Status;

struct hol_inverse {
    std::unique_ptr<const holonomic::Inverse> inverse;
};

namespace {

// Of packed doubles, or of a view.
template <class In>
void create(const hol_chains *chains, std::int64_t molecule, const In *r, hol_inverse **inverse) {
    need(r, "r");
    need(inverse, "inverse");
    const holonomic::Chains &all = chains->chains;
    if (molecule - all.base >= all.n_chains() && molecule - all.base < all.n_molecules() && molecule >= all.base)
        throw make_error(Status::unsupported,
                         "molecule %lld has rigid bodies: the inverse of its matrix is not implemented",
                         static_cast<long long>(molecule));
    if (molecule < all.base || molecule - all.base >= all.n_chains()) {
        holonomic::Error error =
            make_error(Status::index, "molecule %lld is outside %d .. %lld", static_cast<long long>(molecule), all.base,
                       static_cast<long long>(all.n_chains() - 1 + all.base));
        error.base = all.base;
        throw error;
    }
    *inverse = new hol_inverse{holonomic::Inverse::make(all, molecule - all.base, array_of(all.n_atoms(), r, "r"))};
}

// Number of a bond counted from 0; -1, which the core refuses, for one below the base.
std::int64_t bond(const hol_inverse *inverse, std::int64_t i) {
    const int base = inverse->inverse->base();
    return i < base ? -1 : i - base;
}

bool is_physical(hol_scaling scaling) {
    if (scaling != HOL_UNIT_DIAGONAL && scaling != HOL_PHYSICAL)
        throw make_error(Status::value, "scaling is %d; it must be HOL_UNIT_DIAGONAL or HOL_PHYSICAL",
                         static_cast<int>(scaling));
    return scaling == HOL_PHYSICAL;
}

template <class In>
void error_bound(const hol_inverse *inverse, const In *v, const In *f, const double *lambda, double *bound,
                 double *relative) {
    need(inverse, "inverse");
    need(lambda, "lambda");
    const AtomArray av = array_of(1, v, "v"), af = array_of(1, f, "f");
    holonomic::check_dimensions_of<In>({&av, &af});
    const std::vector<double> found = inverse->inverse->error_bound(av, af, lambda);
    double largest = 0, size = 0;
    for (std::size_t k = 0; k < found.size(); ++k) {
        largest = std::max(largest, found[k]);
        size = std::max(size, std::fabs(lambda[k]));
        if (bound) bound[k] = found[k];
    }
    if (!relative) return;
    if (largest == 0)
        *relative = 0;
    else
        *relative = size > 0 ? largest / size : std::numeric_limits<double>::infinity();
}

}  // namespace

int hol_inverse_create(const hol_chains *chains, int64_t molecule, const double *r, hol_inverse **inverse) {
    if (inverse) *inverse = nullptr;
    return guarded(__func__, chains, [&] { create(chains, molecule, r, inverse); });
}

int hol_inverse_create_view(const hol_chains *chains, int64_t molecule, const hol_const_view *r,
                            hol_inverse **inverse) {
    if (inverse) *inverse = nullptr;
    return guarded(__func__, chains, [&] { create(chains, molecule, r, inverse); });
}

void hol_inverse_destroy(hol_inverse *inverse) { delete inverse; }

int64_t hol_inverse_n_bonds(const hol_inverse *inverse) { return inverse ? inverse->inverse->n_bonds() : 0; }

int hol_inverse_entry(const hol_inverse *inverse, hol_scaling scaling, int64_t i, int64_t j, double *value) {
    return guarded(__func__, [&] {
        need(inverse, "inverse");
        need(value, "value");
        *value = inverse->inverse->entry(is_physical(scaling), bond(inverse, i), bond(inverse, j));
    });
}

int hol_inverse_row(const hol_inverse *inverse, hol_scaling scaling, int64_t i, double *row) {
    return guarded(__func__, [&] {
        need(inverse, "inverse");
        need(row, "row");
        inverse->inverse->row(is_physical(scaling), bond(inverse, i), row);
    });
}

int hol_inverse_band(const hol_inverse *inverse, hol_scaling scaling, int64_t width, double *band) {
    return guarded(__func__, [&] {
        need(inverse, "inverse");
        need(band, "band");
        inverse->inverse->band(is_physical(scaling), width, band);
    });
}

int hol_inverse_matrix(const hol_inverse *inverse, hol_scaling scaling, double *matrix) {
    return guarded(__func__, [&] {
        need(inverse, "inverse");
        need(matrix, "matrix");
        inverse->inverse->matrix(is_physical(scaling), matrix);
    });
}

int hol_inverse_condition(const hol_inverse *inverse, double *condition) {
    return guarded(__func__, [&] {
        need(inverse, "inverse");
        need(condition, "condition");
        *condition = inverse->inverse->condition();
    });
}

int hol_inverse_error_bound(const hol_inverse *inverse, const double *v, const double *f, const double *lambda,
                            double *bound, double *relative) {
    return guarded(__func__, [&] { error_bound(inverse, v, f, lambda, bound, relative); });
}

int hol_inverse_error_bound_view(const hol_inverse *inverse, const hol_const_view *v, const hol_const_view *f,
                                 const double *lambda, double *bound, double *relative) {
    return guarded(__func__, [&] { error_bound(inverse, v, f, lambda, bound, relative); });
}
