// One molecule with bodies in one conformation: its nodes, the gradients of its rows, and the solution of its
// equations.
//
// All is kept in twice the precision. The factors are plain doubles; residuals, which are sums over the nodes, are not,
// so that a few corrections give what twice the precision would. Where the factors lose too much they are made in twice
// the precision, too.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/caller/box.hpp"
#include "core/index.hpp"
#include "core/kernels/atom.hpp"
#include "core/rigid/factor.hpp"

namespace holonomic::rigid {

enum class Outcome { good, not_finite, degenerate, no_convergence, stretched };

// Where the caller has the atoms of a molecule.
struct MoleculeView {
    const std::int64_t *atoms;
    const std::int64_t *bonds;
    std::int64_t number;         // of the molecule
    const std::int32_t *images;  // [..][3] of the bonds in the arrays per bond, where they are told
};

// Where a molecule is at an instant.
struct Conformation {
    PairVector *x;         // [n_atoms] from the first atom, images taken; coordinates of sites are read like the others
    PairVector *q;         // [n_nodes]
    PairVector *shift;     // [n_bonds] by which a bond reaches another image than the way through the molecule
    PairVector *gradient;  // [entries]
};

// The length of a vector, rounded.
inline double size_of(const PairVector &a) {
    const Vector3<double> v = rounded(a);
    return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
}

// The lattice vector that is told of a bond.
PairVector told_image(const Cell &box, const MoleculeView &view, std::size_t bond);

class System {
public:
    static std::int64_t bytes(const MoleculeKind &kind);
    // memory: bytes(kind)
    System(const MoleculeKind &kind, const Body *bodies, char *memory);

    // Nodes and gradients.
    void read(const AtomArray &r, const Cell &box, const MoleculeView &view, const Conformation &to) const;
    void differentiate(const Conformation &at) const;
    // Nodes of a vector per atom, by masses: velocities. What sites have is not looked at.
    void velocities(const AtomArray &v, const MoleculeView &view, PairVector *nodes) const;
    // Nodes of forces, on the centre and the u_p; sites' too, where the molecule is.
    void forces(const Conformation &at, const AtomArray &f, const MoleculeView &view, PairVector *nodes) const;
    // Adds to the nodes of fixed atoms what relations pass on to them.
    void pass_to_fixed(const AtomArray &f, const MoleculeView &view, PairVector *nodes) const;
    // What a vector per node is at an atom; not at sites off the plane of a body, for which the next two are.
    PairVector at_atom(const PairVector *nodes, std::int32_t atom) const;
    PairVector position_of(const Conformation &at, std::int32_t atom) const;
    // v: velocities of the nodes.
    PairVector velocity_of(const Conformation &at, const PairVector *v, const BoxRate *rate, std::int32_t atom) const;
    // d of a bond, between positions of nodes.
    PairVector bond_vector(const Conformation &at, std::int32_t bond) const;

    // The same of a row, which is of a distance.
    PairVector distance(const Conformation &at, std::int32_t row) const;

    // Adds to z multiples -w t of gradients so that sum of gradient.z + c = 0 in each row; t is written.
    Outcome project(const Conformation &at, const DoublePair *c, PairVector *z, DoublePair *t) const;
    // Moves q along the gradients of the reference until each row is fulfilled to `tolerance` of its scale. Where
    // Newton's method does not come there, by the path below.
    Outcome restore(const Conformation &reference, const Conformation &now, double tolerance, int most_iterations,
                    DoublePair *t, int *iterations, double *error) const;
    // Moves q along the gradients of the reference to about where the solution comes that begins there: of positions
    // reference + t (q - reference) for t from 0 to 1. Returns the number of linear solves, or 0 where it ends before.
    int follow(const Conformation &reference, const Conformation &now, DoublePair *t) const;
    // The largest residual of a row as |d.d - a^2| / a^2 is one, and its bond (-1: of a body).
    double residuals(const Conformation &at, DoublePair *to, std::int32_t *worst_bond = nullptr) const;
    // -sum t gradient, per node.
    void pulls(const Conformation &at, const DoublePair *t, PairVector *nodes) const;
    // xx xy xz yy yz zz of the sum of q (x) pull.
    void add_virial(const Conformation &at, const DoublePair *t, double factor, double *virial) const;
    // Of carrying the forces of sites off the plane of a body to its masses.
    void add_virial_of_sites(const Conformation &at, const AtomArray &f, const MoleculeView &view,
                             double *virial) const;

    // ln det of Z scaled to ones on its diagonal, of Z, and the gradient of the first per node; of rows that are bonds.
    // The reference's gradients are scratch.
    Outcome metric(const Conformation &at, double *log_det, double *log_det_z, PairVector *slope) const;

    const MoleculeKind &kind() const { return s_; }
    const Body &body(const Part &part) const { return bodies_[part.body]; }

    Conformation now, reference;
    PairVector *a, *b;  // [n_nodes] each
    DoublePair *t, *c;  // [n_rows] each
    double *raw;        // [n_atoms][3]
    double *within;     // of molecules by lengths: [n_bonds][3] and [n_held][3] twice

private:
    // The sum of z f over sites off the plane of a part.
    PairVector lifted_force(const Part &part, const AtomArray &f, const MoleculeView &view) const;
    void carry_to_axes(const Conformation &at, const Part &part, const PairVector &lifted, PairVector *nodes) const;

    // Adds -w times a multiplier times the gradient of a row to z of the nodes that move.
    template <class T>
    void move_along(const Conformation &where, std::int32_t row, const T &multiplier, PairVector *z) const {
        for (std::int32_t e = s_.entry_start[at(row)]; e < s_.entry_start[at(row + 1)]; ++e) {
            const std::int32_t node = s_.entries[at(e)].node;
            if (s_.w[at(node)] > 0) z[node] = z[node] - (s_.w[at(node)] * multiplier) * where.gradient[e];
        }
    }

    template <class T>
    std::int32_t assemble(const Factor<T> &f, const Conformation &rows, const Conformation &columns) const;
    template <class T>
    Outcome project_with(const Factor<T> &f, T *x, const Conformation &at, const DoublePair *c, PairVector *z,
                         DoublePair *t) const;
    // From q and t as they are, which belong together.
    template <class T>
    Outcome restore_with(const Factor<T> &f, T *x, const Conformation &reference, const Conformation &now,
                         double tolerance, int most_iterations, DoublePair *t, int *iterations, double *error) const;

    const MoleculeKind &s_;
    const Body *const bodies_;
    Factor<double> plain_;
    Factor<DoublePair> wide_;
    double *x_;
    DoublePair *wide_x_, *residual_, *inverse_;
    PairVector *start_;
    double *gradient_[2];  // [entries][3] as doubles
    double *path_;         // [n_rows] three times
    std::int64_t bytes_;   // of all arrays
};

}  // namespace holonomic::rigid
