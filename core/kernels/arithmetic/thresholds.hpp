// When plain products of doubles do not answer for a molecule any more, so that its lane, atom or bond is done in twice
// the precision; and when twice the precision, or four times, refuses it: every limit, with the equation of
// docs/theory.md whose error it bounds. What is looked at stands where it is computed; here are the numbers alone.
// docs/stability.md derives them.
//
// They share one promise: a multiplier is right to 16 + sqrt(n) roundings of its scale
// (tests/oracle/molecules/README.md).
#pragma once

#include <stdint.h>

#include "core/kernels/isa/lanes.hpp"

namespace holonomic::HOL_ISA {

constexpr double epsilon = 2.220446049250313e-16;

// Products of two bonds. g = d . d' of nearly orthogonal bonds cancels, which shows where the right-hand sides of the
// two differ by orders of magnitude. Below this cosine g is computed anew from the coordinates: at a few in a hundred
// joints of a coil.
constexpr double small_cosine = 1.0 / 32;
// In segments: the error bound of chains of more than longest_lane bonds is twice as large, which products that are
// rounded before they are added use up. One lane has no segments but on request.
constexpr double segment_cosine = HOL_HAS_FMA && W > 1 ? 1.0 / 64 : 1.0 / 32;

// Chains (9): of the pivots w sin^2 + E there must be so much E, or the joint's cross product may be wrong by so many
// roundings of what it is added to (eliminate/effective_mass.hpp has the three tests).
constexpr double least_effective_mass = 1.0 / 4;
constexpr double joint_tolerance = 8;
constexpr double spare_of_cross_products = 4 * joint_tolerance * joint_tolerance;
// Where segments of a long chain are joined, c (20) is such an effective inverse mass, seen from the far end.
constexpr double join_tolerance = joint_tolerance;

// Trees (52): the part of a diagonal element that its pivot must keep, so that subtraction loses four bits at most.
constexpr double least_part = 1.0 / 16;
// (53a): the error of a multiplier that is a small difference may be so many times its scale, both in roundings; of n
// bonds sqrt(n), where that is more.
constexpr double most_cancelled = 64;
HOL_INLINE double most_cancelled2(int32_t n_bonds) {
    const double large = static_cast<double>(n_bonds);
    return large > most_cancelled * most_cancelled ? large : most_cancelled * most_cancelled;
}
// (53b), atoms with many bonds: the most that tr M tr N may be, which is 9 where M is a multiple of 1.
constexpr double most_uneven = 128, least_uneven = 9;

// Four bonds at one atom (53d): a centre whose inverse mass is so many times that of another atom is light. Newton's
// method corrects itself, and takes elimination a little further. The terms of a multiplier, added without signs, may
// be so many times its scale. tr M tr N is 9 where M is a multiple of 1; beyond this too much is lost.
constexpr double least_light = 3, least_light_to_move = 8;
constexpr double most_parts = 12;
constexpr double most_uneven_light = 20;
// There t_k = (y_k - c D_k.p) / a_k has the roundings of y_k over w_k, but the lightest of the other atoms decides how
// large it is. In Newton's method its inverse mass may be so many times that of the heaviest one.
constexpr double most_unequal = 64;

// Rings (57b): how many roundings of the diagonal elements may be taken off, and what pivots must keep of these, so
// that none is zero.
HOL_INLINE double most_roundings(int32_t n_bonds) { return 0.8 * (16 + __builtin_sqrt(static_cast<double>(n_bonds))); }
constexpr double least_lowered_part = 1.0 / 1024;

// Triangles (56). Below this sine squared the cross product of rounded bonds loses more than a digit. Three distances
// on a line can't be told from the next (eps^2 for the coordinates' roundings would be 5e-32). An element of the
// inverse between two bonds is a difference of two terms, of which so much may cancel.
constexpr double least_sine2 = 1.0 / 64;
constexpr double straight_sine2 = 1e-22;
constexpr double most_cancelled_there = 6;

// Sparse L D L^T (55a): the bound must be no more than this times an equation's terms, both in roundings: a part of the
// promise, and no more than in trees.
HOL_INLINE double most_backward(int32_t n_bonds) {
    const double part = 0.5 * (16 + __builtin_sqrt(static_cast<double>(n_bonds)));
    return part < most_cancelled ? part : most_cancelled;
}
// What is left of an equation is most often less than a third of the roundings of R, and where it is not it can be
// solved for. Where R is beyond this, refinement is needed most often.
constexpr double most_beyond = 30;
// A pivot below the first part of its diagonal element may come of bonds that depend on each other. Below the second it
// may be nothing but rounding; corrections don't show that if the right-hand side does not.
constexpr double least_proven_pivot = 1e-6;
constexpr double least_pivot = 1e-10;
// A multiplier that is less of what meets at its bond's atoms is cancelling: residuals are right to some 2^-104 of
// that.
constexpr double cancelling_part = 1.0 / (1LL << 54);

// Networks (60): a tree's child that offers less than the first part of the inverse mass of its atom is stiff, and that
// atom's tensor is kept in twice the precision. What offers less than the second one is taken to offer so much.
constexpr double stiff_offer = 1e-5, least_stiff_offer = 1e-14;

// The metric (62): the part of what it is subtracted from that a pivot and E must keep. Its inverse is that many
// roundings off H.
constexpr double least_kept = 1.0 / 12;

// In twice the precision (54a): less than a few roundings of a double are left while no ratio is larger. Four times the
// precision does what is beyond.
constexpr double largest_loss = 0x1p46;

#ifdef HOL_QUAD_DOUBLE
constexpr bool is_quad_double = true;
#else
constexpr bool is_quad_double = false;
#endif

namespace extended {

// (54): the inertia of an atom's arms, the sum of rho D.B, is all that is used of many arms while it is below this.
constexpr double mild = 0x1p20;
// An arm whose effective inverse mass E is below this part of w d.d does not give way at all.
constexpr double stiff = 0x1p-280;
// Arms that don't give way are linearly dependent if their Gram determinant <T,T> is below this. Two bonds in line to
// 1e-12, and a third one as near to their plane, are still solved. `coplanar`: as a sum of squares, which subtracts
// nothing.
constexpr double flat = 1e-52, coplanar = is_quad_double ? 1e-80 : flat;
// (52), trees: if a pivot is below this part of the diagonal, its bond is a combination of others; in twice the
// precision it may be that its digits do not tell. Nothing is subtracted, so that any pivot above is right.
constexpr double vanishing = is_quad_double ? 1e-80 : 1e-56;
// (55), cores: a pivot below this part of its diagonal element is refused; four times the precision decides where twice
// would. Constraints that depend on each other leave 1e-30, the rounding of the coordinates being that of a sine
// squared. How small a pivot is depends on the order: the least of a molecule may be a hundredth of what it is in
// another one.
constexpr double redundant = is_quad_double ? 1e-26 : 1e-22;
// (57), rings: three points are refused as in line if the square of the sine is below this; so is a ring of bonds all
// in line.
constexpr double straight = 1e-28;

}  // namespace extended

namespace bodies {

// Molecules with rigid bodies, docs/rigid.md: pivots below this part of the diagonal are too inaccurate as doubles;
// below the other one, rows depend, as they do where less than that is left of one once all others are gone.
constexpr double least_plain = 1e-9, least_wide = 1e-24;
// Corrections end here: beyond what a double holds, so that small multipliers beside large ones are right, too.
constexpr double small_correction = 1e-19;
// Residuals below this are near the end of twice the precision. Where they do not fall any more, all is done.
constexpr double small_residual = 1e-20;

}  // namespace bodies

}  // namespace holonomic::HOL_ISA
