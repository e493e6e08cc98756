#include "core/molecules/plan.hpp"

#include <algorithm>
#include <tuple>

#include "core/molecules/chains.hpp"

namespace holonomic {

namespace {

constexpr std::int64_t bonds_per_piece = 4096;  // enough to hide the cost of a piece, few enough to share out evenly
constexpr std::int64_t widest = 8;  // lanes of the widest instruction set: pieces are cut at multiples of it

// Positions, velocities, forces and results of so many bonds, 96 bytes each, fill a second-level cache.
constexpr std::int64_t bonds_in_cache = 16384;

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

}  // namespace

class Planner {
public:
    explicit Planner(const Chains &chains) : chains_(chains), groups_(chains.groups_.all()) {}

    std::unique_ptr<Plan> make() {
        for (std::size_t g = 0; g < groups_.size(); ++g) divide(static_cast<std::int64_t>(g));
        gather_loose();
        std::sort(plan_->copies.begin(), plan_->copies.end(), [](const Plan::Copy &a, const Plan::Copy &b) {
            return std::tie(a.atom, a.place) < std::tie(b.atom, b.place);
        });
        std::sort(plan_->shapes.begin(), plan_->shapes.end());
        plan_->shapes.erase(std::unique(plan_->shapes.begin(), plan_->shapes.end()), plan_->shapes.end());
        return std::move(plan_);
    }

private:
    const Kind &kind(std::int64_t group) const { return chains_.kind_of(groups_[at(group)]); }

    // Whether a molecule has fixed atoms that stand elsewhere, too.
    bool shares(const Group &group, std::int64_t index) const {
        if (!chains_.use_.any_shared()) return false;
        const Molecule m = chains_.molecule(group.first_molecule + index);
        for (std::int64_t i = 0; i < m.n_atoms; ++i)
            if (m.w(i) == 0 && chains_.use_.shared(m.atom(i))) return true;
        return false;
    }

    // Runs of active molecules that work in the same place.
    void divide(std::int64_t g) {
        const Group &group = groups_[at(g)];
        const bool shared = chains_.use_.any_shared(), one = chains_.active_.empty() && !shared;
        for (std::int64_t begin = 0; begin < group.count;) {
            if (!chains_.is_active(group.first_molecule + begin)) {
                ++begin;
                continue;
            }
            const bool apart = shares(group, begin);
            std::int64_t end = one ? group.count : begin + 1;
            while (end < group.count && chains_.is_active(group.first_molecule + end) && shares(group, end) == apart)
                ++end;
            add_run(g, begin, end, apart);
            begin = end;
        }
    }

    void add_run(std::int64_t g, std::int64_t begin, std::int64_t end, bool apart) {
        const Kind &k = kind(g);
        const int where = (groups_[at(g)].reordered ? reordered : in_place) + (apart ? staged : in_place);
        const auto stage_of_next = [&] { return apart ? static_cast<std::int64_t>(plan_->stage.size()) : -1; };
        plan_->n_bonds += (end - begin) * k.n_bonds;
        plan_->reordered = plan_->reordered || (where & reordered) != 0;
        if (k.shape == linear) {
            plan_->longest = std::max(plan_->longest, k.n_bonds);
            if (k.n_bonds <= longest_lane) plan_->longest_in_lane = std::max(plan_->longest_in_lane, k.n_bonds);
        } else {
            plan_->shapes.push_back(k.shape);
        }
        const bool single = k.shape == linear && k.n_bonds > longest_lane;
        const std::int64_t block = single ? 1 : widest;
        const std::int64_t per_piece = single ? 1 : std::max(widest, bonds_per_piece / k.n_bonds / widest * widest);
        while (end - begin >= block) {
            const std::int64_t count = std::min(per_piece, (end - begin) / block * block);
            plan_->pieces.push_back({g, begin, count, stage_of_next(), k.shape, where});
            for (std::int64_t i = begin; apart && i < begin + count; ++i) add_to_stage(groups_[at(g)], i);
            begin += count;
        }
        for (; begin < end; ++begin) {
            plan_->loose.push_back({g, begin, stage_of_next()});
            if (apart) add_to_stage(groups_[at(g)], begin);
        }
    }

    void add_to_stage(const Group &group, std::int64_t index) {
        const Molecule m = chains_.molecule(group.first_molecule + index);
        for (std::int64_t i = 0; i < m.n_atoms; ++i) {
            const bool copy = m.w(i) == 0 && chains_.use_.shared(m.atom(i));
            if (copy) plan_->copies.push_back({m.atom(i), static_cast<std::int64_t>(plan_->stage.size())});
            plan_->is_copy.push_back(copy);
            plan_->stage.push_back(m.atom(i));
        }
    }

    // Pieces of molecules that work in the same place, in lanes of about the same length or on one shape.
    void gather_loose() {
        const auto where = [this](const Plan::Reference &r) {
            return (groups_[at(r.group)].reordered ? reordered : in_place) + (r.stage >= 0 ? staged : in_place);
        };
        const auto key = [&](const Plan::Reference &r) {
            return std::make_tuple(where(r), kind(r.group).shape, kind(r.group).n_bonds);
        };
        std::vector<Plan::Reference> &loose = plan_->loose;
        std::stable_sort(loose.begin(), loose.end(),
                         [&](const Plan::Reference &a, const Plan::Reference &b) { return key(a) < key(b); });
        for (std::size_t first = 0, end; first < loose.size(); first = end) {
            const auto same = [&](const Plan::Reference &r) {
                return where(r) == where(loose[first]) && kind(r.group).shape == kind(loose[first].group).shape;
            };
            for (end = first + 1; end < loose.size() && end - first < at(loose_piece) && same(loose[end]);) ++end;
            plan_->pieces.push_back({-1, static_cast<std::int64_t>(first), static_cast<std::int64_t>(end - first), -1,
                                     kind(loose[first].group).shape, where(loose[first])});
        }
    }

    const Chains &chains_;
    const std::vector<Group> &groups_;
    std::unique_ptr<Plan> plan_ = std::make_unique<Plan>();
};

std::int64_t Plan::bytes() const {
    return static_cast<std::int64_t>(sizeof *this + pieces.capacity() * sizeof(Piece) +
                                     loose.capacity() * sizeof(Reference) +
                                     (shapes.capacity() + stage.capacity()) * sizeof(std::int64_t) +
                                     is_copy.capacity() + copies.capacity() * sizeof(Copy));
}

const Plan &Chains::plan() const {
    const Plan *plan = plan_.load(std::memory_order_acquire);
    if (plan) return *plan;
    const std::lock_guard<std::mutex> lock(plan_mutex_);
    if (!plan_.load(std::memory_order_relaxed)) {
        plan_owner_ = Planner(*this).make();
        plan_.store(plan_owner_.get(), std::memory_order_release);
    }
    return *plan_owner_;
}

std::int64_t Chains::piece_bonds(const Plan::Piece &piece) const {
    return piece.group < 0 ? 0 : kind_of(groups_.all()[at(piece.group)]).n_bonds;
}

Lane Chains::lane_of(const Group &group, std::int64_t index, std::int64_t stage) const {
    const Kind &kind = kind_of(group);
    Lane lane;
    lane.n_bonds = kind.n_bonds;
    lane.first_atom = stage >= 0 ? stage : group.first_atom + index * kind.n_atoms();
    lane.atoms = stage >= 0 ? nullptr : groups_.atoms(group, index, kind.n_atoms());
    lane.w = kinds_.w(kind);
    lane.length = kinds_.length(kind);
    lane.w_uniform = kind.w_uniform;
    lane.length_uniform = kind.length_uniform;
    lane.first_bond = group.first_bond + index * kind.n_bonds;
    lane.chain = group.first_molecule + index;
    return lane;
}

MoleculeLane Chains::molecule_lane_of(const Group &group, std::int64_t index, std::int64_t stage) const {
    const Kind &kind = kind_of(group);
    MoleculeLane lane;
    lane.first_atom = stage >= 0 ? stage : group.first_atom + index * kind.n_atoms();
    lane.atoms = stage >= 0 ? nullptr : groups_.atoms(group, index, kind.n_atoms());
    lane.shared = nullptr;  // molecules that share atoms have copies of their own
    lane.w = kinds_.w(kind);
    lane.length = kinds_.length(kind);
    lane.first_bond = group.first_bond + index * kind.n_bonds;
    lane.molecule = group.first_molecule + index;
    return lane;
}

Lane Chains::lane(std::int64_t molecule) const {
    const Group &group = groups_.of_molecule(molecule);
    return lane_of(group, molecule - group.first_molecule, -1);
}

Unit Chains::unit(const Plan &plan, const Plan::Piece &p, Lane *lanes) const {
    const bool large = plan.n_bonds > bonds_in_cache;
    if (p.group >= 0) {
        lanes[0] = lane_of(groups_.all()[at(p.group)], p.first, p.stage);
        return {lanes, p.count, true, large};
    }
    for (std::int64_t i = 0; i < p.count; ++i) {
        const Plan::Reference &reference = plan.loose[at(p.first + i)];
        lanes[i] = lane_of(groups_.all()[at(reference.group)], reference.index, reference.stage);
    }
    return {lanes, p.count, false, large};
}

MoleculeUnit Chains::unit(const Plan &plan, const Plan::Piece &p, MoleculeLane *lanes) const {
    const bool large = plan.n_bonds > bonds_in_cache;
    const Schedule *const schedule = shapes_[p.shape].schedule.get();
    if (p.group >= 0) {
        lanes[0] = molecule_lane_of(groups_.all()[at(p.group)], p.first, p.stage);
        return {schedule, lanes, p.count, true, large};
    }
    for (std::int64_t i = 0; i < p.count; ++i) {
        const Plan::Reference &reference = plan.loose[at(p.first + i)];
        lanes[i] = molecule_lane_of(groups_.all()[at(reference.group)], reference.index, reference.stage);
    }
    return {schedule, lanes, p.count, false, large};
}

}  // namespace holonomic
