#include "core/rigid/cliques.hpp"

#include "core/index.hpp"
#include "core/rigid/fit.hpp"
#include "core/rigid/planar_ring.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <unordered_map>
#include <unordered_set>

namespace holonomic::rigid {

namespace {

class CliqueSearch {
public:
    using Atom = std::int64_t;  // what PlanarRing asks for
    template <class Each>
    void for_partners(Atom atom, const Each &each) const {
        for (const Partner &partner : bonds_of_.at(atom))
            if (is_free(partner.atom)) each(partner.atom);
    }
    Atom with_fewer(Atom i, Atom j) const { return bonds_of_.at(i).size() < bonds_of_.at(j).size() ? i : j; }
    double square(Atom i, Atom j) const {
        const std::int64_t bond = bond_between(i, j);
        return bond < 0 ? -1 : lengths_[bond % n_lengths_] * lengths_[bond % n_lengths_];
    }

    // All that hang together by bonds between atoms that can move; for the last atom it is kept, as groups come one
    // after the other.
    std::vector<double> lengths_around(Atom atom) const {
        if (around_.count(atom)) return lengths_around_;
        around_.clear();
        around_.insert(atom);
        lengths_around_.clear();
        for (std::vector<Atom> stack{atom}; !stack.empty();) {
            const Atom next = stack.back();
            stack.pop_back();
            for (const Partner &partner : bonds_of_.at(next)) {
                lengths_around_.push_back(length(partner.bond));
                if (around_.insert(partner.atom).second) stack.push_back(partner.atom);
            }
        }
        return lengths_around_ = each_once(std::move(lengths_around_));
    }

    CliqueSearch(const Masses &masses, const BondList &list, const double *lengths, std::int64_t n_lengths,
                 double tolerance, const std::vector<unsigned char> &left_out)
        : list_(list), lengths_(lengths), n_lengths_(n_lengths), tolerance_(tolerance), left_out_(left_out) {
        for (std::int64_t k = 0; k < list.n_bonds; ++k) {
            const std::int64_t i = list.pairs[2 * k], j = list.pairs[2 * k + 1];
            if (masses.fixed(i - list.base) || masses.fixed(j - list.base) || i == j) continue;
            if (length(k) == 0) {
                bonds_of_[i], bonds_of_[j];
                found_.linear.add({{i, j}, std::vector<double>(6, 0), 0});
                continue;
            }
            bonds_of_[i].push_back({j, k});
            bonds_of_[j].push_back({i, k});
        }
        for (auto &bonds : bonds_of_) std::sort(bonds.second.begin(), bonds.second.end());
    }

    Cliques find() {
        for (std::int64_t k = 0; k < list_.n_bonds; ++k)
            if (is_left_out(k)) compare(k);
        take_away();
        for (std::int64_t k = 0; k < list_.n_bonds; ++k) look_around(k, true);
        std::int64_t steps = steps_for_rings(list_.n_bonds);
        for (std::int64_t k = 0; k < list_.n_bonds; ++k) look_for_ring(k, steps);
        for (std::int64_t k = 0; k < list_.n_bonds; ++k) look_around(k, false);
        found_.bonds = bonds_from(held_atoms());
        for (const std::int64_t k : found_.bonds) look_for_shared(k);
        if (found_.linear.empty()) return std::move(found_);
        take_sharing_bodies(found_.sizes, found_.atoms, found_.coordinates, found_.linear);
        found_.linear_bonds = bonds_from(linear_atoms());
        return std::move(found_);
    }

private:
    struct Partner {
        std::int64_t atom, bond;
        bool operator<(const Partner &other) const {
            return atom != other.atom ? atom < other.atom : bond < other.bond;
        }
    };

    bool is_left_out(std::int64_t bond) const { return !left_out_.empty() && left_out_[at(bond)] != 0; }

    // A length that others imply, with those of five atoms that tell it.
    void compare(std::int64_t bond) {
        if (length(bond) == 0) return;
        std::vector<std::int64_t> both, clique{list_.pairs[2 * bond], list_.pairs[2 * bond + 1]};
        if (bonds_of_.count(clique[0]) && bonds_of_.count(clique[1]))
            for (const Partner &partner : bonds_of_.at(clique[0]))
                if (bond_between(partner.atom, clique[1]) >= 0) both.push_back(partner.atom);
        grow(clique, both);
        if (clique.size() < 5)
            throw bond_error(list_, Status::degenerate, bond,
                             "is one too many: the atoms that it and the bonds around it join have fewer freedoms than "
                             "bonds; hol_chains_add_rigid holds such a part by coordinates");
        std::sort(clique.begin(), clique.end());
        const FittedGroup group = look_at(distances(clique), tolerance_, around(clique));
        if (group.kind == FittedGroup::impossible) refuse(clique, group.misfit);
        note(clique, group.misfit);
    }

    void take_away() {
        if (left_out_.empty()) return;
        for (auto &bonds : bonds_of_) {
            const auto is_out = [this](const Partner &partner) { return is_left_out(partner.bond); };
            bonds.second.erase(std::remove_if(bonds.second.begin(), bonds.second.end(), is_out), bonds.second.end());
        }
    }

    bool is_together(const std::vector<std::int64_t> &atoms) const {
        const auto first = body_of_.find(atoms[0]);
        return first != body_of_.end() && std::all_of(atoms.begin(), atoms.end(), [&](std::int64_t atom) {
                   const auto its = body_of_.find(atom);
                   return its != body_of_.end() && its->second == first->second;
               });
    }

    // Groups that depend and share atoms with a body: equations of distances do not hold these.
    void look_for_shared(std::int64_t bond) {
        const std::int64_t i = list_.pairs[2 * bond], j = list_.pairs[2 * bond + 1];
        if (is_left_out(bond) || !bonds_of_.count(i) || !bonds_of_.count(j)) return;
        std::vector<std::int64_t> both;
        for (const Partner &partner : bonds_of_.at(i))
            if (bond_between(partner.atom, j) >= 0) both.push_back(partner.atom);
        for (std::size_t a = 0; a < both.size(); ++a) {
            check_shared(bond, {i, j, both[a]});
            for (std::size_t b = 0; b < a; ++b)
                if (bond_between(both[a], both[b]) >= 0) check_shared(bond, {i, j, both[b], both[a]});
        }
    }
    void check_shared(std::int64_t bond, const std::vector<std::int64_t> &atoms) {
        if (is_together(atoms) || found_.linear.has_together(atoms) || !depend(atoms)) return;
        if (left_out_.empty()) return found_.shared.push_back(bond);
        FittedGroup group = look_at(distances(atoms), tolerance_, around(atoms));
        std::vector<std::int64_t> all = atoms;
        std::vector<double> coordinates = group.coordinates;
        group.misfit = join_all(
            group.dimension, all, coordinates, [&](Atom atom) { return std::count(all.begin(), all.end(), atom) == 0; },
            [](Atom) {});
        if (group.misfit.error > Decimals(distances(all), tolerance_, around(all)).most()) refuse(all, group.misfit);
        note(all, group.misfit);
        found_.linear.add({std::move(all), std::move(coordinates), group.dimension});
    }

    MoleculeLengths around(const std::vector<Atom> &atoms) const {
        return [this, atom = atoms[0]] { return lengths_around(atom); };
    }

    bool is_free(std::int64_t atom) const { return bonds_of_.count(atom) && !body_of_.count(atom); }

    std::int64_t bond_between(std::int64_t i, std::int64_t j) const {
        const std::vector<Partner> &partners = bonds_of_.at(i);
        const auto found = std::lower_bound(partners.begin(), partners.end(), Partner{j, 0});
        return found != partners.end() && found->atom == j ? found->bond : -1;
    }

    double length_between(std::int64_t i, std::int64_t j) const {
        const std::int64_t bond = bond_between(i, j);
        return bond < 0 ? 0 : lengths_[bond % n_lengths_];
    }

    Distances distances(const std::vector<std::int64_t> &atoms) const {
        Distances all(static_cast<std::int64_t>(atoms.size()));
        for (std::int64_t i = 0; i < all.n; ++i)
            for (std::int64_t j = 0; j < all.n; ++j)
                if (i != j) all.at(i, j) = length_between(atoms[at(i)], atoms[at(j)]);
        return all;
    }

    // Atoms, one after the other, that are bonded to all there are.
    void grow(std::vector<std::int64_t> &clique, const std::vector<std::int64_t> &candidates) const {
        for (const std::int64_t atom : candidates) {
            bool all = true;
            for (const std::int64_t other : clique) all = all && other != atom && bond_between(atom, other) >= 0;
            if (all) clique.push_back(atom);
        }
    }

    bool depend(const std::vector<std::int64_t> &atoms) const {
        const Distances wanted = distances(atoms);
        const FittedGroup group = look_at(wanted, tolerance_, around(atoms));
        if (group.kind == FittedGroup::impossible) refuse(atoms, group.misfit);
        return group.kind == FittedGroup::dependent;
    }

    void look_around(std::int64_t bond, bool five) {
        const std::int64_t i = list_.pairs[2 * bond], j = list_.pairs[2 * bond + 1];
        if (i == j || is_left_out(bond) || !is_free(i) || !is_free(j)) return;
        std::vector<std::int64_t> both;
        const Atom fewer = with_fewer(i, j), other = i + j - fewer;
        for (const Partner &partner : bonds_of_.at(fewer))
            if (partner.atom != other && is_free(partner.atom) && bond_between(partner.atom, other) >= 0 &&
                (both.empty() || both.back() != partner.atom))
                both.push_back(partner.atom);
        if (five) {
            if (both.size() < 3) return;
            std::vector<std::int64_t> clique{i, j};
            grow(clique, both);
            if (clique.size() >= 5) take(clique);
            return;
        }
        for (std::size_t a = 0; a < both.size(); ++a) {
            std::vector<std::int64_t> clique{i, j, both[a]};
            bool flat = depend(clique);
            for (std::size_t b = 0; !flat && b < a; ++b) {
                if (bond_between(both[a], both[b]) < 0) continue;
                clique = {i, j, both[b], both[a]};
                flat = depend(clique);
            }
            if (!flat) continue;
            grow(clique, both);
            return take(clique);
        }
    }

    void take(std::vector<std::int64_t> clique) {
        std::sort(clique.begin(), clique.end());
        const FittedGroup group = look_at(distances(clique), tolerance_, around(clique));
        if (group.kind == FittedGroup::impossible) refuse(clique, group.misfit);
        take(clique, group.coordinates, group.dimension);
    }

    void look_for_ring(std::int64_t bond, std::int64_t &steps) {
        const std::int64_t i = list_.pairs[2 * bond], j = list_.pairs[2 * bond + 1];
        if (i == j || is_left_out(bond) || !is_free(i) || !is_free(j)) return;
        PlanarRing<CliqueSearch> flat(*this, std::min(i, j), std::max(i, j), tolerance_, steps);
        if (flat.find()) take(flat.ring(), flat.coordinates(), 2);
    }

    void take(std::vector<std::int64_t> atoms, std::vector<double> coordinates, int dimension) {
        const std::size_t body = found_.sizes.size();
        for (const std::int64_t atom : atoms) body_of_[atom] = body;
        const Misfit misfit = join_all(
            dimension, atoms, coordinates, [&](Atom atom) { return is_free(atom); },
            [&](Atom atom) { body_of_[atom] = body; });
        const Distances wanted = distances(atoms);
        if (misfit.error > Decimals(wanted, tolerance_, around(atoms)).most()) refuse(atoms, misfit);
        note(atoms, misfit);
        found_.sizes.push_back(static_cast<std::int64_t>(atoms.size()));
        found_.atoms.insert(found_.atoms.end(), atoms.begin(), atoms.end());
        found_.coordinates.insert(found_.coordinates.end(), coordinates.begin(), coordinates.end());
    }

    // All atoms that join a body; its coordinates are those that fit best. Errors of coordinates add up while atoms
    // join: what does not fit then may fit the best ones.
    template <class May, class Take>
    Misfit join_all(int dimension, std::vector<std::int64_t> &atoms, std::vector<double> &coordinates, const May &may,
                    const Take &take) const {
        const Decimals decimals(distances(atoms), tolerance_, around(atoms));
        Misfit misfit = misfit_of(distances(atoms), coordinates);
        for (std::size_t before = 0; before != atoms.size();) {
            before = atoms.size();
            for (std::size_t next = 0; next < atoms.size(); ++next)
                for (const Partner &partner : bonds_of_.at(atoms[next]))
                    if (may(partner.atom) && join(partner.atom, dimension, decimals, atoms, coordinates))
                        take(partner.atom);
            if (atoms.size() != before) misfit = fit_coordinates(distances(atoms), dimension, coordinates);
        }
        return misfit;
    }

    void note(const std::vector<std::int64_t> &atoms, const Misfit &misfit) {
        if (!(misfit.error > found_.adjusted)) return;
        found_.adjusted = misfit.error;
        found_.adjusted_bond = bond_between(atoms[at(misfit.i)], atoms[at(misfit.j)]);
    }

    // An atom joins a body that holds it by more distances than its place has coordinates, all of which it fits.
    bool join(std::int64_t atom, int dimension, const Decimals &of_body, std::vector<std::int64_t> &atoms,
              std::vector<double> &coordinates) const {
        std::vector<std::int64_t> near{atom};
        std::vector<double> there{0, 0, 0};
        for (std::size_t a = 0; a < atoms.size(); ++a) {
            if (bond_between(atom, atoms[a]) < 0) continue;
            near.push_back(atoms[a]);
            there.insert(there.end(), coordinates.begin() + static_cast<std::ptrdiff_t>(3 * a),
                         coordinates.begin() + static_cast<std::ptrdiff_t>(3 * a + 3));
        }
        if (static_cast<int>(near.size()) < dimension + 2) return false;
        Distances wanted(static_cast<std::int64_t>(near.size()));
        for (std::int64_t i = 1; i < wanted.n; ++i) wanted.at(i, 0) = length_between(atom, near[at(i)]);
        if (!locate(wanted, dimension, there)) return false;
        const Misfit misfit = misfit_of(wanted, there);
        const Decimals decimals(distances(near), tolerance_, around(near));
        const auto allows = [&](const Decimals &open) {
            return dimension < 3 ? open.allow_joining(misfit) : misfit.error <= 4 * open.most();
        };
        if (!allows(decimals) && !allows(of_body)) return false;
        atoms.push_back(atom);
        coordinates.insert(coordinates.end(), there.begin(), there.begin() + 3);
        return true;
    }

    // A length that all others contradict is off most.
    [[noreturn]] void refuse(const std::vector<std::int64_t> &atoms, const Misfit &misfit) const {
        const std::int64_t bond = bond_between(atoms[at(misfit.i)], atoms[at(misfit.j)]);
        char words[384];
        std::snprintf(words, sizeof words,
                      "has the length %.10g, which does not fit the others between its %zu atoms, a rigid body: in the "
                      "coordinates that fit best it is %.10g, off by %.2g of it, more than the tolerance of %.2g "
                      "(hol_chains_set_length_tolerance; hol_chains_add_rigid takes coordinates)",
                      lengths_[bond % n_lengths_], atoms.size(), misfit.distance, misfit.error, tolerance_);
        throw bond_error(list_, Status::degenerate, bond, words);
    }

    std::vector<std::int64_t> linear_atoms() const {
        std::vector<std::int64_t> all;
        for (const LinearGroup &group : found_.linear.all())
            all.insert(all.end(), group.atoms.begin(), group.atoms.end());
        return all;
    }
    std::vector<std::int64_t> held_atoms() const {
        std::vector<std::int64_t> all = linear_atoms();
        all.insert(all.end(), found_.atoms.begin(), found_.atoms.end());
        return all;
    }
    // All bonds that hang together with these atoms, but not through fixed atoms.
    std::vector<std::int64_t> bonds_from(std::vector<std::int64_t> stack) const {
        std::vector<std::int64_t> bonds;
        if (stack.empty()) return bonds;
        std::unordered_map<std::int64_t, bool> reached;
        for (const std::int64_t atom : stack) reached[atom] = true;
        while (!stack.empty()) {
            const std::int64_t atom = stack.back();
            stack.pop_back();
            const auto reach = [&](std::int64_t other) {
                if (reached.emplace(other, true).second) stack.push_back(other);
            };
            for (const Partner &partner : bonds_of_.at(atom)) reach(partner.atom);
            found_.linear.for_partners(atom, reach);
        }
        for (std::int64_t k = 0; k < list_.n_bonds; ++k)
            if (!is_left_out(k) && length(k) > 0 &&
                (reached.count(list_.pairs[2 * k]) || reached.count(list_.pairs[2 * k + 1])))
                bonds.push_back(k);
        return bonds;
    }
    double length(std::int64_t bond) const { return lengths_[bond % n_lengths_]; }

    const BondList &list_;
    const double *const lengths_;
    const std::int64_t n_lengths_;
    const double tolerance_;
    const std::vector<unsigned char> &left_out_;
    std::unordered_map<std::int64_t, std::vector<Partner>> bonds_of_;  // of atoms that can move
    std::unordered_map<std::int64_t, std::size_t> body_of_;
    Cliques found_;
    mutable std::unordered_set<Atom> around_;  // the molecule that was asked for last
    mutable std::vector<double> lengths_around_;
};

}  // namespace

Cliques find_cliques(const Masses &masses, const BondList &list, const double *lengths, std::int64_t n_lengths,
                     double tolerance, const std::vector<unsigned char> &left_out) {
    return CliqueSearch(masses, list, lengths, n_lengths, tolerance, left_out).find();
}

}  // namespace holonomic::rigid
