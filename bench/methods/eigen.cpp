// Eigen's dense LDL^T, and its sparse one with the pattern analysed once.
#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <cmath>
#include <memory>

#include "methods.hpp"

namespace bench {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

class Simplicial {
public:
    /// Lower triangle by columns: each has its diagonal element and, but for the last, the one below.
    const Eigen::SimplicialLDLT<Sparse> &factor(const System &s) {
        const Eigen::Index n = s.size();
        if (matrix_.rows() != n) prepare(n);
        double *value = matrix_.valuePtr();
        for (std::size_t k = 0; k < s.diagonal.size(); ++k) {
            *value++ = s.diagonal[k];
            if (k + 1 < s.diagonal.size()) *value++ = s.beside[k];
        }
        solver_.factorize(matrix_);
        return solver_;
    }

private:
    void prepare(Eigen::Index n) {
        matrix_.resize(n, n);
        matrix_.reserve(Eigen::VectorXi::Constant(n, 2));
        for (Eigen::Index k = 0; k < n; ++k) {
            matrix_.insert(k, k) = 1;
            if (k + 1 < n) matrix_.insert(k + 1, k) = 0;
        }
        matrix_.makeCompressed();
        solver_.analyzePattern(matrix_);
    }
    Sparse matrix_;
    Eigen::SimplicialLDLT<Sparse> solver_;
};

const Eigen::LDLT<Eigen::MatrixXd> &factor_dense(const System &s, Eigen::MatrixXd &m,
                                                 Eigen::LDLT<Eigen::MatrixXd> &ldlt) {
    const Eigen::Index n = s.size();
    m.setZero(n, n);
    for (Eigen::Index k = 0; k < n; ++k) {
        const auto at = static_cast<std::size_t>(k);
        m(k, k) = s.diagonal[at];
        if (k + 1 < n) m(k + 1, k) = m(k, k + 1) = s.beside[at];
    }
    return ldlt.compute(m);
}

struct Dense {
    Eigen::MatrixXd matrix;
    Eigen::LDLT<Eigen::MatrixXd> ldlt;
};

template <class Diagonal>
double log_det_of(const Diagonal &pivots) {
    double sum = 0;
    for (Eigen::Index k = 0; k < pivots.size(); ++k) sum += std::log(pivots[k]);
    return sum;
}

}  // namespace

Solver eigen_ldlt() {
    auto dense = std::make_shared<Dense>();
    return [dense](System &s) {
        Eigen::Map<Eigen::VectorXd> x(s.x.data(), s.size());
        x = factor_dense(s, dense->matrix, dense->ldlt).solve(x);
    };
}

Solver eigen_simplicial() {
    auto simplicial = std::make_shared<Simplicial>();
    return [simplicial](System &s) {
        Eigen::Map<Eigen::VectorXd> x(s.x.data(), s.size());
        x = simplicial->factor(s).solve(x);
    };
}

LogDeterminant eigen_ldlt_log_det() {
    auto dense = std::make_shared<Dense>();
    return [dense](System &s) { return log_det_of(factor_dense(s, dense->matrix, dense->ldlt).vectorD()); };
}

LogDeterminant eigen_simplicial_log_det() {
    auto simplicial = std::make_shared<Simplicial>();
    return [simplicial](System &s) { return log_det_of(simplicial->factor(s).vectorD()); };
}

}  // namespace bench
