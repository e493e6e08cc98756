#include "core/molecules/schedule.hpp"

#include <algorithm>
#include <mutex>
#include <vector>

#include "core/molecules/elimination_order.hpp"
#include "core/molecules/schedule_memory.hpp"

namespace holonomic {

namespace {

class Maker {
public:
    // What it is made for: a knot of paths, any molecule, a large graph that has to be a network, the careful solver.
    enum For { knot, molecule, network, careful };
    Maker(Schedule &s, ScheduleArrays &m, std::int64_t most_bytes, For what)
        : s_(s), m_(m), most_bytes_(most_bytes), for_(what), bonds_(bonds_of_atoms()) {}

    void make() {
        strip();
        number_trees();
        if (s_.n_core == 0) {
            s_.type = Schedule::tree;
        } else if (s_.n_core == s_.n_core_atoms && (s_.n_tree == 0 || is_simple_ring())) {
            s_.type = s_.n_bonds == 3 ? Schedule::triangle : Schedule::ring;
            number_ring();
        } else {
            s_.type = Schedule::graph;
            number_core();
        }
        invert_numbers();
        list_children();
        list_meetings();
        if (is_network_) return;
        list_fill();
        const bool listed = for_ == molecule && s_.type == Schedule::graph && takes_flat_list(s_);
        if (!listed && for_ != careful) list_updates();
    }
    bool is_network() const { return is_network_; }
    // What is held fixed accelerates nothing, and no tree can be eliminated from there: of a network it is a node.
    static bool has_fixed(const ScheduleArrays &m) {
        return std::find(m.fixed.begin(), m.fixed.end(), 1) != m.fixed.end();
    }

private:
    bool stays(std::int32_t atom) const { return for_ == network && m_.fixed[at(atom)]; }

    Lists bonds_of_atoms() const {
        return invert(s_.n_atoms, s_.n_bonds,
                      [&](std::int32_t k, int end) { return (end ? m_.atom_j : m_.atom_i)[at(k)]; });
    }
    std::int32_t other_end(std::int32_t bond, std::int32_t atom) const {
        return m_.atom_i[at(bond)] == atom ? m_.atom_j[at(bond)] : m_.atom_i[at(bond)];
    }

    // Takes away atoms with one bond until none is left: upper_bond_ of those. Of a tree the last two atoms would take
    // each other away; the one that is left is the atom with the largest number of those that had one bond.
    void strip() {
        Numbers degree(at(s_.n_atoms)), leaves;
        upper_bond_.assign(at(s_.n_atoms), -1);
        const bool is_tree = s_.n_bonds == s_.n_atoms - 1;
        std::int32_t root = -1;
        for (std::int32_t i = 0; i < s_.n_atoms; ++i) {
            degree[at(i)] = bonds_.size(i);
            if (is_tree && degree[at(i)] == 1) root = i;
        }
        for (std::int32_t i = 0; i < s_.n_atoms; ++i)
            if (degree[at(i)] == 1 && i != root && !stays(i)) leaves.push_back(i);
        s_.n_tree = 0;
        while (!leaves.empty()) {
            const std::int32_t i = leaves.back();
            leaves.pop_back();
            for (const std::int32_t *k = bonds_.begin(i); k != bonds_.end(i); ++k) {
                const std::int32_t j = other_end(*k, i);
                if (upper_bond_[at(j)] == *k) continue;  // a child's
                upper_bond_[at(i)] = *k;
                if (--degree[at(j)] == 1 && j != root && !stays(j)) leaves.push_back(j);
            }
            ++s_.n_tree;
        }
        s_.n_core = s_.n_bonds - s_.n_tree;
        s_.n_core_atoms = is_tree ? 0 : s_.n_atoms - s_.n_tree;
    }

    bool is_child(std::int32_t bond, std::int32_t atom) const {
        const std::int32_t j = other_end(bond, atom);
        return upper_bond_[at(j)] == bond;
    }

    // Post-order of the trees below each atom that was not taken away, children in the order of their bonds.
    void number_trees() {
        Numbers stack, next(bonds_.start.begin(), bonds_.start.end() - 1);
        for (std::int32_t top = 0; top < s_.n_atoms; ++top) {
            if (upper_bond_[at(top)] >= 0) continue;
            stack.assign(1, top);
            while (!stack.empty()) {
                const std::int32_t i = stack.back();
                std::int32_t &k = next[at(i)];
                while (k < bonds_.start[at(i) + 1] && !is_child(bonds_.item[at(k)], i)) ++k;
                if (k < bonds_.start[at(i) + 1]) {
                    stack.push_back(other_end(bonds_.item[at(k++)], i));
                    continue;
                }
                stack.pop_back();
                if (i == top) break;
                m_.atom_of.push_back(i);
                m_.bond_of.push_back(upper_bond_[at(i)]);
            }
        }
        for (std::int32_t i = 0; i < s_.n_atoms; ++i)
            if (upper_bond_[at(i)] < 0) m_.atom_of.push_back(i);
    }

    // Small, and with few trees at each of its atoms.
    bool is_simple_ring() const {
        if (s_.n_bonds > largest_graph_in_lanes) return false;
        for (std::int32_t i = 0; i < s_.n_atoms; ++i)
            if (upper_bond_[at(i)] < 0 && bonds_.size(i) > 2 + most_on_ring) return false;
        return true;
    }
    // Round from the core's first atom in the direction of its first bond.
    void number_ring() {
        const std::int32_t first = m_.atom_of[at(s_.n_tree)];
        m_.atom_of.resize(at(s_.n_tree));
        std::int32_t atom = first, bond = -1;
        do {
            const std::int32_t *k = bonds_.begin(atom);
            while (*k == bond || is_child(*k, atom)) ++k;
            bond = *k;
            m_.atom_of.push_back(atom);
            m_.bond_of.push_back(bond);
            atom = other_end(bond, atom);
        } while (atom != first);
    }

    void number_core() {
        Numbers core, core_number(at(s_.n_bonds), -1);
        for (std::int32_t k = 0; k < s_.n_bonds; ++k) {
            const std::int32_t i = m_.atom_i[at(k)], j = m_.atom_j[at(k)];
            if (upper_bond_[at(i)] == k || upper_bond_[at(j)] == k) continue;
            core_number[at(k)] = static_cast<std::int32_t>(core.size());
            core.push_back(k);
        }
        if (for_ == knot || for_ == careful || s_.n_bonds <= largest_graph_in_lanes)
            return order_core(core, core_number, most_bytes_);
        is_network_ = for_ == network || has_long_strands(core);
        try {
            const std::int64_t most = most_bytes_of_list * static_cast<std::int64_t>(core.size());
            if (!is_network_) return order_core(core, core_number, std::min(most_bytes_, most));
        } catch (const TooMuchMemory &) {
            is_network_ = true;
        }
        m_.bond_of.insert(m_.bond_of.end(), core.begin(), core.end());
    }
    void order_core(const Numbers &core, const Numbers &core_number, std::int64_t most_bytes) {
        check_atoms(core, most_bytes);
        std::vector<Numbers> neighbours(core.size());
        for (std::size_t p = 0; p < core.size(); ++p)
            for (const std::int32_t i : {m_.atom_i[at(core[p])], m_.atom_j[at(core[p])]})
                for (const std::int32_t *l = bonds_.begin(i); l != bonds_.end(i); ++l)
                    if (*l != core[p] && core_number[at(*l)] >= 0) neighbours[p].push_back(core_number[at(*l)]);
        for (const std::int32_t p : minimum_degree(std::move(neighbours), Ties::latest, most_bytes))
            m_.bond_of.push_back(core[at(p)]);
    }
    // Between atoms with other than two bonds of the core, or with trees.
    bool has_long_strands(const Numbers &core) const {
        Numbers degree(at(s_.n_atoms));
        for (const std::int32_t k : core)
            for (const std::int32_t i : {m_.atom_i[at(k)], m_.atom_j[at(k)]}) ++degree[at(i)];
        std::int64_t ends = 0;
        for (std::int32_t i = 0; i < s_.n_atoms; ++i)
            if (degree[at(i)] > 2 || bonds_.size(i) > 2) ends += degree[at(i)];
        return ends >= 2 * many_strands && 2 * static_cast<std::int64_t>(core.size()) >= long_strand * ends;
    }
    // Bonds at one atom are all neighbours of each other: n of them fill at least what n columns do.
    void check_atoms(const Numbers &core, std::int64_t most_bytes) const {
        Numbers degree(at(s_.n_atoms));
        std::int64_t bytes = 0;
        for (const std::int32_t k : core)
            for (const std::int32_t i : {m_.atom_i[at(k)], m_.atom_j[at(k)]})
                bytes += 8 * std::int64_t{++degree[at(i)]};
        if (bytes > most_bytes) throw TooMuchMemory(bytes);
    }

    void invert_numbers() {
        m_.slot_of.resize(at(s_.n_atoms));
        for (std::int32_t i = 0; i < s_.n_atoms; ++i) m_.slot_of[at(m_.atom_of[at(i)])] = i;
        if (for_ == knot) m_.place_of.resize(at(s_.n_bonds));
        for (std::int32_t k = 0; for_ == knot && k < s_.n_bonds; ++k) m_.place_of[at(m_.bond_of[at(k)])] = k;
        m_.parent.reserve(at(s_.n_tree));
        for (std::int32_t k = 0; k < s_.n_tree; ++k)
            m_.parent.push_back(m_.slot_of[at(other_end(m_.bond_of[at(k)], m_.atom_of[at(k)]))]);
        const bool round = s_.type == Schedule::ring || s_.type == Schedule::triangle;
        for (std::int32_t p = 0; p < s_.n_core; ++p) {
            const std::int32_t k = m_.bond_of[at(s_.n_tree + p)];
            const std::int32_t i = m_.slot_of[at(m_.atom_i[at(k)])], j = m_.slot_of[at(m_.atom_j[at(k)])];
            m_.from.push_back(round ? s_.n_tree + p : i);
            m_.to.push_back(round ? s_.n_tree + (p + 1) % s_.n_core : j);
        }
    }

    void list_children() {
        m_.child_start.assign(at(s_.n_atoms) + 1, 0);
        for (const std::int32_t p : m_.parent) ++m_.child_start[at(p) + 1];
        m_.pair_start.assign(at(s_.n_atoms) + 1, 0);
        s_.max_children = s_.max_joint = 0;
        for (std::int32_t i = 0; i < s_.n_atoms; ++i) {
            const std::int32_t k = m_.child_start[at(i) + 1];
            m_.child_start[at(i) + 1] += m_.child_start[at(i)];
            const bool decomposed = i >= s_.n_tree || k <= most_decomposed;
            m_.pair_start[at(i) + 1] = m_.pair_start[at(i)] + (decomposed ? k * (k - 1) / 2 : values_of_joint(k));
            s_.max_children = std::max(s_.max_children, k);
            if (decomposed) s_.max_joint = std::max(s_.max_joint, k);
        }
        s_.n_pairs = m_.pair_start[at(s_.n_atoms)];
        m_.child.resize(at(s_.n_tree));
        Numbers next(m_.child_start.begin(), m_.child_start.end() - 1);
        for (std::int32_t k = 0; k < s_.n_tree; ++k) m_.child[at(next[at(m_.parent[at(k)])]++)] = k;
    }

    // Which bonds meet at each atom of the core.
    void list_meetings() {
        Lists meet = invert(s_.n_core_atoms, s_.n_core,
                            [&](std::int32_t p, int end) { return (end ? m_.to : m_.from)[at(p)] - s_.n_tree; });
        s_.max_core_bonds = 0;
        for (std::int32_t c = 0; c < s_.n_core_atoms; ++c) {
            s_.max_core_bonds = std::max(s_.max_core_bonds, meet.size(c));
            for (std::int32_t m = meet.start[at(c)]; m < meet.start[at(c) + 1]; ++m) {
                std::int32_t &p = meet.item[at(m)];
                p = 2 * p + (m_.to[at(p)] == s_.n_tree + c ? 1 : 0);
            }
        }
        m_.meet_start = std::move(meet.start);
        m_.meet = std::move(meet.item);
    }
    // Calls each(p, q) for all pairs p != q of bonds that meet at atom c of the core.
    template <class Each>
    void for_meetings(std::int32_t c, const Each &each) const {
        for (std::int32_t a = m_.meet_start[at(c)]; a < m_.meet_start[at(c) + 1]; ++a)
            for (std::int32_t b = m_.meet_start[at(c)]; b < m_.meet_start[at(c) + 1]; ++b)
                if (a != b) each(m_.meet[at(a)] / 2, m_.meet[at(b)] / 2, b < a);
    }

    // The factor's pattern.
    void list_fill() {
        std::vector<Numbers> neighbours(at(s_.n_core));
        for (std::int32_t c = 0; c < s_.n_core_atoms; ++c)
            for_meetings(c, [&](std::int32_t p, std::int32_t q, bool) { neighbours[at(p)].push_back(q); });
        Fill fill = fill_of(neighbours);
        m_.column_start = std::move(fill.column_start);
        m_.row = std::move(fill.row);
        s_.n_entries = static_cast<std::int32_t>(m_.row.size());
        m_.meet_pair_start.assign(1, 0);
        for (std::int32_t c = 0; c < s_.n_core_atoms; ++c) {
            for_meetings(c, [&](std::int32_t p, std::int32_t q, bool before) {
                if (before) m_.meet_pair.push_back(entry(std::max(p, q), std::min(p, q)));
            });
            m_.meet_pair_start.push_back(static_cast<std::int32_t>(m_.meet_pair.size()));
        }
    }

    std::int32_t entry(std::int32_t row, std::int32_t column) const {
        const auto begin = m_.row.begin();
        return static_cast<std::int32_t>(
            std::lower_bound(begin + m_.column_start[at(column)], begin + m_.column_start[at(column) + 1], row) -
            begin);
    }

    void list_updates() {
        s_.max_column = 0;
        m_.update_start.assign(1, 0);
        for (std::int32_t p = 0; p < s_.n_core; ++p) {
            const std::int32_t first = m_.column_start[at(p)], end = m_.column_start[at(p) + 1];
            s_.max_column = std::max(s_.max_column, end - first);
            for (std::int32_t a = first; a < end; ++a)
                for (std::int32_t b = first; b < a; ++b) m_.update.push_back(entry(m_.row[at(a)], m_.row[at(b)]));
            m_.update_start.push_back(static_cast<std::int64_t>(m_.update.size()));
        }
    }

    Schedule &s_;
    ScheduleArrays &m_;
    const std::int64_t most_bytes_;
    const For for_;
    bool is_network_ = false;
    const Lists bonds_;
    Numbers upper_bond_;  // of the atoms of trees, by local atom; -1: a root, or of the core
};

// Of a large tree, its arms, or what can be worked on at once.
void add_large_tree(Schedule &s, Schedule::Memory::Large &m) {
    m.arms = arms_of(s);
    s.n_arms = static_cast<std::int32_t>(m.arms.arm.size());
    if (s.n_arms == 0) {
        m.runs = runs_of(s);
        if (!fill_lanes(m.runs, s.n_bonds)) {
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
                                        const bool *fixed, std::int64_t most_bytes, Maker::For what) {
    std::unique_ptr<Schedule> s(new Schedule());
    s->n_atoms = n_atoms;
    s->n_bonds = n_bonds;
    ScheduleArrays m;
    for (Numbers *const list : {&m.atom_i, &m.atom_j, &m.bond_of}) list->reserve(at(n_bonds));
    for (std::int32_t k = 0; k < n_bonds; ++k) {
        m.atom_i.push_back(pairs[2 * k]);
        m.atom_j.push_back(pairs[2 * k + 1]);
    }
    m.atom_of.reserve(at(n_atoms));
    m.fixed.assign(at(n_atoms), 0);
    for (std::int32_t i = 0; fixed && i < n_atoms; ++i) m.fixed[at(i)] = fixed[i];
    point_into(*s, m);
    Maker maker(*s, m, most_bytes, what);
    maker.make();
    if (maker.is_network() && what == Maker::molecule && Maker::has_fixed(m))
        return bare_schedule(n_atoms, n_bonds, pairs, fixed, most_bytes, Maker::network);
    s->memory = new Schedule::Memory();
    pack(*s, m);
    if (!maker.is_network()) return s;
    make_network(*s, most_bytes, s->memory->of_large().network);
    s->network = &s->memory->large->network.plan;
    return s;
}

// Positions of larger trees go along a list in any case: it streams from memory what a forest fetches.
constexpr std::int32_t largest_positions_in_forest = 65536;

// Small networks have it for what does not converge, if it fills no more bytes a bond of the core.
constexpr std::int32_t largest_with_careful = 8192;
constexpr std::int64_t most_bytes_of_careful = 4000;
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
                                              const bool *fixed, std::int64_t most_bytes) {
    std::unique_ptr<Schedule> s = bare_schedule(n_atoms, n_bonds, pairs, fixed, most_bytes, Maker::molecule);
    Schedule::Memory &m = *s->memory;
    if (s->network) {
        if (n_bonds <= largest_with_careful)
            make_careful_too(*s, std::min(most_bytes, most_bytes_of_careful * static_cast<std::int64_t>(s->n_core)));
        return s;
    }
    if (n_bonds > largest_in_lanes && s->type == Schedule::tree) add_large_tree(*s, m.of_large());
    const bool in_lanes = s->n_pieces > 0 && n_bonds <= largest_positions_in_forest;
    if (!in_lanes && takes_flat_list(*s)) {
        make_flat_list(*s, m.of_large().flat);
        s->flat = &m.large->flat.list;
    }
    if (!in_lanes && n_bonds > largest_in_lanes && make_path_plan(*s, m.of_large().paths))
        s->paths = &m.large->paths.plan;
    return s;
}

std::unique_ptr<const Schedule> make_knot_schedule(std::int32_t n_atoms, std::int32_t n_bonds,
                                                   const std::int32_t *pairs, const bool *fixed) {
    return bare_schedule(n_atoms, n_bonds, pairs, fixed, no_limit, Maker::knot);
}

std::unique_ptr<const Schedule> make_careful_schedule(const Schedule &s, std::int64_t most_bytes) {
    Numbers pairs;
    for (std::int32_t k = 0; k < s.n_bonds; ++k) pairs.insert(pairs.end(), {s.atom_i[k], s.atom_j[k]});
    return bare_schedule(s.n_atoms, s.n_bonds, pairs.data(), nullptr, most_bytes, Maker::careful);
}

void make_careful(const Schedule &s, std::int64_t most_bytes) {
    static std::mutex mutex;
    const std::lock_guard<std::mutex> lock(mutex);
    if (s.careful_order()) return;
    s.memory->careful = make_careful_schedule(s, most_bytes);
    s.late_careful = s.memory->careful.get();
}

}  // namespace holonomic
