// Newton's method for the positions with a sparse direct solver, the ILVES way (Lopez-Villellas et al. 2023): the exact
// Jacobian of the bonds' squared lengths, factored without exchanges along a pattern found once for the molecule,
// whatever its shape. Its pattern is symmetric but its values are not (new bonds times old ones), so L and U^T differ
// in their values and share their pattern: an L D L^T in structure. For a chain numbered along itself there is no
// fill-in.
#include <algorithm>
#include <cmath>
#include <memory>

#include "methods.hpp"

namespace bench {
namespace {

const int iterations_at_most = 16;

/// Couplings of one molecule, lower triangle by rows; and for each the products that elimination subtracts from it.
class Pattern {
public:
    struct Entry {
        int column, atom;
        double sign;
    };
    std::vector<int> first, second;  ///< atoms of each bond
    std::vector<int> row;            ///< row k has the entries row[k] .. row[k+1]-1
    std::vector<Entry> entries;

    explicit Pattern(std::size_t n_bonds) {
        const int n = static_cast<int>(n_bonds);
        for (int k = 0; k < n; ++k) {
            first.push_back(k);
            second.push_back(k + 1);
        }
        // Bonds that share an atom, found through the lists of bonds of each atom.
        std::vector<std::vector<int>> bonds_of(n_bonds + 1);
        row.push_back(0);
        for (int k = 0; k < n; ++k) {
            for (int atom : {first[index(k)], second[index(k)]}) {
                for (int j : bonds_of[index(atom)]) {
                    const bool same_end = (first[index(j)] == atom) == (first[index(k)] == atom);
                    entries.push_back({j, atom, same_end ? 1.0 : -1.0});
                }
                bonds_of[index(atom)].push_back(k);
            }
            row.push_back(static_cast<int>(entries.size()));
        }
    }

    static std::size_t index(int i) { return static_cast<std::size_t>(i); }
};

struct Workspace {
    Pattern pattern;
    std::vector<double> b, d;          ///< old and new bonds [n][3]
    std::vector<double> diagonal, x;   ///< [n]
    std::vector<double> lower, upper;  ///< values of J_kj and J_jk per entry
    explicit Workspace(std::size_t n)
        : pattern(n), b(3 * n), d(3 * n), diagonal(n), x(n), lower(pattern.entries.size()),
          upper(pattern.entries.size()) {}
};

double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// New bonds, and what each is too long; returns the worst relative excess.
double excess(const Problem &p, const double *r, Workspace &s) {
    double worst = 0;
    for (std::size_t k = 0; k < p.n(); ++k) {
        const double *from = r + 3 * s.pattern.first[k], *to = r + 3 * s.pattern.second[k];
        double *d = &s.d[3 * k];
        for (int x = 0; x < 3; ++x) d[x] = to[x] - from[x];
        const double square = p.length[k] * p.length[k];
        s.x[k] = dot(d, d) - square;
        worst = std::max(worst, std::abs(s.x[k]) / square);
    }
    return worst;
}

/// J_kj, the derivative of D_k.D_k with respect to t_j, factored and solved in the same sweep over the rows.
void factor_and_solve(const Problem &p, Workspace &s) {
    const Pattern &pattern = s.pattern;
    for (std::size_t k = 0; k < p.n(); ++k) {
        const double *d = &s.d[3 * k], *b = &s.b[3 * k];
        const double w = p.w[Pattern::index(pattern.first[k])] + p.w[Pattern::index(pattern.second[k])];
        double pivot = 2 * w * dot(d, b), x = s.x[k];
        for (int e = pattern.row[k]; e < pattern.row[k + 1]; ++e) {
            const Pattern::Entry &entry = pattern.entries[Pattern::index(e)];
            const std::size_t j = Pattern::index(entry.column);
            const double factor = 2 * entry.sign * p.w[Pattern::index(entry.atom)];
            const double below = factor * dot(d, &s.b[3 * j]) * s.diagonal[j];  // the diagonal holds inverses
            const double above = factor * dot(&s.d[3 * j], b);
            pivot -= below * above;
            x -= below * s.x[j];
            s.lower[Pattern::index(e)] = below;
            s.upper[Pattern::index(e)] = above;
        }
        s.diagonal[k] = 1 / pivot;
        s.x[k] = x;
    }
    for (std::size_t k = p.n(); k-- > 0;) {
        const double x = s.x[k] * s.diagonal[k];
        s.x[k] = x;
        for (int e = pattern.row[k]; e < pattern.row[k + 1]; ++e)
            s.x[Pattern::index(pattern.entries[Pattern::index(e)].column)] -= s.upper[Pattern::index(e)] * x;
    }
}

std::int64_t project(const Problem &p, const double *reference, double tolerance, Workspace &s, double *r) {
    for (std::size_t k = 0; k < p.n(); ++k)
        for (std::size_t x = 0; x < 3; ++x)
            s.b[3 * k + x] = reference[3 * Pattern::index(s.pattern.second[k]) + x] -
                             reference[3 * Pattern::index(s.pattern.first[k]) + x];
    for (int iteration = 0; iteration < iterations_at_most; ++iteration) {
        if (excess(p, r, s) <= tolerance) return iteration;
        factor_and_solve(p, s);
        for (std::size_t k = 0; k < p.n(); ++k) {
            const std::size_t i = Pattern::index(s.pattern.first[k]), j = Pattern::index(s.pattern.second[k]);
            for (std::size_t x = 0; x < 3; ++x) {
                r[3 * i + x] += p.w[i] * s.x[k] * s.b[3 * k + x];
                r[3 * j + x] -= p.w[j] * s.x[k] * s.b[3 * k + x];
            }
        }
    }
    return iterations_at_most;
}

}  // namespace

Method sparse_newton(const Problem &p, double tolerance) {
    auto s = std::make_shared<Workspace>(p.n());
    return {"sparse-newton", tolerance_setting(tolerance), [&p, tolerance, s](State &state) {
                state.iterations = 0;
                for (std::size_t c = 0; c < p.n_chains(); ++c) {
                    const std::size_t atom = 3 * p.first_atom(c);
                    state.iterations =
                        std::max(state.iterations, project(p, &p.r[atom], tolerance, *s, &state.r[atom]));
                }
            }};
}

}  // namespace bench
