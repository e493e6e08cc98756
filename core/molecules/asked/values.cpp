// New masses and lengths of a set of molecules: the same molecules, sorted into kinds again.
#include <algorithm>
#include <utility>

#include "core/index.hpp"
#include "core/molecules/batch.hpp"
#include "core/molecules/chains.hpp"
#include "core/molecules/given/closable.hpp"
#include "core/rigid/bodies.hpp"

namespace holonomic {

namespace {

void check_closable(const Chains &chains, const Molecule &m, const double *length) {
    Unclosable found;
    if (!find_unclosable(*m.shape, length, &found)) return;
    const auto name = [&](std::int64_t i) { return chains.name_of_atom(m.atom(i < 0 ? 0 : i)); };
    const Name names[3] = {name(m.i(found.bond)), name(m.j(found.bond)), name(found.corner)};
    throw unclosable_error(found, names, m.bond(found.bond), chains.base);
}

}  // namespace

// lengths [n_bonds] in the caller's order, or null: as they are.
void Chains::rebuild(const Masses &masses, const double *lengths) {
    Kinds kinds;
    Groups groups;
    std::vector<double> w, length;
    std::vector<std::int64_t> places;
    for (const Group &group : groups_.all())
        for (std::int64_t index = 0; index < group.count; ++index) {
            const Molecule m = molecule(group.first_molecule + index);
            w.resize(at(m.n_atoms));
            length.resize(at(m.n_bonds));
            for (std::int64_t i = 0; i < m.n_atoms; ++i) w[at(i)] = masses.w(m.atom(i));
            for (std::int64_t k = 0; k < m.n_bonds; ++k) length[at(k)] = lengths ? lengths[m.bond(k)] : m.length(k);
            const std::int64_t n_kinds = kinds.size();
            const std::int64_t kind =
                kinds.find(kind_of(group).shape, m.n_atoms, m.n_bonds, w.data(), length.data(), groups.last_kind());
            if (lengths && kind == n_kinds && m.shape) check_closable(*this, m, length.data());
            groups.append(kinds, kind, 1, m.first_atom, m.atom_list, m.first_bond, m.bond_list);
        }
    const double longest = kinds.longest(0, 0);
    check_width(box, longest, lengths);
    check_width(box_of_reference(), longest, lengths);
    longest_ = longest;
    kinds_ = std::move(kinds);
    groups_ = std::move(groups);
    changed();
}

// Lengths that a program changes step by step: the reference still has those before. Where they change by no more than
// this factor, positions that fitted are not looked at again.
constexpr double small_change = 1.5;

void Chains::set_lengths(const double *lengths) {
    std::vector<double> in_equations(lengths, lengths + n_bonds_);
    for (const std::int64_t bond : implied_) in_equations[at(bond)] = 1;
    check_lengths(n_bonds_, in_equations.data(), base);
    bool small = fits_.get();
    for (std::int64_t c = 0; small && c < n_chains(); ++c) {
        const Molecule m = molecule(c);
        for (std::int64_t k = 0; small && k < m.n_bonds; ++k) {
            const double ratio = lengths[m.bond(k)] / m.length(k);
            small = ratio < small_change && ratio * small_change > 1;
        }
    }
    std::unique_ptr<rigid::Bodies> bodies = rebuild_bodies(masses_, lengths);
    rebuild(masses_, lengths);
    bodies_ = std::move(bodies);
    for (std::size_t k = 0; k < unconstrained_.size(); ++k) of_unconstrained_[k].length = lengths[unconstrained_[k]];
    fits_.set(small);
}

void Chains::set_length(std::int64_t bond, double length) {
    std::vector<double> all(at(n_bonds_));
    lengths(all.data());
    all[at(bond)] = length;
    set_lengths(all.data());
}

void Chains::set_masses(const double *masses) {
    Masses next(n_atoms_, masses, base);
    for (std::int64_t i = 0; i < n_atoms_; ++i) {
        if (!use_.used(i) || next.fixed(i) == masses_.fixed(i)) continue;
        Error error = make_error(Status::value, "the mass of atom %s is %g: an atom that has bonds and %s must stay so",
                                 name_of_atom(i).text, masses[i], masses_.fixed(i) ? "is held fixed" : "can move");
        error.atom = i;
        error.base = base;
        throw error;
    }
    const bool fitted = fits_.get();
    std::unique_ptr<rigid::Bodies> bodies = rebuild_bodies(next, nullptr);
    rebuild(next, nullptr);
    bodies_ = std::move(bodies);
    fits_.set(fitted);
    masses_ = std::move(next);
}

}  // namespace holonomic
