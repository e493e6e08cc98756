// Bond vectors of one chain with nothing rounded off, and the cosine and sine between two of them.
#pragma once

#include <vector>

#include "core/double_pair.hpp"
#include "core/molecules/chains.hpp"

namespace holonomic {

// d_k = r_j - r_i for k = 0 .. N-1, the minimum image if there is a box. Not checked for anything.
std::vector<PairVector> bond_vectors(const Molecule &molecule, const AtomArray &r, const Box &box);

// A bond vector over the power of two that brings it to a size of about 1, so that products can't overflow or
// underflow.
struct ScaledBond {
    Vector3<double> hi, lo;
    double length;  // of the scaled vector
    int exponent;
};
ScaledBond scaled(const PairVector &d);

struct BondAngle {
    double cosine;      // of the angle between neighbouring bonds, with its sign
    double complement;  // 1 - |cosine|, right to a few roundings however small
};
BondAngle angle_between(const ScaledBond &a, const ScaledBond &b);

}  // namespace holonomic
