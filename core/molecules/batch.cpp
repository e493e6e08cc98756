#include "core/molecules/batch.hpp"

#include <algorithm>
#include <cstdio>

#include "core/index.hpp"
#include "core/molecules/given/closable.hpp"
#include "core/molecules/memory_limit.hpp"
#include "core/molecules/planned/plan_memory.hpp"
#include "core/rigid/bodies.hpp"
#include "core/rigid/cliques.hpp"

namespace holonomic {

namespace {

bool ascend(const std::int64_t *x, std::int64_t n) {
    for (std::int64_t i = 1; i < n; ++i)
        if (x[i] != x[0] + i) return false;
    return true;
}

// Whether two molecules of the list may be of one kind, by their sizes.
bool alike(const FoundMolecules &found, std::size_t m, std::size_t n) {
    if (n >= found.molecules.size()) return false;  // also "before the first"
    return found.molecules[m].n_bonds == found.molecules[n].n_bonds &&
           found.molecules[m].n_atoms == found.molecules[n].n_atoms;
}

}  // namespace

Batch::Batch(Chains &chains)
    : chains_(chains), work_(std::make_unique<EliminationWork>()), before_(chains.groups_.mark()),
      kinds_before_(chains.kinds_.mark()), n_unconstrained_(chains.unconstrained_.size()),
      n_active_(chains.active_.size()) {}

Batch::~Batch() {
    if (committed_) return;
    chains_.groups_.roll_back(before_);
    chains_.kinds_.roll_back(kinds_before_);
    chains_.unconstrained_.resize(n_unconstrained_);
    chains_.of_unconstrained_.resize(n_unconstrained_);
    chains_.active_.resize(n_active_);
    chains_.changed();  // the tables that a plan points into may have moved
    for (const std::int64_t atom : taken_) chains_.use_.give_back(atom);
}

void Batch::take(std::int64_t atom, std::int64_t chain, std::int64_t position) {
    if (chains_.masses_.fixed(atom)) return fixed_.push_back(atom);
    if (chains_.use_.used(atom)) {
        const int base = chains_.base;
        Error error = make_error(Status::shared_atom,
                                 "atom %s, number %lld of chain %lld, is in use already: all bonds of a molecule must "
                                 "be added in one call of hol_chains_add_bonds",
                                 chains_.name_of_atom(atom).text, static_cast<long long>(position + base),
                                 static_cast<long long>(chain + base));
        error.atom = atom;
        error.chain = chain;
        error.base = base;
        throw error;
    }
    taken_.push_back(atom);
    chains_.use_.take(atom);
}

Error Batch::in_use(const Chains &chains, std::int64_t atom) {
    Error error = make_error(Status::shared_atom,
                             "atom %s is in a molecule of an earlier call already: all bonds of a molecule must be "
                             "added in one call",
                             chains.name_of_atom(atom).text);
    error.atom = atom;
    error.base = chains.base;
    return error;
}

void Batch::append_part(std::int64_t n_bonds, const std::int64_t *atoms, const double *lengths,
                        std::int64_t first_bond) {
    w_.resize(at(n_bonds + 1));
    for (std::int64_t k = 0; k <= n_bonds; ++k) w_[at(k)] = chains_.masses_.w(atoms[k]);
    const std::int64_t kind =
        chains_.kinds_.find(linear, n_bonds + 1, n_bonds, w_.data(), lengths, chains_.groups_.last_kind());
    chains_.groups_.append(chains_.kinds_, kind, 1, atoms[0], ascend(atoms, n_bonds + 1) ? nullptr : atoms, first_bond,
                           nullptr);
}

void Batch::leave_out(std::int64_t bond, const std::int64_t *atoms, double length) {
    chains_.unconstrained_.push_back(bond);
    chains_.of_unconstrained_.push_back({{atoms[0], atoms[1]}, length});
}

// Bonds between two fixed atoms divide it.
void Batch::append_chain(std::int64_t n_bonds, const std::int64_t *atoms, const double *lengths) {
    const std::int64_t first_bond = chains_.n_bonds_ + n_bonds_;
    std::int64_t begin = 0;
    for (std::int64_t k = 0; k <= n_bonds; ++k) {
        const bool end = k == n_bonds;
        if (!end && !(chains_.masses_.fixed(atoms[k]) && chains_.masses_.fixed(atoms[k + 1]))) continue;
        if (k > begin) append_part(k - begin, atoms + begin, lengths + begin, first_bond + begin);
        if (!end) leave_out(first_bond + k, atoms + k, lengths[k]);
        begin = k + 1;
    }
    n_bonds_ += n_bonds;
}

void Batch::append_block(std::int64_t count, std::int64_t n_bonds, std::int64_t first_atom, const double *lengths) {
    if (chains_.masses_.uniform() && !chains_.masses_.fixed(0)) {  // then all of them are of one kind
        w_.assign(at(n_bonds + 1), chains_.masses_.w(0));
        const std::int64_t kind =
            chains_.kinds_.find(linear, n_bonds + 1, n_bonds, w_.data(), lengths, chains_.groups_.last_kind());
        chains_.groups_.append(chains_.kinds_, kind, count, first_atom, nullptr, chains_.n_bonds_ + n_bonds_, nullptr);
        n_bonds_ += count * n_bonds;
        return;
    }
    std::vector<std::int64_t> atoms(at(n_bonds + 1));
    for (std::int64_t c = 0; c < count; ++c) {
        for (std::int64_t k = 0; k <= n_bonds; ++k) atoms[at(k)] = first_atom + c * (n_bonds + 1) + k;
        append_chain(n_bonds, atoms.data(), lengths);
    }
}

// Of a kind that is new.
void Batch::check_closable(const Shape &shape, const std::int64_t *atoms, const std::int64_t *bonds,
                           const double *lengths) const {
    Unclosable found;
    if (!find_unclosable(shape, lengths, &found)) return;
    const auto name = [&](std::int32_t i) { return chains_.name_of_atom(atoms[i < 0 ? 0 : i]); };
    const Name names[3] = {name(shape.i(found.bond)), name(shape.j(found.bond)), name(found.corner)};
    throw unclosable_error(found, names, bonds[found.bond], chains_.base);
}

// Where neighbours of the same size don't follow each other in memory, they all go by lists, so that they are one
// group.
void Batch::append_one(const FoundMolecules &found, std::size_t m, std::int32_t shape, const double *lengths) {
    const FoundMolecule &molecule = found.molecules[m];
    const std::int64_t *const atoms = &found.atoms[at(molecule.first_atom)];
    const std::int64_t *const bonds = &found.bonds[at(molecule.first_bond)];
    const std::int64_t n_kinds = chains_.kinds_.size();
    const std::int64_t kind =
        chains_.kinds_.find(shape, molecule.n_atoms, molecule.n_bonds, w_.data(), lengths, chains_.groups_.last_kind());
    if (kind == n_kinds && shape != linear) {
        flat_ =
            flat_ || rigid::has_dependent_lengths(chains_.shapes_[shape], w_.data(), lengths, chains_.length_tolerance);
        if (!flat_) check_closable(chains_.shapes_[shape], atoms, bonds, lengths);
    }
    bool list_atoms = !ascend(atoms, molecule.n_atoms), list_bonds = !ascend(bonds, molecule.n_bonds);
    if (!list_atoms || !list_bonds) {
        const bool before = alike(found, m, m - 1), after = alike(found, m, m + 1);
        const bool atoms_follow = (before && atoms[-1] + 1 == atoms[0]) ||
                                  (after && atoms[molecule.n_atoms - 1] + 1 == atoms[molecule.n_atoms]);
        const bool bonds_follow = (before && bonds[-1] + 1 == bonds[0]) ||
                                  (after && bonds[molecule.n_bonds - 1] + 1 == bonds[molecule.n_bonds]);
        list_atoms = list_atoms || ((before || after) && !atoms_follow);
        list_bonds = list_bonds || ((before || after) && !bonds_follow);
    }
    places_.clear();
    if (list_bonds)
        for (std::int32_t k = 0; k < molecule.n_bonds; ++k) places_.push_back(chains_.n_bonds_ + bonds[k]);
    chains_.groups_.append(chains_.kinds_, kind, 1, atoms[0], list_atoms ? atoms : nullptr, chains_.n_bonds_ + bonds[0],
                           list_bonds ? places_.data() : nullptr);
}

void Batch::note_direction(const FoundMolecules &found, const FoundMolecule &molecule, const BondList &list) {
    const std::int64_t *const atoms = &found.atoms[at(molecule.first_atom)];
    for (std::int32_t k = 0; k < molecule.n_bonds; ++k) {
        const std::size_t place = at(molecule.first_bond + k);
        const std::int64_t bond = found.bonds[place];
        if (list.pairs[2 * bond] - list.base != atoms[found.pairs[2 * place]]) backwards_.push_back(bond);
    }
}

std::int32_t Batch::shape_of(const FoundMolecules &found, std::size_t m, std::int32_t likely) {
    const FoundMolecule &molecule = found.molecules[m];
    const std::int32_t before = chains_.shapes_.size();
    if (room_ < 0) room_ = memory_left(chains_);
    try {
        const std::int32_t shape = chains_.shapes_.find(
            molecule.topology, molecule.n_atoms, molecule.n_bonds, &found.pairs[2 * at(molecule.first_bond)],
            &found.fixed[at(molecule.first_atom)], likely, room_, work_.get());
        if (shape == before)
            room_ = std::max<std::int64_t>(
                room_ - static_cast<std::int64_t>(bytes_of(*chains_.shapes_[shape].elimination)), 0);
        return shape;
    } catch (const TooMuchMemory &needed) {
        const std::int64_t atom = found.atoms[at(molecule.first_atom)];
        char what[200];
        std::snprintf(what, sizeof what, "the molecule of %lld bonds with atom %s",
                      static_cast<long long>(molecule.n_bonds), chains_.name_of_atom(atom).text);
        Error error = too_much_memory(chains_, what, needed.bytes);
        error.atom = atom;
        error.base = chains_.base;
        throw error;
    }
}

void Batch::append_found(const FoundMolecules &found, const BondList &list, const double *lengths,
                         std::int64_t n_lengths) {
    const std::int64_t n_bonds = list.n_bonds;
    for (std::size_t i = 0; i < found.atoms.size(); ++i)
        if (!found.fixed[i] && chains_.use_.used(found.atoms[i])) throw in_use(chains_, found.atoms[i]);
    found_ = &found;
    // All at once: where bonds stand in the list in any order, the processor then waits for many of them at a time.
    std::vector<double> in_order;
    const bool as_given = n_lengths == n_bonds && found.molecules.size() == 1 && found.bonds[0] == 0 &&
                          ascend(found.bonds.data(), found.molecules[0].n_bonds);
    if (!as_given) in_order.resize(found.bonds.size());
    for (std::size_t k = 0; k < in_order.size(); ++k)
        in_order[k] = lengths[n_lengths == n_bonds ? found.bonds[k] : found.bonds[k] % n_lengths];
    std::int32_t last_shape = linear;
    for (std::size_t m = 0; m < found.molecules.size(); ++m) {
        const FoundMolecule &molecule = found.molecules[m];
        const std::size_t first = at(molecule.first_atom), n_atoms = at(molecule.n_atoms);
        w_.resize(n_atoms);
        for (std::size_t i = 0; i < n_atoms; ++i) w_[i] = chains_.masses_.w(found.atoms[first + i]);
        std::int32_t shape = linear;
        if (molecule.topology != Topology::chain) shape = last_shape = shape_of(found, m, last_shape);
        note_direction(found, molecule, list);
        append_one(found, m, shape, as_given ? lengths : &in_order[at(molecule.first_bond)]);
        if (molecule.n_fixed == 0) continue;
        for (std::size_t i = first; i < first + n_atoms; ++i)
            if (found.fixed[i]) fixed_.push_back(found.atoms[i]);
    }
    fixed_.insert(fixed_.end(), found.unconstrained_atoms.begin(), found.unconstrained_atoms.end());
    for (std::size_t k = 0; k < found.unconstrained.size(); ++k) {
        const std::int64_t bond = found.unconstrained[k];
        leave_out(chains_.n_bonds_ + bond, &found.unconstrained_atoms[2 * k], lengths[bond % n_lengths]);
    }
    n_bonds_ += n_bonds;
}

void Batch::commit() {
    for (const std::int64_t atom : fixed_)
        if (chains_.bodies_ && chains_.bodies_->is_site(atom)) throw in_use(chains_, atom);
    const double longest = chains_.kinds_.longest(static_cast<std::int64_t>(kinds_before_.n_kinds), chains_.longest_);
    chains_.check_width(chains_.box, longest, nullptr);
    chains_.check_width(chains_.box_of_reference(), longest, nullptr);
    if (!backwards_.empty() || !chains_.backwards_.empty()) {
        chains_.backwards_.resize(at(chains_.n_bonds_ + n_bonds_), 0);
        for (const std::int64_t bond : backwards_) chains_.backwards_[at(chains_.n_bonds_ + bond)] = 1;
    }
    chains_.longest_ = longest;
    if (!chains_.active_.empty()) chains_.active_.resize(at(chains_.n_chains()), 1);
    chains_.n_bonds_ += n_bonds_;
    if (found_)
        for (std::size_t i = 0; i < found_->atoms.size(); ++i)
            if (!found_->fixed[i]) chains_.use_.take(found_->atoms[i]);
    for (const std::int64_t atom : fixed_) chains_.use_.take_fixed(atom);
    // What grows by doubling is nearly half empty; an addition that is most of all pays to tidy up.
    if (2 * n_bonds_ > chains_.n_bonds_) {
        chains_.groups_.shrink();
        chains_.kinds_.shrink();
        chains_.shapes_.shrink();
    }
    committed_ = true;
    chains_.changed();
}

}  // namespace holonomic
