#include "core/molecules/given/closable.hpp"

#include "core/molecules/given/triangles.hpp"

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
    if (shape.topology == Topology::ring) return find_in_ring(shape, length, found);
    if (!shape.has_triangles) return false;
    return any_triangle(
        shape.n_atoms, shape.n_bonds, [&](std::int32_t k, int end) { return end ? shape.j(k) : shape.i(k); },
        [&](std::int32_t i, std::int32_t k, std::int32_t l, std::int32_t m) {
            const std::int32_t sides[3] = {k, l, m}, corners[3] = {shape.j(l), i, shape.j(k)};
            const double sum = length[k] + length[l] + length[m];
            for (int s = 0; s < 3; ++s) {
                *found = {sides[s], corners[s], length[sides[s]], sum - length[sides[s]]};
                if (is_longer(found->length, found->others)) return true;
            }
            return false;
        });
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
