// One molecule that is no linear chain, copied and with its equations A t = b eliminated by the extended-precision
// solver (core/kernels/extended), in the baseline's instructions: for what is not in the hot path. As in the kernels,
// four times the precision does what twice loses too many digits of.
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
    static std::unique_ptr<const ExtendedMolecule> make(const Molecule &molecule, const AtomArray &r, const Box &box);
    virtual ~ExtendedMolecule() = default;

    virtual bool good() const = 0;
    // Where it is not good: a bond that depends on others; -1 if the bond vectors are of no use.
    virtual std::int64_t dependent_bond() const = 0;

    // Row i of the inverse of A~ = A over the roots of its diagonal elements. Thread-safe. Throws std::bad_alloc.
    virtual std::vector<double> inverse_row(std::int64_t i) const = 0;
    // The root of a diagonal element of A, as root() 2^exponent().
    virtual double root(std::int64_t k) const = 0;
    virtual int exponent(std::int64_t k) const = 0;
    // Sum of absolute values in the largest row of A~.
    virtual double largest_row() const = 0;

protected:
    virtual bool lacks_digits() const = 0;

private:
    static std::unique_ptr<const ExtendedMolecule> in_four_times_the_precision(const Molecule &molecule,
                                                                               const AtomArray &r, const Box &box);
};

}  // namespace holonomic
