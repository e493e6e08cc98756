#include "core/factors/factors.hpp"

#include <algorithm>

#include "boundary.hpp"
#include "mode.hpp"
#include "view.hpp"

using holonomic::adds;
using holonomic::AtomArray;
using holonomic::FactorsSolve;
using holonomic::guarded;
using holonomic::make_error;
using holonomic::need;
using holonomic::packed_array;
using holonomic::sides_at_once;
using holonomic::Status;
using holonomic::viewed_array;

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
    FactorsSolve what[sides_at_once];
    for (std::int64_t first = 0; first < n_rhs; first += sides_at_once) {
        const int n = static_cast<int>(std::min<std::int64_t>(sides_at_once, n_rhs - first));
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
    return guarded(__func__, [&] {
        need(factors, "factors");
        need(factors->n_atoms(), r, "r");
        factors->factors.update(packed_array(r));
    });
}

int hol_factors_update_view(hol_factors *factors, const hol_const_view *r) {
    return guarded(__func__, [&] {
        need(factors, "factors");
        need(factors->n_atoms(), r, "r");
        factors->factors.update(viewed_array(factors->n_atoms(), r, "r"));
    });
}

int hol_factors_forces(const hol_factors *factors, const double *v, const double *f, double *lambda, double *tension,
                       double *g, hol_mode mode, double *virial) {
    return guarded(__func__, [&] {
        need(factors, "factors");
        FactorsSolve what;
        what.v = packed_array(v);
        what.f = packed_array(f);
        what.g = packed_array(g);
        what.lambda = lambda;
        what.tension = tension;
        what.add = adds(mode);
        factors->factors.forces(what, virial);
    });
}

int hol_factors_forces_view(const hol_factors *factors, const hol_const_view *v, const hol_const_view *f,
                            double *lambda, double *tension, const hol_view *g, hol_mode mode, double *virial) {
    return guarded(__func__, [&] {
        need(factors, "factors");
        FactorsSolve what;
        what.v = viewed_array(factors->n_atoms(), v, "v");
        what.f = viewed_array(factors->n_atoms(), f, "f");
        what.g = viewed_array(factors->n_atoms(), g, "g");
        const AtomArray *const all[] = {&what.v, &what.f, &what.g};
        holonomic::check_dimensions(all, 3);
        what.lambda = lambda;
        what.tension = tension;
        what.add = adds(mode);
        factors->factors.forces(what, virial);
    });
}

int hol_factors_solve(const hol_factors *factors, int64_t n_rhs, const double *rhs, double *lambda, double *g,
                      hol_mode mode, double *virial) {
    return guarded(__func__, [&] {
        need(factors, "factors");
        const std::int64_t numbers = 3 * factors->n_atoms();
        solve(
            factors, n_rhs, rhs, lambda, [&](std::int64_t k) { return packed_array(g ? g + k * numbers : nullptr); },
            adds(mode), virial);
    });
}

int hol_factors_solve_view(const hol_factors *factors, int64_t n_rhs, const double *rhs, double *lambda,
                           const hol_view *g, hol_mode mode, double *virial) {
    return guarded(__func__, [&] {
        need(factors, "factors");
        for (std::int64_t k = 0; g && k < n_rhs; ++k) viewed_array(factors->n_atoms(), g + k, "g");
        solve(
            factors, n_rhs, rhs, lambda,
            [&](std::int64_t k) { return viewed_array(factors->n_atoms(), g ? g + k : nullptr, "g"); }, adds(mode),
            virial);
    });
}
