#include "core/run/bond_words.hpp"

#include <cmath>
#include <cstdio>

#include "core/caller/packed_array.hpp"

namespace holonomic {

Words name_of_bond(const Chains &chains, const Molecule &m, std::int64_t k) {
    const auto number = [&](std::int64_t i) { return static_cast<long long>(i + chains.base); };
    char place[48] = "";
    if (m.bond(k) != k) std::snprintf(place, sizeof place, "%lld of the arrays per bond, ", number(m.bond(k)));
    Words words;
    std::snprintf(words.text, sizeof words.text, "bond %lld (%satoms %s and %s)", number(k), place,
                  chains.name_of_atom(m.atom(m.i(k))).text, chains.name_of_atom(m.atom(m.j(k))).text);
    return words;
}

double length_of_bond(const Molecule &m, std::int64_t k, const AtomArray &r, const Box &box) {
    double a[3], b[3], d[3];
    read_atom(r, m.atom(m.i(k)), a);
    read_atom(r, m.atom(m.j(k)), b);
    bond_vector(box, a, b, d);
    return std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

const char *box_in_words(const Box &box) { return box.lattice == Box::none ? "no box is set" : "a box is set"; }

}  // namespace holonomic
