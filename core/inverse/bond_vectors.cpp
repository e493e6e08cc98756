#include "core/inverse/bond_vectors.hpp"

#include <cmath>

#include "core/caller/packed_array.hpp"

namespace holonomic {

namespace {

void minimum_image(const Box &box, DoublePair *d) {
    double n[3];
    for (int i = 0; i < 3; ++i)
        n[i] = std::nearbyint(d[0].hi * box.inverse[i] + d[1].hi * box.inverse[3 + i] + d[2].hi * box.inverse[6 + i]);
    for (int i = 0; i < 3; ++i)
        for (int c = 0; c < 3; ++c)
            if (box.h[3 * i + c] != 0) d[c] = d[c] - as_pair(n[i]) * as_pair(box.h[3 * i + c]);
}

}  // namespace

std::vector<PairVector> bond_vectors(const Molecule &m, const AtomArray &r, const Box &box) {
    std::vector<PairVector> bonds;
    bonds.reserve(static_cast<std::size_t>(m.n_bonds));
    for (std::int64_t k = 0; k < m.n_bonds; ++k) {
        double from[3], to[3];
        read_atom(r, m.atom(m.i(k)), from);
        read_atom(r, m.atom(m.j(k)), to);
        DoublePair d[3];
        for (int c = 0; c < 3; ++c) d[c] = plain::two_difference(to[c], from[c]);
        if (box.lattice != Box::none) minimum_image(box, d);
        bonds.push_back({d[0], d[1], d[2]});
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
