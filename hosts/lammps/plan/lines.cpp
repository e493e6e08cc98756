// SPDX-License-Identifier: GPL-2.0-only
#include "lines.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace holonomic_lammps {

namespace {

/** Three atoms on a line, the middle one in the middle, and the numbers of their pairs: first, second, whole. */
struct Three {
    int from, middle, to;
    std::array<int, 3> pairs;
};

class Lines {
public:
    explicit Lines(const Shape &shape) : shape_(shape), root_(shape.pairs.size()) {
        std::vector<char> taken(shape.n_atoms, 0);
        for (const Body &body : shape.bodies)
            for (int place : body.places) taken[place] = 1;
        neighbours_.resize(shape.n_atoms);
        for (std::size_t k = 0; k < shape.pairs.size(); ++k) {
            root_[k] = static_cast<int>(k);
            const auto &pair = shape.pairs[k];
            if (taken[pair[0]] || taken[pair[1]]) continue;
            neighbours_[pair[0]][pair[1]] = neighbours_[pair[1]][pair[0]] = static_cast<int>(k);
        }
    }

    std::vector<Body> find() {
        for (int middle = 0; middle < shape_.n_atoms; ++middle)
            for (const auto &a : neighbours_[middle])
                for (const auto &b : neighbours_[middle])
                    if (a.first < b.first) look_at(a.first, middle, b.first);
        std::map<int, std::vector<Three>> groups;
        for (const Three &three : threes_) groups[root(three.pairs[0])].push_back(three);
        std::vector<Body> bodies;
        for (const auto &group : groups) bodies.push_back(line(group.second));
        return bodies;
    }

private:
    int root(int k) const {
        while (root_[k] != k) k = root_[k];
        return k;
    }

    double length(int k) const { return shape_.lengths[k]; }

    void look_at(int from, int middle, int to) {
        const auto whole = neighbours_[from].find(to);
        if (whole == neighbours_[from].end()) return;
        const int a = neighbours_[from][middle], b = neighbours_[middle][to];
        constexpr double rounding = 8 * std::numeric_limits<double>::epsilon();
        if (std::fabs(length(a) + length(b) - length(whole->second)) > rounding * length(whole->second)) return;
        threes_.push_back({from, middle, to, {a, b, whole->second}});
        root_[root(b)] = root(a);
        root_[root(whole->second)] = root(a);
    }

    /** Coordinates along the line, each from a pair whose two places are known. */
    Body line(const std::vector<Three> &threes) const {
        std::map<int, double> x{{threes[0].from, 0.0}, {threes[0].middle, length(threes[0].pairs[0])}};
        for (std::size_t before = 0; before != x.size();) {
            before = x.size();
            for (const Three &three : threes) place(three, x);
        }
        Body body;
        for (const auto &entry : x) {
            body.places.push_back(entry.first);
            body.at.push_back({entry.second, 0, 0});
        }
        return body;
    }

    void place(const Three &three, std::map<int, double> &x) const {
        const auto from = x.find(three.from), middle = x.find(three.middle), to = x.find(three.to), none = x.end();
        if ((from == none) + (middle == none) + (to == none) != 1) return;
        const double a = length(three.pairs[0]), b = length(three.pairs[1]);
        if (to == none) x[three.to] = middle->second + (middle->second > from->second ? b : -b);
        if (from == none) x[three.from] = middle->second + (middle->second > to->second ? a : -a);
        if (middle == none) x[three.middle] = from->second + (to->second > from->second ? a : -a);
    }

    const Shape &shape_;
    std::vector<std::map<int, int>> neighbours_;  // by place: other place, number of the pair
    mutable std::vector<int> root_;               // by pair: of pairs that are on one line
    std::vector<Three> threes_;
};

}  // namespace

bool find_lines(Shape &shape) {
    const std::vector<Body> lines = Lines(shape).find();
    shape.bodies.insert(shape.bodies.end(), lines.begin(), lines.end());
    return !lines.empty();
}

}  // namespace holonomic_lammps
