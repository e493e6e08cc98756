// Accelerations and velocities of molecules of any shape by a sparse L D L^T: A t = b, t = 2 lambda,
// A_kl = sum over shared atoms of s s w d_k.d_l, b_k = d_k.(w_j f_j - w_i f_i) + |v_j - v_i|^2 or d_k.(v_j - v_i).
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <memory>

#include "../molecules/elimination.hpp"
#include "graph_methods.hpp"

namespace bench {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

double right_side(Level level, const Kind &kind, int i, int j, const double *d, const double *v, const double *f) {
    double sum = 0;
    for (int c = 0; c < 3; ++c) {
        const double dv = v[3 * j + c] - v[3 * i + c];
        if (level == Level::velocity)
            sum += d[c] * dv;
        else
            sum += d[c] * (kind.w[at(j)] * f[3 * j + c] - kind.w[at(i)] * f[3 * i + c]) + dv * dv;
    }
    return sum;
}

/// G_i -= s t d, or v_i -= w_i s t d.
void apply(Level level, const Kind &kind, int i, int j, const double *d, double t, double *x) {
    const double pull = level == Level::velocity ? kind.w[at(i)] * t : t;
    const double push = level == Level::velocity ? kind.w[at(j)] * t : t;
    for (int c = 0; c < 3; ++c) {
        x[3 * i + c] += pull * d[c];
        x[3 * j + c] -= push * d[c];
    }
}

/// By the list of the benchmark's own.
struct Listed {
    Elimination list;
    Factors factors;
    std::vector<double> d, x;
    explicit Listed(const Kind &kind) : list(kind), factors(list), d(3 * list.n()), x(list.n()) {}
    void solve() {
        factors.assemble(d.data());
        factors.factor_symmetric(x.data());
        factors.back_symmetric(x.data());
    }
    std::size_t bond(std::size_t k) const { return at(list.bond[k]); }
};

/// By Eigen's class, bonds in their own order: it finds its own.
struct Simplicial {
    std::vector<double> d;
    Eigen::VectorXd x;
    explicit Simplicial(const Kind &kind) : d(3 * kind.n_bonds()), coupled_(coupled_bonds(kind)) {
        const int n = static_cast<int>(kind.n_bonds());
        x.resize(n);
        std::vector<Eigen::Triplet<double>> entries;
        for (int k = 0; k < n; ++k) entries.emplace_back(k, k, 1.0);
        for (const auto &pair : coupled_) {
            entries.emplace_back(pair.first, pair.second, 1.0);
            factor_.push_back(coupling_factor(kind, pair.first, pair.second));
        }
        for (std::size_t k = 0; k < kind.n_bonds(); ++k)
            w_.push_back(kind.w[at(kind.first[k])] + kind.w[at(kind.second[k])]);
        matrix_.resize(n, n);
        matrix_.setFromTriplets(entries.begin(), entries.end());
        for (const auto &pair : coupled_) place_.push_back(&matrix_.coeffRef(pair.first, pair.second));
        for (int k = 0; k < n; ++k) diagonal_.push_back(&matrix_.coeffRef(k, k));
        solver_.analyzePattern(matrix_);
    }
    Simplicial(const Simplicial &) = delete;
    Simplicial &operator=(const Simplicial &) = delete;
    void solve() {
        auto dot = [this](std::size_t k, std::size_t l) {
            return d[3 * k] * d[3 * l] + d[3 * k + 1] * d[3 * l + 1] + d[3 * k + 2] * d[3 * l + 2];
        };
        for (std::size_t k = 0; k < w_.size(); ++k) *diagonal_[k] = w_[k] * dot(k, k);
        for (std::size_t c = 0; c < coupled_.size(); ++c)
            *place_[c] = factor_[c] * dot(at(coupled_[c].first), at(coupled_[c].second));
        solver_.factorize(matrix_);
        x = solver_.solve(x);
    }
    static std::size_t bond(std::size_t k) { return k; }

private:
    std::vector<std::pair<int, int>> coupled_;
    std::vector<double> factor_, w_;
    std::vector<double *> place_, diagonal_;
    Eigen::SparseMatrix<double> matrix_;  ///< lower triangle
    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

template <class System>
void work(Level level, const Molecules &m, const Molecules::Place &place, System &s, State &state) {
    const Kind &kind = m.kind_of(place);
    const double *r = &m.r[3 * place.atom], *f = &m.f[3 * place.atom];
    const double *v = level == Level::velocity ? &state.v[3 * place.atom] : &m.v[3 * place.atom];
    const std::size_t n = kind.n_bonds();
    for (std::size_t k = 0; k < n; ++k) {
        const int i = kind.first[s.bond(k)], j = kind.second[s.bond(k)];
        for (std::size_t c = 0; c < 3; ++c) s.d[3 * k + c] = r[3 * at(j) + c] - r[3 * at(i) + c];
        s.x[static_cast<Eigen::Index>(k)] = right_side(level, kind, i, j, &s.d[3 * k], v, f);
    }
    s.solve();
    double *out = level == Level::velocity ? &state.v[3 * place.atom] : &state.g[3 * place.atom];
    if (level != Level::velocity) std::fill(out, out + 3 * kind.n_atoms(), 0.0);
    for (std::size_t k = 0; k < n; ++k) {
        const double t = s.x[static_cast<Eigen::Index>(k)];
        state.lambda[place.bond + s.bond(k)] = 0.5 * t;
        apply(level, kind, kind.first[s.bond(k)], kind.second[s.bond(k)], &s.d[3 * k], t, out);
    }
}

template <class System>
Method made(const std::string &name, const std::string &setting, Level level, const Molecules &m) {
    auto systems = std::make_shared<std::vector<std::unique_ptr<System>>>();
    for (const Kind &kind : m.kinds) systems->push_back(std::make_unique<System>(kind));
    return {name, setting, [level, &m, systems](State &state) {
                for (const Molecules::Place &place : m.places) work(level, m, place, *(*systems)[place.kind], state);
            }};
}

}  // namespace

Method graph_direct(Level level, const Molecules &m) { return made<Listed>("sparse-ldl", "pattern reused", level, m); }

Method graph_eigen(Level level, const Molecules &m) {
    return made<Simplicial>("eigen-simplicial", "pattern reused", level, m);
}

}  // namespace bench
