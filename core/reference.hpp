// Reference positions made of bond vectors, for programs that keep these instead.
#pragma once

#include "core/molecules/chains.hpp"

namespace holonomic {

// Coordinates of the atoms of each molecule along its bonds, from an origin at its first atom. Only their differences
// matter: those are the vectors, each rounded once as the coordinates are.
class Reference {
public:
    // `bonds` [n_bonds] in the caller's order. Takes memory of the calling thread. Throws Error, or std::bad_alloc.
    Reference(const Chains &chains, const AtomArray &bonds);

    const AtomArray &atoms() const { return atoms_; }    // [n_atoms], of molecules that are worked on in place
    const AtomArray &staged() const { return staged_; }  // in the order of the plan's stage
    // Whether a cycle goes round the reference box: then bonds are the nearest images of these coordinates'
    // differences.
    bool winds() const { return winds_; }
    // Puts a molecule that may be staged where atoms() has it, for messages.
    void show(std::int64_t molecule) const;

private:
    template <class Place>
    void lay_out(const Molecule &molecule, const AtomArray &to, const Place &place) const;

    const Chains &chains_;
    const AtomArray &bonds_;
    AtomArray atoms_, staged_;
    mutable bool winds_ = false;
};

}  // namespace holonomic
