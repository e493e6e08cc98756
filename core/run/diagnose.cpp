#include "core/run/diagnose.hpp"

#include <cmath>
#include <cstdio>

#include "core/caller/box.hpp"
#include "core/caller/view.hpp"
#include "core/run/dependent_bond.hpp"

namespace holonomic {

namespace {

bool bond_vector(const AtomArray &r, const Box &box, const Molecule &m, std::int64_t k, double *d) {
    double a[3], b[3];
    read_atom(r, m.atom(m.i(k)), a);
    read_atom(r, m.atom(m.j(k)), b);
    bond_vector(box, a, b, d);
    return d[0] != 0 || d[1] != 0 || d[2] != 0;
}

// First bond of a linear chain whose pivot vanishes; -1 if none does, -2 if the numbers overflow before.
std::int64_t vanishing_pivot(const AtomArray &r, const Box &box, const Molecule &m) {
    double d[3], d1[3];
    bond_vector(r, box, m, 0, d);
    double q = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], E = m.w(0) * q;
    for (std::int64_t k = 0; k < m.n_bonds; ++k) {
        const double P = E + m.w(k + 1) * q;
        if (!std::isfinite(P)) return -2;
        if (!(P > 0)) return k;
        if (k + 1 == m.n_bonds) break;
        bond_vector(r, box, m, k + 1, d1);
        const double q1 = d1[0] * d1[0] + d1[1] * d1[1] + d1[2] * d1[2];
        double X = 0;
        for (int c = 0; c < 3; ++c) {
            const double x = d[(c + 1) % 3] * d1[(c + 2) % 3] - d[(c + 2) % 3] * d1[(c + 1) % 3];
            X += x * x;
        }
        E = m.w(k + 1) * (q1 * E + m.w(k + 1) * X) / P;
        q = q1;
        for (int c = 0; c < 3; ++c) d[c] = d1[c];
    }
    return -1;
}

// What is wrong with one molecule.
class Diagnosis {
public:
    Diagnosis(const Chains &chains, const Tally &tally, const Box &box)
        : chains_(chains), box_(box), m_(chains.molecule(tally.first_bad)), base_(chains.base), n_bad_(tally.n_bad) {
        std::snprintf(name_, sizeof name_, "%s %s", m_.shape ? "molecule" : "chain",
                      chains.name_of_molecule(m_.number).text);
        if (n_bad_ > 1)
            std::snprintf(others_, sizeof others_, " (the first of %lld bad %s)", static_cast<long long>(n_bad_),
                          m_.shape ? "molecules" : "chains");
    }

    Error find(const NamedArray *arrays, int n_arrays, Status otherwise) {
        Error error;
        if (not_finite(arrays, n_arrays, error)) return error;
        const AtomArray &r = *arrays[0].array;
        for (std::int64_t k = 0; k < m_.n_bonds; ++k) {
            double d[3];
            if (!bond_vector(r, box_, m_, k, d)) return of_bond(k, "has length zero");
        }
        const std::int64_t open = open_cycle(m_, r, box_);
        if (open >= 0)
            return of_bond(
                open, "does not close its cycle: the nearest images of its bonds lead to another image of the atom");
        const std::int64_t bond = m_.shape ? dependent_bond(m_, r, box_) : vanishing_pivot(r, box_, m_);
        if (bond >= 0 && m_.shape)
            return of_bond(bond, "depends on the others: their constraints hold it already at these positions");
        if (bond >= 0) return taut(bond);
        if (bond == -1 && otherwise == Status::no_convergence)
            return finish(make_error(otherwise,
                                     "%s: no corrections along the reference bonds bring the bonds back to their "
                                     "lengths; the step is too large, or a length can't be reached%s",
                                     name_, others_),
                          -1, -1);
        return finish(make_error(Status::not_finite, "%s: the numbers overflow or underflow; choose other units%s",
                                 name_, others_),
                      -1, -1);
    }

private:
    long long number(std::int64_t i) const { return static_cast<long long>(i + base_); }

    Error finish(Error error, std::int64_t bond, std::int64_t atom) const {
        error.chain = m_.number;
        error.bond = bond;
        error.atom = atom;
        error.n_bad = n_bad_;
        error.base = base_;
        return error;
    }

    bool not_finite(const NamedArray *arrays, int n_arrays, Error &error) const {
        for (int a = 0; a < n_arrays; ++a) {
            if (!arrays[a].array->x) continue;
            for (std::int64_t i = 0; i < m_.n_atoms; ++i) {
                double x[3];
                read_atom(*arrays[a].array, m_.atom(i), x);
                if (std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2])) continue;
                error = finish(make_error(Status::not_finite, "%s: the %s of atom %s is not finite%s", name_,
                                          arrays[a].what, chains_.name_of_atom(m_.atom(i)).text, others_),
                               -1, m_.atom(i));
                return true;
            }
        }
        return false;
    }

    // Its number within the molecule, and the atoms; in the caller's arrays it may have another number.
    Error of_bond(std::int64_t k, const char *what) const {
        char place[48] = "";
        if (m_.shape || m_.bond_list)
            std::snprintf(place, sizeof place, "%lld of the arrays per bond, ", number(m_.bond(k)));
        return finish(make_error(Status::degenerate, "%s: bond %lld (%satoms %s and %s) %s%s", name_, number(k), place,
                                 chains_.name_of_atom(m_.atom(m_.i(k))).text,
                                 chains_.name_of_atom(m_.atom(m_.j(k))).text, what, others_),
                      k, -1);
    }

    Error taut(std::int64_t k) const {
        return finish(make_error(Status::degenerate,
                                 "%s: taut between atoms that are held fixed; the tension of bond %lld (atoms %s "
                                 "and %s) is not determined%s",
                                 name_, number(k), chains_.name_of_atom(m_.atom(k)).text,
                                 chains_.name_of_atom(m_.atom(k + 1)).text, others_),
                      k, -1);
    }

    const Chains &chains_;
    const Box &box_;
    const Molecule m_;
    const int base_;
    const std::int64_t n_bad_;
    char name_[128], others_[80] = "";
};

}  // namespace

void check_values(const Chains &chains, const Tally &tally, const double *values, const char *what) {
    const Molecule m = chains.molecule(tally.first_bad);
    for (std::int64_t k = 0; k < m.n_bonds; ++k) {
        if (std::isfinite(values[m.bond(k)])) continue;
        Error error = make_error(Status::not_finite, "molecule %s: the %s of bond %lld is not finite",
                                 chains.name_of_molecule(m.number).text, what, static_cast<long long>(k + chains.base));
        error.chain = m.number;
        error.bond = k;
        error.n_bad = tally.n_bad;
        error.base = chains.base;
        throw error;
    }
}

Error diagnose(const Chains &chains, const Tally &tally, const Box &box, const NamedArray *arrays, int n_arrays,
               Status otherwise) {
    return Diagnosis(chains, tally, box).find(arrays, n_arrays, otherwise);
}

}  // namespace holonomic
