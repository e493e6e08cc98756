#include "core/molecules/given/closable.hpp"
#include "core/index.hpp"

#include <algorithm>
#include <vector>

namespace holonomic {

namespace {

// A line is refused by the calls that meet it; lengths that make one may be rounded.
constexpr double rounding = 1e-12;

bool is_longer(double side, double others) { return side > others * (1 + rounding); }

bool find_in_ring(const Shape &shape, const double *length, Unclosable *found) {
    double sum = 0;
    std::int32_t longest = 0;
    for (std::int32_t k = 0; k < shape.n_bonds; ++k) {
        sum += length[k];
        if (length[k] > length[longest]) longest = k;
    }
    *found = {longest, -1, length[longest], sum - length[longest]};
    return is_longer(found->length, found->others);
}

}  // namespace

bool find_unclosable(const Shape &shape, const double *length, Unclosable *found) {
    if (shape.topology == Topology::chain || shape.topology == Topology::tree) return false;
    if (shape.topology == Topology::ring) return find_in_ring(shape, length, found);
    // Bonds of each atom to higher ones. The pairs ascend, so that these follow each other.
    std::vector<std::int32_t> start(at(shape.n_atoms) + 1, 0), marked(at(shape.n_atoms), -1);
    for (std::int32_t k = 0; k < shape.n_bonds; ++k) ++start[at(shape.i(k)) + 1];
    for (std::int32_t i = 0; i < shape.n_atoms; ++i) start[at(i) + 1] += start[at(i)];
    const auto end_of = [&](std::int32_t bond) { return shape.j(bond); };
    for (std::int32_t i = 0; i < shape.n_atoms; ++i) {
        const std::int32_t first = start[at(i)], end = start[at(i) + 1];
        if (end - first < 2) continue;
        for (std::int32_t k = first; k < end; ++k) marked[at(end_of(k))] = k;
        for (std::int32_t k = first; k < end; ++k)
            for (std::int32_t l = start[at(end_of(k))]; l < start[at(end_of(k)) + 1]; ++l) {
                const std::int32_t m = marked[at(end_of(l))];
                if (m < first) continue;
                // Atom i with bonds k and m to the ends of bond l.
                const std::int32_t sides[3] = {k, l, m}, corners[3] = {end_of(l), i, end_of(k)};
                const double sum = length[k] + length[l] + length[m];
                for (int s = 0; s < 3; ++s) {
                    *found = {sides[s], corners[s], length[sides[s]], sum - length[sides[s]]};
                    if (is_longer(found->length, found->others)) return true;
                }
            }
    }
    return false;
}

Error unclosable_error(const Unclosable &found, const Name *atoms, std::int64_t bond, int base) {
    const long long number = static_cast<long long>(bond + base);
    Error error =
        found.corner < 0
            ? make_error(Status::value,
                         "bond %lld (atoms %s and %s) has the length %g, more than all others of its ring together, "
                         "%g: the ring can't close",
                         number, atoms[0].text, atoms[1].text, found.length, found.others)
            : make_error(Status::value,
                         "bond %lld (atoms %s and %s) has the length %g, more than the two other sides of its triangle "
                         "with atom %s together, %g; a rigid angle is given by the distance between its ends",
                         number, atoms[0].text, atoms[1].text, found.length, atoms[2].text, found.others);
    error.bond = bond;
    error.base = base;
    return error;
}

}  // namespace holonomic
