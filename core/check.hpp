// Positions compared with the lengths of the bonds: what is mistaken where a program begins shows there.
#pragma once

#include "core/molecules/chains.hpp"

namespace holonomic {

// A reference whose bonds are off by more than this part of their lengths does not fit.
constexpr double most_off = 0.1;
// Nor do positions to be projected whose bonds are so many times as long as they should be: no step does that.
constexpr double most_stretched = 5;

// Bond vectors by any means: of positions in a box, or as they are given.
struct BondVectors {
    const AtomArray *r;  // or null:
    const AtomArray *d;  // [n_bonds], in the caller's order
    const Box *box;
};

// Throws Error of Status::lengths, naming the worst bond, if bonds do not fit. What is not finite is passed over: the
// calculation finds it.
void check_reference(const Chains &chains, const BondVectors &bonds, const char *what);
void check_trial(const Chains &chains, const AtomArray &r);
// Where all bonds fit that well: whether those across a face of the box fit as the others do.
void check_cut(const Chains &chains, const AtomArray &r, const Box &box, const char *what);
// Whether what the faces of the box cut is off by so much more than the n that lie inside, each by a part of its length
// at the worst, that the box is not that of the positions.
bool is_of_another_box(double cut, double inside, std::int64_t n_inside);

// The error of a molecule that was refused for its trial positions; or false, if it was not for these.
bool is_stretched(const Chains &chains, std::int64_t molecule, const AtomArray &r, std::int64_t n_bad, Error *error);

// The largest |d.d - a^2| / a^2; molecule and bond as the caller counts, -1 if there is none.
struct WorstLength {
    double error;
    std::int64_t molecule, bond;
};
WorstLength worst_length(const Chains &chains, const BondVectors &bonds);

}  // namespace holonomic
