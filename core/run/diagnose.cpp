#include "core/run/diagnose.hpp"

#include <cmath>
#include <cstdio>

#include "core/caller/box.hpp"
#include "core/caller/packed_array.hpp"
#include "core/extended/molecule.hpp"
#include "core/run/bond_words.hpp"
#include "core/run/outcomes.hpp"

namespace holonomic {

namespace {

bool bond_vector(const AtomArray &r, const Box &box, const Molecule &m, std::int64_t k, double *d) {
    double a[3], b[3];
    read_atom(r, m.atom(m.i(k)), a);
    read_atom(r, m.atom(m.j(k)), b);
    bond_vector(box, a, b, d);
    return d[0] != 0 || d[1] != 0 || d[2] != 0;
}

// Of a molecule that is no linear chain, by the extended-precision solver: the first bond whose pivot vanishes; -1 if
// none does, -2 if the bond vectors are of no use.
std::int64_t dependent_bond(const Molecule &molecule, const AtomArray &r, const Box &box) {
    const std::unique_ptr<const ExtendedMolecule> solver = ExtendedMolecule::make(molecule, r, box);
    if (solver->good()) return -1;
    return solver->dependent_bond() < 0 ? -2 : solver->dependent_bond();
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
        std::snprintf(name_, sizeof name_, "molecule %s", chains.name_of_molecule(m_.number).text);
        if (n_bad_ > 1)
            std::snprintf(others_, sizeof others_, " (the first of %lld bad molecules)",
                          static_cast<long long>(n_bad_));
    }

    Error find(const NamedArray *arrays, int n_arrays, Status otherwise) {
        Error error;
        if (not_finite(arrays, n_arrays, error)) return error;
        const AtomArray &r = *arrays[0].array;
        reference_ = &r;
        if (otherwise == Status::no_convergence) trial_ = arrays[1].array;
        for (std::int64_t k = 0; k < m_.n_bonds; ++k) {
            double d[3];
            if (!bond_vector(r, box_, m_, k, d)) return of_bond(k, "has length zero");
        }
        if (m_.shape && m_.shape->elimination->network && !m_.shape->elimination->extended) {
            if (otherwise == Status::no_convergence) return out_of_reach();
            return finish(make_error(Status::degenerate,
                                     "%s: the iteration for its multipliers does not converge: its bonds depend on "
                                     "each other, or nearly so%s",
                                     name_, others_),
                          -1, -1);
        }
        const std::int64_t bond = m_.shape ? dependent_bond(m_, r, box_) : vanishing_pivot(r, box_, m_);
        if (bond >= 0 && m_.shape)
            return of_bond(bond, "depends on the others: their constraints hold it already at these positions");
        if (bond >= 0) return taut(bond);
        if (bond == -1 && otherwise == Status::no_convergence) return out_of_reach();
        return finish(make_error(Status::not_finite, "%s: the numbers overflow or underflow; choose other units%s",
                                 name_, others_),
                      -1, -1);
    }

private:
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

    // "it should be 1, is 1.1 in the reference and 3 in the positions to be projected; no box is set"
    Words lengths_of(std::int64_t k) const {
        Words words;
        const double a = m_.length(k), before = length_of_bond(m_, k, *reference_, box_);
        if (trial_ && !in_place())
            std::snprintf(words.text, sizeof words.text,
                          "it should be %.6g long, is %.6g in the reference and %.6g in the positions to be projected; "
                          "%s",
                          a, before, length_of_bond(m_, k, *trial_, chains_.box), box_in_words(chains_.box));
        else
            std::snprintf(words.text, sizeof words.text, "it should be %.6g long and is %.6g; %s", a, before,
                          box_in_words(box_));
        return words;
    }

    // The bond that is farthest from its length, by the trial positions or the reference.
    std::int64_t worst_bond() const {
        std::int64_t worst = 0;
        double most = -1;
        for (std::int64_t k = 0; k < m_.n_bonds; ++k)
            for (int which = 0; which < 2; ++which) {
                const double length =
                    which == 0 ? length_of_bond(m_, k, *trial_, chains_.box) : length_of_bond(m_, k, *reference_, box_);
                const double off = std::fabs(length / m_.length(k) - 1);
                if (!(off > most)) continue;
                most = off;
                worst = k;
            }
        return worst;
    }

    // Positions that were to be brought onto the constraints along their own bonds.
    bool in_place() const { return trial_->x == reference_->x; }

    Error out_of_reach() const {
        const std::int64_t k = worst_bond();
        return finish(
            make_error(Status::no_convergence, "%s, %s: %s: %s%s", name_, name_of_bond(chains_, m_, k).text,
                       lengths_of(k).text,
                       in_place() ? "not reached along these bonds (hol_impose goes further)" : too_long_a_step,
                       others_),
            k, -1);
    }

    Error of_bond(std::int64_t k, const char *what) const {
        return finish(make_error(Status::degenerate, "%s: %s %s; %s%s", name_, name_of_bond(chains_, m_, k).text, what,
                                 lengths_of(k).text, others_),
                      k, -1);
    }

    Error taut(std::int64_t k) const {
        return finish(make_error(Status::degenerate,
                                 "%s: taut between atoms that are held fixed; the tension of %s is not determined: "
                                 "%s%s",
                                 name_, name_of_bond(chains_, m_, k).text, lengths_of(k).text, others_),
                      k, -1);
    }

    const Chains &chains_;
    const Box &box_;
    const Molecule m_;
    const int base_;
    const std::int64_t n_bad_;
    const AtomArray *reference_ = nullptr, *trial_ = nullptr;  // trial: at the position level
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

Error diagnose(const Chains &chains, const Tally &tally, const Box &box, std::initializer_list<NamedArray> arrays,
               Status otherwise) {
    return Diagnosis(chains, tally, box).find(arrays.begin(), static_cast<int>(arrays.size()), otherwise);
}

void throw_diagnosis(const Chains &chains, const Tally &tally, std::initializer_list<NamedArray> arrays,
                     Status otherwise) {
    throw_error(chains, tally, [&](const Tally &bad) { return diagnose(chains, bad, chains.box, arrays, otherwise); });
}

}  // namespace holonomic
