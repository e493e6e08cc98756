#include "molecule_errors.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "elimination.hpp"

namespace bench {
namespace {

using Long = long double;
using Sparse = Eigen::SparseMatrix<Long>;
using Column = Eigen::Matrix<Long, Eigen::Dynamic, 1>;

std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// NaN becomes infinite; maxima would lose it.
double size_of(Long x) {
    const double size = static_cast<double>(std::fabs(x));
    return std::isnan(size) ? std::numeric_limits<double>::infinity() : size;
}

/// Calls act(bond number, kind, k, first atom, second atom) for every bond.
template <class Act>
void for_each_bond(const Molecules &m, const Act &act) {
    for (const Molecules::Place &place : m.places) {
        const Kind &kind = m.kind_of(place);
        for (std::size_t k = 0; k < kind.n_bonds(); ++k)
            act(kind.length[k], place.atom + at(kind.first[k]), place.atom + at(kind.second[k]));
    }
}

double length_error(const Molecules &m, const std::vector<double> &r) {
    double worst = 0;
    for_each_bond(m, [&](double length, std::size_t i, std::size_t j) {
        Long square = 0;
        for (std::size_t x = 0; x < 3; ++x) square += std::pow(static_cast<Long>(r[3 * j + x]) - r[3 * i + x], 2);
        worst = std::max(worst, size_of(square / (static_cast<Long>(length) * length) - 1));
    });
    return worst;
}

double rate_error(const Molecules &m, const std::vector<double> &v) {
    double worst = 0;
    Long squares = 0;
    for (double x : v) squares += static_cast<Long>(x) * x;
    const Long rms = std::sqrt(squares / static_cast<Long>(v.size()));
    for_each_bond(m, [&](double length, std::size_t i, std::size_t j) {
        Long rate = 0;
        for (std::size_t x = 0; x < 3; ++x)
            rate +=
                (static_cast<Long>(m.r[3 * j + x]) - m.r[3 * i + x]) * (static_cast<Long>(v[3 * j + x]) - v[3 * i + x]);
        worst = std::max(worst, size_of(rate / (rms * length)));
    });
    return worst;
}

/// One molecule's equations A t = b.
struct Equations {
    const Kind &kind;
    const double *r, *v, *f;
    std::vector<Long> d, w;
    Sparse lower;
    Column right;

    Equations(const Molecules &m, const Molecules::Place &place)
        : kind(m.kind_of(place)), r(&m.r[3 * place.atom]), v(&m.v[3 * place.atom]), f(&m.f[3 * place.atom]) {
        const int n = static_cast<int>(kind.n_bonds());
        // 1/m of the mass that was given, as the reference of the tests has it: w is rounded already.
        for (double x : kind.w) w.push_back(x);
        d.resize(3 * kind.n_bonds());
        right.resize(n);
        std::vector<Eigen::Triplet<Long>> entries;
        for (int k = 0; k < n; ++k) {
            const int i = kind.first[at(k)], j = kind.second[at(k)];
            Long sum = 0;
            for (int x = 0; x < 3; ++x) {
                const Long bond = static_cast<Long>(r[3 * j + x]) - r[3 * i + x],
                           dv = static_cast<Long>(v[3 * j + x]) - v[3 * i + x];
                d[at(3 * k + x)] = bond;
                sum += bond * (w[at(j)] * f[3 * j + x] - w[at(i)] * f[3 * i + x]) + dv * dv;
            }
            right[k] = sum;
            entries.emplace_back(k, k, (w[at(i)] + w[at(j)]) * dot(k, k));
        }
        for (const auto &pair : coupled_bonds(kind))
            entries.emplace_back(pair.first, pair.second,
                                 coupling_factor(kind, pair.first, pair.second) * dot(pair.first, pair.second));
        lower.resize(n, n);
        lower.setFromTriplets(entries.begin(), entries.end());
    }
    Long dot(int k, int l) const {
        Long sum = 0;
        for (int x = 0; x < 3; ++x) sum += d[at(3 * k + x)] * d[at(3 * l + x)];
        return sum;
    }
    /// S of the scale, for multipliers t.
    Column terms(const Column &t) const {
        std::vector<Long> a(3 * kind.n_atoms());
        for (std::size_t i = 0; i < a.size(); ++i) a[i] = f[i];
        for (std::size_t k = 0; k < kind.n_bonds(); ++k)
            for (std::size_t x = 0; x < 3; ++x) {
                const Long pull = t[static_cast<int>(k)] * d[3 * k + x];
                a[3 * at(kind.first[k]) + x] += pull;
                a[3 * at(kind.second[k]) + x] -= pull;
            }
        for (std::size_t i = 0; i < a.size(); ++i) a[i] *= w[i / 3];
        Column s(t.size());
        for (std::size_t k = 0; k < kind.n_bonds(); ++k) {
            const std::size_t i = 3 * at(kind.first[k]), j = 3 * at(kind.second[k]);
            Long sum = 0, along_i = 0, along_j = 0;
            for (std::size_t x = 0; x < 3; ++x) {
                const Long bond = d[3 * k + x], dv = static_cast<Long>(v[j + x]) - v[i + x];
                sum += std::fabs(bond) * (w[i / 3] * std::fabs(f[i + x]) + w[j / 3] * std::fabs(f[j + x])) + dv * dv;
                along_i += bond * a[i + x];
                along_j += bond * a[j + x];
            }
            s[static_cast<int>(k)] = sum + std::fabs(along_i) + std::fabs(along_j);
        }
        return s;
    }
};

}  // namespace

MoleculeReference::MoleculeReference(const Molecules &m, Level level, std::size_t bonds_at_most)
    : molecules_(m), level_(level) {
    if (level != Level::acceleration) return;
    // Every bond costs a solve of its molecule: all bonds of small molecules, a few of large ones.
    const std::size_t each = static_cast<std::size_t>(std::max<std::int64_t>(m.bonds, 1));
    const std::size_t wanted =
        std::clamp<std::size_t>(bonds_at_most / each, 1, std::min<std::size_t>(m.n_chains(), 200));
    const std::size_t per_molecule = std::clamp<std::size_t>(4000000 / each, 8, 200);
    for (std::size_t i = 0; i < wanted; ++i) add_molecule(m.places[i * m.n_chains() / wanted], per_molecule);
}

void MoleculeReference::add_molecule(const Molecules::Place &place, std::size_t bonds_wanted) {
    const Equations e(molecules_, place);
    const Eigen::SimplicialLDLT<Sparse> factors(e.lower);
    Column t = factors.solve(e.right);
    const Column residual = e.right - e.lower.selfadjointView<Eigen::Lower>() * t;
    t += factors.solve(residual);
    const Column terms = e.terms(t);
    const std::size_t n = e.kind.n_bonds(), count = std::min(n, bonds_wanted);
    for (std::size_t i = 0; i < count; ++i) {
        const auto k = static_cast<Eigen::Index>(i * n / count);
        const Column inverse = factors.solve(Column::Unit(static_cast<Eigen::Index>(n), k));
        exact_.push_back({place.bond + static_cast<std::size_t>(k), t[k] / 2, inverse.cwiseAbs().dot(terms) / 2});
    }
}

double MoleculeReference::error(const State &s) const {
    if (level_ == Level::position) return length_error(molecules_, s.r);
    if (level_ == Level::velocity) return rate_error(molecules_, s.v);
    double worst = 0;
    for (const Exact &e : exact_) worst = std::max(worst, size_of((s.lambda[e.bond] - e.lambda) / e.scale));
    return worst;
}

}  // namespace bench
