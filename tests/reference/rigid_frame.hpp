/**
 * @file rigid_frame.hpp
 * Whitened coordinates of a rigid body in wide arithmetic.
 */
#ifndef REFERENCE_RIGID_FRAME_HPP
#define REFERENCE_RIGID_FRAME_HPP

#include <array>
#include <vector>

#include "rigid_solution.hpp"
#include "wide_functions.hpp"

namespace reference
{

/** X_a = c + sum_p y_ap U_p with sum m y = 0 and sum m y y^T = M 1. */
template <class REAL>
struct rigid_frame {
    std::size_t rank = 0;
    REAL mass{0};
    std::vector<std::array<REAL, 3>> y;      // [atoms]
    std::array<vector3<REAL>, 3> vectors{};  // U_p
    std::vector<REAL> z;                     // [atoms] of sites off a plane: + z U_1 x U_2
    body_facts facts;

    /** Lower triangular, or turned to principal axes. */
    rigid_frame(const rigid_problem &p, const std::vector<std::size_t> &atoms, bool principal)
    {
        centre(p, atoms);
        if (!(mass > REAL(0))) return;
        moments(p, atoms);
        flatten(p, atoms);
        factorize(p, atoms);
        if (principal) turn();
        lift();
    }

private:
    using vec = vector3<REAL>;
    static REAL thin()
    {
        return REAL(1e-8);
    }

    std::vector<vec> x_, off_;
    std::array<vec, 3> s_{};

    void centre(const rigid_problem &p, const std::vector<std::size_t> &atoms)
    {
        vec sum{};
        for (const std::size_t a : atoms) {
            x_.push_back({REAL(p.place[3 * a]), REAL(p.place[3 * a + 1]), REAL(p.place[3 * a + 2])});
            mass += REAL(p.mass[a]);
            add_times(sum, REAL(p.mass[a]), x_.back());
        }
        if (!(mass > REAL(0))) return;
        for (vec &x : x_)
            for (std::size_t c = 0; c < 3; ++c) x[c] -= sum[c] / mass;
    }

    void moments(const rigid_problem &p, const std::vector<std::size_t> &atoms)
    {
        s_ = {};
        for (std::size_t a = 0; a < atoms.size(); ++a)
            for (std::size_t c = 0; c < 3; ++c)
                for (std::size_t d = 0; d < 3; ++d) s_[c][d] += REAL(p.mass[atoms[a]]) / mass * x_[a][c] * x_[a][d];
    }

    /** The direction of the largest moment of a matrix whose others are 1e-16 of it, by repeated squaring. */
    static vec leading(std::array<vec, 3> m)
    {
        for (int k = 0; k < 12; ++k) {
            std::array<vec, 3> square{};
            const REAL size = m[0][0] + m[1][1] + m[2][2];
            for (std::size_t c = 0; c < 3; ++c)
                for (std::size_t d = 0; d < 3; ++d) {
                    for (std::size_t e = 0; e < 3; ++e) square[c][d] += m[c][e] * m[e][d];
                    square[c][d] /= size * size;
                }
            m = square;
        }
        std::size_t most = 0;
        for (std::size_t c = 1; c < 3; ++c)
            if (m[c][c] > m[most][most]) most = c;
        vec e = m[most];
        const REAL size = length(e);
        for (REAL &component : e) component /= size;
        return e;
    }

    void note_ratio(const REAL &square)
    {
        if (square > thin() * thin() / REAL(100) && square < thin() * thin() * REAL(100)) facts.flagged = true;
    }

    void lift()
    {
        z.assign(y.size(), REAL(0));
        if (rank != 2) return;
        const vec normal = cross_product(vectors[0], vectors[1]);
        for (std::size_t a = 0; a < z.size(); ++a) z[a] = product(off_[a], normal) / product(normal, normal);
    }

    /** Atoms of a thin body onto its line or plane, but for sites that are clearly off a plane. */
    void flatten(const rigid_problem &p, const std::vector<std::size_t> &atoms)
    {
        off_.assign(x_.size(), {});
        // trace ~ l1, minors ~ l1 l2, determinant = l1 l2 l3, each to a factor of three
        const REAL trace = s_[0][0] + s_[1][1] + s_[2][2];
        if (!(trace > REAL(0))) return;
        std::array<vec, 3> cofactors{};
        for (std::size_t c = 0; c < 3; ++c) cofactors[c] = cross_product(s_[(c + 1) % 3], s_[(c + 2) % 3]);
        const REAL minors = cofactors[0][0] + cofactors[1][1] + cofactors[2][2], det = product(s_[0], cofactors[0]);
        const REAL second = minors / (trace * trace), limit = thin() * thin();
        rank = 1;
        if (second > limit) {
            rank = 2;
            if (det / (minors * trace) > limit) rank = 3;
            note_ratio(det / (minors * trace));
        }
        note_ratio(second);
        REAL extent(0);
        const vec axis = rank == 1 ? leading(s_) : rank == 2 ? leading(cofactors) : vec{};
        for (vec &x : x_) {
            if (length(x) > extent) extent = length(x);
            if (rank == 3) continue;
            const REAL along = product(axis, x);
            vec across = x;
            add_times(across, -along, axis);
            const vec off = rank == 1 ? across : difference(x, across);
            x = difference(x, off);
            off_[static_cast<std::size_t>(&x - x_.data())] = off;
        }
        const REAL most = REAL(4) * thin() * extent;
        facts.rank = static_cast<int>(rank);
        for (std::size_t a = 0; a < atoms.size(); ++a) {
            const REAL far = length(off_[a]);
            if (far > most / REAL(10) && far < most * REAL(10)) facts.flagged = true;
            if (rank == 2 && p.mass[atoms[a]] == 0 && far > most)
                facts.off_plane.push_back(atoms[a]);
            else
                facts.refused = facts.refused || far > most, off_[a] = {};
        }
    }

    /** S = L L^T with the largest pivots first; y = L^-1 x. */
    void factorize(const rigid_problem &p, const std::vector<std::size_t> &atoms)
    {
        moments(p, atoms);
        std::array<vec, 3> left = s_;
        y.assign(atoms.size(), {});
        std::vector<vec> rest = x_;
        for (std::size_t k = 0; k < rank; ++k) {
            std::size_t most = 0;
            for (std::size_t c = 1; c < 3; ++c)
                if (left[c][c] > left[most][most]) most = c;
            const REAL root = square_root(left[most][most]);
            vec column;
            for (std::size_t c = 0; c < 3; ++c) column[c] = left[c][most] / root;
            for (std::size_t a = 0; a < atoms.size(); ++a) {
                y[a][k] = rest[a][most] / root;
                add_times(rest[a], -y[a][k], column);
            }
            for (std::size_t c = 0; c < 3; ++c)
                for (std::size_t d = 0; d < 3; ++d) left[c][d] -= column[c] * column[d];
            vectors[k] = column;
        }
    }

    /** U' = U O, y' = O^T y: O from Jacobi's rotations of U^T U in long double, then orthogonal to the last digit. */
    void turn()
    {
        long double m[3][3] = {}, o[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        const REAL unit = product(vectors[0], vectors[0]);
        for (std::size_t p = 0; p < rank; ++p)
            for (std::size_t q = 0; q < rank; ++q)
                m[p][q] = static_cast<long double>(product(vectors[p], vectors[q]) / unit);
        for (int sweep = 0; sweep < 40; ++sweep)
            for (std::size_t p = 0; p + 1 < rank; ++p)
                for (std::size_t q = p + 1; q < rank; ++q) {
                    if (m[p][q] == 0) continue;
                    const long double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]),
                                      t = (theta < 0 ? -1 : 1) / (std::fabs(theta) + std::sqrt(theta * theta + 1)),
                                      c = 1 / std::sqrt(t * t + 1), s = t * c;
                    for (auto &row : m) {
                        const long double a = row[p], b = row[q];
                        row[p] = c * a - s * b, row[q] = s * a + c * b;
                    }
                    for (std::size_t k = 0; k < 3; ++k) {
                        const long double a = m[p][k], b = m[q][k];
                        m[p][k] = c * a - s * b, m[q][k] = s * a + c * b;
                    }
                    for (auto &row : o) {
                        const long double a = row[p], b = row[q];
                        row[p] = c * a - s * b, row[q] = s * a + c * b;
                    }
                }
        std::array<vec, 3> columns{};
        for (std::size_t p = 0; p < rank; ++p) {
            for (std::size_t k = 0; k < 3; ++k) columns[p][k] = REAL(o[k][p]);
            for (int again = 0; again < 2; ++again)
                for (std::size_t q = 0; q < p; ++q) add_times(columns[p], -product(columns[q], columns[p]), columns[q]);
            const REAL size = length(columns[p]);
            for (REAL &x : columns[p]) x /= size;
        }
        std::array<vec, 3> turned{};
        for (std::size_t p = 0; p < rank; ++p)
            for (std::size_t k = 0; k < rank; ++k) add_times(turned[p], columns[p][k], vectors[k]);
        vectors = turned;
        for (auto &of_atom : y) {
            std::array<REAL, 3> other{};
            for (std::size_t p = 0; p < rank; ++p)
                for (std::size_t k = 0; k < rank; ++k) other[p] += columns[p][k] * of_atom[k];
            of_atom = other;
        }
    }
};

}  // namespace reference

#endif
