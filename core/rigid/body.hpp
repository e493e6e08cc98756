// A kind of rigid body: its mass and its atoms' whitened coordinates.
//
// With X reference positions, c = sum m X / M, x = X - c and S = sum m x x^T / M, the frame of S has the axes e_p and
// the lengths L_p = sqrt of its eigenvalues; y_ap = e_p.x_a / L_p. A body's motion is that of its centre c and of rank
// vectors u_p (L_p e_p in the reference):
//
//     r_a = c + sum_p y_ap u_p,    c = sum_a (m_a/M) r_a,    u_p = sum_a (m_a y_ap / M) r_a,    u_p.u_q = L_p^2 [p = q]
//
// because sum m y = 0 and sum m y y^T = M 1: as far as masses go, c and the u_p are points of mass M each, and what
// keeps the body rigid is rank (rank+1)/2 products of them, whatever the number of its atoms. A massless site is
// carried along: its force goes to c and the u_p like the others'. Where the masses lie in a plane, a site off it is at
// a height along u_1 x u_2 (off_plane.cpp).
//
// Atoms between which linear relations hold, and nothing else, are a *affine* part: c and vectors u_p with other y, of
// the same sums, as many as the relations leave free; no products of them are held. Distances between its atoms may be.
// Where relations have fixed atoms r_f a part is not free to shift:
//
//     r_a = y_a0 u_0 + sum_p y_ap u_p + sum_j of_fixed_aj r_fj,    sum_a m_a y_ap of_fixed_aj = 0,
//
// with u_0 in place of the centre.
#pragma once

#include <cstdint>
#include <vector>

#include "core/double_pair.hpp"
#include "core/rigid/relations.hpp"

namespace holonomic::rigid {

struct Body {
    std::int32_t n_atoms;
    std::int32_t rank;       // 1: on a line, 2: in a plane, 3; of an affine part any
    std::int32_t n_massive;  // atoms that are no sites
    double mass, inverse_mass;
    double length[3];            // L_p, descending
    DoublePair square[3];        // L_p^2
    double extent;               // the largest distance of an atom from the centre; of an affine part a length of it
    bool is_rigid = true;        // else affine
    Relations relations;         // of an affine part
    std::vector<double> masses;  // [n_atoms], 0: a massless site
    std::vector<double> coordinates;   // [n_atoms][3] the reference coordinates as they were given
    std::vector<DoublePair> first;     // [n_atoms] of an affine part with fixed atoms: y_a0; else empty: 1
    std::vector<DoublePair> of_fixed;  // [n_atoms][relations.n_fixed]
    bool is_thick;                     // plain doubles do: neither thin nor with atoms far out for their mass
    std::vector<DoublePair> y;         // [n_atoms][rank]
    std::vector<DoublePair> z;         // [n_atoms] of a site off the plane: + z u_1 x u_2; or empty: there is none
    std::vector<double> height;        // the same over unit axes, rounded
    std::vector<DoublePair> share;     // [n_atoms][1 + rank]: m/M, m y_p / M
    std::vector<double> weights;  // [2][n_atoms][1 + rank] of a thick one: coordinates and shares as BodyKind has them
    double excess[4][4];          // as in BodyKind

    std::int64_t bytes() const;
};

// What makes a body impossible; `atom` within it, -1 if it is none in particular.
struct BodyFault {
    enum Cause { no_mass, one_mass, one_point, not_finite, size, off_line, light, twice, undetermined, held } cause;
    std::int32_t atom;
};

// masses [n], of which 0 are sites; place [n][3]. Throws BodyFault.
Body make_body(std::int32_t n, const double *masses, const double *coordinates);

// relations: none of them implied by others. extent: what violations are relative to. Throws BodyFault.
Body make_affine(const double *masses, const Relations &relations, double extent);

// "has no mass", ...
const char *fault_in_words(BodyFault::Cause cause);

// Which atom of a body is nearest to one of those before it, so that images are taken step by step: pairs of an atom
// and the one before it, beginning at `first`.
struct NearestStep {
    std::int32_t atom, before;
};
std::vector<NearestStep> nearest_steps(const Body &body, std::int32_t first);

}  // namespace holonomic::rigid
