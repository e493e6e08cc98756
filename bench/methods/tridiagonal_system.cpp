#include "tridiagonal_system.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

namespace bench {
namespace {

double dot(const double *a, const double *b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

}  // namespace

void assemble_matrix(const Problem &p, const double *r, System &s) {
    const std::size_t n = p.n();
    const double *w = p.w.data();
    for (std::size_t i = 0; i < 3 * n; ++i) s.d[i] = r[i + 3] - r[i];
    for (std::size_t k = 0; k < n; ++k) {
        const double *d = &s.d[3 * k];
        s.diagonal[k] = 4 * (w[k] + w[k + 1]) * dot(d, d);
        s.beside[k] = k + 1 < n ? -4 * w[k + 1] * dot(d, d + 3) : 0;
    }
}

void assemble_forces(const Problem &p, const double *v, const double *f, System &s) {
    const double *w = p.w.data();
    for (std::size_t k = 0; k < p.n(); ++k) {
        double sum = 0, square = 0;
        for (std::size_t x = 3 * k; x < 3 * k + 3; ++x) {
            const double dv = v[x + 3] - v[x];
            sum += s.d[x] * (w[k + 1] * f[x + 3] - w[k] * f[x]);
            square += dv * dv;
        }
        s.x[k] = 2 * (sum + square);
    }
}

void apply_forces(const System &s, double *g) {
    const std::size_t n = s.x.size();
    double last[3] = {0, 0, 0};
    for (std::size_t k = 0; k < n; ++k)
        for (std::size_t x = 0; x < 3; ++x) {
            const double pull = 2 * s.x[k] * s.d[3 * k + x];
            g[3 * k + x] = pull - last[x];
            last[x] = pull;
        }
    for (std::size_t x = 0; x < 3; ++x) g[3 * n + x] = -last[x];
}

Method direct_forces(const Problem &p, const std::string &name, const std::string &setting, Solver solver) {
    auto s = std::make_shared<System>(p.n());
    return {name, setting, [&p, s, solver](State &state) {
                for (std::size_t c = 0; c < p.n_chains(); ++c) {
                    const std::size_t atom = 3 * p.first_atom(c);
                    assemble_matrix(p, &p.r[atom], *s);
                    assemble_forces(p, &p.v[atom], &p.f[atom], *s);
                    solver(*s);
                    std::copy(s->x.begin(), s->x.end(), &state.lambda[c * p.n()]);
                    apply_forces(*s, &state.g[atom]);
                }
            }};
}

Method direct_velocities(const Problem &p, const std::string &name, const std::string &setting, Solver solver) {
    auto s = std::make_shared<System>(p.n());
    return {name, setting, [&p, s, solver](State &state) {
                const double *w = p.w.data();
                for (std::size_t c = 0; c < p.n_chains(); ++c) {
                    const std::size_t atom = 3 * p.first_atom(c);
                    double *v = &state.v[atom];
                    assemble_matrix(p, &p.r[atom], *s);
                    for (std::size_t k = 0; k < p.n(); ++k) {
                        double sum = 0;
                        for (std::size_t x = 3 * k; x < 3 * k + 3; ++x) sum += s->d[x] * (v[x + 3] - v[x]);
                        s->x[k] = 2 * sum;
                    }
                    solver(*s);
                    for (std::size_t k = 0; k < p.n(); ++k)
                        for (std::size_t x = 3 * k; x < 3 * k + 3; ++x) {
                            const double pull = 2 * s->x[k] * s->d[x];
                            v[x] += w[k] * pull;
                            v[x + 3] -= w[k + 1] * pull;
                        }
                }
            }};
}

UnitSystems::UnitSystems(const Problem &p) : gamma(p.all_bonds()), right_side(p.all_bonds()) {
    System s(p.n());
    for (std::size_t c = 0; c < p.n_chains(); ++c) {
        const std::size_t atom = 3 * p.first_atom(c), first = c * p.n();
        assemble_matrix(p, &p.r[atom], s);
        assemble_forces(p, &p.v[atom], &p.f[atom], s);
        for (std::size_t k = 0; k < p.n(); ++k) {
            right_side[first + k] = s.x[k] / std::sqrt(s.diagonal[k]);
            if (k > 0) gamma[first + k] = -s.beside[k - 1] / std::sqrt(s.diagonal[k - 1] * s.diagonal[k]);
        }
    }
}

Method direct_solve(const Problem &p, const UnitSystems &systems, const std::string &name, const std::string &setting,
                    Solver solver) {
    auto s = std::make_shared<System>(p.n());
    return {name, setting, [&p, &systems, s, solver](State &state) {
                const std::size_t n = p.n();
                for (std::size_t c = 0; c < p.n_chains(); ++c) {
                    const double *gamma = &systems.gamma[c * n], *b = &systems.right_side[c * n];
                    for (std::size_t k = 0; k < n; ++k) {
                        s->diagonal[k] = 1;
                        s->beside[k] = k + 1 < n ? -gamma[k + 1] : 0;
                        s->x[k] = b[k];
                    }
                    solver(*s);
                    std::copy(s->x.begin(), s->x.end(), &state.lambda[c * n]);
                }
            }};
}

Method direct_metric(const Problem &p, const std::string &name, const std::string &setting, LogDeterminant log_det) {
    auto s = std::make_shared<System>(p.n());
    return {name, setting, [&p, s, log_det](State &state) {
                for (std::size_t c = 0; c < p.n_chains(); ++c) {
                    assemble_matrix(p, &p.r[3 * p.first_atom(c)], *s);
                    double last = 1;
                    for (std::size_t k = 0; k < p.n(); ++k) {
                        const double root = std::sqrt(s->diagonal[k]);
                        if (k > 0) s->beside[k - 1] /= last * root;
                        s->diagonal[k] = 1;
                        last = root;
                    }
                    state.log_det[c] = log_det(*s);
                }
            }};
}

}  // namespace bench
