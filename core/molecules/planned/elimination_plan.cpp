#include "core/molecules/planned/elimination_plan.hpp"

#include <algorithm>
#include <mutex>
#include <vector>

#include "core/kernels/extended/scratch.hpp"
#include "core/molecules/planned/elimination_planner.hpp"
#include "core/molecules/planned/way.hpp"

namespace holonomic {

namespace {

// Of a large tree, its arms, or what can be worked on at once.
void add_large_tree(EliminationPlan &s, EliminationPlan::Memory::Large &m) {
    m.arms = arms_of(s);
    s.n_arms = static_cast<std::int32_t>(m.arms.arm.size());
    if (s.n_arms == 0) {
        m.runs = runs_of(s);
        if (!fills_lanes(s, elements_in_lanes(m.runs))) {
            m.runs = {};
            return;
        }
        s.runs = m.runs.runs();
        s.n_tiles = static_cast<std::int32_t>(m.runs.tile_start.size()) - 2;
        return;
    }
    s.arm = m.arms.arm.data();
    s.stretch = m.arms.stretch.data();
    s.share_start = m.arms.share_start.data();
    s.n_shares = static_cast<std::int32_t>(m.arms.share_start.size()) - 1;
}

std::unique_ptr<EliminationPlan> bare_plan(std::int32_t n_atoms, std::int32_t n_bonds, const std::int32_t *pairs,
                                           const unsigned char *fixed, std::int64_t most_bytes,
                                           EliminationPlanner::For what, EliminationWork &work) {
    std::unique_ptr<EliminationPlan> s(new EliminationPlan());
    s->n_atoms = n_atoms;
    s->n_bonds = n_bonds;
    clear(work);
    for (Numbers *const list : {&work.atom_i, &work.atom_j}) list->resize(at(n_bonds));
    for (std::int32_t k = 0; k < n_bonds; ++k) {
        work.atom_i[at(k)] = pairs[2 * k];
        work.atom_j[at(k)] = pairs[2 * k + 1];
    }
    work.fixed.assign(at(n_atoms), 0);
    if (fixed) work.fixed.assign(fixed, fixed + n_atoms);
    point_into(*s, work);
    EliminationPlanner maker(*s, work, most_bytes, what);
    maker.make();
    // What is held fixed accelerates nothing, and no tree can be eliminated from there: of a network it is a node.
    if (maker.is_network() && what == EliminationPlanner::molecule && fixed &&
        std::count(fixed, fixed + n_atoms, 0) < n_atoms)
        return bare_plan(n_atoms, n_bonds, pairs, fixed, most_bytes, EliminationPlanner::network, work);
    s->memory = new EliminationPlan::Memory();
    pack(*s, work);
    if (!maker.is_network()) {
        s->extended_bytes = extended_scratch_bytes(*s, s->more_of_metric);
        return s;
    }
    make_network(*s, most_bytes, s->memory->of_large().network);
    s->network = &s->memory->large->network.plan;
    return s;
}

// For what does not converge.
void make_extended_too(EliminationPlan &s, std::int64_t most_bytes) {
    try {
        s.memory->extended = make_extended_plan(s, most_bytes);
        s.extended = s.memory->extended.get();
    } catch (const TooMuchMemory &) {
        s.extended = nullptr;  // then there is none
    }
}

}  // namespace

std::unique_ptr<const EliminationPlan> make_elimination_plan(std::int32_t n_atoms, std::int32_t n_bonds,
                                                             const std::int32_t *pairs, const unsigned char *fixed,
                                                             std::int64_t most_bytes, EliminationWork *work) {
    EliminationWork own, &w = work ? *work : own;
    std::unique_ptr<EliminationPlan> s =
        bare_plan(n_atoms, n_bonds, pairs, fixed, most_bytes, EliminationPlanner::molecule, w);
    EliminationPlan::Memory &m = *s->memory;
    if (s->network) {
        if (const std::int64_t most = most_bytes_of_extended(*s)) make_extended_too(*s, std::min(most_bytes, most));
    } else {
        if (is_large_tree(*s)) add_large_tree(*s, m.of_large());
        if (takes_ldl(*s, w.bonds)) {
            LdlArrays &arrays = m.of_large().ldl;
            s->n_core > 0 ? make_ldl_plan(*s, std::move(w.bonds), std::move(w.leaves_first), arrays)
                          : make_ldl_plan(*s, std::move(w.bonds), arrays);
            s->ldl = &arrays.list;
        }
        if (may_have_paths(*s) && make_path_plan(*s, m.of_large().paths)) s->paths = &m.large->paths.plan;
    }
    choose_ways(*s);
    return s;
}

std::unique_ptr<const EliminationPlan> make_junction_plan(std::int32_t n_atoms, std::int32_t n_bonds,
                                                          const std::int32_t *pairs, const unsigned char *fixed) {
    EliminationWork work;
    return bare_plan(n_atoms, n_bonds, pairs, fixed, no_limit, EliminationPlanner::junction, work);
}

std::unique_ptr<const EliminationPlan> make_extended_plan(const EliminationPlan &s, std::int64_t most_bytes) {
    Numbers pairs;
    for (std::int32_t k = 0; k < s.n_bonds; ++k) pairs.insert(pairs.end(), {s.atom_i[k], s.atom_j[k]});
    EliminationWork work;
    return bare_plan(s.n_atoms, s.n_bonds, pairs.data(), s.fixed, most_bytes, EliminationPlanner::extended, work);
}

namespace {
std::mutex late_mutex;  // of what is made late
}  // namespace

void make_list_of_kept(const EliminationPlan &s) {
    const std::lock_guard<std::mutex> lock(late_mutex);
    if (s.way.given != Way::large_tree || list_of_kept(s)) return;
    Lists bonds = invert(s.n_atoms, s.n_bonds, [&](std::int32_t k, int end) { return (end ? s.atom_j : s.atom_i)[k]; });
    if (!has_short_ldl(s, bonds)) return;
    make_ldl_plan(s, std::move(bonds), s.memory->of_large().ldl);
    s.late_ldl = &s.memory->large->ldl.list;
}

const EliminationPlan &make_extended(const EliminationPlan &s, std::int64_t most_bytes) {
    const std::lock_guard<std::mutex> lock(late_mutex);
    if (!extended_order(s)) {
        s.memory->extended = make_extended_plan(s, most_bytes);
        s.late_extended = s.memory->extended.get();
    }
    return *extended_order(s);
}

}  // namespace holonomic
