// SPDX-License-Identifier: GPL-2.0-only
#include "shape.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

#include "lines.hpp"
#include "superpose.hpp"

namespace holonomic_lammps {

namespace {

using Neighbours = std::vector<std::vector<int>>;

/** Joins the atoms of a body by its shortest gaps: those are what nearest images are taken of. */
void join(const Body &body, Neighbours &neighbours) {
    for (const auto &step : shortest_way(body.at)) {
        neighbours[body.places[step[0]]].push_back(body.places[step[1]]);
        neighbours[body.places[step[1]]].push_back(body.places[step[0]]);
    }
}

Neighbours neighbours_of(const Shape &shape) {
    Neighbours neighbours(shape.n_atoms);
    for (const auto &pair : shape.pairs) {
        neighbours[pair[0]].push_back(pair[1]);
        neighbours[pair[1]].push_back(pair[0]);
    }
    for (const Body &body : shape.bodies) join(body, neighbours);
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

/** A body holds what is in it. */
void drop_pairs_within_bodies(Shape &shape) {
    std::vector<std::vector<int>> bodies_of(shape.n_atoms);  // ascending
    for (std::size_t b = 0; b < shape.bodies.size(); ++b)
        for (int place : shape.bodies[b].places) bodies_of[place].push_back(static_cast<int>(b));
    std::size_t n_kept = 0;
    for (std::size_t k = 0; k < shape.pairs.size(); ++k) {
        const auto pair = shape.pairs[k];
        const std::vector<int> &a = bodies_of[pair[0]], &b = bodies_of[pair[1]];
        if (std::find_first_of(a.begin(), a.end(), b.begin(), b.end()) != a.end()) continue;
        shape.pairs[n_kept] = pair;
        shape.lengths[n_kept++] = shape.lengths[k];
    }
    shape.pairs.resize(n_kept);
    shape.lengths.resize(n_kept);
}

/** Whether bonds and bodies make no cycle: then no bond depends on others. */
bool is_forest(const Shape &shape) {
    std::vector<int> root(shape.n_atoms);
    std::iota(root.begin(), root.end(), 0);
    const auto find = [&](int place) {
        while (root[place] != place) place = root[place] = root[root[place]];
        return place;
    };
    const auto join_parts = [&](int a, int b) {
        a = find(a), b = find(b);
        root[b] = a;
        return a != b;
    };
    bool forest = true;
    for (const Body &body : shape.bodies)
        for (std::size_t k = 1; k < body.places.size(); ++k) forest &= join_parts(body.places[0], body.places[k]);
    for (const auto &pair : shape.pairs) forest &= join_parts(pair[0], pair[1]);
    return forest;
}

/** Atoms on a line become bodies where nothing else depends on anything, as the kernels for bodies are fast. */
void take_lines(Shape &shape) {
    Shape with_lines = shape;
    if (!find_lines(with_lines)) return;
    drop_pairs_within_bodies(with_lines);
    if (!shape.bodies.empty() || is_forest(with_lines)) shape = with_lines;
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

static bool operator<(const Body &a, const Body &b) { return std::tie(a.places, a.at) < std::tie(b.places, b.at); }

bool Shape::operator<(const Shape &other) const {
    return std::tie(n_atoms, pairs, lengths, bodies) <
           std::tie(other.n_atoms, other.pairs, other.lengths, other.bodies);
}

Shape shape_of(const std::vector<RigidBond> &bonds, const std::vector<BodyAtom> &body_atoms, std::vector<Tag> &tags) {
    tags.clear();
    for (const RigidBond &bond : bonds) {
        tags.push_back(bond.from);
        tags.push_back(bond.to);
    }
    for (const BodyAtom &atom : body_atoms) tags.push_back(atom.atom);
    std::sort(tags.begin(), tags.end());
    tags.erase(std::unique(tags.begin(), tags.end()), tags.end());
    const auto place = [&](Tag tag) {
        return static_cast<int>(std::lower_bound(tags.begin(), tags.end(), tag) - tags.begin());
    };
    Shape shape;
    shape.n_atoms = static_cast<int>(tags.size());
    // However they have come here: molecules alike have one shape.
    std::vector<BodyAtom> parts = body_atoms;
    std::sort(parts.begin(), parts.end(),
              [](const BodyAtom &a, const BodyAtom &b) { return std::tie(a.body, a.atom) < std::tie(b.body, b.atom); });
    std::map<Tag, Body> bodies;
    for (const BodyAtom &atom : parts) {
        Body &body = bodies[atom.body];
        body.places.push_back(place(atom.atom));
        body.at.push_back({atom.at[0], atom.at[1], atom.at[2]});
    }
    for (const auto &entry : bodies) shape.bodies.push_back(entry.second);
    for (const RigidBond &bond : bonds) {
        if (bond.length == no_distance) continue;
        shape.pairs.push_back({place(bond.from), place(bond.to)});
        shape.lengths.push_back(bond.length);
    }
    if (!shape.bodies.empty()) drop_pairs_within_bodies(shape);
    const bool may_have_cycles = !shape.bodies.empty() || shape.pairs.size() >= static_cast<std::size_t>(shape.n_atoms);
    if (may_have_cycles) take_lines(shape);
    const Neighbours neighbours = neighbours_of(shape);
    shape.linear = shape.bodies.empty() && is_linear(neighbours, shape.pairs.size());
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

Walk walk(const Shape &shape) {
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

void write(const Shape &shape, std::vector<double> &numbers) {
    const auto add = [&](double x) { numbers.push_back(x); };
    for (double x : {static_cast<double>(shape.n_atoms), static_cast<double>(shape.linear),
                     static_cast<double>(shape.rigid), static_cast<double>(shape.taken), shape.tolerance,
                     static_cast<double>(shape.pairs.size()), static_cast<double>(shape.bodies.size())})
        add(x);
    for (std::size_t b = 0; b < shape.pairs.size(); ++b)
        for (double x :
             {static_cast<double>(shape.pairs[b][0]), static_cast<double>(shape.pairs[b][1]), shape.lengths[b]})
            add(x);
    for (const Body &body : shape.bodies) {
        add(static_cast<double>(body.places.size()));
        for (std::size_t k = 0; k < body.places.size(); ++k) {
            add(body.places[k]);
            for (double x : body.at[k]) add(x);
        }
    }
}

Shape read(const double *&number) {
    const auto integer = [&] { return static_cast<int>(*number++); };
    Shape shape;
    shape.n_atoms = integer();
    shape.linear = integer() != 0;
    shape.rigid = integer() != 0;
    shape.taken = integer();
    shape.tolerance = *number++;
    const int n_bonds = integer();
    shape.bodies.resize(integer());
    for (int b = 0; b < n_bonds; ++b) {
        const int from = integer(), to = integer();
        shape.pairs.push_back({from, to});
        shape.lengths.push_back(*number++);
    }
    for (Body &body : shape.bodies)
        for (int n = integer(); n > 0; --n) {
            body.places.push_back(integer());
            body.at.push_back({number[0], number[1], number[2]});
            number += 3;
        }
    return shape;
}

}  // namespace holonomic_lammps
