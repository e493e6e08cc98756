// SPDX-License-Identifier: GPL-2.0-only
#include "registry.hpp"

#include <algorithm>
#include <map>
#include <string>

#include "library.hpp"
#include "table.hpp"

namespace holonomic_lammps {

namespace {

/** A bond on its way to the bookkeeper of its molecule. */
struct SentBond {
    Tag molecule;
    RigidBond bond;
};

/** An atom of a body on its way to the bookkeeper of its molecule. */
struct Part {
    Tag molecule;
    BodyAtom atom;
};

/** How many atoms of a molecule a rank has. */
struct Present {
    Tag molecule;
    int n_atoms;
};

/** What the bookkeeper of an atom is told. */
struct Note {
    Tag tag;
    Membership membership;
};

}  // namespace

void throw_together(MPI_Comm world, const std::string &message) {
    int first = message.empty() ? size_of(world) : rank_of(world);
    MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, world);
    if (first == size_of(world)) return;
    int length = static_cast<int>(message.size());
    MPI_Bcast(&length, 1, MPI_INT, first, world);
    std::string text = message;
    text.resize(length);
    MPI_Bcast(&text[0], length, MPI_CHAR, first, world);
    throw ErrorEverywhere(text);
}

Registry::Registry(MPI_Comm world, const std::vector<RigidBond> &bonds, const std::vector<BodyAtom> &bodies,
                   int dimensions, std::int64_t divide, double tolerance)
    : world_(world), n_ranks_(size_of(world)), divide_(divide) {
    std::vector<Node> nodes = collect(bonds, bodies);
    find_components(world, nodes);
    build(nodes, dimensions, tolerance);
    add_up();
}

bool Registry::divides(const Shape &shape) const {
    return divide_ > 0 && shape.n_atoms >= divide_ && !shape.dependent() && shape.bodies.empty();
}

/** What there is on all ranks. */
void Registry::add_up() {
    std::int64_t sums[5] = {static_cast<std::int64_t>(molecules_.size()),
                            static_cast<std::int64_t>(memberships_.size()), 0, 0, 0};
    for (const auto &entry : molecules_) {
        sums[2] += static_cast<std::int64_t>(entry.second.pairs.size());
        sums[3] += static_cast<std::int64_t>(entry.second.bodies.size());
        sums[4] += divides(entry.second);
    }
    MPI_Allreduce(MPI_IN_PLACE, sums, 5, MPI_INT64_T, MPI_SUM, world_);
    n_molecules_ = sums[0];
    n_atoms_ = sums[1];
    n_bonds_ = sums[2];
    n_bodies_ = sums[3];
    n_divided_ = sums[4];
    struct {
        double part;
        int rank;
    } worst = {adjusted_.part, rank_of(world_)};
    MPI_Allreduce(MPI_IN_PLACE, &worst, 1, MPI_DOUBLE_INT, MPI_MAXLOC, world_);
    Tag ends[2] = {adjusted_.from, adjusted_.to};
    MPI_Bcast(ends, 2, MPI_INT64_T, worst.rank, world_);
    adjusted_ = {worst.part, ends[0], ends[1]};
}

/** Nodes whose books are kept here, with all their bonds, each once. A body's atoms are tied to one of them. */
std::vector<Node> Registry::collect(const std::vector<RigidBond> &bonds, const std::vector<BodyAtom> &bodies) const {
    Outgoing<RigidBond> outgoing(n_ranks_);
    const auto tell = [&](Tag from, Tag to, double length) {
        outgoing[bookkeeper(from, n_ranks_)].push_back({from, to, length});
        outgoing[bookkeeper(to, n_ranks_)].push_back({to, from, length});
    };
    for (const RigidBond &bond : bonds) tell(bond.from, bond.to, bond.length);
    Outgoing<BodyAtom> of_bodies(n_ranks_);
    for (const BodyAtom &part : bodies) {
        of_bodies[bookkeeper(part.atom, n_ranks_)].push_back(part);
        if (part.atom != part.first) tell(part.first, part.atom, no_distance);
    }
    std::vector<RigidBond> known = route(world_, outgoing).items;
    std::sort(known.begin(), known.end(), [](const RigidBond &a, const RigidBond &b) {
        return a.from != b.from ? a.from < b.from : a.to != b.to ? a.to < b.to : a.length < b.length;
    });
    std::string trouble;
    std::vector<Node> nodes;
    for (std::size_t k = 0; k < known.size(); ++k) {
        const RigidBond &bond = known[k];
        if (bond.from == bond.to) trouble = "a bond of atom " + std::to_string(bond.from) + " with itself";
        if (k > 0 && known[k - 1].from == bond.from && known[k - 1].to == bond.to) {
            // An angle may give the distance that a bond or another angle gives, to rounding.
            if (known[k - 1].length != no_distance && bond.length - known[k - 1].length > 1e-9 * bond.length)
                trouble = "atoms " + std::to_string(bond.from) + " and " + std::to_string(bond.to) +
                          " are to be at two distances, " + std::to_string(known[k - 1].length) + " and " +
                          std::to_string(bond.length);
            continue;
        }
        if (nodes.empty() || nodes.back().tag != bond.from) nodes.push_back({bond.from, bond.from, {}, {}, {}});
        nodes.back().neighbours.push_back(bond.to);
        nodes.back().lengths.push_back(bond.length);
    }
    for (const BodyAtom &part : route(world_, of_bodies).items) {
        const auto node =
            std::lower_bound(nodes.begin(), nodes.end(), part.atom, [](const Node &n, Tag tag) { return n.tag < tag; });
        for (const InBody &other : node->bodies)
            if (other.body == part.body) trouble = "atom " + std::to_string(part.atom) + " is twice in a rigid body";
        node->bodies.push_back({part.body, {part.at[0], part.at[1], part.at[2]}});
    }
    throw_together(world_, trouble);
    return nodes;
}

/** Sends each bond to the bookkeeper of its molecule, who makes the shape and tells the bookkeepers of its atoms. */
void Registry::build(const std::vector<Node> &nodes, int dimensions, double tolerance) {
    Outgoing<SentBond> outgoing(n_ranks_);
    Outgoing<Part> of_bodies(n_ranks_);
    for (const Node &node : nodes) {
        for (const InBody &in : node.bodies)
            of_bodies[bookkeeper(node.component, n_ranks_)].push_back(
                {node.component, {in.body, node.tag, node.tag, {in.at[0], in.at[1], in.at[2]}}});
        for (std::size_t k = 0; k < node.neighbours.size(); ++k)
            if (node.tag < node.neighbours[k])
                outgoing[bookkeeper(node.component, n_ranks_)].push_back(
                    {node.component, {node.tag, node.neighbours[k], node.lengths[k]}});
    }
    std::map<Tag, std::vector<BodyAtom>> bodies;
    for (const Part &part : route(world_, of_bodies).items) bodies[part.molecule].push_back(part.atom);
    std::vector<SentBond> entries = route(world_, outgoing).items;
    std::sort(entries.begin(), entries.end(),
              [](const SentBond &a, const SentBond &b) { return a.molecule < b.molecule; });
    Outgoing<Note> notes(n_ranks_);
    std::map<Shape, Shape> examined;
    for (std::size_t begin = 0, end = 0; begin < entries.size(); begin = end) {
        std::vector<RigidBond> bonds;
        for (; end < entries.size() && entries[end].molecule == entries[begin].molecule; ++end)
            bonds.push_back(entries[end].bond);
        std::vector<Tag> tags;
        const Tag molecule = entries[begin].molecule;
        const auto parts = bodies.find(molecule);
        Shape found = shape_of(bonds, parts == bodies.end() ? std::vector<BodyAtom>() : parts->second, tags);
        found.tolerance = tolerance;
        const auto before = examined.find(found);
        if (before != examined.end()) {
            found = before->second;
        } else {
            const Shape key = found;
            const Adjustment adjustment = examine(found, dimensions);
            if (adjustment.part > adjusted_.part)
                adjusted_ = {adjustment.part, tags[adjustment.places[0]], tags[adjustment.places[1]]};
            examined[key] = found;
        }
        const Shape &shape = molecules_[molecule] = found;
        const bool evenly = shape.dependent();
        std::vector<double> taken(tags.size(), evenly ? static_cast<double>(shape.taken) / shape.n_atoms : 0);
        for (const auto &pair : shape.pairs)
            for (int place : pair) taken[place] += evenly ? 0 : 0.5;
        const bool in_parts = divides(shape);
        for (int place = 0; place < shape.n_atoms; ++place)
            notes[bookkeeper(tags[place], n_ranks_)].push_back(
                {tags[place], {molecule, in_parts ? divided : place, shape.n_atoms, taken[place]}});
    }
    for (const Note &note : route(world_, notes).items) memberships_[note.tag] = note.membership;
    for (const Node &node : nodes) {
        if (memberships_[node.tag].place != divided) continue;
        std::vector<Partner> &partners = partners_[node.tag];
        for (std::size_t k = 0; k < node.neighbours.size(); ++k)
            partners.push_back({node.neighbours[k], node.lengths[k]});
    }
}

std::vector<Tag> Registry::incomplete(const std::vector<Membership> &members) const {
    Table numbers;
    std::vector<Present> here;
    for (const Membership &member : members) {
        if (member.molecule == 0) continue;
        const int next = static_cast<int>(here.size()), number = numbers.find_or_insert(member.molecule, next);
        if (number == next) here.push_back({member.molecule, 0});
        ++here[number].n_atoms;
    }
    Outgoing<Present> outgoing(n_ranks_);
    for (const Present &part : here) outgoing[bookkeeper(part.molecule, n_ranks_)].push_back(part);
    std::unordered_map<Tag, int> present;
    for (const Present &part : route(world_, outgoing).items) present[part.molecule] += part.n_atoms;
    std::vector<Tag> result;
    for (const auto &entry : molecules_)
        if (present[entry.first] != entry.second.n_atoms) result.push_back(entry.first);
    return result;
}

bool Registry::replace(const std::unordered_set<Tag> &gone, Registry come) {
    const std::int64_t n_divided = n_divided_;
    for (Tag molecule : gone) molecules_.erase(molecule);
    for (auto entry = memberships_.begin(); entry != memberships_.end();) {
        if (gone.count(entry->second.molecule) == 0) {
            ++entry;
            continue;
        }
        partners_.erase(entry->first);
        entry = memberships_.erase(entry);
    }
    molecules_.merge(come.molecules_);
    memberships_.merge(come.memberships_);
    partners_.merge(come.partners_);
    if (come.adjusted_.part > adjusted_.part) adjusted_ = come.adjusted_;
    add_up();
    return come.n_divided_ > 0 || n_divided_ < n_divided;
}

std::vector<Membership> Registry::memberships(const std::vector<Tag> &tags) const {
    return ask_bookkeepers<Membership>(world_, tags, itself, [this](Tag tag) {
        const auto found = memberships_.find(tag);
        return found == memberships_.end() ? Membership() : found->second;
    });
}

std::vector<std::vector<Partner>> Registry::partners(const std::vector<Tag> &tags) const {
    Outgoing<Tag> questions(n_ranks_);
    for (Tag tag : tags) questions[bookkeeper(tag, n_ranks_)].push_back(tag);
    const Delivery<Tag> asked = route(world_, questions);
    Outgoing<Partner> replies(n_ranks_);
    for (int p = 0; p < n_ranks_; ++p)
        for (int k = asked.first[p]; k < asked.first[p + 1]; ++k) {
            // How many there are, then they themselves
            const std::vector<Partner> &known = partners_.at(asked.items[k]);
            replies[p].push_back({static_cast<Tag>(known.size()), 0});
            replies[p].insert(replies[p].end(), known.begin(), known.end());
        }
    const Delivery<Partner> came = route(world_, replies);
    std::vector<int> next(came.first.begin(), came.first.end() - 1);
    std::vector<std::vector<Partner>> result;
    for (Tag tag : tags) {
        int &from = next[bookkeeper(tag, n_ranks_)];
        const auto first = came.items.begin() + from + 1;
        result.emplace_back(first, first + static_cast<std::ptrdiff_t>(came.items[from].atom));
        from += 1 + static_cast<int>(came.items[from].atom);
    }
    return result;
}

std::vector<Shape> Registry::shapes(const std::vector<Tag> &molecules) const {
    Outgoing<Tag> questions(n_ranks_);
    for (Tag molecule : molecules) questions[bookkeeper(molecule, n_ranks_)].push_back(molecule);
    const Delivery<Tag> asked = route(world_, questions);
    Outgoing<double> replies(n_ranks_);
    for (int p = 0; p < n_ranks_; ++p)
        for (int k = asked.first[p]; k < asked.first[p + 1]; ++k) write(molecules_.at(asked.items[k]), replies[p]);
    const Delivery<double> came = route(world_, replies);
    std::vector<int> next(came.first.begin(), came.first.end() - 1);
    std::vector<Shape> result;
    for (Tag molecule : molecules) {
        int &from = next[bookkeeper(molecule, n_ranks_)];
        const double *number = &came.items[from];
        result.push_back(read(number));
        from = static_cast<int>(number - came.items.data());
    }
    return result;
}

}  // namespace holonomic_lammps
