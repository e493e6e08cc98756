#include "errors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "linear_solve.hpp"
#include "solution.h"

namespace bench {
namespace {

solution_problem chain_of(const Problem &p, std::size_t chain) {
    solution_problem s = {};
    const std::size_t atom = 3 * p.first_atom(chain);
    s.n_bonds = p.bonds;
    s.mass = p.mass.data();
    s.inverse_mass = p.w.data();
    s.r = &p.r[atom];
    s.v = &p.v[atom];
    s.f = &p.f[atom];
    return s;
}

/// NaN becomes infinite; maxima would lose it.
double size_of(long double x) {
    const double size = static_cast<double>(std::fabs(x));
    return std::isnan(size) ? std::numeric_limits<double>::infinity() : size;
}

double length_error(const Problem &p, const State &s, std::size_t chains) {
    double worst = 0;
    for (std::size_t c = 0; c < chains; ++c)
        for (std::size_t k = 0; k < p.n(); ++k) {
            const double *r = &s.r[3 * (p.first_atom(c) + k)];
            long double square = 0;
            const long double target = static_cast<long double>(p.length[k]) * p.length[k];
            for (int x = 0; x < 3; ++x) {
                const long double d = static_cast<long double>(r[x + 3]) - r[x];
                square += d * d;
            }
            worst = std::max(worst, size_of(square / target - 1));
        }
    return worst;
}

double rate_error(const Problem &p, const State &s, std::size_t chains) {
    double worst = 0;
    long double squares = 0;
    for (double v : s.v) squares += static_cast<long double>(v) * v;
    const long double rms = std::sqrt(squares / static_cast<long double>(s.v.size()));
    for (std::size_t c = 0; c < chains; ++c)
        for (std::size_t k = 0; k < p.n(); ++k) {
            const std::size_t atom = 3 * (p.first_atom(c) + k);
            long double rate = 0;
            for (std::size_t x = atom; x < atom + 3; ++x)
                rate +=
                    (static_cast<long double>(p.r[x + 3]) - p.r[x]) * (static_cast<long double>(s.v[x + 3]) - s.v[x]);
            worst = std::max(worst, size_of(rate / (rms * p.length[k])));
        }
    return worst;
}

}  // namespace

Reference::Reference(const Problem &p, Level level, const UnitSystems *systems, std::size_t bonds_at_most)
    : problem_(p), level_(level) {
    if (level == Level::velocity || level == Level::position) return;  // the constraints themselves are the reference
    const std::size_t wanted =
        std::clamp<std::size_t>(bonds_at_most / p.n(), 1, std::min<std::size_t>(p.n_chains(), 500));
    for (std::size_t i = 0; i < wanted; ++i) chains_.push_back(i * p.n_chains() / wanted);
    auto keep = [this](long double x) {
        exact_.push_back(static_cast<double>(x));
        exact_low_.push_back(static_cast<double>(x - static_cast<long double>(exact_.back())));
    };
    for (std::size_t chain : chains_) {
        const solution_problem problem = chain_of(p, chain);
        if (level == Level::acceleration) {
            solution s = {};
            if (solution_forces(&problem, &s) != 0) throw std::runtime_error("no reference for " + p.name);
            for (std::size_t k = 0; k < p.n(); ++k) {
                keep(s.lambda[k]);
                scale_.push_back(static_cast<double>(s.lambda_scale[k]));
            }
            solution_free(&s);
        } else if (level == Level::metric) {
            solution_metric m = {};
            if (solution_metric_make(&problem, &m) != 0) throw std::runtime_error("no reference for " + p.name);
            keep(m.log_det);
            scale_.push_back(std::fabs(exact_.back()));
            solution_metric_free(&m);
        } else {
            reference::tridiagonal matrix(p.n());
            std::vector<reference::quad> x;
            for (std::size_t k = 0; k < p.n(); ++k) {
                const std::size_t at = chain * p.n() + k;
                matrix.diagonal[k] = 1;
                if (k > 0) matrix.lower[k] = matrix.upper[k - 1] = -reference::quad(systems->gamma[at]);
                x.push_back(systems->right_side[at]);
            }
            if (!reference::solve_banded(matrix, x)) throw std::runtime_error("no reference for " + p.name);
            double largest = 0;
            for (const reference::quad &value : x) {
                keep(static_cast<long double>(value));
                largest = std::max(largest, std::fabs(exact_.back()));
            }
            scale_.insert(scale_.end(), p.n(), largest);
        }
    }
}

double Reference::error(const State &s, double part) const {
    const auto chains = static_cast<std::size_t>(std::ceil(part * static_cast<double>(problem_.n_chains()) - 1e-6));
    if (level_ == Level::position) return length_error(problem_, s, chains);
    if (level_ == Level::velocity) return rate_error(problem_, s, chains);
    double worst = 0;
    std::size_t i = 0;
    for (std::size_t chain : chains_) {
        if (chain >= chains) break;
        const bool per_chain = level_ == Level::metric;
        const double *x = per_chain ? &s.log_det[chain] : &s.lambda[chain * problem_.n()];
        for (std::size_t k = 0; k < (per_chain ? 1 : problem_.n()); ++k, ++i) {
            const long double off = static_cast<long double>(x[k]) - exact_[i] - exact_low_[i];
            if (scale_[i] > 0)
                worst = std::max(worst, size_of(off / scale_[i]));
            else if (!(off == 0))  // exactly zero is what it must be
                worst = std::numeric_limits<double>::infinity();
        }
    }
    return worst;
}

}  // namespace bench
