/**
 * @file wide_metric.hpp
 * Metric determinant, inverse and Fixman force in wide arithmetic, by A^-1 as a whole.
 */
#ifndef REFERENCE_WIDE_METRIC_HPP
#define REFERENCE_WIDE_METRIC_HPP

#include <cmath>
#include <vector>

#include "exact_molecule.hpp"

namespace reference
{

/** molecule_metric in wide arithmetic; rows of bonds that are no constraints are zero. */
template <class REAL>
struct wide_metric {
    bool regular = false;  // false: nothing but the least pivot is set
    REAL log_det{0}, log_det_z{0}, log_det_z_scale{0}, condition{0}, least_pivot{0};
    std::vector<vector3<REAL>> force;
    std::vector<REAL> force_scale;
    std::vector<std::vector<REAL>> inverse;  // of Z~, by the numbers of the bonds
};

/**
 * phi_k = d_k x (sum over neighbours l at both ends of s_ki s_li w_i H_kl d_k x d_l) / q_k, taken from atom i and given
 * to atom j of bond k; H = A^-1.
 */
template <class REAL>
void add_fixman_force(const exact_molecule<REAL> &m, const std::vector<std::vector<REAL>> &h, wide_metric<REAL> &out)
{
    out.force.resize(m.w.size());
    out.force_scale.resize(m.w.size());
    for (std::size_t k = 0; k < m.bonds.size(); ++k) {
        const auto &bond = m.bonds[k];
        vector3<REAL> sum{};
        REAL scale(0);
        for (const std::size_t atom : {bond.i, bond.j}) {
            const int own = atom == bond.j ? 1 : -1;
            for (const auto &l : m.ends[atom]) {
                if (l.bond == k) continue;
                const auto normal = cross_product(bond.d, m.bonds[l.bond].d);
                const REAL weight = REAL(own * l.sign) * m.w[atom] * h[k][l.bond];
                add_times(sum, weight, normal);
                scale += absolute(weight) * length(normal);
            }
        }
        const REAL q = product(bond.d, bond.d);
        const auto phi = cross_product(bond.d, sum);
        add_times(out.force[bond.j], REAL(1) / q, phi);
        add_times(out.force[bond.i], REAL(-1) / q, phi);
        scale /= square_root(q);
        out.force_scale[bond.i] += scale;
        out.force_scale[bond.j] += scale;
    }
}

/** ln det Z~, ln det Z and the sizes of the terms of the latter. */
template <class REAL>
void add_determinants(const bond_system<REAL> &system, wide_metric<REAL> &out)
{
    REAL det(1), diagonal(1);
    for (std::size_t k = 0; k < system.diagonal.size(); ++k) {
        det *= system.factor.pivots()[k] / system.diagonal[k];
        diagonal *= system.diagonal[k].scaled(2);
        const long double size = static_cast<long double>(system.diagonal[k].scaled(2));
        out.log_det_z_scale += REAL(std::fabs(std::log(size)));  // a scale needs no more digits
    }
    out.log_det = logarithm(det);
    out.log_det_z = out.log_det + logarithm(diagonal);
    out.log_det_z_scale += absolute(out.log_det);
}

template <class REAL>
wide_metric<REAL> wide_metric_of(const molecule_problem &p)
{
    const exact_molecule<REAL> m(p);
    const sparse_matrix<REAL> a = m.matrix(m.vectors());
    const bond_system<REAL> system(a);
    wide_metric<REAL> out;
    out.least_pivot = system.least_pivot;
    if (!(system.least_pivot > REAL(0))) return out;
    out.regular = true;
    add_determinants(system, out);
    const auto h = system.factor.inverse();
    add_fixman_force(m, h, out);
    const std::size_t n = static_cast<std::size_t>(p.n_bonds);
    out.inverse.assign(n, std::vector<REAL>(n));
    std::vector<REAL> root;
    for (const REAL &x : system.diagonal) root.push_back(square_root(x));
    REAL largest(0), largest_inverse(0);
    for (std::size_t k = 0; k < root.size(); ++k) {
        REAL sum(0), sum_inverse(0);
        for (const auto &[l, x] : a[k]) sum += absolute(x) / (root[k] * root[l]);
        for (std::size_t l = 0; l < root.size(); ++l) {
            const REAL x = h[k][l] * root[k] * root[l];
            out.inverse[m.bonds[k].number][m.bonds[l].number] = x;
            sum_inverse += absolute(x);
        }
        if (sum > largest) largest = sum;
        if (sum_inverse > largest_inverse) largest_inverse = sum_inverse;
    }
    out.condition = largest * largest_inverse;
    return out;
}

}  // namespace reference

#endif
