// Which bodies, atoms and bonds of a call make a molecule.
#include <algorithm>
#include <numeric>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "core/index.hpp"
#include "core/molecules/chains.hpp"
#include "core/rigid/bodies.hpp"
#include "core/rigid/linear.hpp"

namespace holonomic {

namespace {

// Groups of things that belong together.
class Joined {
public:
    explicit Joined(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }
    std::size_t add() {
        parent_.push_back(parent_.size());
        return parent_.size() - 1;
    }
    std::size_t of(std::size_t i) {
        while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    void join(std::size_t a, std::size_t b) {
        a = of(a);
        b = of(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::vector<std::size_t> parent_;
};

// The call that is sorted, its atoms counted from 0.
class Sorting {
public:
    Sorting(const Chains &chains, const Masses &masses, const AtomUse &use, std::int64_t n_bodies,
            const std::int64_t *sizes, const std::int64_t *atoms, std::int64_t offset, std::int64_t n_bonds,
            const std::int64_t *pairs, const rigid::AffineParts *parts)
        : chains_(chains), masses_(masses), use_(use), base_(chains.base), n_bodies_(n_bodies), n_bonds_(n_bonds),
          offset_(offset), sizes_(sizes), given_atoms_(atoms), given_pairs_(pairs), parts_(parts),
          joined_(at(n_bodies)) {}

    std::vector<rigid::Given> sort(const double *coordinates, const double *lengths) {
        take_bodies();
        take_bonds();
        make_molecules(coordinates);
        fixed_.resize(molecules_.size());
        if (parts_ && !parts_->fixed.empty()) add_fixed();
        add_bonds(lengths);
        if (parts_) add_distances();
        return std::move(molecules_);
    }

private:
    std::int64_t take(std::int64_t given, std::int64_t bond) const {
        const std::int64_t atom = given < base_ ? -1 : given - base_ + offset_;
        if (atom < 0 || atom >= chains_.n_atoms())
            fail(make_error(Status::index, "atom %lld is outside %d .. %lld", static_cast<long long>(given), base_,
                            number(chains_.n_atoms() - 1, base_)),
                 base_, bond, atom);
        return atom;
    }

    void check_free(std::int64_t atom, std::int64_t bond) const {
        if (!use_.used(atom)) return;
        fail(make_error(Status::shared_atom,
                        "atom %s is in a molecule of an earlier call already: a body with all its bonds must be added "
                        "in one call",
                        chains_.name_of_atom(atom).text),
             base_, bond, atom);
    }

    std::int64_t end(std::int64_t bond, int which) const { return given_pairs_[2 * bond + which] - base_ + offset_; }

    void take_bodies() {
        const std::int64_t *next = given_atoms_;
        for (std::int64_t b = 0; b < n_bodies_; ++b)
            for (std::int64_t a = 0; a < sizes_[b]; ++a) {
                const std::int64_t atom = take(*next++, -1);
                check_free(atom, -1);
                if (masses_.infinite(atom))
                    fail(make_error(Status::value,
                                    "atom %s of body %lld has an infinite mass, so that it is held fixed: a fixed atom "
                                    "can be in no body (mass 0 makes it a massless site)",
                                    chains_.name_of_atom(atom).text, number(b, base_)),
                         base_, -1, atom);
                if (!group_of_.emplace(atom, at(b)).second)
                    fail(make_error(Status::shared_atom, "atom %s is given twice: an atom belongs to one body",
                                    chains_.name_of_atom(atom).text),
                         base_, -1, atom);
            }
    }

    void take_bonds() {
        for (std::int64_t e = 0; e < 2 * n_bonds_; ++e) {
            const std::int64_t atom = take(given_pairs_[e], e / 2);
            if (group_of_.count(atom)) continue;
            if (masses_.fixed(atom)) {
                if (chains_.bodies() && chains_.bodies()->is_site(atom)) check_free(atom, e / 2);
                continue;
            }
            check_free(atom, e / 2);
            group_of_.emplace(atom, joined_.add());
            others_.push_back(atom);
        }
        std::sort(others_.begin(), others_.end());
        for (std::int64_t k = 0; k < n_bonds_; ++k) {
            const auto i = group_of_.find(end(k, 0)), j = group_of_.find(end(k, 1));
            if (i != group_of_.end() && j != group_of_.end()) joined_.join(i->second, j->second);
        }
    }

    // -1: a fixed atom, or one of a molecule without bodies. A group's root is its first body, if it has any.
    std::int64_t molecule_of_atom(std::int64_t atom) {
        const auto found = group_of_.find(atom);
        if (found == group_of_.end()) return -1;
        const std::size_t root = joined_.of(found->second);
        return root < at(n_bodies_) ? molecule_of_body_[root] : -1;
    }

    std::int32_t append(rigid::Given &given, std::int64_t atom) const {
        given.atoms.push_back(atom);
        given.masses.push_back(masses_.mass(atom));
        return static_cast<std::int32_t>(given.atoms.size() - 1);
    }

    // In the order of their first bodies.
    void make_molecules(const double *coordinates) {
        molecule_of_body_.assign(at(n_bodies_), -1);
        const std::int64_t *next = given_atoms_;
        for (std::int64_t b = 0; b < n_bodies_; ++b) {
            const std::size_t root = joined_.of(at(b));
            if (molecule_of_body_[root] < 0) {
                molecule_of_body_[root] = static_cast<std::int64_t>(molecules_.size());
                molecules_.emplace_back();
            }
            rigid::Given &given = molecules_[at(molecule_of_body_[root])];
            given.sizes.push_back(static_cast<std::int32_t>(sizes_[b]));
            if (parts_) given.affine.push_back(parts_->affine[at(b)]);
            for (std::int64_t a = 0; a < sizes_[b]; ++a, ++next, coordinates += 3) {
                const std::int64_t atom = *next - base_ + offset_;
                local_[atom] = append(given, atom);
                given.coordinates.insert(given.coordinates.end(), coordinates, coordinates + 3);
            }
        }
        for (std::int64_t k = 0; k < n_bonds_; ++k)
            if (molecule_of_atom(end(k, 0)) < 0 && molecule_of_atom(end(k, 1)) < 0)
                fail(make_error(Status::value,
                                "bond %lld, of atoms %s and %s, is in no molecule with a body: hol_chains_add_bonds "
                                "takes such bonds",
                                number(k, base_), chains_.name_of_atom(end(k, 0)).text,
                                chains_.name_of_atom(end(k, 1)).text),
                     base_, k, -1);
        for (const std::int64_t atom : others_) local_[atom] = append(molecules_[at(molecule_of_atom(atom))], atom);
        for (rigid::Given &given : molecules_) given.n_movable = static_cast<std::int32_t>(given.atoms.size());
    }

    // By their lower and then by their higher atom, that one last: nothing depends on how they were given.
    std::vector<std::int64_t> bonds_in_order() const {
        struct Listed {
            std::int64_t low, high, bond;
        };
        std::vector<Listed> list;
        for (std::int64_t k = 0; k < n_bonds_; ++k) {
            const auto [i, j] = std::minmax({end(k, 0), end(k, 1)});
            const auto name = [&](std::int64_t atom) { return chains_.name_of_atom(atom); };
            if (i == j)
                fail(make_error(Status::value, "bond %lld joins atom %s with itself", number(k, base_), name(i).text),
                     base_, k, i);
            list.push_back({i, j, k});
        }
        std::sort(list.begin(), list.end(), [](const Listed &a, const Listed &b) {
            return std::tie(a.low, a.high, a.bond) < std::tie(b.low, b.high, b.bond);
        });
        std::vector<std::int64_t> order;
        for (std::size_t k = 0; k < list.size(); ++k) {
            const Listed &it = list[k];
            if (k > 0 && it.low == list[k - 1].low && it.high == list[k - 1].high)
                fail(make_error(Status::degenerate, "bond %lld, of atoms %s and %s, is given twice",
                                number(it.bond, base_), chains_.name_of_atom(it.low).text,
                                chains_.name_of_atom(it.high).text),
                     base_, it.bond, -1);
            order.push_back(it.bond);
        }
        return order;
    }

    void add_bonds(const double *lengths) {
        for (const std::int64_t k : bonds_in_order()) {
            const auto [i, j] = std::minmax({end(k, 0), end(k, 1)});
            const std::int64_t of_first = molecule_of_atom(i);
            const std::size_t m = at(of_first >= 0 ? of_first : molecule_of_atom(j));
            rigid::Given &given = molecules_[m];
            std::int32_t ends[2], *next = ends;
            for (const std::int64_t atom : {i, j}) {
                if (const auto found = local_.find(atom); found != local_.end()) {
                    *next++ = found->second;
                    continue;
                }
                *next++ = fixed_atom(m, atom);
            }
            const bool held = parts_ && std::binary_search(parts_->held.begin(), parts_->held.end(), k);
            given.bonds.push_back({ends[0], ends[1], lengths[k], held ? rigid::held_elsewhere : -1});
            given.bond_numbers.push_back(chains_.n_bonds() + k);
        }
    }

    // The number of a fixed atom in a molecule.
    std::int32_t fixed_atom(std::size_t molecule, std::int64_t atom) {
        const auto known = fixed_[molecule].find(atom);
        if (known != fixed_[molecule].end()) return known->second;
        const std::int32_t local = append(molecules_[molecule], atom);
        fixed_[molecule].emplace(atom, local);
        return local;
    }

    // Those that relations have.
    void add_fixed() {
        std::vector<std::size_t> done(molecules_.size(), 0);
        const std::int64_t *first = given_atoms_;
        for (std::int64_t b = 0; b < n_bodies_; first += sizes_[b++]) {
            const std::size_t m = at(molecule_of_atom(*first - base_ + offset_)), part = done[m]++;
            for (const std::int64_t given : parts_->fixed[at(b)]) {
                const std::int64_t atom = take(given, -1);
                molecules_[m].affine[part].fixed.push_back(fixed_atom(m, atom));
            }
        }
    }

    void add_distances() {
        const auto local = [&](std::int64_t given, std::int64_t partner) {
            const std::int64_t atom = given - base_ + offset_;
            const auto found = local_.find(atom);
            if (found != local_.end()) return found->second;
            const std::int64_t m = molecule_of_atom(partner - base_ + offset_);
            const bool is_held = m >= 0 && fixed_[at(m)].count(atom) > 0;
            return is_held ? fixed_[at(m)].at(atom) : -1;
        };
        for (const auto &its : parts_->hidden) {
            rigid::Given &given = molecules_[at(molecule_of_atom(its.i - base_ + offset_))];
            given.hidden.push_back({local(its.i, its.j), local(its.j, its.i), its.length, -1});
        }
        for (const auto &link : parts_->links) {
            const std::int32_t i = local(link.first, link.second), j = local(link.second, link.first);
            const std::int64_t first = molecule_of_atom(link.first - base_ + offset_),
                               m = first >= 0 ? first : molecule_of_atom(link.second - base_ + offset_);
            if (i >= 0 && j >= 0 && m >= 0) molecules_[at(m)].links.push_back({i, j});
        }
        for (rigid::Given &given : molecules_)
            if (std::all_of(given.affine.begin(), given.affine.end(),
                            [](const auto &affine) { return affine.is_rigid(); }))
                given.affine.clear();
    }

    const Chains &chains_;
    const Masses &masses_;
    const AtomUse &use_;
    const int base_;
    const std::int64_t n_bodies_, n_bonds_, offset_;
    const std::int64_t *const sizes_, *const given_atoms_, *const given_pairs_;
    const rigid::AffineParts *const parts_;
    Joined joined_;  // bodies, then atoms of none
    std::unordered_map<std::int64_t, std::size_t> group_of_;
    std::vector<std::int64_t> others_;  // atoms that can move and are in no body
    std::vector<std::int64_t> molecule_of_body_;
    std::unordered_map<std::int64_t, std::int32_t> local_;  // number of a movable atom within its molecule
    std::vector<rigid::Given> molecules_;
    std::vector<std::unordered_map<std::int64_t, std::int32_t>> fixed_;  // of each molecule, their numbers in it
};

}  // namespace

// The molecules of one call, or of one copy of its molecules, whose atoms stand `offset` further on.
std::vector<rigid::Given> Chains::sort_rigid(std::int64_t n_bodies, const std::int64_t *sizes,
                                             const std::int64_t *atoms, std::int64_t offset, const double *coordinates,
                                             std::int64_t n_bonds, const std::int64_t *pairs, const double *lengths,
                                             const rigid::AffineParts *parts) const {
    if (!parts && rigid::share_atoms(n_bodies, sizes, atoms)) {
        const rigid::JoinedBodies joined =
            rigid::join_bodies(n_bodies, sizes, atoms, coordinates, n_bonds, pairs, lengths);
        return sort_rigid(static_cast<std::int64_t>(joined.sizes.size()), joined.sizes.data(), joined.atoms.data(),
                          offset, joined.coordinates.data(), n_bonds, pairs, lengths, &joined.parts);
    }
    return Sorting(*this, masses_, use_, n_bodies, sizes, atoms, offset, n_bonds, pairs, parts)
        .sort(coordinates, lengths);
}

}  // namespace holonomic
