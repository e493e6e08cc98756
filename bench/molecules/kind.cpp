#include "kind.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace bench {

int KindMaker::atom(double mass) {
    kind.mass.push_back(mass);
    kind.w.push_back(1 / mass);
    return static_cast<int>(kind.mass.size()) - 1;
}

int KindMaker::atom(double mass, int bonded_to, double length) {
    const int here = atom(mass);
    bond(bonded_to, here, length);
    return here;
}

void KindMaker::bond(int i, int j, double length) {
    kind.first.push_back(std::min(i, j));
    kind.second.push_back(std::max(i, j));
    kind.length.push_back(length);
}

Kind KindMaker::done() {
    std::vector<std::size_t> order(kind.n_bonds());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::sort(order.begin(), order.end(), [this](std::size_t a, std::size_t b) {
        return kind.first[a] != kind.first[b] ? kind.first[a] < kind.first[b] : kind.second[a] < kind.second[b];
    });
    Kind sorted = kind;
    for (std::size_t k = 0; k < order.size(); ++k) {
        sorted.first[k] = kind.first[order[k]];
        sorted.second[k] = kind.second[order[k]];
        sorted.length[k] = kind.length[order[k]];
    }
    return sorted;
}

namespace {

/// Masses over one decade.
class Beads {
public:
    double mass() { return std::pow(10, random_uniform(&stream_) - 0.5); }
    std::int64_t any_below(std::int64_t n) { return random_integer(&stream_, 0, n - 1); }

private:
    random_stream stream_ = random_seed(11);
};

}  // namespace

Kind water_kind() {
    KindMaker m;
    const int o = m.atom(15.9994);
    for (int h = 0; h < 2; ++h) m.atom(1.008, o, 0.1);
    m.bond(1, 2, 0.2 * std::sqrt(2.0 / 3));  // the tetrahedral angle
    m.kind.chemical = true;
    return m.done();
}

Kind dendrimer_kind(int core, int branching, int generations) {
    KindMaker m;
    Beads beads;
    std::vector<int> rim = {m.atom(beads.mass())};
    for (int generation = 0; generation < generations; ++generation) {
        std::vector<int> next;
        for (int parent : rim)
            for (int k = 0; k < (generation == 0 ? core : branching); ++k)
                next.push_back(m.atom(beads.mass(), parent, 1));
        rim = next;
    }
    return m.done();
}

Kind comb_kind(int backbone, int side) {
    KindMaker m;
    Beads beads;
    int last = -1;
    for (int i = 0; i < backbone; ++i) {
        last = last < 0 ? m.atom(beads.mass()) : m.atom(beads.mass(), last, 1);
        int end = last;
        for (int k = 0; k < side; ++k) end = m.atom(beads.mass(), end, 1);
    }
    return m.done();
}

Kind ring_kind(int n_atoms) {
    KindMaker m;
    Beads beads;
    m.atom(beads.mass());
    for (int i = 1; i < n_atoms; ++i) m.atom(beads.mass(), i - 1, 1);
    m.bond(0, n_atoms - 1, 1);
    m.kind.closed_walk = true;
    return m.done();
}

Kind triangles_kind(int n_atoms) {
    KindMaker m;
    Beads beads;
    const double degree = std::acos(-1.0) / 180;
    for (int i = 0; i < n_atoms; ++i) {
        m.atom(beads.mass());
        if (i > 0) m.bond(i - 1, i, 1);
        if (i > 1) m.bond(i - 2, i, 2 * std::sin(55.0 * degree));  // angles of 110 degrees
    }
    return m.done();
}

Kind arms_kind(std::int64_t n_bonds, std::int64_t segment) {
    KindMaker m;
    Beads beads;
    std::vector<int> ends = {m.atom(beads.mass())}, neighbours = {0};
    for (std::int64_t made = 0; made < n_bonds;) {
        std::size_t from;
        do from = static_cast<std::size_t>(beads.any_below(static_cast<std::int64_t>(ends.size())));
        while (neighbours[from] == 4);
        ++neighbours[from];
        int last = ends[from];
        for (std::int64_t k = 0; k < segment && made < n_bonds; ++k, ++made) last = m.atom(beads.mass(), last, 1);
        ends.push_back(last);
        neighbours.push_back(1);
    }
    return m.done();
}

Kind random_tree_kind(std::int64_t n_bonds) {
    KindMaker m;
    Beads beads;
    std::vector<int> neighbours = {0};
    m.atom(beads.mass());
    for (std::int64_t k = 0; k < n_bonds; ++k) {
        std::size_t from;
        do from = static_cast<std::size_t>(beads.any_below(k + 1));
        while (neighbours[from] == 4);
        ++neighbours[from];
        m.atom(beads.mass(), static_cast<int>(from), 1);
        neighbours.push_back(1);
    }
    return m.done();
}

}  // namespace bench
