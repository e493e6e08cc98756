// How a call goes through the chains: pieces of work of a few thousand bonds, the same for any number of threads.
#include <algorithm>

#include "core/molecules/chains.hpp"

namespace holonomic {

namespace {

constexpr std::int64_t bonds_per_piece = 4096;  // enough to hide the cost of a piece, few enough to share out evenly
constexpr std::int64_t widest = 8;  // lanes of the widest instruction set: pieces are cut at multiples of it

// Positions, velocities, forces and results of so many bonds, 96 bytes each, fill a second-level cache.
constexpr std::int64_t bonds_in_cache = 16384;

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

}  // namespace

const Plan &Chains::plan() const {
    const Plan *plan = plan_.load(std::memory_order_acquire);
    if (plan) return *plan;
    const std::lock_guard<std::mutex> lock(plan_mutex_);
    if (!plan_.load(std::memory_order_relaxed)) make_plan();
    return *plan_owner_;
}

void Chains::make_plan() const {
    auto plan = std::make_unique<Plan>();
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        const Group &group = groups_[g];
        const std::int64_t n_bonds = kinds_[at(group.kind)].n_bonds, index = static_cast<std::int64_t>(g);
        const std::int64_t per_piece = std::max(widest, bonds_per_piece / n_bonds / widest * widest);
        for (std::int64_t begin = 0; begin < group.n_chains;) {
            if (!is_active(group.first_chain + begin)) {
                ++begin;
                continue;
            }
            std::int64_t end = active_.empty() ? group.n_chains : begin + 1;
            while (end < group.n_chains && is_active(group.first_chain + end)) ++end;
            plan->n_bonds += (end - begin) * n_bonds;
            plan->longest = std::max(plan->longest, n_bonds);
            if (n_bonds > longest_lane) {
                for (; begin < end; ++begin) plan->pieces.push_back({index, begin, 1});
                continue;
            }
            plan->longest_in_lane = std::max(plan->longest_in_lane, n_bonds);
            while (end - begin >= widest) {
                const std::int64_t count = std::min(per_piece, (end - begin) / widest * widest);
                plan->pieces.push_back({index, begin, count});
                begin += count;
            }
            for (; begin < end; ++begin) plan->loose.push_back({index, begin});
        }
    }
    std::stable_sort(
        plan->loose.begin(), plan->loose.end(), [this](const Plan::Reference &a, const Plan::Reference &b) {
            return kinds_[at(groups_[at(a.group)].kind)].n_bonds < kinds_[at(groups_[at(b.group)].kind)].n_bonds;
        });
    const std::int64_t n_loose = static_cast<std::int64_t>(plan->loose.size());
    for (std::int64_t first = 0; first < n_loose; first += loose_piece)
        plan->pieces.push_back({-1, first, std::min(loose_piece, n_loose - first)});
    plan_owner_ = std::move(plan);
    plan_.store(plan_owner_.get(), std::memory_order_release);
}

std::int64_t Chains::piece_bonds(const Plan &plan, std::int64_t piece) const {
    const std::int64_t group = plan.pieces[at(piece)].group;
    return group < 0 ? 0 : kinds_[at(groups_[at(group)].kind)].n_bonds;
}

Unit Chains::unit(const Plan &plan, std::int64_t piece, Lane *lanes) const {
    const Plan::Piece &p = plan.pieces[at(piece)];
    if (p.group >= 0) {
        lanes[0] = lane_of(groups_[at(p.group)], p.first);
        return {lanes, p.count, true, plan.n_bonds > bonds_in_cache};
    }
    for (std::int64_t i = 0; i < p.count; ++i) {
        const Plan::Reference &reference = plan.loose[at(p.first + i)];
        lanes[i] = lane_of(groups_[at(reference.group)], reference.index);
    }
    return {lanes, p.count, false, plan.n_bonds > bonds_in_cache};
}

}  // namespace holonomic
