// Positions by linear solves with the whole matrix of a molecule of any shape. Newton, the ILVES way (Lopez-Villellas
// et al. 2023): the exact Jacobian of the bonds' squared lengths, new bonds times old ones, factored in each iteration.
// Quasi-Newton: the symmetric matrix of the old bonds alone, factored once per step, solved with until the lengths are
// right. Both without exchanges, along a list of operations that is made once per kind.
#include <algorithm>
#include <cmath>
#include <memory>

#include "../molecules/elimination.hpp"
#include "graph_methods.hpp"

namespace bench {
namespace {

struct Solver {
    Elimination list;
    Factors factors;
    std::vector<double> b, d, x;  ///< old and new bonds [n][3], right side; in the order of the steps
    explicit Solver(const Kind &kind) : list(kind), factors(list), b(3 * list.n()), d(b), x(list.n()) {}

    void vectors(const double *r, std::vector<double> &to) const {
        for (std::size_t k = 0; k < list.n(); ++k) {
            const double *i = r + 3 * list.first[k], *j = r + 3 * list.second[k];
            for (std::size_t c = 0; c < 3; ++c) to[3 * k + c] = j[c] - i[c];
        }
    }
    /// New bonds, and in x what each is too long, over two; returns the worst relative excess.
    double excess(const double *r) {
        double worst = 0;
        for (std::size_t k = 0; k < list.n(); ++k) {
            const double *i = r + 3 * list.first[k], *j = r + 3 * list.second[k];
            double square = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                d[3 * k + c] = j[c] - i[c];
                square += d[3 * k + c] * d[3 * k + c];
            }
            const double wanted = list.length[k] * list.length[k], over = square - wanted;
            x[k] = 0.5 * over;
            const double relative = std::abs(over) / wanted;
            worst = relative > worst ? relative : worst;
        }
        return worst;
    }
    void move(const Kind &kind, double *r) const {
        for (std::size_t k = 0; k < list.n(); ++k) {
            const auto i = static_cast<std::size_t>(list.first[k]), j = static_cast<std::size_t>(list.second[k]);
            const double pull = kind.w[i] * x[k], push = kind.w[j] * x[k];
            for (std::size_t c = 0; c < 3; ++c) {
                r[3 * i + c] += pull * b[3 * k + c];
                r[3 * j + c] -= push * b[3 * k + c];
            }
        }
    }
};

std::int64_t newton(const Kind &kind, Solver &s, double tolerance, double *r) {
    const int iterations_at_most = 16;
    for (int iteration = 0; iteration < iterations_at_most; ++iteration) {
        if (s.excess(r) <= tolerance) return iteration;
        s.factors.assemble(s.d.data(), s.b.data());
        s.factors.factor(s.x.data());
        s.factors.back(s.x.data());
        s.move(kind, r);
    }
    return iterations_at_most;
}

std::int64_t quasi_newton(const Kind &kind, Solver &s, double tolerance, double *r) {
    const int iterations_at_most = 100;
    double before = s.excess(r);
    if (before <= tolerance) return 0;
    s.factors.assemble(s.b.data());
    s.factors.factor_symmetric(s.x.data());
    for (int iteration = 1; iteration <= iterations_at_most; ++iteration) {
        if (iteration > 1) s.factors.forward(s.x.data());
        s.factors.back_symmetric(s.x.data());
        s.move(kind, r);
        const double worst = s.excess(r);
        // Below the rounding of the coordinates it no longer falls; going on would only cost time.
        if (worst <= tolerance || (worst < 1e-9 && worst > 0.5 * before)) return iteration;
        before = worst;
    }
    return iterations_at_most;
}

using Iteration = std::int64_t (*)(const Kind &, Solver &, double, double *);

Method made(const std::string &name, const Molecules &m, double tolerance, Iteration iterate) {
    auto solvers = std::make_shared<std::vector<std::unique_ptr<Solver>>>();
    for (const Kind &kind : m.kinds) solvers->push_back(std::make_unique<Solver>(kind));
    return {name, tolerance_setting(tolerance), [&m, tolerance, solvers, iterate](State &state) {
                state.iterations = 0;
                for (const Molecules::Place &place : m.places) {
                    Solver &s = *(*solvers)[place.kind];
                    s.vectors(&m.r[3 * place.atom], s.b);
                    const std::int64_t count = iterate(m.kind_of(place), s, tolerance, &state.r[3 * place.atom]);
                    state.iterations = std::max(state.iterations, count);
                }
            }};
}

}  // namespace

Method graph_newton(const Molecules &m, double tolerance) { return made("sparse-newton", m, tolerance, newton); }

Method graph_quasi_newton(const Molecules &m, double tolerance) {
    return made("quasi-newton", m, tolerance, quasi_newton);
}

}  // namespace bench
