// The molecules of a set that have rigid bodies. Their numbers follow those of all other molecules of the set.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "core/rigid/molecule_kind.hpp"

namespace holonomic::rigid {

// What makes a part an affine one: relations among its atoms, though there may be none. A rigid body has no such atoms.
struct AffinePart {
    Relations relations;
    double extent = 0;
    std::vector<std::int32_t> fixed;  // atoms of the molecule, as the relations have them
    bool is_rigid() const { return relations.n_atoms == 0; }
};

// Bodies and bonds of one molecule as they are given; atoms are the caller's, counted from 0.
struct Given {
    std::vector<std::int32_t> sizes;  // of the bodies
    std::vector<std::int64_t> atoms;  // bodies' atoms, others that can move, fixed ones
    std::vector<double> coordinates;  // [atoms of bodies][3]
    std::vector<double> masses;       // [atoms], 0: site; of fixed atoms 0
    std::int32_t n_movable = 0;
    std::vector<Bond> bonds;
    std::vector<std::int64_t> bond_numbers;  // in the arrays per bond
    bool has_images = false;                 // of its bonds, which are told (images.cpp)
    bool by_lengths = false;                 // bonds within bodies are what holds these, and have multipliers
    std::vector<AffinePart> affine;          // of the bodies, or empty: all are rigid
    std::vector<Bond> hidden;                // distances that are held and are no bonds of the caller's
    std::vector<NearestStep> links;          // pairs of atoms between which nearest images are taken where no bond is
};

// What makes given bodies impossible: a body's fault or that of their bonds.
struct Refusal {
    enum Cause { of_body, of_bonds } cause;
    BodyFault fault;
    Unsolvable unsolvable;
    std::int64_t body;  // of the molecule's
};

class Bodies {
public:
    std::int64_t n_molecules() const { return static_cast<std::int64_t>(molecules_.size()); }
    std::int64_t n_kinds() const { return static_cast<std::int64_t>(kinds_.size()); }
    const MoleculeKind &kind(std::int64_t molecule) const {
        return kinds_[static_cast<std::size_t>(molecules_[static_cast<std::size_t>(molecule)].kind)];
    }
    std::int32_t kind_number(std::int64_t molecule) const {
        return molecules_[static_cast<std::size_t>(molecule)].kind;
    }
    const std::int64_t *atoms(std::int64_t molecule) const {
        return atoms_.data() + molecules_[static_cast<std::size_t>(molecule)].first_atom;
    }
    const std::int64_t *bonds(std::int64_t molecule) const {
        return bonds_.data() + molecules_[static_cast<std::size_t>(molecule)].first_bond;
    }
    const Body *body_kinds() const { return body_kinds_.data(); }
    const Body &body(const Part &part) const { return body_kinds_[static_cast<std::size_t>(part.body)]; }
    bool all_active() const { return active_.empty(); }
    bool is_active(std::int64_t molecule) const {
        return all_active() || active_[static_cast<std::size_t>(molecule)] != 0;
    }
    bool is_site(std::int64_t atom) const { return sites_.count(atom) > 0; }
    // [n_molecules] or null: all
    void set_active(const unsigned char *active);
    double longest() const { return longest_; }  // of what is taken as a nearest image
    bool is_consecutive(std::int64_t molecule) const {
        return molecules_[static_cast<std::size_t>(molecule)].consecutive;
    }
    std::int64_t scratch_bytes() const { return scratch_bytes_; }  // of a System, a multiple of 64
    std::int64_t block_bytes() const { return block_bytes_; }      // of the kernels for bodies alone, behind it
    std::int64_t work() const { return work_; }                    // rows of all molecules
    // That active ones take from the freedoms of the atoms that have mass.
    std::int64_t constraints(int dimensions) const;
    std::int64_t constraints(std::int64_t molecule, int dimensions) const;  // of one
    const std::vector<std::int64_t> &fixed_atoms() const { return fixed_; }
    std::int64_t bytes() const;

    // Adds a molecule. Throws Refusal or std::bad_alloc; roll_back then takes away what has been added since.
    void add(const Given &given);
    struct Mark {
        std::size_t molecules, body_kinds, kinds, atoms, bonds, fixed, active;
        double longest;
        std::int64_t scratch_bytes, block_bytes, work;
    };
    Mark mark() const;
    void roll_back(const Mark &before);
    // As it was given, but for w of its atoms: to build the set again.
    Given given(std::int64_t molecule) const;

private:
    struct MoleculeOfKind {
        std::int32_t kind;
        bool consecutive;  // its atoms stand one behind the other
        std::int64_t first_atom, first_bond;
    };
    std::int32_t find_kind(const Given &given);
    std::int32_t find_body(std::int32_t n, const double *masses, const double *coordinates, const AffinePart *affine);

    std::vector<Body> body_kinds_;
    std::unordered_multimap<std::uint64_t, std::int32_t> body_of_hash_, kind_of_hash_;
    std::vector<MoleculeKind> kinds_;
    std::vector<MoleculeOfKind> molecules_;
    std::vector<std::int64_t> atoms_, bonds_, fixed_;
    std::unordered_set<std::int64_t> sites_;
    std::vector<unsigned char> active_;
    double longest_ = 0;
    std::int64_t scratch_bytes_ = 0, block_bytes_ = 0, work_ = 0;
};

}  // namespace holonomic::rigid
