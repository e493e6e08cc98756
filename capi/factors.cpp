#include "core/factors/factors.hpp"

#include <algorithm>

#include "boundary.hpp"
#include "mode.hpp"
#include "view.hpp"

using holonomic::adds;
using holonomic::array_of;
using holonomic::FactorsSolve;
using holonomic::guarded;
using holonomic::make_error;
using holonomic::need;
using holonomic::rhs_at_once;
using holonomic::Status;

struct hol_factors {
    holonomic::Factors factors;
    explicit hol_factors(const holonomic::Chains &chains) : factors(chains) {}
    std::int64_t n_atoms() const { return factors.chains().n_atoms(); }
    std::int64_t n_bonds() const { return factors.chains().n_bonds(); }
};

namespace {

// g(k): where the forces of right-hand side k go; absent if they are not wanted.
template <class G>
void solve(const hol_factors *factors, std::int64_t n_rhs, const double *rhs, double *lambda, const G &g, bool add,
           double *virial) {
    if (n_rhs < 0)
        throw make_error(Status::value, "n_rhs is %lld; it must be at least 0", static_cast<long long>(n_rhs));
    const std::int64_t n_bonds = factors->n_bonds();
    need(n_rhs == 0 ? 0 : n_bonds, rhs, "rhs");
    FactorsSolve what[rhs_at_once];
    for (std::int64_t first = 0; first < n_rhs; first += rhs_at_once) {
        const int n = static_cast<int>(std::min<std::int64_t>(rhs_at_once, n_rhs - first));
        for (int i = 0; i < n; ++i) {
            const std::int64_t k = first + i;
            what[i].rhs = rhs + k * n_bonds;
            what[i].lambda = lambda ? lambda + k * n_bonds : nullptr;
            what[i].g = g(k);
            what[i].add = add;
        }
        factors->factors.solve(what, n, virial ? virial + 9 * first : nullptr);
    }
}

// Of packed doubles, or of views.
template <class In>
void update(hol_factors *factors, const In *r) {
    need(factors, "factors");
    need(factors->n_atoms(), r, "r");
    factors->factors.update(array_of(factors->n_atoms(), r, "r"));
}

template <class In, class Out>
void forces(const hol_factors *factors, const In *v, const In *f, double *lambda, double *tension, Out *g,
            hol_mode mode, double *virial) {
    need(factors, "factors");
    FactorsSolve what;
    what.v = array_of(factors->n_atoms(), v, "v");
    what.f = array_of(factors->n_atoms(), f, "f");
    what.g = array_of(factors->n_atoms(), g, "g");
    holonomic::check_dimensions_of<In>({&what.v, &what.f, &what.g});
    what.lambda = lambda;
    what.tension = tension;
    what.add = adds(mode);
    factors->factors.forces(what, virial);
}

}  // namespace

int hol_factors_create(const hol_chains *chains, hol_factors **factors) {
    return guarded(__func__, [&] {
        need(factors, "factors");
        *factors = nullptr;
        need(chains, "chains");
        *factors = new hol_factors(chains->chains);
    });
}

void hol_factors_destroy(hol_factors *factors) { delete factors; }

int hol_factors_update(hol_factors *factors, const double *r) {
    return guarded(__func__, [&] { update(factors, r); });
}

int hol_factors_update_view(hol_factors *factors, const hol_const_view *r) {
    return guarded(__func__, [&] { update(factors, r); });
}

int hol_factors_forces(const hol_factors *factors, const double *v, const double *f, double *lambda, double *tension,
                       double *g, hol_mode mode, double *virial) {
    return guarded(__func__, [&] { forces(factors, v, f, lambda, tension, g, mode, virial); });
}

int hol_factors_forces_view(const hol_factors *factors, const hol_const_view *v, const hol_const_view *f,
                            double *lambda, double *tension, const hol_view *g, hol_mode mode, double *virial) {
    return guarded(__func__, [&] { forces(factors, v, f, lambda, tension, g, mode, virial); });
}

int hol_factors_solve(const hol_factors *factors, int64_t n_rhs, const double *rhs, double *lambda, double *g,
                      hol_mode mode, double *virial) {
    return guarded(__func__, [&] {
        need(factors, "factors");
        const std::int64_t numbers = 3 * factors->n_atoms();
        solve(
            factors, n_rhs, rhs, lambda,
            [&](std::int64_t k) { return array_of(0, g ? g + k * numbers : nullptr, "g"); }, adds(mode), virial);
    });
}

int hol_factors_solve_view(const hol_factors *factors, int64_t n_rhs, const double *rhs, double *lambda,
                           const hol_view *g, hol_mode mode, double *virial) {
    return guarded(__func__, [&] {
        need(factors, "factors");
        for (std::int64_t k = 0; g && k < n_rhs; ++k) array_of(factors->n_atoms(), g + k, "g");
        solve(
            factors, n_rhs, rhs, lambda,
            [&](std::int64_t k) { return array_of(factors->n_atoms(), g ? g + k : nullptr, "g"); }, adds(mode), virial);
    });
}
