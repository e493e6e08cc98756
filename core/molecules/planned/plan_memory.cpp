#include "core/molecules/planned/plan_memory.hpp"

#include <cstring>
#include <type_traits>

#include "core/molecules/planned/elimination_plan.hpp"

namespace holonomic {

EliminationPlan::~EliminationPlan() { delete memory; }

namespace {

// Calls each(pointer, list) for the arrays, those of large elements first.
template <class Arrays, class Each>
void for_arrays(EliminationPlan &s, Arrays &a, const Each &each) {
    each(s.atom_i, a.atom_i);
    each(s.atom_j, a.atom_j);
    each(s.atom_of, a.atom_of);
    each(s.index_of, a.index_of);
    each(s.bond_of, a.bond_of);
    each(s.bond_index_of, a.bond_index_of);
    each(s.parent, a.parent);
    each(s.child_start, a.child_start);
    each(s.child, a.child);
    each(s.pair_start, a.pair_start);
    each(s.from, a.from);
    each(s.to, a.to);
    each(s.meet_start, a.meet_start);
    each(s.meet, a.meet);
    each(s.column_start, a.column_start);
    each(s.row, a.row);
    each(s.fixed, a.fixed);
}

}  // namespace

void point_into(EliminationPlan &s, const EliminationWork &work) {
    for_arrays(s, work, [](auto &pointer, const auto &list) { pointer = list.data(); });
}

void clear(EliminationWork &work) {
    EliminationPlan any;
    for_arrays(any, work, [](auto &, auto &list) { list.clear(); });
    work.leaves_first.clear();
}

// What a large one was made in is given back at once.
void pack(EliminationPlan &s, EliminationWork &work) {
    if (s.n_bonds > largest_in_lanes) {
        for (Numbers *const list : {&work.upper_bond, &work.degree, &work.leaves, &work.stack, &work.next})
            Numbers().swap(*list);
        if (s.n_core > 0 && work.leaves_first.empty()) work.bonds = {};
    }
    std::size_t bytes = 0;
    for_arrays(s, work, [&](auto &, const auto &list) { bytes += list.size() * sizeof list[0]; });
    s.memory->block.resize((bytes + 7) / 8);
    char *next = reinterpret_cast<char *>(s.memory->block.data());
    for_arrays(s, work, [&](auto &pointer, auto &list) {
        pointer = reinterpret_cast<std::remove_reference_t<decltype(pointer)>>(next);
        if (!list.empty()) std::memcpy(next, list.data(), list.size() * sizeof list[0]);
        next += list.size() * sizeof list[0];
        if (s.n_bonds > largest_in_lanes) std::remove_reference_t<decltype(list)>().swap(list);
    });
}

namespace {

template <class T>
std::size_t bytes(const std::vector<T> &list) {
    return list.capacity() * sizeof(T);
}
template <class... Lists>
std::size_t bytes(const Lists &...lists) {
    return (bytes(lists) + ...);
}
std::size_t bytes(const TreeRuns &r) { return bytes(r.run, r.index, r.tile_start); }
std::size_t bytes(const LdlArrays &f) {
    return bytes(f.atom_of, f.home, f.site_of, f.bond_of, f.from, f.to, f.row, f.row_4, f.column_4, f.mass, f.update,
                 f.outer, f.tile, f.subtree, f.run, f.late, f.late_entry, f.visit);
}

std::size_t bytes(const PathArrays &p) {
    std::size_t sum = bytes(p.path, p.section, p.kind, p.overlap, p.atom, p.bond, p.elimination);
    for (const auto &elimination : p.elimination) sum += bytes_of(*elimination);
    return sum;
}

std::size_t bytes(const EliminationPlan::Memory::Large &l) {
    return sizeof l + bytes(l.arms.arm, l.arms.stretch, l.arms.share_start) + bytes(l.runs) + bytes(l.ldl) +
           bytes(l.paths) + bytes_of(l.network);
}

}  // namespace

std::size_t bytes_of(const EliminationPlan &s) {
    const EliminationPlan::Memory &m = *s.memory;
    return sizeof s + sizeof m + bytes(m.block) + (m.large ? bytes(*m.large) : 0) +
           (m.extended ? bytes_of(*m.extended) : 0);
}

}  // namespace holonomic
