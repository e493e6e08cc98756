#include "core/molecules/path_plan.hpp"

#include <algorithm>
#include <map>

#include "core/molecules/schedule.hpp"

namespace holonomic {

namespace {

constexpr std::size_t most_kinds = 32;

// One knot: its atoms and bonds, its legs, and all that its kind is told by.
struct Knot {
    Numbers atom, bond;
    std::vector<PathPlan::Leg> leg;
    Numbers form;  // numbers of atoms, bonds and legs; the ends of bonds; where legs begin; which atoms are fixed
};

class PathMaker {
public:
    PathMaker(const Schedule &s, PathArrays &a)
        : s_(s), a_(a), bonds_(invert(s.n_atoms, s.n_bonds, [&](std::int32_t k, int end) { return end_of(k, end); })),
          knot_of_(at(s.n_atoms), -1), in_path_(at(s.n_bonds)) {}

    bool make() {
        find_paths();
        if (a_.path.empty()) return false;
        find_knots();
        if (!pays()) return false;
        cut_paths();
        return list_kinds();
    }

private:
    std::int32_t end_of(std::int32_t bond, int end) const { return (end ? s_.atom_j : s_.atom_i)[bond]; }
    std::int32_t lower(std::int32_t bond) const { return std::min(s_.atom_i[bond], s_.atom_j[bond]); }
    bool is_step(std::int32_t bond) const {
        return bond < s_.n_bonds && std::max(s_.atom_i[bond], s_.atom_j[bond]) == lower(bond) + 1;
    }

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
    void find_knots() {
        Numbers ends;
        for (const PathPlan::Path &path : a_.path)
            for (const std::int32_t atom : {path.first_atom, path.first_atom + path.n_bonds}) ends.push_back(atom);
        begin_ = invert(s_.n_atoms, static_cast<std::int32_t>(a_.path.size()),
                        [&](std::int32_t p, int end) { return ends[at(2 * p + end)]; });
        for (const PathPlan::Path &path : a_.path) {
            if (!path.begins_free()) find_knot(path.first_atom);
            if (!path.ends_free()) find_knot(path.first_atom + path.n_bonds);
        }
    }
    // From one of its atoms.
    void find_knot(std::int32_t start) {
        if (knot_of_[at(start)] >= 0) return;
        Knot knot;
        Numbers from, pairs;
        knot.atom.assign(1, start);
        const auto number_of = [&](std::int32_t atom) {
            if (knot_of_[at(atom)] < 0) {
                knot_of_[at(atom)] = static_cast<std::int32_t>(knot.atom.size());
                knot.atom.push_back(atom);
            }
            return knot_of_[at(atom)];
        };
        knot_of_[at(start)] = 0;
        for (std::size_t next = 0; next < knot.atom.size(); ++next) {
            const std::int32_t atom = knot.atom[next];
            for (const std::int32_t *k = bonds_.begin(atom); k != bonds_.end(atom); ++k) {
                if (in_path_[at(*k)]) continue;
                in_path_[at(*k)] = 1;  // done
                knot.bond.push_back(*k);
                for (int end = 0; end < 2; ++end) pairs.push_back(number_of(end_of(*k, end)));
            }
            for (const std::int32_t *p = begin_.begin(atom); p != begin_.end(atom); ++p) {
                from.push_back(static_cast<std::int32_t>(next));
                knot.leg.push_back({*p, a_.path[at(*p)].first_atom != atom});
            }
        }
        knot.form = {static_cast<std::int32_t>(knot.atom.size()), static_cast<std::int32_t>(knot.bond.size()),
                     static_cast<std::int32_t>(knot.leg.size())};
        knot.form.insert(knot.form.end(), pairs.begin(), pairs.end());
        knot.form.insert(knot.form.end(), from.begin(), from.end());
        for (const std::int32_t atom : knot.atom) knot.form.push_back(s_.fixed[atom] ? 1 : 0);
        of_kind_[knot.form].push_back(std::move(knot));
    }

    static std::int64_t bonds_of(const Numbers &form, int reach) {
        return form[1] + std::int64_t{form[2]} * PathPlan::reach(reach);
    }
    // A bond of a knot takes two to three times what one of a path does, four of a kind are done at a time, and a bond
    // of a list takes five times as much.
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
            const std::int32_t parts = (n + PathPlan::bonds_of_piece - 1) / PathPlan::bonds_of_piece;
            for (std::int32_t i = 0; i < parts; ++i) {
                const std::int32_t from = first + n / parts * i + std::min(i, n % parts);
                a_.piece.push_back({static_cast<std::int32_t>(p), from, from + n / parts + (i < n % parts ? 1 : 0)});
            }
        }
        std::stable_sort(a_.piece.begin(), a_.piece.end(), [](const PathPlan::Piece &a, const PathPlan::Piece &b) {
            return a.end - a.from > b.end - b.from;
        });
    }

    // False if a knot has cycles that only a list could eliminate.
    bool list_kinds() {
        std::int32_t first = 0;
        for (const auto &kind : of_kind_) {
            const Numbers &form = kind.first;
            const std::int32_t count = static_cast<std::int32_t>(kind.second.size());
            PathPlan::Kind x = {{},
                                form[0],
                                form[1],
                                form[2],
                                first,
                                count,
                                static_cast<std::int32_t>(a_.atom.size()),
                                static_cast<std::int32_t>(a_.bond.size()),
                                static_cast<std::int32_t>(a_.leg.size())};
            for (int i = 0; i < PathPlan::n_reaches; ++i) {
                a_.schedule.push_back(schedule_of(form, PathPlan::reach(i)));
                x.schedule[i] = a_.schedule.back().get();
                if (x.schedule[i]->type == Schedule::graph) return false;
            }
            a_.kind.push_back(x);
            first += count;
            for (const Knot &knot : kind.second) {
                a_.atom.insert(a_.atom.end(), knot.atom.begin(), knot.atom.end());
                a_.bond.insert(a_.bond.end(), knot.bond.begin(), knot.bond.end());
                a_.leg.insert(a_.leg.end(), knot.leg.begin(), knot.leg.end());
            }
        }
        a_.plan = {a_.path.data(),
                   static_cast<std::int32_t>(a_.path.size()),
                   a_.piece.data(),
                   static_cast<std::int32_t>(a_.piece.size()),
                   a_.kind.data(),
                   static_cast<std::int32_t>(a_.kind.size()),
                   a_.atom.data(),
                   a_.bond.data(),
                   a_.leg.data(),
                   static_cast<std::int32_t>(a_.atom.size()),
                   static_cast<std::int32_t>(a_.bond.size()),
                   first};
        return true;
    }
    static std::unique_ptr<const Schedule> schedule_of(const Numbers &form, std::int32_t reach) {
        const std::int32_t atoms = form[0], bonds = form[1], legs = form[2], n_atoms = atoms + legs * reach;
        const std::int32_t *const from = form.data() + 3 + 2 * bonds, *const fixed_atoms = from + legs;
        Numbers pairs(form.begin() + 3, form.begin() + 3 + 2 * bonds);
        for (std::int32_t l = 0; l < legs; ++l)
            for (std::int32_t j = 0; j < reach; ++j) {
                pairs.push_back(j == 0 ? from[l] : atoms + l * reach + j - 1);
                pairs.push_back(atoms + l * reach + j);
            }
        std::vector<unsigned char> fixed(at(n_atoms), 0);
        for (std::int32_t i = 0; i < atoms; ++i) fixed[at(i)] = fixed_atoms[i] != 0;
        return make_knot_schedule(n_atoms, bonds + legs * reach, pairs.data(), fixed.data());
    }

    const Schedule &s_;
    PathArrays &a_;
    const Lists bonds_;
    Lists begin_;                         // paths by the atoms at their ends
    Numbers knot_of_;                     // an atom's number in its knot
    std::vector<unsigned char> in_path_;  // bonds that are in paths, or done
    std::map<Numbers, std::vector<Knot>> of_kind_;
};

}  // namespace

bool make_path_plan(const Schedule &s, PathArrays &arrays) {
    if (PathMaker(s, arrays).make()) return true;
    arrays = PathArrays();
    return false;
}

}  // namespace holonomic
