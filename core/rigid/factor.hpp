// The factors of a sparse matrix whose pattern is symmetric, without pivoting: of the equations of a molecule, which
// are definite, or nearly so at the level of positions.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/rigid/molecule_kind.hpp"

namespace holonomic::rigid {

inline double first_word(double a) { return a; }
inline double first_word(const DoublePair &a) { return a.hi; }

// T is double or DoublePair. l and u have the pattern below the diagonal and its mirror image.
template <class T>
struct Factor {
    T *diagonal, *l, *u;
    double *before;  // what stood on the diagonal

    // The first row whose pivot is not above `least` times what stood there; -1: all are. On entry the matrix.
    std::int32_t eliminate(const MoleculeKind &s, double least) const {
        const std::int32_t *const start = s.column_start.data(), *const row = s.row.data();
        for (std::int32_t k = 0; k < s.n_rows; ++k) before[k] = first_word(diagonal[k]);
        for (std::int32_t k = 0; k < s.n_rows; ++k) {
            const double pivot = first_word(diagonal[k]);
            if (!(pivot > least * before[k])) return k;
            const std::int32_t begin = start[k], end = start[k + 1];
            for (std::int32_t a = begin; a < end; ++a) l[a] = l[a] / diagonal[k];
            for (std::int32_t a = begin; a < end; ++a) {
                const std::int32_t i = row[a];
                diagonal[i] = diagonal[i] - l[a] * u[a];
                std::int32_t entry = start[i];
                for (std::int32_t b = a + 1; b < end; ++b) {
                    while (row[entry] < row[b]) ++entry;
                    l[entry] = l[entry] - l[b] * u[a];
                    u[entry] = u[entry] - l[a] * u[b];
                }
            }
        }
        return -1;
    }

    void solve(const MoleculeKind &s, T *x) const {
        const std::int32_t *const start = s.column_start.data(), *const row = s.row.data();
        for (std::int32_t k = 0; k < s.n_rows; ++k)
            for (std::int32_t a = start[k]; a < start[k + 1]; ++a) x[row[a]] = x[row[a]] - l[a] * x[k];
        for (std::int32_t k = s.n_rows - 1; k >= 0; --k) {
            T sum = x[k];
            for (std::int32_t a = start[k]; a < start[k + 1]; ++a) sum = sum - u[a] * x[row[a]];
            x[k] = sum / diagonal[k];
        }
    }
};

}  // namespace holonomic::rigid
