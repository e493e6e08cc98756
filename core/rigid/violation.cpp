// How far molecules with bodies are from their constraints. Of a body: how far its atoms are from where it has them,
// and its axes from their lengths and right angles, relative to its size; it has no bond to name.
#include <algorithm>
#include <cmath>

#include "core/check.hpp"
#include "core/index.hpp"
#include "core/rigid/rates.hpp"
#include "core/rigid/run.hpp"
#include "core/rigid/verbs.hpp"
#include "core/run/bond_words.hpp"
#include "core/run/outcomes.hpp"
#include "core/run/thread_memory.hpp"

namespace holonomic::rigid {

namespace {

// Whether a face of the box cuts a molecule, as it has been read: an atom was put into another image.
bool is_cut(const System &system) {
    double straight = 0, moved = 0;
    for (std::int32_t i = 1; i < system.kind().n_atoms; ++i) {
        const Vector3<double> x = rounded(system.now.x[i]);
        const double at_once[3] = {x.x, x.y, x.z};
        for (int c = 0; c < 3; ++c) {
            const double as_it_is = system.raw[3 * i + c] - system.raw[c];
            straight = std::max(straight, std::fabs(as_it_is));
            moved = std::max(moved, std::fabs(as_it_is - at_once[c]));
        }
    }
    return moved > 0.25 * straight;
}

// An error of |d.d - a^2| / a^2, or of a rate.
struct Worst1 {
    double error = -1;
    std::int64_t molecule = -1, bond = -1, atom = -1;
    void take(double value, std::int64_t m, std::int64_t k, std::int64_t a) {
        if (!(value > error) && molecule >= 0) return;
        error = value;
        molecule = m;
        bond = k;
        atom = a;
    }
};

class Measure {
public:
    explicit Measure(const Chains &chains) : chains_(chains), bodies_(*chains.bodies()) {
        memory_ = static_cast<char *>(thread_memory(Keep::rigid, bodies_.scratch_bytes()));
        if (!memory_) throw std::bad_alloc();
    }

    // Calls each(system, view) for the active molecules, positions read.
    template <class Each>
    void for_each(const AtomArray &r, const Cell &box, const Each &each) const {
        for (std::int64_t m = 0; m < bodies_.n_molecules(); ++m) {
            if (!bodies_.is_active(m)) continue;
            const System system(bodies_.kind(m), bodies_.body_kinds(), memory_);
            const MoleculeView view{bodies_.atoms(m), bodies_.bonds(m), chains_.n_chains() + m, chains_.images()};
            system.read(r, box, view, system.now);
            each(system, view);
        }
    }

    // Calls each(error, bond within the molecule or -1, atom or -1); the error is that of squares of lengths.
    template <class Each>
    static void lengths(const System &system, const MoleculeView &view, const Each &each) {
        const MoleculeKind &s = system.kind();
        for (std::size_t k = 0; k < s.bonds.size(); ++k) {
            if (s.bonds[k].row < 0) continue;
            const double a = s.bonds[k].length,
                         d = size_of(system.bond_vector(system.now, static_cast<std::int32_t>(k)));
            each(std::fabs((d - a) * (d + a)) / (a * a), static_cast<std::int64_t>(k), std::int64_t{-1});
        }
        for (std::int32_t k = 0; !s.hidden.empty() && k < s.n_rows; ++k) {
            if (s.bond_of_row[at(k)] >= 0 || !s.is_distance(k)) continue;
            const PairVector d = system.distance(system.now, k);
            each(std::fabs(rounded(dot(d, d) - s.target[at(k)])) / s.scale[at(k)], std::int64_t{-1}, view.atoms[0]);
        }
        for (const Part &part : s.parts) {
            const Body &body = system.body(part);
            const PairVector *const u = system.now.q + part.first_node + 1;
            for (std::int32_t p = 0; body.is_rigid && p < body.rank; ++p)
                for (std::int32_t q = p; q < body.rank; ++q) {
                    const DoublePair off = dot(u[p], u[q]) - (p == q ? body.square[p] : as_pair(0));
                    each(std::fabs(off.hi) / body.square[0].hi, std::int64_t{-1}, view.atoms[part.first_atom]);
                }
            for (std::int32_t i = part.first_atom; i < part.first_atom + body.n_atoms; ++i)
                each(2 * size_of(system.position_of(system.now, i) - system.now.x[i]) / body.extent, std::int64_t{-1},
                     view.atoms[i]);
        }
    }

    template <class Each>
    static void rates(const System &system, const MoleculeView &view, const AtomArray &v, const BoxRate *rate,
                      const Each &each) {
        const MoleculeKind &s = system.kind();
        system.velocities(v, view, system.b);
        for_rates(system, system.b, rate,
                  [&](std::int32_t, std::int32_t bond, bool square, const PairVector &p, const PairVector &q,
                      const PairVector &u, const PairVector &w) {
                      each(std::fabs(rounded(square ? dot(p, u) : dot(p, w) + dot(q, u))), bond);
                  });
        for (std::int32_t i = 0; i < s.n_held; ++i)
            each(size_of(system.velocity_of(system.now, system.b, rate, i) - vector_of_atom(v, view.atoms[i])) *
                     system.body(s.parts[at(s.part_of[at(i)])]).extent,
                 -1);
    }

private:
    const Chains &chains_;
    const Bodies &bodies_;
    char *memory_;
};

// Of a square; what is off by more is wrong in another way, too.
constexpr double most_of_another_box = 1.25;

Error another_box(const Chains &chains, std::int64_t molecule, double off, double inside, const char *what) {
    const std::int64_t *const atoms = chains.bodies()->atoms(molecule - chains.n_chains());
    Error error = make_error(Status::lengths,
                             "molecule %s: off by %.2g of its size %s; a face of the box cuts it, others fit to "
                             "%.0e: hardly the box of these positions",
                             chains.name_of_rigid(molecule, atoms[0]).text, off, what, std::max(inside, 0.0));
    error.chain = molecule;
    error.n_bad = 1;
    error.base = chains.base;
    return error;
}

}  // namespace

void check_reference(const Chains &chains, const AtomArray &r, const Cell &box, const char *what) {
    if (!chains.bodies()) return;
    Worst1 worst, cut, inside;
    std::int64_t n_inside = 0;
    Measure(chains).for_each(r, box, [&](const System &system, const MoleculeView &view) {
        const bool its_cut = box.lattice != Box::none && is_cut(system);
        n_inside += !its_cut;
        Measure::lengths(system, view, [&](double error, std::int64_t bond, std::int64_t atom) {
            if (std::isfinite(error)) (its_cut ? cut : inside).take(error, view.number, bond, atom);
            // off by a tenth of the length: its square by a fifth
            if (!std::isfinite(error) || !(error > 2 * most_off)) return;
            worst.take(error, view.number, bond, atom);
            note_status(view.number, Status::lengths);
        });
    });
    // errors of squares are twice those of lengths
    if (is_of_another_box(cut.error / 2, inside.error / 2, n_inside) && !(cut.error > most_of_another_box))
        throw another_box(chains, cut.molecule, cut.error / 2, inside.error / 2, what);
    if (worst.molecule < 0) return;
    const std::int64_t m = worst.molecule - chains.n_chains();
    const std::int64_t *const atoms = chains.bodies()->atoms(m);
    const auto name = [&](std::int64_t atom) { return chains.name_of_atom(atom); };
    Error error;
    if (worst.bond >= 0) {
        const Bond &bond = chains.bodies()->kind(m).bonds[at(worst.bond)];
        error = make_error(Status::lengths,
                           "molecule %s, its bond between atoms %s and %s: far from its length, %.6g, %s; %s",
                           chains.name_of_rigid(worst.molecule, atoms[0]).text, name(atoms[bond.i]).text,
                           name(atoms[bond.j]).text, bond.length, what, box_in_words(box));
    } else {
        error = make_error(Status::lengths,
                           "molecule %s, atom %s: far from its place in its body %s; %s; likely another order of atoms "
                           "than in the body's "
                           "coordinates, another unit, or a molecule cut by a face of the cell",
                           chains.name_of_rigid(worst.molecule, atoms[0]).text, name(worst.atom).text, what,
                           box_in_words(box));
    }
    error.chain = worst.molecule;
    error.bond = worst.bond;
    error.atom = worst.atom;
    error.n_bad = 1;
    error.base = chains.base;
    throw error;
}

void worst_length(const Chains &chains, const AtomArray &r, const Cell &box, WorstLength *worst) {
    if (!chains.bodies()) return;
    Worst1 found;
    Measure(chains).for_each(r, box, [&](const System &system, const MoleculeView &view) {
        Measure::lengths(system, view, [&](double error, std::int64_t bond, std::int64_t) {
            found.take(error, view.number, bond, -1);
        });
    });
    if (found.molecule < 0 || (worst->molecule >= 0 && !(found.error > worst->error))) return;
    *worst = {found.error, found.molecule + chains.base, found.bond < 0 ? -1 : found.bond + chains.base};
}

void violation(const Chains &chains, const AtomArray &r, const AtomArray &v, Worst *worst) {
    Worst1 length, rate;
    RunResult bad{empty_tally(), Outcome::not_finite};
    Measure(chains).for_each(r, chains.box, [&](const System &system, const MoleculeView &view) {
        bool finite = true;
        Measure::lengths(system, view, [&](double error, std::int64_t bond, std::int64_t) {
            finite = finite && std::isfinite(error);
            length.take(error, view.number, bond, -1);
        });
        if (v.x)
            Measure::rates(system, view, v, chains.box_rate(), [&](double error, std::int64_t bond) {
                finite = finite && std::isfinite(error);
                rate.take(error, view.number, bond, -1);
            });
        if (!finite) note_bad(view.number, bad.tally);
    });
    throw_if_bad(chains, bad, {{"position", &r}, {"velocity", &v}});
    const auto shown = [&](std::int64_t bond) { return bond < 0 ? -1 : bond + chains.base; };
    if (length.molecule >= 0 && (worst->length_molecule < 0 || length.error > worst->length)) {
        worst->length = length.error;
        worst->length_molecule = length.molecule + chains.base;
        worst->length_bond = shown(length.bond);
    }
    if (rate.molecule >= 0 && (worst->rate_molecule < 0 || rate.error > worst->rate)) {
        worst->rate = rate.error;
        worst->rate_molecule = rate.molecule + chains.base;
        worst->rate_bond = shown(rate.bond);
    }
}

}  // namespace holonomic::rigid
