// One molecule that is no linear chain, copied and with its equations A t = b eliminated by the extended-precision
// solver (core/kernels/extended), in the baseline's instructions: for what is not in the hot path.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/kernels/call.hpp"
#include "core/molecules/given/molecule.hpp"

namespace holonomic {

class ExtendedMolecule {
public:
    // Throws std::bad_alloc.
    ExtendedMolecule(const Molecule &molecule, const AtomArray &r, const Box &box);
    ~ExtendedMolecule();

    bool good() const;
    // Where it is not good: a bond that depends on others; -1 if the bond vectors are of no use.
    std::int64_t dependent_bond() const;

    // Row i of the inverse of A~ = A over the roots of its diagonal elements. Thread-safe. Throws std::bad_alloc.
    std::vector<double> inverse_row(std::int64_t i) const;
    // The root of a diagonal element of A, as root() 2^exponent().
    double root(std::int64_t k) const;
    int exponent(std::int64_t k) const;
    // Sum of absolute values in the largest row of A~.
    double largest_row() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace holonomic
