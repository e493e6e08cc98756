#include "core/molecules/schedule_memory.hpp"

#include "core/molecules/schedule.hpp"

namespace holonomic {

Schedule::~Schedule() { delete memory; }

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
                 f.outer, f.tile, f.run, f.late, f.late_entry, f.visit);
}

}  // namespace

std::size_t bytes_of(const Schedule &s) {
    const Schedule::Memory &m = *s.memory;
    return sizeof s + sizeof m +
           bytes(m.atom_i, m.atom_j, m.atom_of, m.slot_of, m.bond_of, m.place_of, m.parent, m.child_start, m.child,
                 m.pair_start, m.from, m.to, m.meet_start, m.meet, m.meet_pair, m.meet_pair_start, m.column_start,
                 m.row, m.update, m.update_start, m.fixed, m.arms.arm, m.arms.stretch, m.arms.stretch_start,
                 m.arms.share_start) +
           bytes(m.runs) + bytes(m.arms.runs) + bytes(m.flat) + static_cast<std::size_t>(m.careful->memory());
}

}  // namespace holonomic
