#include "core/rigid/linear.hpp"
#include "core/index.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace holonomic::rigid {

namespace {

// Coordinates as seen from the base: axes one after the other, each through the atom that is farthest from those
// before.
class BaseFrame {
public:
    explicit BaseFrame(const LinearGroup &group) : n_(group.atoms.size()), left_(group.coordinates) {
        base_.push_back(0);
        double farthest = -1;  // from the first atom, then the other way: an end
        for (std::size_t i = 0; i < n_ && group.dimension > 0; ++i)
            if (square(i, 0) > farthest) farthest = square(i, 0), base_[0] = i;
        const double origin[3] = {left_[3 * base_[0]], left_[3 * base_[0] + 1], left_[3 * base_[0] + 2]};
        for (std::size_t e = 0; e < left_.size(); ++e) left_[e] -= origin[e % 3];
        for (int d = 0; d < group.dimension; ++d) go_on();
    }
    const std::vector<std::size_t> &base() const { return base_; }

    // Coefficients of the base at whose place atom i is.
    std::vector<double> coefficients(std::size_t i) const {
        std::vector<double> c(base_.size());
        double rest = 1;
        for (std::size_t d = base_.size() - 1; d > 0; --d) {
            double along = along_[d - 1][i];
            for (std::size_t e = d + 1; e < base_.size(); ++e) along -= c[e] * along_[d - 1][base_[e]];
            c[d] = along / along_[d - 1][base_[d]];
            if (std::fabs(c[d]) < 1e-9) c[d] = 0;
            rest -= c[d];
        }
        c[0] = rest;
        return c;
    }

private:
    double square(std::size_t i, std::size_t j) const {
        double sum = 0;
        for (int x = 0; x < 3; ++x) sum += std::pow(left_[3 * i + at(x)] - left_[3 * j + at(x)], 2);
        return sum;
    }
    void go_on() {
        std::size_t next = 0;
        const auto size = [&](std::size_t i) {
            return left_[3 * i] * left_[3 * i] + left_[3 * i + 1] * left_[3 * i + 1] +
                   left_[3 * i + 2] * left_[3 * i + 2];
        };
        for (std::size_t i = 0; i < n_; ++i)
            if (size(i) > size(next)) next = i;
        double axis[3];
        for (std::size_t x = 0; x < 3; ++x) axis[x] = left_[3 * next + x] / std::sqrt(size(next));
        std::vector<double> along(n_);
        for (std::size_t i = 0; i < n_; ++i) {
            for (std::size_t x = 0; x < 3; ++x) along[i] += axis[x] * left_[3 * i + x];
            for (std::size_t x = 0; x < 3; ++x) left_[3 * i + x] -= along[i] * axis[x];
        }
        base_.push_back(next);
        along_.push_back(std::move(along));
    }

    const std::size_t n_;
    std::vector<double> left_;
    std::vector<std::size_t> base_;
    std::vector<std::vector<double>> along_;
};

}  // namespace

GroupRelations relations_of(const LinearGroup &group) {
    const BaseFrame frame(group);
    GroupRelations found;
    for (const std::size_t b : frame.base()) found.base.push_back(group.atoms[b]);
    found.relations.push_back({group.atoms, {}});
    for (std::size_t i = 0; i < group.atoms.size(); ++i) {
        if (std::count(frame.base().begin(), frame.base().end(), i) > 0) continue;
        LinearRelation one{found.base, frame.coefficients(i)};
        one.atoms.push_back(group.atoms[i]);
        one.c.push_back(-1);
        found.relations.push_back(std::move(one));
    }
    return found;
}

LinearParts LinearParts::of_groups(const std::vector<LinearGroup> &groups) {
    constexpr double same = 1e-3;  // a group on a line within a plane says what the plane says
    std::vector<LinearRelation> all;
    for (const LinearGroup &group : groups)
        for (LinearRelation &one : relations_of(group).relations) all.push_back(std::move(one));
    return LinearParts(all, same);
}

LinearParts::LinearParts(const std::vector<LinearRelation> &all, double least) {
    std::unordered_map<std::int64_t, std::int64_t> parent;
    const auto root = [&](std::int64_t atom) {
        while (parent.at(atom) != atom) atom = parent[atom] = parent.at(parent.at(atom));
        return atom;
    };
    for (const LinearRelation &one : all)
        for (const std::int64_t atom : one.atoms) {
            parent.emplace(atom, atom);
            const std::int64_t a = root(atom), b = root(one.atoms[0]);
            parent[std::max(a, b)] = std::min(a, b);
        }
    std::map<std::int64_t, std::vector<std::int64_t>> atoms_of, relations_of_part;
    for (const auto &entry : parent) atoms_of[root(entry.first)].push_back(entry.first);
    for (std::size_t k = 0; k < all.size(); ++k)
        if (!all[k].c.empty()) relations_of_part[root(all[k].atoms[0])].push_back(static_cast<std::int64_t>(k));
    for (auto &entry : atoms_of) {
        std::vector<std::int64_t> &atoms = entry.second;
        std::sort(atoms.begin(), atoms.end());
        const std::vector<std::int64_t> &its = relations_of_part[entry.first];
        Relations given;
        given.n_atoms = static_cast<std::int32_t>(atoms.size());
        std::vector<std::int64_t> fixed;
        for (const std::int64_t k : its) fixed.insert(fixed.end(), all[at(k)].fixed.begin(), all[at(k)].fixed.end());
        std::sort(fixed.begin(), fixed.end());
        fixed.erase(std::unique(fixed.begin(), fixed.end()), fixed.end());
        given.n_fixed = static_cast<std::int32_t>(fixed.size());
        for (const std::int64_t k : its) {
            std::vector<double> held(fixed.size(), 0);
            for (std::size_t j = 0; j < all[at(k)].fixed.size(); ++j)
                held[at(std::lower_bound(fixed.begin(), fixed.end(), all[at(k)].fixed[j]) - fixed.begin())] +=
                    all[at(k)].of_fixed[j];
            given.of_fixed.insert(given.of_fixed.end(), held.begin(), held.end());
            std::vector<double> row(atoms.size(), 0);
            for (std::size_t i = 0; i < all[at(k)].atoms.size(); ++i)
                row[at(std::lower_bound(atoms.begin(), atoms.end(), all[at(k)].atoms[i]) - atoms.begin())] +=
                    all[at(k)].c[i];
            given.c.insert(given.c.end(), row.begin(), row.end());
        }
        Leaders leaders = leaders_of(given, least);
        Relations kept;
        kept.n_atoms = given.n_atoms;
        kept.n_fixed = given.n_fixed;
        for (std::int32_t k = 0; k < given.count(); ++k) {
            if (std::count(leaders.left_out.begin(), leaders.left_out.end(), k) > 0) continue;
            kept.c.insert(kept.c.end(), given.row(k), given.row(k) + given.n_atoms);
            for (std::int32_t j = 0; j < given.n_fixed; ++j) kept.of_fixed.push_back(given.fixed(k, j));
        }
        fixed_.push_back(std::move(fixed));
        if (!leaders.left_out.empty()) left_out_ = its[at(leaders.left_out[0])];
        for (std::size_t i = 0; i < atoms.size(); ++i)
            membership_of_[atoms[i]] = {
                parts_.size(), i,
                std::binary_search(leaders.atoms.begin(), leaders.atoms.end(), static_cast<std::int32_t>(i))};
        leaders_.push_back(std::move(leaders));
        parts_.push_back(std::move(atoms));
        relations_.push_back(std::move(kept));
    }
}

}  // namespace holonomic::rigid
