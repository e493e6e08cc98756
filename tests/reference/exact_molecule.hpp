/**
 * @file exact_molecule.hpp
 * A molecule in wide arithmetic: its bond vectors, and the matrix A = Z/4 from the gradients of its constraints.
 */
#ifndef REFERENCE_EXACT_MOLECULE_HPP
#define REFERENCE_EXACT_MOLECULE_HPP

#include <vector>

#include "molecule_problem.h"
#include "sparse_factor.hpp"
#include "wide_functions.hpp"

namespace reference
{

template <class REAL>
struct exact_molecule {
    using vec = vector3<REAL>;
    struct bond {
        std::size_t i, j;    // its atoms
        std::size_t number;  // its place in the problem
        vec d;               // r_j - r_i
    };
    struct end {
        std::size_t bond;
        int sign;  // +1 where the atom is j, -1 where it is i
    };

    std::vector<REAL> w;
    std::vector<vec> r;
    std::vector<bond> bonds;             // those that are constraints
    std::vector<std::vector<end>> ends;  // of each atom

    explicit exact_molecule(const molecule_problem &p)
    {
        const std::size_t atoms = static_cast<std::size_t>(p.n_atoms);
        ends.resize(atoms);
        for (std::size_t i = 0; i < atoms; ++i) {
            w.push_back(REAL(p.inverse_mass[i]));
            r.push_back(row(p.r, i));
        }
        for (std::size_t k = 0; k < static_cast<std::size_t>(p.n_bonds); ++k) {
            const std::size_t i = static_cast<std::size_t>(p.pairs[2 * k]),
                              j = static_cast<std::size_t>(p.pairs[2 * k + 1]);
            if (p.inverse_mass[i] == 0 && p.inverse_mass[j] == 0) continue;
            ends[i].push_back({bonds.size(), -1});
            ends[j].push_back({bonds.size(), +1});
            bonds.push_back({i, j, k, image(difference(r[j], r[i]), p.box)});
        }
    }

    static vec row(const double *array, std::size_t i)
    {
        if (!array) return {};
        return {REAL(array[3 * i]), REAL(array[3 * i + 1]), REAL(array[3 * i + 2])};
    }

    /** The shortest of d + n0 h0 + n1 h1 + n2 h2, by repeated search among the neighbouring cells. */
    static vec image(vec d, const double *box)
    {
        for (bool moved = box != nullptr; moved;) {
            moved = false;
            vec best = d;
            for (int n = 0; n < 27; ++n) {
                vec x = d;
                for (std::size_t h = 0; h < 3; ++h) {
                    const int steps[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
                    add_times(x, REAL(steps[h]), row(box, h));
                }
                if (product(x, x) < product(best, best)) {
                    best = x;
                    moved = true;
                }
            }
            d = best;
        }
        return d;
    }

    /** J_kl: sum over the atoms that bonds k and l share of s_k s_l w left_k.d_l; A if left are the bonds themselves.
     */
    sparse_matrix<REAL> matrix(const std::vector<vec> &left) const
    {
        sparse_matrix<REAL> a(bonds.size());
        for (std::size_t atom = 0; atom < w.size(); ++atom)
            for (const end &k : ends[atom])
                for (const end &l : ends[atom])
                    a[k.bond][l.bond] += REAL(k.sign * l.sign) * w[atom] * product(left[k.bond], bonds[l.bond].d);
        return a;
    }
    std::vector<vec> vectors() const
    {
        std::vector<vec> d;
        for (const bond &b : bonds) d.push_back(b.d);
        return d;
    }

    /** G_i = - sum s t d, t = 2 lambda. */
    std::vector<vec> forces(const std::vector<REAL> &t) const
    {
        std::vector<vec> g(w.size());
        for (std::size_t k = 0; k < bonds.size(); ++k) {
            add_times(g[bonds[k].i], t[k], bonds[k].d);
            add_times(g[bonds[k].j], -t[k], bonds[k].d);
        }
        return g;
    }
};

/** A, its factors, and A^-1 where asked for. */
template <class REAL>
struct bond_system {
    std::vector<REAL> diagonal;
    sparse_factor<REAL> factor;
    REAL least_pivot{1};  // the smallest pivot of Z~; 0 if there was a pivot of 0

    explicit bond_system(const exact_molecule<REAL> &m) : bond_system(m.matrix(m.vectors()))
    {
    }
    explicit bond_system(const sparse_matrix<REAL> &a) : factor(a)
    {
        for (std::size_t k = 0; k < a.size(); ++k) diagonal.push_back(a[k].at(k));
        if (!factor.regular()) least_pivot = REAL(0);
        for (std::size_t k = 0; factor.regular() && k < a.size(); ++k) {
            const REAL ratio = factor.pivots()[k] / diagonal[k];
            if (ratio < least_pivot) least_pivot = ratio;
        }
    }
};

}  // namespace reference

#endif
