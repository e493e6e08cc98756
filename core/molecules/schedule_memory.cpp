#include "core/molecules/schedule_memory.hpp"

#include <cstring>
#include <type_traits>

#include "core/molecules/schedule.hpp"

namespace holonomic {

Schedule::~Schedule() { delete memory; }

namespace {

// Calls each(pointer, list) for the arrays, those of large elements first.
template <class Arrays, class Each>
void for_arrays(Schedule &s, Arrays &a, const Each &each) {
    each(s.atom_i, a.atom_i);
    each(s.atom_j, a.atom_j);
    each(s.atom_of, a.atom_of);
    each(s.slot_of, a.slot_of);
    each(s.bond_of, a.bond_of);
    each(s.place_of, a.place_of);
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

void point_into(Schedule &s, const ScheduleWork &work) {
    for_arrays(s, work, [](auto &pointer, const auto &list) { pointer = list.data(); });
}

void clear(ScheduleWork &work) {
    Schedule any;
    for_arrays(any, work, [](auto &, auto &list) { list.clear(); });
}

// What a large one was made in is given back at once.
void pack(Schedule &s, ScheduleWork &work) {
    if (s.n_bonds > largest_in_lanes) {
        for (Numbers *const list :
             {&work.bonds.start, &work.bonds.item, &work.upper_bond, &work.degree, &work.stack, &work.next})
            *list = {};
    }
    std::size_t bytes = 0;
    for_arrays(s, work, [&](auto &, const auto &list) { bytes += list.size() * sizeof list[0]; });
    s.memory->block.resize((bytes + 7) / 8);
    char *next = reinterpret_cast<char *>(s.memory->block.data());
    for_arrays(s, work, [&](auto &pointer, auto &list) {
        pointer = reinterpret_cast<std::remove_reference_t<decltype(pointer)>>(next);
        if (!list.empty()) std::memcpy(next, list.data(), list.size() * sizeof list[0]);
        next += list.size() * sizeof list[0];
        if (s.n_bonds > largest_in_lanes) list = {};
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
std::size_t bytes(const ScheduleRuns &r) { return bytes(r.run, r.slot, r.piece_start); }
std::size_t bytes(const FlatArrays &f) {
    return bytes(f.atom_of, f.home, f.place_of, f.bond_of, f.from, f.to, f.row, f.row_4, f.column_4, f.mass, f.update,
                 f.outer, f.tile, f.branch, f.run, f.late, f.late_entry, f.visit);
}

std::size_t bytes(const PathArrays &p) {
    std::size_t sum = bytes(p.path, p.piece, p.kind, p.leg, p.atom, p.bond, p.schedule);
    for (const auto &schedule : p.schedule) sum += bytes_of(*schedule);
    return sum;
}

std::size_t bytes(const Schedule::Memory::Large &l) {
    return sizeof l + bytes(l.arms.arm, l.arms.stretch, l.arms.share_start) + bytes(l.runs) + bytes(l.flat) +
           bytes(l.paths) + bytes_of(l.network);
}

}  // namespace

std::size_t bytes_of(const Schedule &s) {
    const Schedule::Memory &m = *s.memory;
    return sizeof s + sizeof m + bytes(m.block) + (m.large ? bytes(*m.large) : 0) +
           (m.careful ? bytes_of(*m.careful) : 0);
}

}  // namespace holonomic
