// Bodies that share atoms: ball joints and hinges.
#include <algorithm>
#include <cmath>
#include <tuple>
#include <unordered_map>

#include "core/error.hpp"
#include "core/index.hpp"
#include "core/rigid/heights.hpp"
#include "core/rigid/rank_of_linear.hpp"

namespace holonomic::rigid {

namespace {

double distance(const LinearGroup &group, std::size_t i, std::size_t j) {
    double square = 0;
    for (std::size_t x = 0; x < 3; ++x)
        square += std::pow(group.coordinates[3 * i + x] - group.coordinates[3 * j + x], 2);
    return std::sqrt(square);
}

// As body.cpp has it: thinner than 1e-8 of its length is flat or straight.
int dimension_of(const LinearGroup &group) {
    constexpr double thin = 1e-16;
    const std::int64_t n = static_cast<std::int64_t>(group.atoms.size());
    std::vector<double> squares(at(n * n)), coordinates;
    for (std::size_t i = 0; i < at(n); ++i)
        for (std::size_t j = 0; j < at(n); ++j) squares[i * at(n) + j] = std::pow(distance(group, i, j), 2);
    for (int d = 0; d < 3; ++d)
        if (std::fabs(coordinates_in(d, n, squares.data(), coordinates)) <= thin) return d;
    return 3;
}

class Joining {
public:
    Joining(std::int64_t n_bodies, const std::int64_t *sizes, const std::int64_t *atoms, const double *coordinates) {
        for (std::int64_t b = 0; b < n_bodies; ++b) {
            groups_.push_back({{atoms, atoms + sizes[b]}, {coordinates, coordinates + 3 * sizes[b]}, 0});
            atoms += sizes[b];
            coordinates += 3 * sizes[b];
            for (const std::int64_t atom : groups_.back().atoms) bodies_of_[atom].push_back(at(b));
        }
    }

    JoinedBodies run() {
        std::vector<LinearGroup> joined;
        for (const LinearGroup &group : groups_) {
            if (shares(group)) {
                joined.push_back(group);
                joined.back().dimension = dimension_of(group);
                check_shared(group);
                continue;
            }
            append(group.atoms);
            out_.coordinates.insert(out_.coordinates.end(), group.coordinates.begin(), group.coordinates.end());
            out_.parts.affine.emplace_back();
        }
        const LinearParts linear = LinearParts::of_groups(joined);
        for (std::size_t p = 0; p < linear.parts().size(); ++p) {
            append(linear.parts()[p]);
            out_.coordinates.resize(3 * out_.atoms.size(), 0);
            out_.parts.affine.push_back({linear.relations()[p], extent_of(linear.parts()[p]), {}});
        }
        hold(joined, linear);
        return std::move(out_);
    }

    // A bond within a body that is an affine part now.
    bool holds(std::int64_t i, std::int64_t j, double *length) const {
        const auto found = bodies_of_.find(i);
        if (found == bodies_of_.end()) return false;
        for (const std::size_t b : found->second) {
            const LinearGroup &group = groups_[b];
            const auto second = std::find(group.atoms.begin(), group.atoms.end(), j);
            if (second == group.atoms.end() || !shares(group)) continue;
            const auto first = std::find(group.atoms.begin(), group.atoms.end(), i);
            *length = distance(group, at(first - group.atoms.begin()), at(second - group.atoms.begin()));
            return true;
        }
        return false;
    }

private:
    bool shares(const LinearGroup &group) const {
        return std::any_of(group.atoms.begin(), group.atoms.end(),
                           [&](std::int64_t atom) { return bodies_of_.at(atom).size() > 1; });
    }
    void append(const std::vector<std::int64_t> &atoms) {
        out_.sizes.push_back(static_cast<std::int64_t>(atoms.size()));
        out_.atoms.insert(out_.atoms.end(), atoms.begin(), atoms.end());
    }
    double extent_of(const std::vector<std::int64_t> &atoms) const {
        double largest = 0;
        for (const std::int64_t atom : atoms)
            for (const std::size_t b : bodies_of_.at(atom))
                for (std::size_t i = 1; i < groups_[b].atoms.size(); ++i)
                    largest = std::max(largest, distance(groups_[b], 0, i));
        return largest;
    }
    void check_shared(const LinearGroup &group) const {
        for (std::size_t i = 0; i < group.atoms.size(); ++i)
            for (std::size_t j = 0; j < i; ++j)
                for (const std::size_t b : bodies_of_.at(group.atoms[i])) {
                    const LinearGroup &other = groups_[b];
                    const auto k = std::find(other.atoms.begin(), other.atoms.end(), group.atoms[i]),
                               l = std::find(other.atoms.begin(), other.atoms.end(), group.atoms[j]);
                    if (l == other.atoms.end()) continue;
                    const double here = distance(group, i, j),
                                 there = distance(other, at(k - other.atoms.begin()), at(l - other.atoms.begin()));
                    if (!(std::fabs(here - there) <= same_length * std::max(here, there)))
                        throw make_error(Status::value,
                                         "atoms %lld and %lld are in two bodies, at the distances %.9g and %.9g",
                                         static_cast<long long>(group.atoms[i]), static_cast<long long>(group.atoms[j]),
                                         here, there);
                }
    }

    // Distances of the bases that are independent, and the way from atom to neighbouring atom.
    void hold(const std::vector<LinearGroup> &joined, const LinearParts &linear) {
        RankOfLinear rank(linear);
        std::vector<std::tuple<int, std::size_t, AffineParts::Distance>> all;
        for (const LinearGroup &group : joined) {
            const std::vector<std::int64_t> base = relations_of(group).base;
            const auto index = [&](std::int64_t atom) {
                return at(std::find(group.atoms.begin(), group.atoms.end(), atom) - group.atoms.begin());
            };
            for (std::size_t a = 0; a < base.size(); ++a)
                for (std::size_t b = 0; b < a; ++b)
                    all.emplace_back(
                        rank.followers(base[a], base[b]), all.size(),
                        AffineParts::Distance{base[b], base[a], distance(group, index(base[a]), index(base[b]))});
            Body body;
            body.n_atoms = static_cast<std::int32_t>(group.atoms.size());
            body.coordinates = group.coordinates;
            for (const NearestStep &step : nearest_steps(body, 0))
                out_.parts.links.emplace_back(group.atoms[at(step.atom)], group.atoms[at(step.before)]);
        }
        std::sort(all.begin(), all.end(), [](const auto &a, const auto &b) {
            return std::tie(std::get<0>(a), std::get<1>(a)) < std::tie(std::get<0>(b), std::get<1>(b));
        });
        for (const auto &entry : all) {
            const AffineParts::Distance &its = std::get<2>(entry);
            if (!rank.add(its.i, its.j, [](std::int64_t) { return false; })) out_.parts.hidden.push_back(its);
        }
    }

    std::vector<LinearGroup> groups_;
    std::unordered_map<std::int64_t, std::vector<std::size_t>> bodies_of_;
    JoinedBodies out_;
};

}  // namespace

bool share_atoms(std::int64_t n_bodies, const std::int64_t *sizes, const std::int64_t *atoms) {
    std::unordered_map<std::int64_t, std::int64_t> body_of;
    bool share = false;
    for (std::int64_t b = 0; b < n_bodies; ++b)
        for (std::int64_t a = 0; a < sizes[b]; ++a) {
            const auto found = body_of.emplace(*atoms++, b);
            if (found.second) continue;
            if (found.first->second == b) return false;  // a mistake, which is refused elsewhere
            found.first->second = b;
            share = true;
        }
    return share;
}

JoinedBodies join_bodies(std::int64_t n_bodies, const std::int64_t *sizes, const std::int64_t *atoms,
                         const double *coordinates, std::int64_t n_bonds, const std::int64_t *pairs,
                         const double *lengths) {
    Joining joining(n_bodies, sizes, atoms, coordinates);
    std::vector<std::int64_t> held;
    for (std::int64_t k = 0; k < n_bonds; ++k) {
        double length;
        if (!joining.holds(pairs[2 * k], pairs[2 * k + 1], &length)) continue;
        if (!(std::fabs(length - lengths[k]) <= same_length * lengths[k]))
            throw make_error(Status::value,
                             "the bond between atoms %lld and %lld has the length %g but lies within a body, whose "
                             "atoms are at another distance",
                             static_cast<long long>(pairs[2 * k]), static_cast<long long>(pairs[2 * k + 1]),
                             lengths[k]);
        held.push_back(k);
    }
    JoinedBodies joined = joining.run();
    joined.parts.held = std::move(held);
    return joined;
}

}  // namespace holonomic::rigid
