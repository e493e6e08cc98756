// SPDX-License-Identifier: GPL-2.0-only
#include "plan.hpp"

#include <algorithm>
#include <string>

#include "route.hpp"

namespace holonomic_lammps {

namespace {

/** A rank that owns fewer atoms than this part of what another has is no home, so that little has to travel. */
constexpr double fair_share = 0.75;

struct Arrival {
    Tag molecule;
    Tag tag;
    int place;
};

std::uint64_t scatter(Tag tag) {
    std::uint64_t x = static_cast<std::uint64_t>(tag) * 0x9E3779B97F4A7C15u;
    x ^= x >> 29;
    x *= 0xBF58476D1CE4E5B9u;
    return x ^ (x >> 32);
}

}  // namespace

/** The atoms of a molecule that one rank has. */
struct Plan::Part {
    Tag molecule;
    int present, wanted;
    int rank;
};

int Plan::size_of_world() const { return size_of(world_); }

bool Plan::renew(const Registry &registry, const Membership *members, const Tag *tags, int n_atoms) {
    count(members, n_atoms);
    choose_homes();
    const bool changed = settle(registry);
    fill_slots(members, tags, n_atoms);
    return changed;
}

void Plan::forget(const std::unordered_set<Tag> &molecules) {
    for (Tag molecule : molecules)
        if (shape_of_.erase(molecule)) stale_ = true;
}

/** How many atoms of which molecule are here. Those of the last plan keep their numbers. */
void Plan::count(const Membership *members, int n_atoms) {
    std::fill(present_.begin(), present_.end(), 0);
    for (int i = 0; i < n_atoms; ++i) {
        if (members[i].molecule == 0 || members[i].place == divided) continue;
        const int next = static_cast<int>(molecules_.size());
        const int number = numbers_.find_or_insert(members[i].molecule, next);
        if (number == next) {
            molecules_.push_back(members[i].molecule);
            present_.push_back(0);
            wanted_.push_back(0);
        }
        wanted_[number] = members[i].n_atoms;
        ++present_[number];
    }
    home_.assign(molecules_.size(), -1);
}

/** Those that are here as a whole live here; of the others the bookkeeper decides. */
void Plan::choose_homes() {
    const int me = rank_of(world_);
    Outgoing<Part> parts(n_ranks_);
    std::vector<std::vector<int>> asked(n_ranks_);
    for (std::size_t k = 0; k < molecules_.size(); ++k) {
        if (present_[k] == wanted_[k]) home_[k] = me;
        if (present_[k] == 0 || present_[k] == wanted_[k]) continue;
        const int keeper = bookkeeper(molecules_[k], n_ranks_);
        parts[keeper].push_back({molecules_[k], present_[k], wanted_[k], me});
        asked[keeper].push_back(static_cast<int>(k));
    }
    const Delivery<Part> came = route(world_, parts);
    std::vector<int> order(came.items.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = static_cast<int>(k);
    std::sort(order.begin(), order.end(), [&](int a, int b) {
        const Part &p = came.items[a], &q = came.items[b];
        return p.molecule != q.molecule ? p.molecule < q.molecule : p.rank < q.rank;
    });
    std::vector<int> chosen(order.size());
    std::string trouble;
    for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
        std::vector<Part> all;
        int present = 0;
        for (; end < order.size() && came.items[order[end]].molecule == came.items[order[begin]].molecule; ++end) {
            all.push_back(came.items[order[end]]);
            present += all.back().present;
        }
        if (present != all[0].wanted)
            trouble = "the molecule of atom " + std::to_string(all[0].molecule) + " has " +
                      std::to_string(all[0].wanted) + " atoms, of which " + std::to_string(present) + " are there";
        const int home = choose(all.data(), all.data() + all.size());
        for (std::size_t k = begin; k < end; ++k) chosen[order[k]] = home;
    }
    throw_together(world_, trouble);
    Outgoing<int> replies(n_ranks_);
    for (int p = 0; p < n_ranks_; ++p)
        replies[p].assign(chosen.begin() + came.first[p], chosen.begin() + came.first[p + 1]);
    const Delivery<int> homes = route(world_, replies);
    for (int p = 0; p < n_ranks_; ++p)
        for (std::size_t k = 0; k < asked[p].size(); ++k) home_[asked[p][k]] = homes.items[homes.first[p] + k];
}

/** The last home if it still has a fair share; otherwise one of those that have, drawn by their shares and the name. */
int Plan::choose(const Part *begin, const Part *end) {
    int most = 0;
    for (const Part *part = begin; part != end; ++part) most = std::max(most, part->present);
    const auto fair = [most](const Part &part) { return part.present >= fair_share * most; };
    const auto last = last_home_.find(begin->molecule);
    std::uint64_t sum = 0;
    for (const Part *part = begin; part != end; ++part) {
        if (!fair(*part)) continue;
        if (last != last_home_.end() && last->second == part->rank) return part->rank;
        sum += part->present;
    }
    std::uint64_t drawn = scatter(begin->molecule) % sum;
    for (const Part *part = begin;; ++part) {
        if (!fair(*part)) continue;
        if (drawn < static_cast<std::uint64_t>(part->present)) return last_home_[begin->molecule] = part->rank;
        drawn -= part->present;
    }
}

/** Lists the residents, those of one shape together. */
bool Plan::settle(const Registry &registry) {
    const int me = rank_of(world_);
    std::vector<Tag> here;
    bool same = !stale_;
    for (std::size_t k = 0; k < molecules_.size(); ++k) {
        if (home_[k] == me) here.push_back(molecules_[k]);
        same = same && (home_[k] == me) == (k < residents_.size());
    }
    if (same) here.clear();
    if (!same) forget_shapes();
    find_shapes(registry, here);
    if (same) return false;
    stale_ = false;
    std::vector<Resident> residents;
    for (Tag molecule : here) residents.push_back({molecule, shape_of_.at(molecule), 0});
    std::sort(residents.begin(), residents.end(), [](const Resident &a, const Resident &b) {
        return a.shape != b.shape ? a.shape < b.shape : a.molecule < b.molecule;
    });
    int slot = 0;
    for (Resident &resident : residents) {
        resident.first = slot;
        slot += shapes_[resident.shape].n_atoms;
    }
    residents_ = residents;
    atoms_.assign(slot, -1);
    tags_.assign(slot, 0);
    // New numbers, residents first; those that have left are forgotten.
    std::vector<std::array<Tag, 3>> others;
    for (std::size_t k = 0; k < molecules_.size(); ++k)
        if (home_[k] != me && present_[k] > 0) others.push_back({molecules_[k], present_[k], home_[k]});
    std::vector<int> wanted_of;
    for (const auto &other : others) wanted_of.push_back(wanted_[numbers_.find(other[0])]);
    numbers_.clear(residents_.size() + others.size());
    molecules_.clear(), present_.clear(), wanted_.clear(), home_.clear();
    const auto enter = [this](Tag molecule, int present, int wanted, int home) {
        numbers_.find_or_insert(molecule, static_cast<int>(molecules_.size()));
        molecules_.push_back(molecule);
        present_.push_back(present);
        wanted_.push_back(wanted);
        home_.push_back(home);
    };
    for (const Resident &resident : residents_) enter(resident.molecule, 0, shapes_[resident.shape].n_atoms, me);
    for (std::size_t k = 0; k < others.size(); ++k)
        enter(others[k][0], static_cast<int>(others[k][1]), wanted_of[k], static_cast<int>(others[k][2]));
    return true;
}

void Plan::find_shapes(const Registry &registry, const std::vector<Tag> &molecules) {
    std::vector<Tag> unknown;
    for (Tag molecule : molecules)
        if (shape_of_.count(molecule) == 0) unknown.push_back(molecule);
    int any = !unknown.empty();
    MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_MAX, world_);
    if (!any) return;
    const std::vector<Shape> found = registry.shapes(unknown);
    for (std::size_t k = 0; k < unknown.size(); ++k) {
        const auto entry = shape_numbers_.emplace(found[k], static_cast<int>(shapes_.size()));
        if (entry.second) {
            shapes_.push_back(found[k]);
            walks_.push_back(walk(found[k]));
            n_listed_ += found[k].n_atoms + found[k].pairs.size();
        }
        shape_of_[unknown[k]] = entry.first->second;
    }
}

/** Where bonds change, shapes come that are never seen again: all are learnt anew before they take more than atoms do.
 */
void Plan::forget_shapes() {
    if (n_listed_ < 1000 + 8 * tags_.size()) return;
    shapes_.clear(), walks_.clear(), shape_numbers_.clear(), shape_of_.clear();
    n_listed_ = 0;
    ++numbering_;
}

void Plan::fill_slots(const Membership *members, const Tag *tags, int n_atoms) {
    const int me = rank_of(world_);
    Outgoing<Arrival> leaving(n_ranks_);
    std::vector<std::vector<int>> leavers(n_ranks_);
    n_away_ = 0;
    std::fill(atoms_.begin(), atoms_.end(), -1);
    for (int i = 0; i < n_atoms; ++i) {
        if (members[i].molecule == 0 || members[i].place == divided) continue;
        const int number = numbers_.find(members[i].molecule);
        const int home = home_[number];
        if (home == me) {
            const int slot = residents_[number].first + members[i].place;
            atoms_[slot] = i;
            tags_[slot] = tags[i];
        } else {
            leaving[home].push_back({members[i].molecule, tags[i], members[i].place});
            leavers[home].push_back(i);
            ++n_away_;
        }
    }
    const Delivery<Arrival> came = route(world_, leaving);
    exchange.homes.clear(), exchange.owners.clear();
    for (int p = 0; p < n_ranks_; ++p) {
        if (!leavers[p].empty()) exchange.homes.push_back({p, leavers[p]});
        if (came.first[p] == came.first[p + 1]) continue;
        exchange.owners.push_back({p, {}});
        for (int k = came.first[p]; k < came.first[p + 1]; ++k) {
            const Arrival &arrival = came.items[k];
            const int slot = residents_[numbers_.find(arrival.molecule)].first + arrival.place;
            tags_[slot] = arrival.tag;
            exchange.owners.back().indices.push_back(slot);
        }
    }
}

}  // namespace holonomic_lammps
