// The rank of distances whose atoms obey linear relations.
#pragma once

#include <unordered_map>
#include <utility>
#include <vector>

#include "core/rigid/linear.hpp"
#include "core/rigid/rank.hpp"

namespace holonomic::rigid {

class RankOfLinear {
public:
    explicit RankOfLinear(const LinearParts &linear) : linear_(linear) {
        for (std::size_t p = 0; p < linear.parts().size(); ++p)
            followers_.push_back(Rank::followers(linear.relations()[p], linear.leaders()[p]));
    }
    // Whether those before imply it. Of atoms in no part, is_fixed(atom).
    template <class IsFixed>
    bool add(std::int64_t i, std::int64_t j, const IsFixed &is_fixed) {
        return rank_.add(end(i, is_fixed), end(j, is_fixed));
    }
    // How many of its atoms follow others.
    int followers(std::int64_t i, std::int64_t j) const { return follows(i) + follows(j); }

private:
    bool follows(std::int64_t atom) const {
        const LinearParts::Membership *const membership = linear_.find(atom);
        return membership && !membership->leads;
    }
    std::int64_t column(std::int64_t atom) {
        return column_.emplace(atom, static_cast<std::int64_t>(column_.size())).first->second;
    }
    template <class IsFixed>
    Rank::End end(std::int64_t atom, const IsFixed &is_fixed) {
        const LinearParts::Membership *const membership = linear_.find(atom);
        if (!membership) return is_fixed(atom) ? Rank::fixed(atom) : Rank::free(column(atom));
        const std::vector<std::int32_t> &leaders = linear_.leaders()[membership->part].atoms;
        std::vector<std::pair<std::int64_t, Rank::Number>> of;
        for (std::size_t l = 0; l < leaders.size(); ++l)
            of.emplace_back(column(linear_.parts()[membership->part][static_cast<std::size_t>(leaders[l])]),
                            followers_[membership->part][membership->atom * leaders.size() + l]);
        return Rank::combination(std::move(of));
    }

    const LinearParts &linear_;
    Rank rank_;
    std::vector<std::vector<Rank::Number>> followers_;
    std::unordered_map<std::int64_t, std::int64_t> column_;
};

}  // namespace holonomic::rigid
