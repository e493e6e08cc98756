#include "core/molecules/schedule.hpp"

#include <algorithm>
#include <mutex>
#include <vector>

#include "core/kernels/careful/scratch.hpp"
#include "core/molecules/schedule_maker.hpp"
#include "core/molecules/way.hpp"

namespace holonomic {

namespace {

// Of a large tree, its arms, or what can be worked on at once.
void add_large_tree(Schedule &s, Schedule::Memory::Large &m) {
    m.arms = arms_of(s);
    s.n_arms = static_cast<std::int32_t>(m.arms.arm.size());
    if (s.n_arms == 0) {
        m.runs = runs_of(s);
        if (!fills_lanes(s, places_in_lanes(m.runs))) {
            m.runs = {};
            return;
        }
        s.runs = m.runs.runs();
        s.n_pieces = static_cast<std::int32_t>(m.runs.piece_start.size()) - 2;
        return;
    }
    s.arm = m.arms.arm.data();
    s.stretch = m.arms.stretch.data();
    s.share_start = m.arms.share_start.data();
    s.n_shares = static_cast<std::int32_t>(m.arms.share_start.size()) - 1;
}

std::unique_ptr<Schedule> bare_schedule(std::int32_t n_atoms, std::int32_t n_bonds, const std::int32_t *pairs,
                                        const unsigned char *fixed, std::int64_t most_bytes, ScheduleMaker::For what,
                                        ScheduleWork &work) {
    std::unique_ptr<Schedule> s(new Schedule());
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
    ScheduleMaker maker(*s, work, most_bytes, what);
    maker.make();
    // What is held fixed accelerates nothing, and no tree can be eliminated from there: of a network it is a node.
    if (maker.is_network() && what == ScheduleMaker::molecule && fixed &&
        std::count(fixed, fixed + n_atoms, 0) < n_atoms)
        return bare_schedule(n_atoms, n_bonds, pairs, fixed, most_bytes, ScheduleMaker::network, work);
    s->memory = new Schedule::Memory();
    pack(*s, work);
    if (!maker.is_network()) {
        s->careful_bytes = careful_scratch_bytes(*s, s->more_of_metric);
        return s;
    }
    make_network(*s, most_bytes, s->memory->of_large().network);
    s->network = &s->memory->large->network.plan;
    return s;
}

// For what does not converge.
void make_careful_too(Schedule &s, std::int64_t most_bytes) {
    try {
        s.memory->careful = make_careful_schedule(s, most_bytes);
        s.careful = s.memory->careful.get();
    } catch (const TooMuchMemory &) {
        s.careful = nullptr;  // then there is none
    }
}

}  // namespace

std::unique_ptr<const Schedule> make_schedule(std::int32_t n_atoms, std::int32_t n_bonds, const std::int32_t *pairs,
                                              const unsigned char *fixed, std::int64_t most_bytes, ScheduleWork *work) {
    ScheduleWork own;
    std::unique_ptr<Schedule> s =
        bare_schedule(n_atoms, n_bonds, pairs, fixed, most_bytes, ScheduleMaker::molecule, work ? *work : own);
    Schedule::Memory &m = *s->memory;
    if (s->network) {
        if (const std::int64_t most = most_bytes_of_careful(*s)) make_careful_too(*s, std::min(most_bytes, most));
    } else {
        if (is_large_tree(*s)) add_large_tree(*s, m.of_large());
        if (takes_list(*s)) {
            make_flat_list(*s, m.of_large().flat);
            s->flat = &m.large->flat.list;
        }
        if (may_have_paths(*s) && make_path_plan(*s, m.of_large().paths)) s->paths = &m.large->paths.plan;
    }
    choose_ways(*s);
    return s;
}

std::unique_ptr<const Schedule> make_knot_schedule(std::int32_t n_atoms, std::int32_t n_bonds,
                                                   const std::int32_t *pairs, const unsigned char *fixed) {
    ScheduleWork work;
    return bare_schedule(n_atoms, n_bonds, pairs, fixed, no_limit, ScheduleMaker::knot, work);
}

std::unique_ptr<const Schedule> make_careful_schedule(const Schedule &s, std::int64_t most_bytes) {
    Numbers pairs;
    for (std::int32_t k = 0; k < s.n_bonds; ++k) pairs.insert(pairs.end(), {s.atom_i[k], s.atom_j[k]});
    ScheduleWork work;
    return bare_schedule(s.n_atoms, s.n_bonds, pairs.data(), s.fixed, most_bytes, ScheduleMaker::careful, work);
}

const Schedule &make_careful(const Schedule &s, std::int64_t most_bytes) {
    static std::mutex mutex;
    const std::lock_guard<std::mutex> lock(mutex);
    if (!careful_order(s)) {
        s.memory->careful = make_careful_schedule(s, most_bytes);
        s.late_careful = s.memory->careful.get();
    }
    return *careful_order(s);
}

}  // namespace holonomic
