#include "core/molecules/schedule_memory.hpp"

#include "core/molecules/schedule.hpp"

namespace holonomic {

Schedule::~Schedule() { delete memory; }

void point_into(Schedule &s, const Schedule::Memory &m) {
    s.atom_i = m.atom_i.data();
    s.atom_j = m.atom_j.data();
    s.fixed = m.fixed.data();
    s.atom_of = m.atom_of.data();
    s.slot_of = m.slot_of.data();
    s.bond_of = m.bond_of.data();
    s.place_of = m.place_of.data();
    s.parent = m.parent.data();
    s.child_start = m.child_start.data();
    s.child = m.child.data();
    s.pair_start = m.pair_start.data();
    s.from = m.from.data();
    s.to = m.to.data();
    s.meet_start = m.meet_start.data();
    s.meet = m.meet.data();
    s.meet_pair = m.meet_pair.data();
    s.meet_pair_start = m.meet_pair_start.data();
    s.column_start = m.column_start.data();
    s.row = m.row.data();
    s.update_start = m.update_start.data();
    s.update = m.update.data();
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
                 f.outer, f.tile, f.run, f.late, f.late_entry, f.visit);
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
    return sizeof s + sizeof m +
           bytes(m.atom_i, m.atom_j, m.atom_of, m.slot_of, m.bond_of, m.place_of, m.parent, m.child_start, m.child,
                 m.pair_start, m.from, m.to, m.meet_start, m.meet, m.meet_pair, m.meet_pair_start, m.column_start,
                 m.row, m.update, m.update_start, m.fixed) +
           (m.large ? bytes(*m.large) : 0) + (m.careful ? static_cast<std::size_t>(m.careful->memory()) : 0);
}

}  // namespace holonomic
