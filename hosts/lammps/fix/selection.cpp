// SPDX-License-Identifier: GPL-2.0-only
#include "selection.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <map>

#include "../plan/route.hpp"
#include "angle.h"
#include "atom.h"
#include "bond.h"
#include "error.h"
#include "force.h"

using namespace LAMMPS_NS;
using namespace std::string_literals;

namespace holonomic_lammps {

namespace {

/** As in fix shake. */
constexpr double mass_tolerance = 0.1;
constexpr double straight = 1e-5;
constexpr double pi = 3.14159265358979323846;

/** A question about the other atom of a bond. */
enum : int { there = 1, in_group = 2, wanted = 4 };

/** A pair of atoms, lower first, as a key. */
using Pair = std::pair<Tag, Tag>;
Pair pair_of(Tag a, Tag b) { return a < b ? Pair(a, b) : Pair(b, a); }

struct Flags {
    Tag tag;
    int flags;
};

struct Ask {
    Tag from, to;
};

/** An entry of an atom's list of bonds or angles, which holds 32 at most. */
void check_entries(Error *error, int n) {
    if (n > 32) error->one(FLERR, "Fix holonomic: an atom has more than 32 bonds or angles"s);
}

}  // namespace

int Selection::read(int narg, char **arg, int first) {
    int k = first;
    char mode = 0;
    for (; k < narg; ++k) {
        if (strlen(arg[k]) == 1 && strchr("batm", arg[k][0])) {
            mode = arg[k][0];
            continue;
        }
        if (mode == 0 || isalpha(static_cast<unsigned char>(arg[k][0]))) break;
        const int most = mode == 'b' ? atom->nbondtypes : mode == 'a' ? atom->nangletypes : atom->ntypes;
        const double value = utils::numeric(FLERR, arg[k], false, lmp);
        if (mode == 'm') {
            if (value <= 0) error->all(FLERR, "Fix holonomic: a mass must be positive"s);
            masses_.push_back(value);
            continue;
        }
        const int type = utils::inumeric(FLERR, arg[k], false, lmp);
        if (type < 1 || type > most)
            error->all(FLERR, std::string("Fix holonomic: there is no ") +
                                  (mode == 'b'   ? "bond"
                                   : mode == 'a' ? "angle"
                                                 : "atom") +
                                  " type " + arg[k]);
        (mode == 'b' ? bond_types_ : mode == 'a' ? angle_types_ : atom_types_).insert(type);
    }
    return k;
}

bool Selection::empty() const {
    return bond_types_.empty() && atom_types_.empty() && masses_.empty() && bodies.empty();
}

int Selection::n_bonds(int i) const { return atom->num_bond ? atom->num_bond[i] : 0; }
int Selection::n_angles(int i) const { return atom->num_angle ? atom->num_angle[i] : 0; }

/** Whether all bonds of an atom are wanted for its type or mass. */
bool Selection::wants(int i) const {
    if (atom_types_.count(atom->type[i])) return true;
    const double mass = atom->rmass ? atom->rmass[i] : atom->mass[atom->type[i]];
    for (double wanted_mass : masses_)
        if (std::fabs(mass - wanted_mass) <= mass_tolerance) return true;
    return false;
}

std::vector<RigidBond> Selection::select(int groupbit, std::vector<Belonging> &atoms, const std::vector<int> &which) {
    // Entries of a list that another command has changed may stand elsewhere now: they are selected anew.
    for (int i : which)
        if (atoms[i].topology != topology(i)) release_atom(i, atoms[i]);
    std::vector<RigidBond> bonds = select_bonds(groupbit, atoms, which);
    if (!angle_types_.empty()) select_angles(atoms, which, bonds);
    for (int i : which) atoms[i].topology = topology(i);
    return bonds;
}

/** A number for an atom's lists of bonds and angles, 0 for empty ones. */
std::uint32_t Selection::topology(int i) const {
    std::uint64_t number = 0;
    const auto add = [&](std::int64_t x) {
        number = (number ^ static_cast<std::uint64_t>(x)) * 0x9E3779B97F4A7C15u;
        number ^= number >> 32;
    };
    for (int k = 0; k < n_bonds(i); ++k) add(atom->bond_type[i][k]), add(atom->bond_atom[i][k]);
    for (int k = 0; k < n_angles(i); ++k) {
        add(atom->angle_type[i][k]);
        add(atom->angle_atom1[i][k]), add(atom->angle_atom2[i][k]), add(atom->angle_atom3[i][k]);
    }
    const auto result = static_cast<std::uint32_t>(number);
    return result == Belonging::never_seen ? 0 : result;
}

std::vector<int> Selection::changed(const std::vector<Belonging> &atoms) const {
    std::vector<int> which;
    for (int i = 0; i < atom->nlocal; ++i)
        if (atoms[i].topology != topology(i)) which.push_back(i);
    return which;
}

/** Lengths by bond type; 1 where the bond style has none yet. */
std::vector<double> Selection::lengths_of_types() {
    std::vector<double> lengths(atom->nbondtypes + 1, 1.0);
    for (int type = 1; type <= atom->nbondtypes; ++type)
        if (force->bond && force->bond->setflag && force->bond->setflag[type])
            lengths[type] = force->bond->equilibrium_distance(type);
    return lengths;
}

std::vector<RigidBond> Selection::select_bonds(int groupbit, std::vector<Belonging> &atoms,
                                               const std::vector<int> &which) {
    const int n_ranks = size_of(world);
    Outgoing<Flags> notes(n_ranks);
    for (int i : which) {
        const int flags = there | (atom->mask[i] & groupbit ? in_group : 0) | (wants(i) ? wanted : 0);
        notes[bookkeeper(atom->tag[i], n_ranks)].push_back({atom->tag[i], flags});
    }
    std::unordered_map<Tag, int> known;
    for (const Flags &flags : route(world, notes).items) known[flags.tag] = flags.flags;

    std::vector<Ask> questions;
    for (int i : which) {
        check_entries(error, n_bonds(i));
        for (int k = 0; k < n_bonds(i); ++k) questions.push_back({atom->tag[i], atom->bond_atom[i][k]});
    }
    const auto other = ask_bookkeepers<int>(
        world, questions, [](const Ask &q) { return q.to; },
        [&](const Ask &q) {
            const auto found = known.find(q.to);
            return found == known.end() ? 0 : found->second;
        });

    const std::vector<double> lengths = lengths_of_types();
    std::vector<RigidBond> bonds;
    std::size_t next = 0;
    for (int i : which)
        for (int k = 0; k < n_bonds(i); ++k) {
            const int flags = other[next++];
            int &type = atom->bond_type[i][k];
            const bool ours = atoms[i].bonds >> k & 1 && type < 0;
            const bool chosen = type > 0 && atom->mask[i] & groupbit && flags & in_group &&
                                (bond_types_.count(type) || wants(i) || flags & wanted);
            if (!ours && !chosen) continue;
            if (chosen) type = -type;
            atoms[i].bonds |= 1u << k;
            bonds.push_back({atom->tag[i], atom->bond_atom[i][k], lengths[-type]});
        }
    return bonds;
}

/** Angles of the types wanted whose two bonds are rigid: the distance of their ends by the law of cosines. */
void Selection::select_angles(std::vector<Belonging> &atoms, const std::vector<int> &which,
                              std::vector<RigidBond> &bonds) {
    const int n_ranks = size_of(world);
    Outgoing<RigidBond> notes(n_ranks);
    for (const RigidBond &bond : bonds) notes[bookkeeper(std::min(bond.from, bond.to), n_ranks)].push_back(bond);
    std::map<Pair, double> known;
    for (const RigidBond &bond : route(world, notes).items) known[pair_of(bond.from, bond.to)] = bond.length;

    std::vector<Ask> questions;
    for (int i : which) {
        check_entries(error, n_angles(i));
        for (int k = 0; k < n_angles(i); ++k) {
            questions.push_back({atom->angle_atom1[i][k], atom->angle_atom2[i][k]});
            questions.push_back({atom->angle_atom3[i][k], atom->angle_atom2[i][k]});
        }
    }
    const auto sides = ask_bookkeepers<double>(
        world, questions, [](const Ask &q) { return std::min(q.from, q.to); },
        [&](const Ask &q) {
            const auto found = known.find(pair_of(q.from, q.to));
            return found == known.end() ? 0.0 : found->second;
        });

    std::size_t next = 0;
    for (int i : which)
        for (int k = 0; k < n_angles(i); ++k) {
            const double a = sides[next], b = sides[next + 1];
            next += 2;
            int &type = atom->angle_type[i][k];
            const bool ours = atoms[i].angles >> k & 1 && type < 0;
            const bool chosen = type > 0 && angle_types_.count(type) && a > 0 && b > 0;
            if (!ours && !chosen) continue;
            if (chosen) type = -type;
            atoms[i].angles |= 1u << k;
            double angle = pi / 2;
            if (force->angle && force->angle->setflag && force->angle->setflag[-type])
                angle = force->angle->equilibrium_angle(-type);
            // What is straight to the digits of an input file is straight to the last bit: the three atoms are a body.
            bonds.push_back({atom->angle_atom1[i][k], atom->angle_atom3[i][k],
                             pi - angle < straight ? a + b : std::sqrt(a * a + b * b - 2 * a * b * std::cos(angle))});
        }
}

Tag Selection::held_elsewhere(const std::vector<Belonging> &atoms) const {
    const int n_ranks = size_of(world);
    Outgoing<Tag> notes(n_ranks);
    std::vector<Tag> questions;
    for (int i = 0; i < atom->nlocal; ++i) {
        if (atoms[i].molecule) notes[bookkeeper(atom->tag[i], n_ranks)].push_back(atom->tag[i]);
        for (int k = 0; k < n_bonds(i); ++k)
            if (atom->bond_type[i][k] < 0 && !(atoms[i].bonds >> k & 1))
                questions.insert(questions.end(), {atom->tag[i], static_cast<Tag>(atom->bond_atom[i][k])});
    }
    const std::vector<Tag> members = route(world, notes).items;
    const std::set<Tag> known(members.begin(), members.end());
    const auto belongs = ask_bookkeepers<int>(
        world, questions, [](Tag tag) { return tag; }, [&](Tag tag) { return static_cast<int>(known.count(tag)); });
    Tag first = MAXTAGINT;
    for (std::size_t k = 0; k < questions.size(); ++k)
        if (belongs[k]) first = std::min(first, questions[k]);
    MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_LMP_TAGINT, MPI_MIN, world);
    return first == MAXTAGINT ? 0 : first;
}

void Selection::release(std::vector<Belonging> &atoms) {
    for (int i = 0; i < atom->nlocal; ++i) release_atom(i, atoms[i]);
}

/** Where lists have changed, nobody knows which entries were this fix's: then all that are off are on again. */
void Selection::release_atom(int i, Belonging &belonging) {
    if ((belonging.bonds | belonging.angles) == 0) return;
    const bool known = belonging.topology == topology(i);
    for (int k = 0; k < n_bonds(i); ++k)
        if (!known || belonging.bonds >> k & 1) atom->bond_type[i][k] = std::abs(atom->bond_type[i][k]);
    for (int k = 0; k < n_angles(i); ++k)
        if (!known || belonging.angles >> k & 1) atom->angle_type[i][k] = std::abs(atom->angle_type[i][k]);
    belonging.bonds = belonging.angles = 0;
}

}  // namespace holonomic_lammps
