#include "core/molecules/planned/plan.hpp"

#include <algorithm>
#include <limits>
#include <tuple>
#include <unordered_map>

#include "core/index.hpp"
#include "core/kernel_choice.hpp"
#include "core/molecules/chains.hpp"
#include "core/molecules/planned/way.hpp"
#include "core/plan/elimination.hpp"

namespace holonomic {

namespace {

constexpr std::int64_t bonds_per_chunk = 4096;  // enough to hide the cost of a chunk, few enough to share out evenly
// Chunks are cut at multiples of this, the lanes of the widest set that is installed. It is a matter of speed: kernels
// of any number of lanes take any number of chains.
constexpr std::int64_t widest = 8;
static_assert(widest <= most_lanes, "");
constexpr std::size_t gathering_window = 4096;  // molecules
// Different trees are sorted within so many bonds, so that those that are worked on together are close in memory.
constexpr std::int64_t batch_window = 16384;

}  // namespace

class Planner {
public:
    Planner(const Chains &chains, bool of_parts)
        : chains_(chains), groups_(chains.groups_.all()), n_shapes_(chains.shapes_.size()) {
        if (of_parts) divide_kinds();
        for (std::int32_t s = 0; s < n_shapes_; ++s)
            plan_->elimination_plans.push_back(chains.shapes_[s].elimination.get());
        for (std::int32_t s = 0; s < plan_->part_shapes.size(); ++s)
            plan_->elimination_plans.push_back(plan_->part_shapes[s].elimination.get());
    }

    std::unique_ptr<Plan> make() {
        for (std::size_t g = 0; g < groups_.size(); ++g) divide(static_cast<std::int64_t>(g));
        gather();
        plan_->tree_batches.finish();
        std::sort(plan_->copies.begin(), plan_->copies.end(), [](const Plan::Copy &a, const Plan::Copy &b) {
            return std::tie(a.atom, a.place) < std::tie(b.atom, b.place);
        });
        std::sort(plan_->shapes.begin(), plan_->shapes.end());
        plan_->shapes.erase(std::unique(plan_->shapes.begin(), plan_->shapes.end()), plan_->shapes.end());
        const auto need = [&](std::int64_t bytes) { plan_->scratch_bytes = std::max(plan_->scratch_bytes, bytes); };
        for (const std::int32_t s : plan_->shapes)
            need(kernels().molecules.scratch_bytes(*plan_->elimination_plans[at(s)]));
        for (std::int64_t i = 0; i < plan_->tree_batches.size(); ++i)
            need(kernels().molecules.batch_bytes(*plan_->tree_batches[i]));
        need(scratch_bytes(plan_->longest));
        const std::vector<Plan::Chunk> &chunks = plan_->chunks;
        if (chunks.size() == 1 && chunks[0].shape == linear && plan_->longest <= longest_lane &&
            !(chunks[0].where & far_units))
            plan_->only = chains_.unit(*plan_, chunks[0], &plan_->first_of_only);
        return std::move(plan_);
    }

private:
    const Kind &kind(std::int64_t group) const { return chains_.kind_of(groups_[at(group)]); }

    // Not in lanes beside others of its kind (core/kernels/molecules/blocks.hpp): a chunk of its own, so that threads
    // share what is large.
    bool works_alone(std::int32_t shape, std::int64_t n_bonds) const {
        if (shape == linear) return n_bonds > longest_lane;
        return plan_->elimination_plans[at(shape)]->alone;
    }

    // What solves a network finds bonds by a list, but for the extended-precision solver.
    bool lists_bonds(std::int32_t shape) const {
        const EliminationPlan *const s = shape == linear ? nullptr : plan_->elimination_plans[at(shape)];
        return s && s->way.forces == Way::network && !s->extended;
    }

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

    // What lies between the fixed atoms of each kind of linear chain.
    void divide_kinds() {
        plan_->w.resize(at(chains_.kinds_.size()));
        plan_->part_start.push_back(0);
        for (std::int64_t k = 0; k < chains_.kinds_.size(); ++k) {
            const Kind &kind = chains_.kinds_[k];
            if (kind.shape == linear) {
                const double *w = chains_.kinds_.w(kind);
                if (!w) plan_->w[at(k)].assign(at(kind.n_atoms()), kind.w_uniform);
                if (!w) w = plan_->w[at(k)].data();
                std::int64_t first = 0;
                for (std::int64_t i = 1; i <= kind.n_bonds; ++i)
                    if (w[i] == 0 || i == kind.n_bonds) {
                        add_part(w, first, i - first);
                        first = i;
                    }
            }
            plan_->part_start.push_back(static_cast<std::int64_t>(plan_->parts.size()));
        }
    }

    void add_part(const double *w, std::int64_t first, std::int64_t n_bonds) {
        if (n_bonds >= std::numeric_limits<std::int32_t>::max())
            throw make_error(Status::value, "a chain of %lld bonds is too long for this function",
                             static_cast<long long>(n_bonds));
        std::vector<std::int32_t> pairs(at(2 * n_bonds));
        std::vector<unsigned char> fixed(at(n_bonds + 1));
        for (std::size_t e = 0; e < pairs.size(); ++e) pairs[e] = static_cast<std::int32_t>((e + 1) / 2);
        for (std::size_t i = 0; i < fixed.size(); ++i) fixed[i] = w[at(first) + i] == 0;
        const std::int32_t shape =
            plan_->part_shapes.find(Topology::chain, static_cast<std::int32_t>(n_bonds + 1),
                                    static_cast<std::int32_t>(n_bonds), pairs.data(), fixed.data(), -1);
        plan_->parts.push_back({first, n_bonds, n_shapes_ + shape});
    }

    void add_run(std::int64_t g, std::int64_t begin, std::int64_t end, bool apart) {
        const Kind &k = kind(g);
        const int where = (groups_[at(g)].reordered ? reordered : in_place) + (apart ? staged : in_place) +
                          (chains_.kinds_.is_ordinary(k) ? 0 : far_units);
        const std::int64_t stage = apart ? static_cast<std::int64_t>(plan_->stage.size()) : -1;
        for (std::int64_t i = begin; apart && i < end; ++i) add_to_stage(groups_[at(g)], i);
        plan_->n_bonds += (end - begin) * k.n_bonds;
        plan_->reordered = plan_->reordered || (where & reordered) != 0;
        plan_->copied = plan_->copied || ((where & reordered) && !lists_bonds(k.shape));
        StretchOfGroup run{g, begin, end, stage, -1, k.n_bonds, k.shape, where};
        if (k.shape != linear || plan_->part_start.empty()) return add_chunks(run);
        for (run.part = plan_->part_start[at(groups_[at(g)].kind)];
             run.part < plan_->part_start[at(groups_[at(g)].kind + 1)]; ++run.part) {
            run.shape = plan_->parts[at(run.part)].shape;
            add_chunks(run);
        }
    }

    // Molecules of a group, or of each its part.
    struct StretchOfGroup {
        std::int64_t group, begin, end, stage, part, n_bonds;
        std::int32_t shape;
        int where;
    };

    void add_chunks(const StretchOfGroup &run) {
        if (run.shape == linear) {
            plan_->longest = std::max(plan_->longest, run.n_bonds);
        } else {
            plan_->shapes.push_back(run.shape);
        }
        // Molecules that are not alike from one to the next are gathered, and so are parts of a chain of several.
        const bool alone = works_alone(run.shape, run.n_bonds);
        const bool whole = run.part < 0 || plan_->parts[at(run.part)].n_bonds == run.n_bonds;
        const std::int64_t block = alone ? 1 : widest, size = kind(run.group).n_atoms();
        const std::int64_t per_chunk = alone ? 1 : std::max(widest, bonds_per_chunk / run.n_bonds / widest * widest);
        const auto stage = [&](std::int64_t i) { return run.stage < 0 ? -1 : run.stage + (i - run.begin) * size; };
        std::int64_t begin = run.begin;
        while (whole && run.end - begin >= block) {
            const std::int64_t count = std::min(per_chunk, (run.end - begin) / block * block);
            plan_->chunks.push_back({run.group, begin, count, stage(begin), run.part, run.shape, run.where});
            if (alone && run.shape != linear) plant_alone(plan_->chunks.back());
            begin += count;
        }
        for (; begin < run.end; ++begin)
            gathered_.push_back({run.group, begin, stage(begin), run.part, run.n_bonds, run.shape, run.where, 0, {}});
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

    // A molecule, or a part of it, that goes into lanes beside others of its size or shape, wherever these stand.
    struct Gathered {
        std::int64_t group, index, stage, part, n_bonds;
        std::int32_t shape;
        int where;
        std::int32_t window;  // a tree without enough of its shape nearby: which trees it is put beside; else 0
        TreeProfile profile;
    };

    // Parts of molecules that work in the same place, in lanes of about the same length or on one shape, and of one
    // kind as far as there are such near each other in memory: sorted within windows that a cache holds.
    void gather() {
        const auto before = [this](const Gathered &a, const Gathered &b) {
            return std::tie(a.where, a.window, a.profile, a.shape, a.n_bonds, groups_[at(a.group)].kind, a.part) <
                   std::tie(b.where, b.window, b.profile, b.shape, b.n_bonds, groups_[at(b.group)].kind, b.part);
        };
        for (std::size_t begin = 0, end; begin < gathered_.size(); begin = end) {
            end = std::min(gathered_.size(), begin + gathering_window);
            mark_mixed(begin, end);
            std::stable_sort(&gathered_[begin], &gathered_[begin] + (end - begin), before);
        }
        for (std::size_t first = 0, end; first < gathered_.size(); first = end) {
            const Gathered &head = gathered_[first];
            const bool chains = head.shape == linear;
            const std::size_t place = chains ? plan_->gathered_chains.size() : plan_->gathered_molecules.size();
            std::int64_t bonds = 0;
            for (end = first; end < gathered_.size(); bonds += gathered_[end++].n_bonds) {
                const Gathered &one = gathered_[end];
                if (one.where != head.where || one.window != head.window) break;
                if (one.shape != head.shape && !one.window) break;
                if (end > first && works_alone(one.shape, one.n_bonds)) break;
                if (end > first && (end - first) % at(gathered_chunk) == 0 && bonds >= gathered_chunk_bonds) break;
                const Group &group = groups_[at(one.group)];
                if (chains)
                    plan_->gathered_chains.push_back(chains_.lane_of(group, one.index, one.stage));
                else
                    plan_->gathered_molecules.push_back(
                        chains_.molecule_lane_of(*plan_, group, one.index, one.stage, one.part));
            }
            plan_->chunks.push_back({-1, static_cast<std::int64_t>(place), static_cast<std::int64_t>(end - first), -1,
                                     -1, head.shape, head.where});
            if (head.shape != gathered_[end - 1].shape) plant(first, end, plan_->chunks.back());
        }
    }

    // Trees of the gathered molecules in a range that are fewer of a shape than a block has lanes.
    void mark_mixed(std::size_t begin, std::size_t end) {
        const std::int64_t lanes = kernels().lanes;
        std::unordered_map<std::int32_t, std::int64_t> count;
        for (std::size_t i = begin; i < end; ++i) ++count[gathered_[i].shape];
        std::int64_t bonds = 0;
        for (std::size_t i = begin; i < end; ++i) {
            Gathered &one = gathered_[i];
            if (one.part >= 0 || one.shape == linear || count[one.shape] >= lanes ||
                works_alone(one.shape, one.n_bonds))
                continue;
            const EliminationPlan &s = *plan_->elimination_plans[at(one.shape)];
            if (!mixes(s)) continue;
            one.profile = TreeProfile(s);
            one.window = static_cast<std::int32_t>(1 + bonds / batch_window);
            bonds += one.n_bonds;
        }
    }

    // Puts the trees of a chunk into batches of trees.
    void plant(std::size_t first, std::size_t end, Plan::Chunk &chunk) {
        const std::size_t lanes = static_cast<std::size_t>(kernels().lanes);
        const EliminationPlan *tree[most_lanes];
        chunk.first_batch = plan_->tree_batches.size();
        for (std::size_t i = first; i < end; i += lanes) {
            const std::size_t n = std::min(lanes, end - i);
            for (std::size_t l = 0; l < n; ++l) tree[l] = plan_->elimination_plans[at(gathered_[i + l].shape)];
            plan_->tree_batches.add(static_cast<int>(lanes), tree, static_cast<int>(n));
        }
        chunk.n_batches = plan_->tree_batches.size() - chunk.first_batch;
    }

    // A large tree whose atoms fill the lanes is a batch of trees by itself, the same for all molecules of a shape.
    void plant_alone(Plan::Chunk &chunk) {
        const EliminationPlan &s = *plan_->elimination_plans[at(chunk.shape)];
        if (s.way.forces != Way::large_tree) return;
        const auto found = alone_.emplace(chunk.shape, plan_->tree_batches.size());
        if (found.second) plan_->tree_batches.add_large(kernels().lanes, &s);
        chunk.first_batch = found.first->second;
        chunk.n_batches = 1;
    }

    const Chains &chains_;
    const std::vector<Group> &groups_;
    const std::int32_t n_shapes_;
    std::unordered_map<std::int32_t, std::int64_t> alone_;  // batches of trees of large trees, by shape
    std::vector<Gathered> gathered_;
    std::unique_ptr<Plan> plan_ = std::make_unique<Plan>();
};

std::int64_t Plan::bytes() const {
    std::size_t bytes = sizeof *this + chunks.capacity() * sizeof(Chunk) + gathered_chains.capacity() * sizeof(Lane) +
                        gathered_molecules.capacity() * sizeof(MoleculeLane) +
                        elimination_plans.capacity() * sizeof(void *) + shapes.capacity() * sizeof(shapes[0]) +
                        (stage.capacity() + part_start.capacity()) * sizeof(std::int64_t) + is_copy.capacity() +
                        copies.capacity() * sizeof(Copy) + parts.capacity() * sizeof(ChainPart) + part_shapes.bytes() +
                        tree_batches.bytes();
    for (const std::vector<double> &table : w) bytes += table.capacity() * sizeof(double);
    return static_cast<std::int64_t>(bytes);
}

const Plan &Chains::make_plan() const {
    return plan_.once([this] { return Planner(*this, false).make(); });
}

const Plan &Chains::plan_of_parts() const {
    const Plan *const made = plan_of_parts_.there();
    return made ? *made : plan_of_parts_.once([this] { return Planner(*this, true).make(); });
}

}  // namespace holonomic
