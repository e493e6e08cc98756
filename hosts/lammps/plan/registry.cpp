// SPDX-License-Identifier: GPL-2.0-only
#include "registry.hpp"

#include <algorithm>
#include <string>

namespace holonomic_lammps {

namespace {

/** A bond on its way to the bookkeeper of its molecule. */
struct Entry {
    Tag molecule;
    Bond bond;
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

Registry::Registry(MPI_Comm world, const std::vector<Bond> &bonds) : world_(world), n_ranks_(size_of(world)) {
    std::vector<Node> nodes = collect(bonds);
    find_components(world, nodes);
    build(nodes);
}

/** Nodes whose books are kept here, with all their bonds, each once. */
std::vector<Node> Registry::collect(const std::vector<Bond> &bonds) const {
    Outgoing<Bond> outgoing(n_ranks_);
    for (const Bond &bond : bonds) {
        outgoing[bookkeeper(bond.from, n_ranks_)].push_back(bond);
        outgoing[bookkeeper(bond.to, n_ranks_)].push_back({bond.to, bond.from, bond.length});
    }
    std::vector<Bond> known = route(world_, outgoing).items;
    std::sort(known.begin(), known.end(), [](const Bond &a, const Bond &b) {
        return a.from != b.from ? a.from < b.from : a.to != b.to ? a.to < b.to : a.length < b.length;
    });
    std::string trouble;
    std::vector<Node> nodes;
    for (std::size_t k = 0; k < known.size(); ++k) {
        const Bond &bond = known[k];
        const std::string names = std::to_string(bond.from) + " and " + std::to_string(bond.to);
        if (bond.from == bond.to) trouble = "a bond of atom " + std::to_string(bond.from) + " with itself";
        if (k > 0 && known[k - 1].from == bond.from && known[k - 1].to == bond.to) {
            if (known[k - 1].length != bond.length)
                trouble = "atoms " + names + " are to be at two distances, " + std::to_string(known[k - 1].length) +
                          " and " + std::to_string(bond.length);
            continue;
        }
        if (nodes.empty() || nodes.back().tag != bond.from) nodes.push_back({bond.from, bond.from, {}, {}});
        nodes.back().neighbours.push_back(bond.to);
        nodes.back().lengths.push_back(bond.length);
    }
    throw_together(world_, trouble);
    return nodes;
}

/** Sends each bond to the bookkeeper of its molecule, who makes the shape and tells the bookkeepers of its atoms. */
void Registry::build(const std::vector<Node> &nodes) {
    Outgoing<Entry> outgoing(n_ranks_);
    for (const Node &node : nodes)
        for (std::size_t k = 0; k < node.neighbours.size(); ++k)
            if (node.tag < node.neighbours[k])
                outgoing[bookkeeper(node.component, n_ranks_)].push_back(
                    {node.component, {node.tag, node.neighbours[k], node.lengths[k]}});
    std::vector<Entry> entries = route(world_, outgoing).items;
    std::sort(entries.begin(), entries.end(), [](const Entry &a, const Entry &b) { return a.molecule < b.molecule; });
    Outgoing<Note> notes(n_ranks_);
    for (std::size_t begin = 0, end = 0; begin < entries.size(); begin = end) {
        std::vector<Bond> bonds;
        for (; end < entries.size() && entries[end].molecule == entries[begin].molecule; ++end)
            bonds.push_back(entries[end].bond);
        std::vector<Tag> tags;
        const Tag molecule = entries[begin].molecule;
        const Shape &shape = molecules_[molecule] = shape_of(bonds, tags);
        std::vector<int> degree(tags.size(), 0);
        for (const auto &pair : shape.pairs)
            for (int place : pair) ++degree[place];
        for (int place = 0; place < shape.n_atoms; ++place)
            notes[bookkeeper(tags[place], n_ranks_)].push_back(
                {tags[place], {molecule, place, shape.n_atoms, degree[place]}});
    }
    for (const Note &note : route(world_, notes).items) memberships_[note.tag] = note.membership;
    std::int64_t sums[3] = {static_cast<std::int64_t>(molecules_.size()), static_cast<std::int64_t>(entries.size()),
                            static_cast<std::int64_t>(memberships_.size())};
    MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPI_INT64_T, MPI_SUM, world_);
    n_molecules_ = sums[0];
    n_bonds_ = sums[1];
    n_atoms_ = sums[2];
}

std::vector<Membership> Registry::memberships(const std::vector<Tag> &tags) const {
    return ask_bookkeepers<Membership>(world_, tags, itself, [this](Tag tag) {
        const auto found = memberships_.find(tag);
        return found == memberships_.end() ? Membership() : found->second;
    });
}

std::vector<Shape> Registry::shapes(const std::vector<Tag> &molecules) const {
    Outgoing<Tag> questions(n_ranks_);
    for (Tag molecule : molecules) questions[bookkeeper(molecule, n_ranks_)].push_back(molecule);
    const Delivery<Tag> asked = route(world_, questions);
    // A shape travels as numbers: atoms, bonds, linear; two places and a length for each bond.
    Outgoing<double> replies(n_ranks_);
    for (int p = 0; p < n_ranks_; ++p)
        for (int k = asked.first[p]; k < asked.first[p + 1]; ++k) {
            const Shape &shape = molecules_.at(asked.items[k]);
            replies[p].push_back(shape.n_atoms);
            replies[p].push_back(static_cast<double>(shape.pairs.size()));
            replies[p].push_back(shape.linear);
            for (std::size_t b = 0; b < shape.pairs.size(); ++b)
                replies[p].insert(replies[p].end(), {static_cast<double>(shape.pairs[b][0]),
                                                     static_cast<double>(shape.pairs[b][1]), shape.lengths[b]});
        }
    const Delivery<double> came = route(world_, replies);
    std::vector<int> read(came.first.begin(), came.first.end() - 1);
    std::vector<Shape> result;
    for (Tag molecule : molecules) {
        const double *number = &came.items[read[bookkeeper(molecule, n_ranks_)]];
        Shape shape;
        shape.n_atoms = static_cast<int>(number[0]);
        shape.linear = number[2] != 0;
        const int n_bonds = static_cast<int>(number[1]);
        for (int b = 0; b < n_bonds; ++b) {
            shape.pairs.push_back({static_cast<int>(number[3 + 3 * b]), static_cast<int>(number[4 + 3 * b])});
            shape.lengths.push_back(number[5 + 3 * b]);
        }
        read[bookkeeper(molecule, n_ranks_)] += 3 + 3 * n_bonds;
        result.push_back(shape);
    }
    return result;
}

}  // namespace holonomic_lammps
