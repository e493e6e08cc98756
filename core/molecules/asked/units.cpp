// The lanes of a chunk of work, as the kernels see them.
#include "core/index.hpp"
#include "core/molecules/chains.hpp"

namespace holonomic {

namespace {

// Positions, velocities, forces and results of so many bonds, 96 bytes each, fill a second-level cache.
constexpr std::int64_t bonds_in_cache = 16384;

}  // namespace

std::int64_t Chains::chunk_bonds(const Plan::Chunk &chunk) const {
    return chunk.group < 0 ? 0 : kind_of(groups_.all()[at(chunk.group)]).n_bonds;
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
    lane.kind = group.kind;
    for (std::int64_t k = 0; k < 4; ++k) {
        const bool there = kind.n_bonds < 4 && k <= kind.n_bonds;
        lane.element[k] = there ? 3 * (lane.atoms ? lane.atoms[k] : lane.first_atom + k) : 0;
    }
    return lane;
}

MoleculeLane Chains::molecule_lane_of(const Plan &plan, const Group &group, std::int64_t index, std::int64_t stage,
                                      std::int64_t part) const {
    const Kind &kind = kind_of(group);
    MoleculeLane lane;
    lane.first_atom = stage >= 0 ? stage : group.first_atom + index * kind.n_atoms();
    lane.atoms = stage >= 0 ? nullptr : groups_.atoms(group, index, kind.n_atoms());
    lane.shared = nullptr;  // molecules that share atoms have copies of their own
    lane.w = kinds_.w(kind);
    lane.length = kinds_.length(kind);
    lane.first_bond = group.first_bond + index * kind.n_bonds;
    lane.molecule = group.first_molecule + index;
    if (group.reordered && !plan.copied) lane.bonds = groups_.reordered().data() + lane.first_bond;
    if (part < 0) return lane;
    const std::int64_t first = plan.parts[at(part)].first;
    if (!lane.w) lane.w = plan.w[at(group.kind)].data();
    lane.w += first;
    if (lane.length) lane.length += first;
    lane.first_atom += first;
    if (lane.atoms) lane.atoms += first;
    lane.first_bond += first;
    return lane;
}

Unit Chains::unit(const Plan &plan, const Plan::Chunk &p, Lane *lane) const {
    const bool large = plan.n_bonds > bonds_in_cache;
    if (p.group >= 0) {
        *lane = lane_of(groups_.all()[at(p.group)], p.first, p.stage);
        return {lane, p.count, true, large};
    }
    return {&plan.gathered_chains[at(p.first)], p.count, p.count == 1, large};  // one is like itself
}

namespace {

inline MoleculeUnit unit_of(const Plan &plan, const Plan::Chunk &p, const MoleculeLane *lanes, bool regular) {
    return {plan.elimination_plans[at(p.shape)],
            lanes,
            p.count,
            regular,
            plan.n_bonds > bonds_in_cache,
            nullptr,
            p.n_batches > 0 ? plan.tree_batches[p.first_batch] : nullptr,
            p.n_batches};
}

}  // namespace

MoleculeUnit Chains::unit(const Plan &plan, const Plan::Chunk &p, MoleculeLane *lane) const {
    if (p.group >= 0) return unit_of_group(plan, p, lane);
    return unit_of(plan, p, &plan.gathered_molecules[at(p.first)], false);
}

// Not inlined: what comes as a list needs none of it.
[[gnu::noinline]] MoleculeUnit Chains::unit_of_group(const Plan &plan, const Plan::Chunk &p, MoleculeLane *lane) const {
    *lane = molecule_lane_of(plan, groups_.all()[at(p.group)], p.first, p.stage, p.part);
    return unit_of(plan, p, lane, true);
}

}  // namespace holonomic
