/**
 * @file extended_case.hpp
 * One molecule for the extended-precision solver, its calls, and the exact solution by dense elimination in 113 bits.
 */
#ifndef EXTENDED_CASE_HPP
#define EXTENDED_CASE_HPP

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "../reference/quad.hpp"
#include "core/caller/packed_array.hpp"
#include "core/kernels/call.hpp"

namespace extended_case
{

using namespace reference;
using bonds = std::vector<std::pair<int, int>>;

inline void require(bool condition, const char *name, const char *what)
{
    if (condition) return;
    std::printf("%s: %s\n", name, what);
    std::exit(1);
}

struct molecule {
    const char *name;
    int n_atoms, n_bonds;
    std::vector<std::int32_t> pairs;
    std::vector<double> w, length, r, v, f;

    // Atoms of random masses at random places, some of them fixed if they have one bond.
    molecule(const char *n, const bonds &list, unsigned seed, double decades)
        : name(n), n_atoms(0), n_bonds(static_cast<int>(list.size()))
    {
        for (const auto &b : list) {
            pairs.push_back(std::min(b.first, b.second));
            pairs.push_back(std::max(b.first, b.second));
            n_atoms = std::max(n_atoms, pairs.back() + 1);
        }
        std::mt19937 random(seed);
        std::uniform_real_distribution<double> uniform(-1, 1);
        for (int i = 0; i < n_atoms; ++i) w.push_back(std::pow(10.0, decades * uniform(random)));
        for (std::vector<double> *x : {&r, &v, &f})
            for (int e = 0; e < 3 * n_atoms; ++e) x->push_back(uniform(random));
        measure();
    }

    void measure()
    {
        length.clear();
        for (int k = 0; k < n_bonds; ++k) length.push_back(static_cast<double>(reference::norm(bond(k))));
    }
    quad3 atom(const std::vector<double> &x, int i) const
    {
        return {x[3 * i], x[3 * i + 1], x[3 * i + 2]};
    }
    quad3 difference(const std::vector<double> &x, int k) const
    {
        return atom(x, pairs[2 * k + 1]) - atom(x, pairs[2 * k]);
    }
    quad3 bond(int k) const
    {
        return difference(r, k);
    }
};

inline holonomic::Tally empty_tally()
{
    holonomic::Tally tally{};
    tally.first_bad = tally.worst_chain = tally.worst_bond = -1;
    return tally;
}

using matrix = std::vector<std::vector<quad>>;

// A_kl = sum over shared atoms of s s w d_k.d_l.
inline matrix matrix_of(const molecule &m)
{
    matrix a(m.n_bonds, std::vector<quad>(m.n_bonds, 0));
    for (int k = 0; k < m.n_bonds; ++k)
        for (int l = 0; l < m.n_bonds; ++l)
            for (int e = 0; e < 2; ++e)
                for (int g = 0; g < 2; ++g)
                    if (m.pairs[2 * k + e] == m.pairs[2 * l + g])
                        a[k][l] += (e == g ? 1 : -1) * quad(m.w[m.pairs[2 * k + e]]) * dot(m.bond(k), m.bond(l));
    return a;
}

// The inverse, by Gauss and Jordan with pivoting.
inline matrix inverse_of(matrix a)
{
    const std::size_t n = a.size();
    matrix b(n, std::vector<quad>(n, 0));
    for (std::size_t i = 0; i < n; ++i) b[i][i] = 1;
    for (std::size_t c = 0; c < n; ++c) {
        std::size_t p = c;
        for (std::size_t i = c + 1; i < n; ++i)
            if (reference::absolute(a[i][c]) > reference::absolute(a[p][c])) p = i;
        std::swap(a[c], a[p]);
        std::swap(b[c], b[p]);
        const quad pivot = a[c][c];
        for (std::size_t j = 0; j < n; ++j) {
            a[c][j] /= pivot;
            b[c][j] /= pivot;
        }
        for (std::size_t i = 0; i < n; ++i) {
            if (i == c) continue;
            const quad l = a[i][c];
            for (std::size_t j = 0; j < n; ++j) {
                a[i][j] -= l * a[c][j];
                b[i][j] -= l * b[c][j];
            }
        }
    }
    return b;
}

}  // namespace extended_case

#endif
