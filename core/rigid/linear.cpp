#include "core/rigid/linear.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace holonomic::rigid {

namespace {

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

// Places as seen from the base: axes one after the other, each through the atom that is farthest from those before.
class Frame {
public:
    explicit Frame(const LinearGroup &group) : n_(group.atoms.size()), left_(group.places) {
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
            return left_[3 * i] * left_[3 * i] + left_[3 * i + 1] * left_[3 * i + 1] + left_[3 * i + 2] * left_[3 * i + 2];
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

std::vector<std::size_t> base_of(const LinearGroup &group) { return Frame(group).base(); }

Linear::Linear(const std::vector<LinearGroup> &groups) {
    // Groups that hang together through atoms, by the lowest number of one.
    std::vector<std::size_t> part_of(groups.size());
    std::unordered_map<std::int64_t, std::size_t> first_with;
    for (std::size_t g = 0; g < groups.size(); ++g) {
        part_of[g] = g;
        for (const std::int64_t atom : groups[g].atoms) {
            const std::size_t other = part_of[first_with.emplace(atom, g).first->second], mine = part_of[g];
            for (std::size_t h = 0; h <= g && other != mine; ++h)
                if (part_of[h] == std::max(other, mine)) part_of[h] = std::min(other, mine);
        }
    }
    std::map<std::size_t, std::vector<std::size_t>> groups_of;
    for (std::size_t g = 0; g < groups.size(); ++g) groups_of[part_of[g]].push_back(g);
    for (const auto &entry : groups_of) {
        std::vector<std::int64_t> atoms;
        for (const std::size_t g : entry.second) atoms.insert(atoms.end(), groups[g].atoms.begin(), groups[g].atoms.end());
        std::sort(atoms.begin(), atoms.end());
        atoms.erase(std::unique(atoms.begin(), atoms.end()), atoms.end());
        const auto place = [&](std::int64_t atom) {
            return at(std::lower_bound(atoms.begin(), atoms.end(), atom) - atoms.begin());
        };
        Relations all;
        all.n_atoms = static_cast<std::int32_t>(atoms.size());
        for (const std::size_t g : entry.second) {
            const LinearGroup &group = groups[g];
            const Frame frame(group);
            for (std::size_t i = 0; i < group.atoms.size(); ++i) {
                if (std::count(frame.base().begin(), frame.base().end(), i) > 0) continue;
                std::vector<double> row(atoms.size(), 0);
                const std::vector<double> c = frame.coefficients(i);
                for (std::size_t b = 0; b < c.size(); ++b) row[place(group.atoms[frame.base()[b]])] = c[b];
                row[place(group.atoms[i])] = -1;
                all.c.insert(all.c.end(), row.begin(), row.end());
            }
        }
        // A group on a line within a plane says what the plane says.
        constexpr double same = 1e-3;
        const Leaders leaders = leaders_of(all, same);
        Relations kept;
        kept.n_atoms = all.n_atoms;
        for (std::int32_t k = 0; k < all.count(); ++k)
            if (std::count(leaders.left_out.begin(), leaders.left_out.end(), k) == 0)
                kept.c.insert(kept.c.end(), all.row(k), all.row(k) + all.n_atoms);
        for (std::size_t i = 0; i < atoms.size(); ++i)
            place_of_[atoms[i]] = {parts_.size(), i,
                                   std::count(leaders.atoms.begin(), leaders.atoms.end(), static_cast<std::int32_t>(i)) > 0};
        leaders_.push_back(leaders);
        parts_.push_back(std::move(atoms));
        relations_.push_back(std::move(kept));
    }
}

}  // namespace holonomic::rigid
