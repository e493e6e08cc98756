#include "core/molecules/planned/path_plan.hpp"

#include <algorithm>
#include <map>

#include "core/molecules/planned/elimination_plan.hpp"

namespace holonomic {

namespace {

constexpr std::size_t most_kinds = 32;

// One junction: its atoms and bonds, its overlaps, and all that its kind is told by.
struct Junction {
    Numbers atom, bond;
    std::vector<PathPlan::Overlap> overlap;
    Numbers
        form;  // numbers of atoms, bonds and overlaps; the ends of bonds; where overlaps begin; which atoms are fixed
};

std::int32_t lower_atom(const EliminationPlan &s, std::int32_t bond) {
    return std::min(s.atom_i[bond], s.atom_j[bond]);
}
bool joins_next(const EliminationPlan &s, std::int32_t bond) {
    return std::max(s.atom_i[bond], s.atom_j[bond]) == lower_atom(s, bond) + 1;
}

// Whether so many bonds stand one behind the other, whatever else their atoms have.
bool may_have_path(const EliminationPlan &s) {
    std::int32_t n = 0;
    for (std::int32_t k = 0; k < s.n_bonds && n < PathPlan::shortest_path; ++k) {
        const bool follows = n > 0 && lower_atom(s, k) == lower_atom(s, k - 1) + 1;
        n = !joins_next(s, k) ? 0 : follows ? n + 1 : 1;
    }
    return n >= PathPlan::shortest_path;
}

class PathMaker {
public:
    PathMaker(const EliminationPlan &s, PathArrays &a)
        : s_(s), a_(a), bonds_(invert(s.n_atoms, s.n_bonds, [&](std::int32_t k, int end) { return end_of(k, end); })),
          junction_of_(at(s.n_atoms), -1), in_path_(at(s.n_bonds)) {}

    bool make() {
        find_paths();
        if (a_.path.empty()) return false;
        find_junctions();
        if (!pays()) return false;
        cut_paths();
        return list_kinds();
    }

private:
    std::int32_t end_of(std::int32_t bond, int end) const { return (end ? s_.atom_j : s_.atom_i)[bond]; }
    std::int32_t lower(std::int32_t bond) const { return lower_atom(s_, bond); }
    bool is_step(std::int32_t bond) const { return bond < s_.n_bonds && joins_next(s_, bond); }

    void find_paths() {
        for (std::int32_t first = 0, end; first < s_.n_bonds; first = end) {
            const std::int32_t atom = lower(first);
            end = first + 1;
            if (!is_step(first)) continue;
            while (is_step(end) && lower(end) == atom + (end - first) && bonds_.size(lower(end)) == 2) ++end;
            if (end - first < PathPlan::shortest_path) continue;
            const auto is_free = [&](std::int32_t i) { return bonds_.size(i) == 1 && !s_.fixed[i]; };
            const std::int32_t n = end - first;
            a_.path.push_back({atom, first, n, is_free(atom) ? 0 : PathPlan::bonds_of_end,
                               is_free(atom + n) ? n : n - PathPlan::bonds_of_end});
            for (std::int32_t k = first; k < end; ++k) in_path_[at(k)] = 1;
        }
    }

    // Legs by the atoms at which they begin.
    void find_junctions() {
        Numbers ends;
        for (const PathPlan::Path &path : a_.path)
            for (const std::int32_t atom : {path.first_atom, path.first_atom + path.n_bonds}) ends.push_back(atom);
        begin_ = invert(s_.n_atoms, static_cast<std::int32_t>(a_.path.size()),
                        [&](std::int32_t p, int end) { return ends[at(2 * p + end)]; });
        for (const PathPlan::Path &path : a_.path) {
            if (!path.begins_free()) find_junction(path.first_atom);
            if (!path.ends_free()) find_junction(path.first_atom + path.n_bonds);
        }
    }
    // From one of its atoms.
    void find_junction(std::int32_t start) {
        if (junction_of_[at(start)] >= 0) return;
        Junction junction;
        Numbers from, pairs;
        junction.atom.assign(1, start);
        const auto number_of = [&](std::int32_t atom) {
            if (junction_of_[at(atom)] < 0) {
                junction_of_[at(atom)] = static_cast<std::int32_t>(junction.atom.size());
                junction.atom.push_back(atom);
            }
            return junction_of_[at(atom)];
        };
        junction_of_[at(start)] = 0;
        for (std::size_t next = 0; next < junction.atom.size(); ++next) {
            const std::int32_t atom = junction.atom[next];
            for (const std::int32_t *k = bonds_.begin(atom); k != bonds_.end(atom); ++k) {
                if (in_path_[at(*k)]) continue;
                in_path_[at(*k)] = 1;  // done
                junction.bond.push_back(*k);
                for (int end = 0; end < 2; ++end) pairs.push_back(number_of(end_of(*k, end)));
            }
            for (const std::int32_t *p = begin_.begin(atom); p != begin_.end(atom); ++p) {
                from.push_back(static_cast<std::int32_t>(next));
                junction.overlap.push_back({*p, a_.path[at(*p)].first_atom != atom});
            }
        }
        junction.form = {static_cast<std::int32_t>(junction.atom.size()),
                         static_cast<std::int32_t>(junction.bond.size()),
                         static_cast<std::int32_t>(junction.overlap.size())};
        junction.form.insert(junction.form.end(), pairs.begin(), pairs.end());
        junction.form.insert(junction.form.end(), from.begin(), from.end());
        for (const std::int32_t atom : junction.atom) junction.form.push_back(s_.fixed[atom] ? 1 : 0);
        of_kind_[junction.form].push_back(std::move(junction));
    }

    static std::int64_t bonds_of(const Numbers &form, int reach) {
        return form[1] + std::int64_t{form[2]} * PathPlan::reach(reach);
    }
    // A bond of a junction takes two to three times what one of a path does, four of a kind are done at a time, and a
    // bond of a list takes five times as much.
    bool pays() const {
        if (of_kind_.size() > most_kinds) return false;
        std::int64_t bonds = 0;
        for (const auto &kind : of_kind_) {
            if (bonds_of(kind.first, PathPlan::n_reaches - 1) > largest_in_lanes) return false;
            bonds += (static_cast<std::int64_t>(kind.second.size()) + 3) / 4 * 4 * bonds_of(kind.first, 0);
        }
        return 2 * bonds <= s_.n_bonds;
    }

    void cut_paths() {
        for (std::size_t p = 0; p < a_.path.size(); ++p) {
            const std::int32_t first = a_.path[p].own, n = a_.path[p].own_end - first;
            const std::int32_t parts = (n + PathPlan::bonds_of_section - 1) / PathPlan::bonds_of_section;
            for (std::int32_t i = 0; i < parts; ++i) {
                const std::int32_t from = first + n / parts * i + std::min(i, n % parts);
                a_.section.push_back({static_cast<std::int32_t>(p), from, from + n / parts + (i < n % parts ? 1 : 0)});
            }
        }
        std::stable_sort(
            a_.section.begin(), a_.section.end(),
            [](const PathPlan::Section &a, const PathPlan::Section &b) { return a.end - a.from > b.end - b.from; });
    }

    // False if a junction has cycles that only a list could eliminate.
    bool list_kinds() {
        std::int32_t first = 0;
        for (const auto &kind : of_kind_) {
            const Numbers &form = kind.first;
            const std::int32_t count = static_cast<std::int32_t>(kind.second.size());
            PathPlan::JunctionKind x = {{},
                                        form[0],
                                        form[1],
                                        form[2],
                                        first,
                                        count,
                                        static_cast<std::int32_t>(a_.atom.size()),
                                        static_cast<std::int32_t>(a_.bond.size()),
                                        static_cast<std::int32_t>(a_.overlap.size())};
            for (int i = 0; i < PathPlan::n_reaches; ++i) {
                a_.elimination.push_back(plan_of_bonds(form, PathPlan::reach(i)));
                x.elimination[i] = a_.elimination.back().get();
                if (x.elimination[i]->type == EliminationPlan::graph) return false;
            }
            a_.kind.push_back(x);
            first += count;
            for (const Junction &junction : kind.second) {
                a_.atom.insert(a_.atom.end(), junction.atom.begin(), junction.atom.end());
                a_.bond.insert(a_.bond.end(), junction.bond.begin(), junction.bond.end());
                a_.overlap.insert(a_.overlap.end(), junction.overlap.begin(), junction.overlap.end());
            }
        }
        a_.plan = {a_.path.data(),
                   static_cast<std::int32_t>(a_.path.size()),
                   a_.section.data(),
                   static_cast<std::int32_t>(a_.section.size()),
                   a_.kind.data(),
                   static_cast<std::int32_t>(a_.kind.size()),
                   a_.atom.data(),
                   a_.bond.data(),
                   a_.overlap.data(),
                   static_cast<std::int32_t>(a_.atom.size()),
                   static_cast<std::int32_t>(a_.bond.size())};
        return true;
    }
    static std::unique_ptr<const EliminationPlan> plan_of_bonds(const Numbers &form, std::int32_t reach) {
        const std::int32_t atoms = form[0], bonds = form[1], overlaps = form[2], n_atoms = atoms + overlaps * reach;
        const std::int32_t *const from = form.data() + 3 + 2 * bonds, *const fixed_atoms = from + overlaps;
        Numbers pairs(form.begin() + 3, form.begin() + 3 + 2 * bonds);
        for (std::int32_t l = 0; l < overlaps; ++l)
            for (std::int32_t j = 0; j < reach; ++j) {
                pairs.push_back(j == 0 ? from[l] : atoms + l * reach + j - 1);
                pairs.push_back(atoms + l * reach + j);
            }
        std::vector<unsigned char> fixed(at(n_atoms), 0);
        for (std::int32_t i = 0; i < atoms; ++i) fixed[at(i)] = fixed_atoms[i] != 0;
        return make_junction_plan(n_atoms, bonds + overlaps * reach, pairs.data(), fixed.data());
    }

    const EliminationPlan &s_;
    PathArrays &a_;
    const Lists bonds_;
    Lists begin_;                         // paths by the atoms at their ends
    Numbers junction_of_;                 // an atom's number in its junction
    std::vector<unsigned char> in_path_;  // bonds that are in paths, or done
    std::map<Numbers, std::vector<Junction>> of_kind_;
};

}  // namespace

bool make_path_plan(const EliminationPlan &s, PathArrays &arrays) {
    if (!may_have_path(s)) return false;
    if (PathMaker(s, arrays).make()) return true;
    arrays = PathArrays();
    return false;
}

}  // namespace holonomic
