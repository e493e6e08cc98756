#include "core/inverse/bond_vectors.hpp"

#include <cmath>

#include "core/caller/packed_array.hpp"

namespace holonomic {

std::vector<PairVector> bond_vectors(const Molecule &m, const AtomArray &r, const Box &box) {
    std::vector<PairVector> bonds;
    bonds.reserve(static_cast<std::size_t>(m.n_bonds));
    for (std::int64_t k = 0; k < m.n_bonds; ++k) {
        double from[3], to[3];
        read_atom(r, m.atom(m.i(k)), from);
        read_atom(r, m.atom(m.j(k)), to);
        PairVector d = {plain::two_difference(to[0], from[0]), plain::two_difference(to[1], from[1]),
                        plain::two_difference(to[2], from[2])};
        if (box.lattice != Box::none) plain::wrap(box, d);
        bonds.push_back(d);
    }
    return bonds;
}

ScaledBond scaled(const PairVector &d) {
    ScaledBond s;
    const double largest = std::fmax(std::fabs(d.x.hi), std::fmax(std::fabs(d.y.hi), std::fabs(d.z.hi)));
    s.exponent = largest > 0 && std::isfinite(largest) ? std::ilogb(largest) : 0;
    const int e = -s.exponent;
    s.hi = {std::scalbn(d.x.hi, e), std::scalbn(d.y.hi, e), std::scalbn(d.z.hi, e)};
    s.lo = {std::scalbn(d.x.lo, e), std::scalbn(d.y.lo, e), std::scalbn(d.z.lo, e)};
    s.length = std::sqrt(plain::dot_compensated(s.hi, s.lo, s.hi, s.lo));
    return s;
}

BondAngle angle_between(const ScaledBond &a, const ScaledBond &b) {
    const double lengths = a.length * b.length;
    double cosine = plain::dot_compensated(a.hi, a.lo, b.hi, b.lo) / lengths;
    if (std::fabs(cosine) < 1e-15) cosine = dot_exact(a.hi, a.lo, b.hi, b.lo) / lengths;
    if (std::fabs(cosine) < 0.5) return {cosine, 1 - std::fabs(cosine)};
    const Vector3<double> normal = plain::cross_compensated(a.hi, a.lo, b.hi, b.lo);
    const double sine2 = plain::dot(normal, normal) / (lengths * lengths);
    return {cosine, sine2 / (1 + std::fabs(cosine))};
}

}  // namespace holonomic
