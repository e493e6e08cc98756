#include "networks/peers.hpp"

#include <Eigen/CholmodSupport>
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <new>

namespace bench {

namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Vector = Eigen::VectorXd;

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

Eigen::Map<const Vector> vector_of(const std::vector<double> &x) {
    return {x.data(), static_cast<Eigen::Index>(x.size())};
}

/** CHOLMOD with a look at what it has done. */
struct Cholmod : Eigen::CholmodDecomposition<Sparse, Eigen::Lower> {
    double entries() const {
        if (!m_cholmodFactor) return 0;
        if (m_cholmodFactor->is_super) return static_cast<double>(m_cholmodFactor->xsize);
        return static_cast<double>(m_cholmodFactor->nzmax);
    }
};

}  // namespace

struct BondMatrix::Parts {
    /** What a pair of bonds at one atom adds: to which element, and 4 / m with its sign. */
    struct Term {
        std::int64_t element, k, l;
        double factor;
    };
    const Network &network;
    Sparse lower;
    std::vector<Term> terms;
    std::vector<double> at_r, d;  // positions; [n_bonds][3]
    Cholmod direct;
    bool analysed = false;

    explicit Parts(const Network &of) : network(of), d(3 * of.lengths.size()) {
        std::vector<std::vector<std::int64_t>> bonds_of(of.masses.size());
        for (std::int64_t k = 0; k < of.n_bonds(); ++k)
            for (std::size_t end = 0; end < 2; ++end) bonds_of[at(of.pairs[2 * at(k) + end])].push_back(k);
        std::vector<Eigen::Triplet<double>> elements;
        const auto each = [&](const std::function<void(std::int64_t, std::int64_t, double)> &body) {
            for (std::size_t i = 0; i < bonds_of.size(); ++i)
                for (const std::int64_t k : bonds_of[i])
                    for (const std::int64_t l : bonds_of[i]) {
                        if (k < l) continue;
                        const auto sign = [&](std::int64_t b) {
                            return of.pairs[2 * at(b)] == static_cast<std::int64_t>(i) ? -1.0 : 1.0;
                        };
                        body(k, l, 4 * sign(k) * sign(l) / of.masses[i]);
                    }
        };
        each([&](std::int64_t k, std::int64_t l, double) {
            elements.emplace_back(static_cast<int>(k), static_cast<int>(l), 1.0);
        });
        lower.resize(static_cast<Eigen::Index>(of.n_bonds()), static_cast<Eigen::Index>(of.n_bonds()));
        lower.setFromTriplets(elements.begin(), elements.end());
        each([&](std::int64_t k, std::int64_t l, double factor) {
            terms.push_back({static_cast<std::int64_t>(&lower.coeffRef(k, l) - lower.valuePtr()), k, l, factor});
        });
    }
};

BondMatrix::BondMatrix(const Network &network) : parts(new Parts(network)) {}
BondMatrix::~BondMatrix() = default;
const Network &BondMatrix::network() const { return parts->network; }

void BondMatrix::assemble(const std::vector<double> &r) {
    const Network &n = parts->network;
    parts->at_r = r;
    for (std::int64_t k = 0; k < n.n_bonds(); ++k) n.bond(r, k, &parts->d[3 * at(k)]);
    double *const value = parts->lower.valuePtr();
    std::fill(value, value + parts->lower.nonZeros(), 0.0);
    for (const Parts::Term &t : parts->terms) {
        const double *const k = &parts->d[3 * at(t.k)], *const l = &parts->d[3 * at(t.l)];
        value[t.element] += t.factor * (k[0] * l[0] + k[1] * l[1] + k[2] * l[2]);
    }
}

std::vector<double> BondMatrix::refined(const std::vector<double> &rhs) {
    Parts &p = *parts;
    if (!p.analysed) p.direct.analyzePattern(p.lower);
    p.analysed = true;
    p.direct.factorize(p.lower);
    const std::size_t n = rhs.size();
    std::vector<long double> x(n), left(n), d(3 * n);  // d: as the coordinates are, unrounded
    for (std::size_t k = 0; k < n; ++k)
        for (std::size_t c = 0; c < 3; ++c) {
            const std::int64_t *const pair = &p.network.pairs[2 * k];
            const long double whole =
                                  static_cast<long double>(p.at_r[3 * at(pair[1]) + c]) - p.at_r[3 * at(pair[0]) + c],
                              side = p.network.side[c];
            d[3 * k + c] = side > 0 ? whole - side * std::nearbyint(whole / side) : whole;
        }
    for (int round = 0; round < 6; ++round) {
        for (std::size_t k = 0; k < n; ++k) left[k] = rhs[k];
        // From the coordinates themselves, so that no rounding of bonds and elements counts.
        for (const Parts::Term &t : p.terms) {
            const long double *const k = &d[3 * at(t.k)], *const l = &d[3 * at(t.l)];
            const long double product = k[0] * l[0] + k[1] * l[1] + k[2] * l[2];
            left[at(t.k)] -= t.factor * product * x[at(t.l)];
            if (t.k != t.l) left[at(t.l)] -= t.factor * product * x[at(t.k)];
        }
        Vector correction(static_cast<Eigen::Index>(n));
        for (std::size_t k = 0; k < n; ++k) correction[static_cast<Eigen::Index>(k)] = static_cast<double>(left[k]);
        correction = p.direct.solve(correction);
        for (std::size_t k = 0; k < n; ++k) x[k] += correction[static_cast<Eigen::Index>(k)];
    }
    return {x.begin(), x.end()};
}

namespace {

std::vector<double> solved(const Vector &x) { return {x.data(), x.data() + x.size()}; }

Peer cholmod() {
    const auto solver = std::make_shared<Cholmod>();
    const auto check = [solver] {
        if (solver->info() != Eigen::Success) throw std::bad_alloc();
    };
    return {"CHOLMOD",
            [=](const BondMatrix &z) {
                solver->analyzePattern(z.parts->lower);
                check();
            },
            [=](const BondMatrix &z) {
                solver->factorize(z.parts->lower);
                check();
            },
            [=](const std::vector<double> &rhs) { return solved(solver->solve(vector_of(rhs))); },
            [] { return 0L; },
            [=] { return solver->entries(); }};
}

template <class Preconditioner>
Peer conjugate_gradients(const std::string &name) {
    using Solver = Eigen::ConjugateGradient<Sparse, Eigen::Lower, Preconditioner>;
    const auto solver = std::make_shared<Solver>();
    solver->setTolerance(1e-14);
    solver->setMaxIterations(2000);
    return {name,
            [=](const BondMatrix &z) { solver->analyzePattern(z.parts->lower); },
            [=](const BondMatrix &z) { solver->factorize(z.parts->lower); },
            [=](const std::vector<double> &rhs) { return solved(solver->solve(vector_of(rhs))); },
            [=] { return static_cast<long>(solver->iterations()); },
            [=] { return 0.0; }};
}

}  // namespace

std::vector<Peer> peers() {
    return {cholmod(), conjugate_gradients<Eigen::DiagonalPreconditioner<double>>("gradients, diagonal"),
            conjugate_gradients<Eigen::IncompleteCholesky<double, Eigen::Lower>>("gradients, incomplete factor")};
}

int project(BondMatrix &matrix, const Peer &peer, std::vector<double> &r, double tolerance) {
    const Network &n = matrix.network();
    matrix.assemble(n.r);
    const std::vector<double> reference = matrix.parts->d;
    peer.factorize(matrix);
    std::vector<double> left(n.lengths.size());
    for (int round = 0; round < 100; ++round) {
        double worst = 0;
        for (std::int64_t k = 0; k < n.n_bonds(); ++k) {
            double d[3];
            n.bond(r, k, d);
            const double a2 = n.lengths[at(k)] * n.lengths[at(k)];
            left[at(k)] = d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - a2;
            worst = std::max(worst, std::abs(left[at(k)]) / a2);
        }
        if (worst <= tolerance) return round;
        if (!(worst < 1e3)) return -1;
        const std::vector<double> t = peer.solve(left);
        for (std::int64_t k = 0; k < n.n_bonds(); ++k) {
            const std::size_t i = at(n.pairs[2 * at(k)]), j = at(n.pairs[2 * at(k) + 1]);
            for (std::size_t c = 0; c < 3; ++c) {
                const double pull = 2 * t[at(k)] * reference[3 * at(k) + c];
                r[3 * i + c] += pull / n.masses[i];
                r[3 * j + c] -= pull / n.masses[j];
            }
        }
    }
    return -1;
}

}  // namespace bench
