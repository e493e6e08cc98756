// A kind of molecule with rigid bodies: its bodies, its other atoms, its bonds, and in which order its equations are
// eliminated.
//
// Coordinates are *nodes*: of a body its centre and its vectors u_p (body.hpp), of another atom its position. Equations
// are *rows*: of a bond d.d = a^2, of a body u_p.u_q = L_p^2 [p = q]. Every row is an inner product of differences of
// nodes, so that its gradient has one vector per node, an *entry*.
#pragma once

#include <cstdint>
#include <vector>

#include "core/rigid/body.hpp"

namespace holonomic::rigid {

// A body within a molecule.
struct Part {
    std::int32_t body;  // its kind
    std::int32_t first_atom, first_node;
    std::vector<std::int32_t> fixed;  // atoms that its relations have
};

// A bond's length and the distance between its atoms in a body that was given by coordinates: equal to what digits
// allow.
constexpr double same_length = 1e-6;

// Row of a bond that is none, as an affine part holds it by other distances.
constexpr std::int32_t held_elsewhere = -2;

// A bond as it was given, of atoms numbered within the molecule.
struct Bond {
    std::int32_t i, j;
    double length;
    std::int32_t row;  // -1: within a body, which holds it
};

struct Entry {
    std::int32_t node;
    std::int32_t other;  // of a body's row: the gradient is this node; -1: it is factor d
    DoublePair factor;
};

// What two entries at a node add to the matrix: at `element` of the diagonal (same row), or of the factor's pattern.
struct Product {
    std::int32_t a, b;  // entries, of the row eliminated first and of the other
    std::int32_t element;
    std::int32_t of_diagonal;
};

struct MoleculeKind {
    std::vector<double> signature;  // what makes two molecules of one kind, word by word
    std::int32_t n_atoms = 0;       // bodies' atoms, others that can move, fixed ones
    std::int32_t n_held = 0;        // atoms of bodies
    std::int32_t n_movable = 0;     // and others that can move
    std::int32_t n_nodes = 0, n_rows = 0;
    std::vector<Part> parts;
    std::vector<std::int32_t> part_of;  // [n_held]
    std::vector<std::int32_t> node_of;  // [n_atoms] of an atom that no body holds; -1
    std::vector<double> w;              // [n_nodes]
    std::vector<double> mass;           // [n_atoms], 0: a site; of fixed atoms 0 too
    std::vector<Bond> bonds;
    std::vector<Bond> hidden;        // distances that are held, but are no bonds of the caller's
    std::vector<NearestStep> links;  // between which nearest images are taken where no bond is
    std::vector<NearestStep> steps;  // the way through the molecule, from its first atom
    bool by_lengths = false;         // bonds within bodies have multipliers (within.hpp)
    bool has_images = false;         // of bonds, which are told and not looked for
    bool is_lone_body = false;       // one that plain doubles do for, without bonds but within it
    bool is_ordinary = false;        // no product of its masses and lengths overflows or underflows; else it is refused
    double longest = 0;              // of what is taken as a nearest image
    // rows in the order of elimination
    std::vector<std::int32_t> entry_start;  // [n_rows + 1]
    std::vector<Entry> entries;
    std::vector<std::int32_t> bond_of_row;  // -1: of a body, or of a hidden distance
    std::vector<DoublePair> target;         // [n_rows] a^2, L_p^2 or 0
    std::vector<double> scale;              // [n_rows] what the row is compared with: a^2, L_p L_q
    std::vector<double> reach;              // [n_rows] by how much it changes with a coordinate: a, L_p + L_q
    std::vector<Product> products;
    std::vector<std::int32_t> column_start, row;  // the factor's pattern below its diagonal

    // Whether a row is d.d of a distance; else it is of a body.
    bool is_distance(std::int32_t k) const {
        return entries[static_cast<std::size_t>(entry_start[static_cast<std::size_t>(k)])].other < 0;
    }
    std::int64_t bytes() const;
};

// Fills in all that follows from parts, atoms, bonds and masses. Throws Unsolvable.
struct Unsolvable {
    enum Cause { length_in_body, off_plane, unconnected, too_many } cause;
    std::int32_t bond;
};
void complete(MoleculeKind &kind, const std::vector<Body> &bodies);

}  // namespace holonomic::rigid
