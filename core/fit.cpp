#include "core/fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/caller/box.hpp"
#include "core/caller/view.hpp"
#include "core/run/bond_words.hpp"

namespace holonomic {

namespace {

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

template <class Each>
void for_active(const Chains &chains, const Each &each) {
    for (std::int64_t number = 0; number < chains.n_chains(); ++number)
        if (chains.is_active(number)) each(chains.molecule(number));
}

// Half the smallest distance between opposite faces, beyond which the image may be another one.
double half_width(const Box &box) {
    double steepest = 0;
    for (int i = 0; i < 3; ++i) {
        const double *const g = box.inverse + i;
        steepest = std::max(steepest, g[0] * g[0] + g[3] * g[3] + g[6] * g[6]);
    }
    return box.shape == Box::none || !(steepest > 0) ? std::numeric_limits<double>::infinity()
                                                     : 0.5 / std::sqrt(steepest);
}

// What does not fit, and how all bonds are.
struct Misfit {
    std::int64_t molecule = -1, bond = -1, n_molecules = 0, n_bad = 0;
    double worst = 1;  // the larger one of length over length wanted, and its inverse
    double least = std::numeric_limits<double>::infinity(), most = 0;  // length over length wanted, of all bonds
};

template <class IsBad>
Misfit find_misfit(const Chains &chains, const BondVectors &bonds, const IsBad &is_bad) {
    Misfit found;
    for_active(chains, [&](const Molecule &m) {
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
    });
    return found;
}

// What is likely to have gone wrong, by what the bonds look like.
void write_causes(const Misfit &found, const Box *box, int base, char *text, std::size_t size) {
    if (found.most < 1.2 * found.least) {
        std::snprintf(text, size,
                      "all bonds are about %.3g times as long as they should be: are lengths and positions "
                      "in the same unit?",
                      found.most);
        return;
    }
    const char *const of_box = !box                      ? ""
                               : box->shape == Box::none ? "a molecule cut by a face of the cell, as no box is set; "
                                                         : "a box of another unit or another time than the positions; ";
    std::snprintf(text, size,
                  "likely causes: %slengths in another order than the bonds, or in another unit than the positions; "
                  "atoms counted from %d (here from %d)",
                  of_box, 1 - base, base);
}

Error misfit_error(const Chains &chains, const Misfit &found, const BondVectors &bonds, const char *what) {
    const Molecule m = chains.molecule(found.molecule);
    double length = 0;
    for_bonds(bonds, m, [&](std::int64_t k, const double *d) {
        if (k == found.bond) length = length_of(d);
    });
    char causes[280];
    write_causes(found, bonds.box, chains.base, causes, sizeof causes);
    Error error =
        make_error(Status::lengths,
                   "molecule %s, %s: %.6g long %s, it should be %.6g; %s%s%lld of %lld molecules have such "
                   "bonds; %s. Nothing was changed (hol_chains_set_checks)",
                   chains.name_of_molecule(m.number).text, name_of_bond(chains, m, found.bond).text, length, what,
                   m.length(found.bond), bonds.box ? box_in_words(*bonds.box) : "", bonds.box ? "; " : "",
                   static_cast<long long>(found.n_bad), static_cast<long long>(found.n_molecules), causes);
    error.chain = found.molecule;
    error.bond = found.bond;
    error.n_bad = found.n_bad;
    error.base = chains.base;
    return error;
}

bool is_too_long(double length, double a) { return length > most_stretched * a; }

}  // namespace

void check_reference(const Chains &chains, const BondVectors &bonds, const char *what) {
    const double half = bonds.box ? half_width(*bonds.box) : std::numeric_limits<double>::infinity();
    const Misfit found = find_misfit(chains, bonds, [&](double length, double a) {
        return std::fabs(length - a) > most_off * a || length > half * (1 + 1e-6);
    });
    if (found.molecule >= 0) throw misfit_error(chains, found, bonds, what);
}

void check_trial(const Chains &chains, const AtomArray &r) {
    const BondVectors bonds{&r, nullptr, &chains.box};
    const Misfit found = find_misfit(chains, bonds, is_too_long);
    if (found.molecule >= 0) throw misfit_error(chains, found, bonds, "in the positions to be projected");
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
    char others[80] = "";
    if (n_bad > 1)
        std::snprintf(others, sizeof others, " (the first of %lld bad molecules)", static_cast<long long>(n_bad));
    *error =
        make_error(Status::lengths,
                   "molecule %s, %s: %.6g long in the positions to be projected, it should be %.6g; %s: a molecule "
                   "cut by a face of the cell, or a step that is far too large; the molecule was left as it "
                   "is (hol_chains_set_checks)%s",
                   chains.name_of_molecule(molecule).text, name_of_bond(chains, m, bond).text, worst * m.length(bond),
                   m.length(bond), box_in_words(chains.box), others);
    error->chain = molecule;
    error->bond = bond;
    error->n_bad = n_bad;
    error->base = chains.base;
    return true;
}

WorstLength worst_length(const Chains &chains, const BondVectors &bonds) {
    WorstLength worst{0, -1, -1};
    for_active(chains, [&](const Molecule &m) {
        for_bonds(bonds, m, [&](std::int64_t k, const double *d) {
            const double a = m.length(k), error = std::fabs(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - a * a) / (a * a);
            if (worst.molecule >= 0 && !(error > worst.error)) return;
            worst = {error, m.number + chains.base, k + chains.base};
        });
    });
    return worst;
}

}  // namespace holonomic
