#include "core/check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/caller/box.hpp"
#include "core/caller/packed_array.hpp"
#include "core/run/bond_words.hpp"
#include "core/run/outcomes.hpp"

namespace holonomic {

namespace {

// Up to this many times too long or too short, bonds look like those of other force fields.
constexpr double crude = 1.5;

// Where squares overflow, the bond is too long all the same.
double length_of(const double *d) {
    const double dd = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    return std::isfinite(dd) ? std::sqrt(dd) : std::hypot(d[0], d[1], d[2]);
}

// Calls each(bond, vector) for all bonds of a molecule.
template <class Each>
void for_bonds(const BondVectors &bonds, const Molecule &m, const Each &each) {
    double from[3], to[3] = {0, 0, 0}, d[3];
    for (std::int64_t k = 0; k < m.n_bonds; ++k) {
        if (!bonds.r) {
            read_atom(*bonds.d, m.bond(k), d);
        } else {
            if (k > 0 && m.i(k) == m.j(k - 1))
                std::copy(to, to + 3, from);
            else
                read_atom(*bonds.r, m.atom(m.i(k)), from);
            read_atom(*bonds.r, m.atom(m.j(k)), to);
            bond_vector(*bonds.box, from, to, d);
        }
        each(k, d);
    }
}

// How vectors are read: most arrays are packed, and most programs have no box or a rectangular one.
struct PackedRows {
    const double *x;
    explicit PackedRows(const AtomArray &array) : x(reinterpret_cast<const double *>(array.x)) {}
    void read(std::int64_t i, double *d) const {
        for (int c = 0; c < 3; ++c) d[c] = x[3 * i + c];
    }
    void difference(std::int64_t i, std::int64_t j, double *d) const {
        for (int c = 0; c < 3; ++c) d[c] = x[3 * j + c] - x[3 * i + c];
    }
};
struct AnyLayout {
    const AtomArray &array;
    explicit AnyLayout(const AtomArray &a) : array(a) {}
    void read(std::int64_t i, double *d) const { read_atom(array, i, d); }
    void difference(std::int64_t i, std::int64_t j, double *d) const {
        double from[3];
        read_atom(array, i, from);
        read_atom(array, j, d);
        for (int c = 0; c < 3; ++c) d[c] -= from[c];
    }
};
struct NoBox {
    explicit NoBox(const Box *) {}
    void image(double *) const {}
};
// Half the smallest distance between opposite faces, beyond which the image may be another one.
double half_width(const Box &box) {
    const double gradient = steepest_gradient(box);
    return gradient > 0 ? 0.5 / gradient : std::numeric_limits<double>::infinity();
}

// Most bonds are shorter than that, and their own images.
struct InBox {
    const Box &box;
    const double near;  // a square
    explicit InBox(const Box *b) : box(*b), near((1 - 1e-9) * half_width(*b) * half_width(*b)) {}
    void image(double *d) const {
        if (!(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < near)) minimum_image(box, d);
    }
};

// Calls each(molecule, k, d.d, a) for all bonds of active molecules as long as it returns true: once per run, and in
// every call with a report, so that no bond waits for what all of them have in common.
template <class Vectors, class Images, class Each>
bool go_through(const Chains &chains, const BondVectors &bonds, const Each &each) {
    const Vectors vectors(bonds.r ? *bonds.r : *bonds.d);
    const Images images(bonds.box);
    const bool of_atoms = bonds.r != nullptr;
    return chains.for_active([&](const Molecule &m) {
        const EliminationPlan *const shape = m.shape ? m.shape->elimination.get() : nullptr;
        const std::int64_t *const list = m.atom_list, first = m.first_atom, n_bonds = m.n_bonds;
        const double *const lengths = m.length_table, uniform = m.length_uniform;
        for (std::int64_t k = 0; k < n_bonds; ++k) {
            double d[3];
            if (of_atoms) {
                const std::int64_t i = shape ? shape->atom_i[k] : k, j = shape ? shape->atom_j[k] : k + 1;
                vectors.difference(list ? list[i] : first + i, list ? list[j] : first + j, d);
                images.image(d);
            } else {
                vectors.read(m.bond(k), d);
            }
            const double a = lengths ? lengths[k] : uniform;
            if (!each(m, k, d[0] * d[0] + d[1] * d[1] + d[2] * d[2], a)) return false;
        }
        return true;
    });
}
template <class Each>
bool go_through(const Chains &chains, const BondVectors &bonds, const Each &each) {
    const bool packed = (bonds.r ? bonds.r : bonds.d)->packed, box = bonds.r && bonds.box->lattice != Box::none;
    if (packed)
        return box ? go_through<PackedRows, InBox>(chains, bonds, each)
                   : go_through<PackedRows, NoBox>(chains, bonds, each);
    return box ? go_through<AnyLayout, InBox>(chains, bonds, each) : go_through<AnyLayout, NoBox>(chains, bonds, each);
}

// Whether no bond's length is outside least a .. most a, nor above `longest`. Not a number is inside.
bool all_within(const Chains &chains, const BondVectors &bonds, double least, double most, double longest) {
    const double low = least * least, high = most * most, end = longest * longest;
    return go_through(chains, bonds, [=](const Molecule &, std::int64_t, double dd, double a) {
        const double a2 = a * a;
        return !((dd < low * a2) | (dd > high * a2) | (dd > end));
    });
}

// What does not fit, and how all bonds are.
struct BondMisfit {
    std::int64_t molecule = -1, bond = -1, n_molecules = 0, n_bad = 0;
    double worst = 1;  // the larger one of length over length wanted, and its inverse
    double least = std::numeric_limits<double>::infinity(), most = 0;  // length over length wanted, of all bonds
};

template <class IsBad>
BondMisfit find_misfit(const Chains &chains, const BondVectors &bonds, Status status, const IsBad &is_bad) {
    BondMisfit found;
    chains.for_active([&](const Molecule &m) {
        bool bad = false;
        for_bonds(bonds, m, [&](std::int64_t k, const double *d) {
            const double length = length_of(d);
            if (!std::isfinite(length)) return;
            const double a = m.length(k), ratio = length / a, off = std::max(ratio, 1 / ratio);
            found.least = std::min(found.least, ratio);
            found.most = std::max(found.most, ratio);
            if (!is_bad(length, a)) return;
            bad = true;
            if (found.molecule >= 0 && !(off > found.worst)) return;
            found.worst = off;
            found.molecule = m.number;
            found.bond = k;
        });
        ++found.n_molecules;
        found.n_bad += bad;
        if (bad) note_status(m.number, status);
        return true;
    });
    return found;
}

// What is likely to have gone wrong, by what the bonds look like; the most likely first.
void write_causes(const BondMisfit &found, const Box *box, int base, char *text, std::size_t size) {
    const bool none_is_right = found.least > 1 + most_off || found.most < 1 - most_off;
    if (none_is_right && found.most < 1.2 * found.least && found.worst > crude)
        std::snprintf(text, size, "all are about %.3g times as long: lengths and positions are hardly in the same unit",
                      found.most);
    else if (found.worst > 1 + most_off && found.worst <= crude)
        std::snprintf(text, size,
                      "likely a crude start or another force field's lengths (hol_impose), or another order");
    else
        std::snprintf(text, size, "likely a %s, another order or unit, or atoms counted from %d (here from %d)",
                      !box || box->lattice == Box::none ? "molecule cut by a face" : "box of another time", 1 - base,
                      base);
}

Error misfit_error(const Chains &chains, const BondMisfit &found, const BondVectors &bonds, const char *what) {
    const Molecule m = chains.molecule(found.molecule);
    double length = 0;
    for_bonds(bonds, m, [&](std::int64_t k, const double *d) {
        if (k == found.bond) length = length_of(d);
    });
    char causes[160];
    write_causes(found, bonds.box, chains.base, causes, sizeof causes);
    Error error =
        make_error(Status::lengths, "molecule %s, %s: %.6g long %s, it should be %.6g (%lld of %lld molecules); %s%s%s",
                   chains.name_of_molecule(m.number).text, name_of_bond(chains, m, found.bond).text, length, what,
                   m.length(found.bond), static_cast<long long>(found.n_bad), static_cast<long long>(found.n_molecules),
                   bonds.box ? box_in_words(*bonds.box) : "", bonds.box ? "; " : "", causes);
    error.chain = found.molecule;
    error.bond = found.bond;
    error.n_bad = found.n_bad;
    error.base = chains.base;
    return error;
}

bool is_too_long(double length, double a) { return length > most_stretched * a; }

// The reference fits where this is said: it is the step that is too long, whether or not Newton's method would come
// back.
Error stretched_error(const Chains &chains, const Molecule &m, std::int64_t bond, double length, std::int64_t n_bad) {
    char others[80] = "";
    if (n_bad > 1)
        std::snprintf(others, sizeof others, " (the first of %lld bad molecules)", static_cast<long long>(n_bad));
    Error error = make_error(
        Status::no_convergence,
        "molecule %s, %s: %.6g long in the positions to be projected, it should be %.6g; %s: %s, or a face of "
        "the cell cuts the molecule%s",
        chains.name_of_molecule(m.number).text, name_of_bond(chains, m, bond).text, length, m.length(bond),
        box_in_words(chains.box), too_long_a_step, others);
    error.chain = m.number;
    error.bond = bond;
    error.n_bad = n_bad;
    error.base = chains.base;
    return error;
}

}  // namespace

void check_reference(const Chains &chains, const BondVectors &bonds, const char *what) {
    const double half = bonds.r ? half_width(*bonds.box) : std::numeric_limits<double>::infinity();
    const double longest = half * (1 + 1e-6);
    if (all_within(chains, bonds, 1 - most_off, 1 + most_off, longest)) {
        if (bonds.r) check_cut(chains, *bonds.r, *bonds.box, what);
        return;
    }
    const BondMisfit found = find_misfit(chains, bonds, Status::lengths, [&](double length, double a) {
        return std::fabs(length - a) > most_off * a || length > longest;
    });
    if (bonds.r && found.worst <= crude) check_cut(chains, *bonds.r, *bonds.box, what);
    if (found.molecule >= 0) throw misfit_error(chains, found, bonds, what);
}

void check_trial(const Chains &chains, const AtomArray &r) {
    const BondVectors bonds{&r, nullptr, &chains.box};
    if (all_within(chains, bonds, 0, most_stretched, std::numeric_limits<double>::infinity())) return;
    const BondMisfit found = find_misfit(chains, bonds, Status::no_convergence, is_too_long);
    if (found.molecule < 0) return;
    const Molecule m = chains.molecule(found.molecule);
    throw stretched_error(chains, m, found.bond, found.worst * m.length(found.bond), found.n_bad);
}

bool is_stretched(const Chains &chains, std::int64_t molecule, const AtomArray &r, std::int64_t n_bad, Error *error) {
    const BondVectors bonds{&r, nullptr, &chains.box};
    const Molecule m = chains.molecule(molecule);
    double worst = 0;
    std::int64_t bond = -1;
    for_bonds(bonds, m, [&](std::int64_t k, const double *d) {
        const double a = m.length(k), length = length_of(d);
        if (!std::isfinite(length) || !is_too_long(length, a) || !(length / a > worst)) return;
        worst = length / a;
        bond = k;
    });
    if (bond < 0) return false;
    *error = stretched_error(chains, m, bond, worst * m.length(bond), n_bad);
    return true;
}

WorstLength worst_length(const Chains &chains, const BondVectors &bonds) {
    double a2_of_worst = 1, worst = -1;
    std::int64_t molecule = -1, bond = -1;
    go_through(chains, bonds, [&](const Molecule &m, std::int64_t k, double dd, double a) {
        const double a2 = a * a, off = std::fabs(dd - a2);
        if (off * a2_of_worst > worst * a2) { /* without a division for each bond */
            worst = off;
            a2_of_worst = a2;
            molecule = m.number;
            bond = k;
        }
        return true;
    });
    if (molecule < 0) return {0, -1, -1};
    return {worst / a2_of_worst, molecule + chains.base, bond + chains.base};
}

}  // namespace holonomic
