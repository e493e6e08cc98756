// SPDX-License-Identifier: GPL-2.0-only
#include "shape.hpp"

#include <algorithm>
#include <tuple>

namespace holonomic_lammps {

namespace {

using Neighbours = std::vector<std::vector<int>>;

Neighbours neighbours_of(const Shape &shape) {
    Neighbours neighbours(shape.n_atoms);
    for (const auto &pair : shape.pairs) {
        neighbours[pair[0]].push_back(pair[1]);
        neighbours[pair[1]].push_back(pair[0]);
    }
    return neighbours;
}

bool is_linear(const Neighbours &neighbours, std::size_t n_bonds) {
    if (n_bonds + 1 != neighbours.size()) return false;
    return std::all_of(neighbours.begin(), neighbours.end(), [](const std::vector<int> &n) { return n.size() <= 2; });
}

/** New places along a chain, from its end of lower place: order[new] = old. */
std::vector<int> along(const Neighbours &neighbours) {
    int place = 0;
    while (neighbours[place].size() != 1) ++place;
    std::vector<int> order{place};
    for (int before = -1; order.size() < neighbours.size();) {
        const std::vector<int> &next = neighbours[place];
        const int after = next[0] == before ? next[1] : next[0];
        before = place;
        place = after;
        order.push_back(place);
    }
    return order;
}

void sort_bonds(Shape &shape) {
    std::vector<std::size_t> order(shape.pairs.size());
    for (std::size_t k = 0; k < order.size(); ++k) {
        order[k] = k;
        if (shape.pairs[k][0] > shape.pairs[k][1]) std::swap(shape.pairs[k][0], shape.pairs[k][1]);
    }
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return shape.pairs[a] < shape.pairs[b]; });
    const Shape old = shape;
    for (std::size_t k = 0; k < order.size(); ++k) {
        shape.pairs[k] = old.pairs[order[k]];
        shape.lengths[k] = old.lengths[order[k]];
    }
}

}  // namespace

bool Shape::operator<(const Shape &other) const {
    return std::tie(n_atoms, pairs, lengths) < std::tie(other.n_atoms, other.pairs, other.lengths);
}

Shape shape_of(std::vector<Bond> bonds, std::vector<Tag> &tags) {
    tags.clear();
    for (const Bond &bond : bonds) {
        tags.push_back(bond.from);
        tags.push_back(bond.to);
    }
    std::sort(tags.begin(), tags.end());
    tags.erase(std::unique(tags.begin(), tags.end()), tags.end());
    const auto place = [&](Tag tag) {
        return static_cast<int>(std::lower_bound(tags.begin(), tags.end(), tag) - tags.begin());
    };
    Shape shape;
    shape.n_atoms = static_cast<int>(tags.size());
    for (const Bond &bond : bonds) {
        shape.pairs.push_back({place(bond.from), place(bond.to)});
        shape.lengths.push_back(bond.length);
    }
    const Neighbours neighbours = neighbours_of(shape);
    shape.linear = is_linear(neighbours, bonds.size());
    if (shape.linear) {
        const std::vector<int> order = along(neighbours);
        std::vector<int> moved(order.size());
        const std::vector<Tag> ascending = tags;
        for (std::size_t k = 0; k < order.size(); ++k) {
            moved[order[k]] = static_cast<int>(k);
            tags[k] = ascending[order[k]];
        }
        for (auto &pair : shape.pairs) pair = {moved[pair[0]], moved[pair[1]]};
    }
    sort_bonds(shape);
    return shape;
}

std::vector<std::array<int, 2>> walk(const Shape &shape) {
    const Neighbours neighbours = neighbours_of(shape);
    std::vector<char> seen(shape.n_atoms, 0);
    std::vector<int> reached{0};
    std::vector<std::array<int, 2>> way;
    seen[0] = 1;
    for (std::size_t k = 0; k < reached.size(); ++k)
        for (int other : neighbours[reached[k]]) {
            if (seen[other]) continue;
            seen[other] = 1;
            reached.push_back(other);
            way.push_back({other, reached[k]});
        }
    return way;
}

}  // namespace holonomic_lammps
