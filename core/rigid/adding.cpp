// Adding molecules with rigid bodies to a set, and building them again with other masses or lengths.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/index.hpp"
#include "core/molecules/batch.hpp"
#include "core/molecules/chains.hpp"
#include "core/molecules/memory_limit.hpp"
#include "core/rigid/bodies.hpp"
#include "core/rigid/cliques.hpp"
#include "core/rigid/fit.hpp"
#include "core/rigid/implied.hpp"
#include "core/rigid/linear.hpp"

namespace holonomic {

namespace {

// Numbers within a molecule are kept in 32 bits.
constexpr std::int64_t most = std::int64_t{1} << 30;

// Throws Error.
void check_counts(std::int64_t n_bodies, std::int64_t n_bonds) {
    if (n_bodies < 0)
        throw make_error(Status::value, "n_bodies is %lld; it must be at least 0", static_cast<long long>(n_bodies));
    if (n_bonds < 0 || n_bonds > most)
        throw make_error(Status::value, "n_bonds is %lld; it must be in 0 .. %lld", static_cast<long long>(n_bonds),
                         static_cast<long long>(most));
}

// Returns the number of atoms of all bodies. Throws Error.
std::int64_t check_sizes(std::int64_t n_bodies, const std::int64_t *sizes, int base) {
    std::int64_t n_held = 0;
    for (std::int64_t b = 0; b < n_bodies; ++b) {
        if (sizes[b] < 2 || sizes[b] > most || n_held > most)
            throw make_error(Status::value, "body %lld has %lld atoms; a body has at least 2", number(b, base),
                             static_cast<long long>(sizes[b]));
        n_held += sizes[b];
    }
    return n_held;
}

// "body 0 of molecule 3 (atoms 9, 10, 11)": by its first atoms.
struct BodyName {
    char text[320];
};
BodyName name_of_body(const Chains &chains, const rigid::Given &given, std::int64_t body) {
    std::size_t first = 0;
    for (std::int64_t b = 0; b < body; ++b) first += at(given.sizes[at(b)]);
    const std::int32_t n = given.sizes[at(body)];
    BodyName name;
    if (n == 1)
        std::snprintf(name.text, sizeof name.text, "the part of atom %s", chains.name_of_atom(given.atoms[first]).text);
    else if (n == 2)
        std::snprintf(name.text, sizeof name.text, "the body of atoms %s and %s",
                      chains.name_of_atom(given.atoms[first]).text, chains.name_of_atom(given.atoms[first + 1]).text);
    else
        std::snprintf(name.text, sizeof name.text, "the body of %d atoms, from atom %s to atom %s", static_cast<int>(n),
                      chains.name_of_atom(given.atoms[first]).text,
                      chains.name_of_atom(given.atoms[first + at(n) - 1]).text);
    return name;
}

[[noreturn]] void refuse(const Chains &chains, const rigid::Given &given, const rigid::Refusal &refusal) {
    using rigid::BodyFault;
    using rigid::Unsolvable;
    const auto name = [&](std::int64_t atom) { return chains.name_of_atom(given.atoms[at(atom)]); };
    if (refusal.cause == rigid::Refusal::of_body) {
        const BodyFault &fault = refusal.fault;
        const bool named = fault.atom >= 0;
        const Status status = fault.cause == BodyFault::not_finite ? Status::not_finite : Status::value;
        fail(make_error(status, "%s %s%s%s", name_of_body(chains, given, refusal.body).text,
                        rigid::fault_in_words(fault.cause), named ? ": atom " : "", named ? name(fault.atom).text : ""),
             chains.base, -1, named ? given.atoms[at(fault.atom)] : -1);
    }
    if (refusal.unsolvable.cause == Unsolvable::length_in_body) {
        const rigid::Bond &bond = given.bonds[at(refusal.unsolvable.bond)];
        fail(make_error(Status::value,
                        "the bond between atoms %s and %s has the length %g but lies within a body, whose atoms are at "
                        "another distance",
                        name(bond.i).text, name(bond.j).text, bond.length),
             chains.base, given.bond_numbers[at(refusal.unsolvable.bond)], given.atoms[at(bond.i)]);
    }
    if (refusal.unsolvable.cause == Unsolvable::off_plane) {
        const rigid::Bond &bond = given.bonds[at(refusal.unsolvable.bond)];
        fail(make_error(Status::value,
                        "the bond between atoms %s and %s is at a massless site out of the plane of its body's masses: "
                        "such a site follows the body and has no bonds",
                        name(bond.i).text, name(bond.j).text),
             chains.base, given.bond_numbers[at(refusal.unsolvable.bond)], given.atoms[at(bond.i)]);
    }
    fail(make_error(Status::degenerate,
                    "the molecule of %s%s has more bonds than its bodies and atoms have freedoms: they depend on each "
                    "other",
                    given.sizes.empty() ? "atom " : "",
                    given.sizes.empty() ? name(0).text : name_of_body(chains, given, 0).text),
         chains.base, -1, given.atoms[0]);
}

// Of a set that is to have no bodies but those that are given as such.
[[noreturn]] void refuse_body(const Chains &chains, const rigid::Cliques &cliques) {
    const auto name = [&](std::size_t i) { return chains.name_of_atom(cliques.atoms[i] - chains.base); };
    const std::int64_t n = cliques.sizes[0];
    fail(make_error(Status::degenerate,
                    "the distances between %lld atoms, from %s to %s, depend on each other: they are a rigid body, and "
                    "hol_chains_set_bodies says that none is to be made of "
                    "distances",
                    static_cast<long long>(n), name(0).text, name(at(n) - 1).text),
         chains.base, -1, cliques.atoms[0] - chains.base);
}

// A body that its lengths have made stays as it is, and so do flat and straight groups.
void give_length(const rigid::MoleculeKind &kind, std::size_t bond, double length, rigid::Given &given) {
    const double old = given.bonds[bond].length;
    given.bonds[bond].length = length;
    const rigid::Bond &its = kind.bonds[bond];
    const auto part = [&](std::int32_t atom) { return atom < kind.n_held ? kind.part_of[at(atom)] : -1 - atom; };
    const bool within = part(its.i) == part(its.j);
    if (!kind.by_lengths || !within) return;
    if (!(std::fabs(length - old) <= rigid::same_length * old))
        throw rigid::Refusal{
            rigid::Refusal::of_bonds, {}, {rigid::Unsolvable::length_in_body, static_cast<std::int32_t>(bond)}, -1};
    given.bonds[bond].length = old;
}

}  // namespace

void Chains::add_rigid(std::int64_t n_bodies, const std::int64_t *sizes, const std::int64_t *atoms,
                       const double *coordinates, std::int64_t n_bonds, const std::int64_t *pairs,
                       const double *lengths) {
    check_counts(n_bodies, n_bonds);
    if (n_bodies == 0 && n_bonds == 0) return;
    const std::int64_t n_held = check_sizes(n_bodies, sizes, base);
    check_memory(*this, n_held + n_bonds, bytes_of_body_atom);
    check_lengths(n_bonds, lengths, base);
    commit_rigid(sort_rigid(n_bodies, sizes, atoms, 0, coordinates, n_bonds, pairs, lengths), n_bonds);
}

void Chains::add_rigid_molecules(std::int64_t count, std::int64_t n_atoms, std::int64_t first_atom,
                                 std::int64_t n_bodies, const std::int64_t *sizes, const std::int64_t *atoms,
                                 const double *coordinates, std::int64_t n_bonds, const std::int64_t *pairs,
                                 const double *lengths) {
    check_counts(n_bodies, n_bonds);
    if (count == 0 || (n_bodies == 0 && n_bonds == 0)) return;  // the arrays need not be there
    const std::int64_t n_held = check_sizes(n_bodies, sizes, base);
    check_lengths(n_bonds, lengths, base);
    const std::int64_t first = check_copies(count, n_atoms, first_atom);
    check_memory(*this, count * (n_held + std::min(n_bonds, most)), bytes_of_body_atom);
    check_of_molecule(atoms, n_held, n_atoms, false);
    check_of_molecule(pairs, 2 * n_bonds, n_atoms, true);
    commit_rigid(copies_of(count, n_atoms, n_bonds,
                           [&](std::int64_t m) {
                               return sort_rigid(n_bodies, sizes, atoms, first + m * n_atoms, coordinates, n_bonds,
                                                 pairs, lengths);
                           }),
                 count * n_bonds);
}

// The first atom, counted from 0. Throws Error.
std::int64_t Chains::check_copies(std::int64_t count, std::int64_t n_atoms, std::int64_t first_atom) const {
    const std::int64_t first = first_atom < base ? -1 : first_atom - base;
    if (count < 0 || n_atoms < 2)
        throw make_error(Status::value, "n_molecules is %lld and n_atoms %lld; they must be at least 0 and 2",
                         static_cast<long long>(count), static_cast<long long>(n_atoms));
    if (count > 0 && (first < 0 || first >= n_atoms_ || n_atoms > n_atoms_ || count > (n_atoms_ - first) / n_atoms))
        fail(make_error(Status::index,
                        "%lld molecules of %lld atoms from atom %lld on reach outside the atoms %d .. %lld",
                        static_cast<long long>(count), static_cast<long long>(n_atoms),
                        static_cast<long long>(first_atom), base, number(n_atoms_ - 1, base)),
             base, -1, first);
    return first;
}

void Chains::check_of_molecule(const std::int64_t *list, std::int64_t n, std::int64_t n_atoms, bool bonds) const {
    for (std::int64_t e = 0; e < n; ++e)
        if (list[e] < base || list[e] - base >= n_atoms)
            fail(make_error(Status::index, "atom %lld of the molecule is outside %d .. %lld",
                            static_cast<long long>(list[e]), base, number(n_atoms - 1, base)),
                 base, bonds ? e / 2 : -1, -1);
}

std::vector<rigid::Given> Chains::copies_of(std::int64_t count, std::int64_t n_atoms, std::int64_t n_bonds,
                                            const std::function<std::vector<rigid::Given>(std::int64_t)> &make) const {
    std::vector<rigid::Given> all;
    // Where masses are those of the first copy at the same coordinates, the molecules are its own.
    const std::vector<rigid::Given> model = make(0);
    for (std::int64_t m = 0; m < count; ++m) {
        std::vector<rigid::Given> copy = model;
        bool alike = true;
        for (rigid::Given &given : copy)
            for (std::size_t i = 0; i < given.atoms.size(); ++i) {
                std::int64_t &atom = given.atoms[i];
                const bool was_infinite = masses_.infinite(atom);
                atom += m * n_atoms;
                const bool held = i >= at(given.n_movable);
                alike = alike && masses_.mass(atom) == given.masses[i] && masses_.infinite(atom) == was_infinite &&
                        (held ? !(bodies_ && bodies_->is_site(atom)) : !use_.used(atom) && !masses_.infinite(atom));
            }
        if (!alike) copy = make(m);
        for (rigid::Given &given : copy) {
            for (std::int64_t &bond : given.bond_numbers) bond += m * n_bonds;
            all.push_back(std::move(given));
        }
    }
    return all;
}

// Where parts of the list depend, their molecules are added as bodies, or without what others imply, the others as
// ever.
void Chains::add_with_bodies(const BondList &list, const double *lengths, std::int64_t n_lengths) {
    rigid::Cliques cliques = rigid::find_cliques(masses_, list, lengths, n_lengths, length_tolerance);
    std::vector<unsigned char> implied = rigid::implied_bonds(masses_, list, lengths, n_lengths, cliques);
    if (!cliques.shared.empty() || std::count(implied.begin(), implied.end(), 1) > 0)
        cliques = rigid::find_cliques(masses_, list, lengths, n_lengths, length_tolerance, implied);
    rigid::AffineParts parts;
    const bool has_points = std::count(lengths, lengths + n_lengths, 0.0) > 0;
    if (!cliques.linear.empty() || has_points) parts = take_linear(list, lengths, n_lengths, cliques, implied);
    FoundMolecules found;
    std::vector<std::int64_t> pairs, of_bodies, rest, rest_pairs;
    std::vector<double> its_lengths;
    std::size_t next = 0;
    for (std::int64_t k = 0; k < list.n_bonds; ++k) {
        const bool of_body = next < cliques.bonds.size() && cliques.bonds[next] == k;
        next += of_body;
        if (implied[at(k)]) continue;
        if (of_body) of_bodies.push_back(k);
        std::vector<std::int64_t> &to = of_body ? pairs : rest_pairs;
        to.push_back(list.pairs[2 * k]);
        to.push_back(list.pairs[2 * k + 1]);
        if (of_body)
            its_lengths.push_back(lengths[k % n_lengths]);
        else
            rest.push_back(k);
    }
    try {
        const std::int64_t n_rest = static_cast<std::int64_t>(rest.size());
        if (n_rest > 0) found = find_molecules(masses_, n_atoms_, {n_rest, rest_pairs.data(), base, &labels_});
    } catch (const Error &error) {
        if (error.bond < 0 || rest.size() == at(list.n_bonds)) throw;
        throw bond_error(list, error.status, rest[at(error.bond)], "is one too many: others of the list say the same");
    }
    for (std::int64_t &bond : found.bonds) bond = rest[at(bond)];
    for (std::int64_t &bond : found.unconstrained) bond = rest[at(bond)];
    Batch batch(*this);
    batch.append_found(found, list, lengths, n_lengths);
    for (std::int64_t k = 0; k < list.n_bonds; ++k) {
        if (!implied[at(k)]) continue;
        const std::int64_t atoms[2] = {list.pairs[2 * k] - list.base, list.pairs[2 * k + 1] - list.base};
        batch.leave_out(n_bonds_ + k, atoms, lengths[k % n_lengths]);
    }
    const std::int64_t first_bond = n_bonds_;
    const auto note = [&] {
        if (cliques.adjusted > rigid::rounding && cliques.adjusted > adjustment_.largest)
            adjustment_ = {cliques.adjusted, first_bond + cliques.adjusted_bond};
        for (std::int64_t k = 0; k < list.n_bonds; ++k)
            if (implied[at(k)]) implied_.push_back(first_bond + k);
    };
    if (cliques.sizes.empty()) {
        batch.commit();
        return note();
    }
    if (!finds_bodies) refuse_body(*this, cliques);
    std::vector<rigid::Given> molecules =
        sort_rigid(static_cast<std::int64_t>(cliques.sizes.size()), cliques.sizes.data(), cliques.atoms.data(), 0,
                   cliques.coordinates.data(), static_cast<std::int64_t>(its_lengths.size()), pairs.data(),
                   its_lengths.data(), parts.affine.empty() ? nullptr : &parts);
    for (rigid::Given &given : molecules) {
        given.by_lengths = true;
        for (std::int64_t &bond : given.bond_numbers) bond = n_bonds_ + of_bodies[at(bond - n_bonds_)];
    }
    commit_rigid(molecules, 0, &batch);
    note();
}

void Chains::commit_rigid(const std::vector<rigid::Given> &molecules, std::int64_t n_bonds, Batch *also) {
    std::unique_ptr<rigid::Bodies> made;
    if (!bodies_) made = std::make_unique<rigid::Bodies>();
    rigid::Bodies &bodies = bodies_ ? *bodies_ : *made;
    const rigid::Bodies::Mark before = bodies.mark();
    const std::int64_t room = memory_left(*this) + (bodies_ ? bodies.bytes() : 0);
    try {
        for (const rigid::Given &given : molecules) {
            try {
                bodies.add(given);
            } catch (const rigid::Refusal &refusal) {
                refuse(*this, given, refusal);
            }
        }
        if (bodies.bytes() > room) throw too_much_memory(*this, "these molecules with bodies", bodies.bytes() - room);
        check_width(box, bodies.longest(), nullptr);
        check_width(box_of_reference(), bodies.longest(), nullptr);
        if (also) also->commit();
    } catch (...) {
        bodies.roll_back(before);
        throw;
    }
    for (const rigid::Given &given : molecules)
        for (std::size_t i = 0; i < given.atoms.size(); ++i) {
            if (i < at(given.n_movable))
                use_.take(given.atoms[i]);
            else
                use_.take_fixed(given.atoms[i]);
        }
    if (made) bodies_ = std::move(made);
    n_bonds_ += n_bonds;
    changed();
}

// The same molecules with other masses or lengths; null if there are none.
std::unique_ptr<rigid::Bodies> Chains::rebuild_bodies(const Masses &masses, const double *lengths) const {
    if (!bodies_) return nullptr;
    std::unique_ptr<rigid::Bodies> next = std::make_unique<rigid::Bodies>();
    std::vector<unsigned char> active;
    for (std::int64_t m = 0; m < bodies_->n_molecules(); ++m) {
        rigid::Given given = bodies_->given(m);
        for (std::size_t i = 0; i < given.atoms.size(); ++i) {
            const std::int64_t atom = given.atoms[i];
            given.masses[i] = masses.mass(atom);
            if (bodies_->is_site(atom) && masses.infinite(atom))
                fail(make_error(Status::value, "the mass of atom %s, a massless site of a body, is infinite",
                                name_of_atom(atom).text),
                     base, -1, atom);
        }
        try {
            for (std::size_t k = 0; lengths && k < given.bonds.size(); ++k)
                give_length(bodies_->kind(m), k, lengths[given.bond_numbers[k]], given);
            next->add(given);
        } catch (const rigid::Refusal &refusal) {
            refuse(*this, given, refusal);
        }
        active.push_back(bodies_->is_active(m));
    }
    check_width(box, next->longest(), nullptr);
    check_width(box_of_reference(), next->longest(), nullptr);
    next->set_active(active.data());
    return next;
}

}  // namespace holonomic
