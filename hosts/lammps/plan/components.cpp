// SPDX-License-Identifier: GPL-2.0-only
#include "components.hpp"

#include <algorithm>

namespace holonomic_lammps {

namespace {

/** A label that is offered to a node. */
struct Offer {
    Tag node;
    Tag label;
};

struct Labels {
    MPI_Comm world;
    int n_ranks;
    std::unordered_map<Tag, int> index;  // of a node in the arrays below
    std::vector<Tag> parent;
    std::vector<Tag> next;

    void offer(const Outgoing<Offer> &offers) {
        for (const Offer &offer : route(world, offers).items) {
            Tag &label = next[index.at(offer.node)];
            label = std::min(label, offer.label);
        }
    }

    std::vector<Tag> grandparents() const {
        return ask_bookkeepers<Tag>(world, parent, itself, [this](Tag tag) { return parent[index.at(tag)]; });
    }
};

}  // namespace

void find_components(MPI_Comm world, std::vector<Node> &nodes) {
    Labels labels{world, size_of(world), {}, {}, {}};
    for (const Node &node : nodes) {
        labels.index[node.tag] = static_cast<int>(labels.parent.size());
        labels.parent.push_back(node.tag);
    }
    labels.next = labels.parent;
    std::vector<Tag> grandparent = labels.parent;
    for (int changed = 1; changed;) {
        // Each node offers its grandparent to its neighbours, and each neighbour passes the least on to its parent.
        Outgoing<Offer> to_neighbours(labels.n_ranks), to_parents(labels.n_ranks);
        for (std::size_t i = 0; i < nodes.size(); ++i)
            for (Tag other : nodes[i].neighbours)
                to_neighbours[bookkeeper(other, labels.n_ranks)].push_back({other, grandparent[i]});
        labels.offer(to_neighbours);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            labels.next[i] = std::min(labels.next[i], grandparent[i]);
            to_parents[bookkeeper(labels.parent[i], labels.n_ranks)].push_back({labels.parent[i], labels.next[i]});
        }
        labels.offer(to_parents);
        labels.parent = labels.next;
        const std::vector<Tag> before = grandparent;
        grandparent = labels.grandparents();
        changed = grandparent != before || grandparent != labels.parent;
        MPI_Allreduce(MPI_IN_PLACE, &changed, 1, MPI_INT, MPI_MAX, world);
    }
    for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i].component = labels.parent[i];
}

}  // namespace holonomic_lammps
