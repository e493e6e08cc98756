/**
 * Error of the multipliers against the condition number, 1 .. 1e16 and beyond, in three families: straight chains of
 * growing length, straight chains with ever lighter joints, chains ever more taut between fixed ends. For each chain
 * the library, the recursion as printed in the paper (Eq. 17 on the gammas), and LAPACK's dptsv (or, without LAPACK,
 * the same LDL^T). condition_sweep          prints  family condition library printed ldl   in units of eps times the
 * componentwise scale Exit status 1 if the library exceeds the bound of tests/oracle/README.md anywhere, 77 if
 * without MPFR some chains are not decided.
 */
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "checks.hpp"

using namespace stress;

#ifdef STRESS_HAVE_LAPACK
extern "C" void dptsv_(const int *n, const int *nrhs, double *d, double *e, double *b, const int *ldb, int *info);
#endif

namespace
{

using row3 = const double *;

double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/** Z and K + C in ordinary double precision. */
struct system_of {
    vec diagonal, beside, right;
    explicit system_of(const hostile_chain &c)
    {
        const std::size_t n = static_cast<std::size_t>(c.n_bonds);
        vec d(3 * n);
        for (std::size_t i = 0; i < 3 * n; ++i) d[i] = c.r[i + 3] - c.r[i];
        for (std::size_t k = 0; k < n; ++k) {
            const double *const dk = &d[3 * k];
            double dv[3], df[3];
            for (std::size_t x = 0; x < 3; ++x) {
                dv[x] = c.v[3 * k + 3 + x] - c.v[3 * k + x];
                df[x] = c.w[k + 1] * c.f[3 * k + 3 + x] - c.w[k] * c.f[3 * k + x];
            }
            diagonal.push_back(4 * (c.w[k] + c.w[k + 1]) * dot(dk, dk));
            if (k + 1 < n) beside.push_back(-4 * c.w[k + 1] * dot(dk, &d[3 * k + 3]));
            right.push_back(2 * dot(dk, df) + 2 * dot(dv, dv));
        }
    }
};

/** Omega_k^2 = 1 - gamma_k^2 / Omega_{k-1}^2, then the two sweeps. */
vec by_printed_recursion(const system_of &s)
{
    const std::size_t n = s.diagonal.size();
    vec x(n), omega2(n), gamma(n, 0), scale(n);
    for (std::size_t k = 0; k < n; ++k) scale[k] = 1 / std::sqrt(s.diagonal[k]);
    for (std::size_t k = 0; k < n; ++k) {
        if (k > 0) gamma[k] = -s.beside[k - 1] * scale[k - 1] * scale[k];
        omega2[k] = k > 0 ? 1 - gamma[k] * gamma[k] / omega2[k - 1] : 1;
        x[k] = scale[k] * s.right[k] + (k > 0 ? gamma[k] / omega2[k - 1] * x[k - 1] : 0);
    }
    for (std::size_t k = n; k-- > 0;) x[k] = x[k] / omega2[k] + (k + 1 < n ? gamma[k + 1] / omega2[k] * x[k + 1] : 0);
    for (std::size_t k = 0; k < n; ++k) x[k] *= scale[k];
    return x;
}

vec by_elimination(system_of s)
{
    const int n = static_cast<int>(s.diagonal.size());
#ifdef STRESS_HAVE_LAPACK
    const int one = 1;
    int info = 0;
    dptsv_(&n, &one, s.diagonal.data(), s.beside.data(), s.right.data(), &n, &info);
    if (info != 0) s.right.assign(s.right.size(), NAN);  // it takes the matrix for singular
#else
    for (std::size_t k = 1; k < s.right.size(); ++k) {
        const double l = s.beside[k - 1] / s.diagonal[k - 1];
        s.diagonal[k] -= l * s.beside[k - 1];
        s.right[k] -= l * s.right[k - 1];
    }
    for (std::size_t k = static_cast<std::size_t>(n); k-- > 0;) {
        if (k + 1 < s.right.size()) s.right[k] -= s.beside[k] * s.right[k + 1];
        s.right[k] /= s.diagonal[k];
    }
#endif
    return s.right;
}

hostile_chain straight(std::int64_t n, double light, double bend, bool fixed_ends)
{
    hostile_chain c;
    random_stream stream = random_seed(static_cast<std::uint64_t>(n));
    c.n_bonds = n;
    const std::size_t atoms = static_cast<std::size_t>(n) + 1;
    double u[3];
    random_direction(&stream, u);
    for (std::size_t i = 0; i < atoms; ++i) {
        const double m = i % 2 ? light : 1;
        const bool fixed = fixed_ends && (i == 0 || i + 1 == atoms);
        c.w.push_back(fixed ? 0 : 1 / m);
        c.mass.push_back(fixed ? 0 : 1 / (1 / m));
        for (int x = 0; x < 3; ++x) {
            c.r.push_back(static_cast<double>(i) * u[x] + bend * random_normal(&stream));
            c.v.push_back(fixed ? 0 : std::sqrt(c.w.back()) * random_normal(&stream));
            c.f.push_back(random_normal(&stream));
        }
    }
    complete(c, 1e-3);
    return c;
}

double worst(const vec &x, const solution &reference)
{
    long double largest = 0;
    for (std::size_t k = 0; k < x.size(); ++k) {
        const long double e = std::fabs(x[k] - reference.lambda[k]) / (DBL_EPSILON * reference.lambda_scale[k]);
        if (!(e <= largest)) largest = e;
    }
    return static_cast<double>(largest);
}

std::int64_t undecided = 0, chains = 0;

bool print(const char *family, const hostile_chain &c)
{
    const solution_problem p = c.problem();
    const exact_metric exact = metric_of(p);
    solution reference;
    ++chains;
    if (!is_decided(c, exact)) return ++undecided, true;
    if (!exact.regular || solution_forces(&p, &reference)) return true;
    const library_results library = compute(arrange({&c}, 0), 1);
    const system_of s(c);
    const double error = worst(library.lambda, reference);
    const double bound = static_cast<double>(oracle_bound(c.n_bonds));
    std::printf("%-12s %10.3Le %10.3e %10.3e %10.3e %10.3e\n", family, exact.condition, error,
                worst(by_printed_recursion(s), reference), worst(by_elimination(s), reference), bound);
    solution_free(&reference);
    return library.forces == HOL_OK && error <= bound;
}

}  // namespace

int main()
{
    bool right = true;
    std::printf("# family      condition    library    printed      dptsv      bound\n");
    for (std::int64_t n = 1; n <= 16384; n *= 2) right = print("straight", straight(n, 1, 1e-9, false)) && right;
    for (int e = 0; e <= 15; ++e) right = print("light-joints", straight(64, std::pow(10.0, -e), 1e-9, false)) && right;
    for (int e = 0; e <= 14; ++e) right = print("taut", straight(64, 1, std::pow(10.0, -e / 2.0), true)) && right;
    return right ? status_of_undecided(undecided, chains) : 1;
}
