// Flat and straight groups that share atoms, and points, as a list of distances has them.
#pragma once

#include <algorithm>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/rigid/linear.hpp"

namespace holonomic::rigid {

class LinearGroups {
public:
    void add(LinearGroup group) {
        for (const std::int64_t atom : group.atoms) of_[atom].push_back(all_.size());
        all_.push_back(std::move(group));
    }
    const std::vector<LinearGroup> &all() const { return all_; }
    bool empty() const { return all_.empty(); }
    bool has(std::int64_t atom) const { return of_.count(atom) > 0; }
    // Whether one of them has all these atoms.
    bool has_together(const std::vector<std::int64_t> &atoms) const {
        const auto found = of_.find(atoms[0]);
        return found != of_.end() && std::any_of(found->second.begin(), found->second.end(), [&](std::size_t g) {
                   const std::vector<std::int64_t> &its = all_[g].atoms;
                   return std::all_of(atoms.begin(), atoms.end(), [&](std::int64_t atom) {
                       return std::find(its.begin(), its.end(), atom) != its.end();
                   });
               });
    }
    // Calls each(other) for the atoms of groups of an atom.
    template <class Each>
    void for_partners(std::int64_t atom, const Each &each) const {
        const auto found = of_.find(atom);
        if (found == of_.end()) return;
        for (const std::size_t g : found->second)
            for (const std::int64_t other : all_[g].atoms) each(other);
    }

private:
    std::vector<LinearGroup> all_;
    std::unordered_map<std::int64_t, std::vector<std::size_t>> of_;
};

// Bodies that share atoms with the groups are such groups, too: they are taken out of the lists.
inline void take_sharing_bodies(std::vector<std::int64_t> &sizes, std::vector<std::int64_t> &atoms,
                                std::vector<double> &coordinates, LinearGroups &groups) {
    std::vector<std::int64_t> kept_sizes, kept_atoms;
    std::vector<double> kept_coordinates;
    std::vector<LinearGroup> taken;
    auto atom = atoms.begin();
    auto next = coordinates.begin();
    for (const std::int64_t size : sizes) {
        LinearGroup body{{atom, atom + size}, {next, next + 3 * size}, 1};
        atom += size;
        next += 3 * size;
        const bool shares =
            std::any_of(body.atoms.begin(), body.atoms.end(), [&](std::int64_t its) { return groups.has(its); });
        if (shares) {
            for (std::size_t e = 0; e < body.coordinates.size(); ++e)
                if (body.coordinates[e] != 0) body.dimension = std::max(body.dimension, static_cast<int>(e % 3) + 1);
            taken.push_back(std::move(body));
            continue;
        }
        kept_sizes.push_back(size);
        kept_atoms.insert(kept_atoms.end(), body.atoms.begin(), body.atoms.end());
        kept_coordinates.insert(kept_coordinates.end(), body.coordinates.begin(), body.coordinates.end());
    }
    sizes = std::move(kept_sizes);
    atoms = std::move(kept_atoms);
    coordinates = std::move(kept_coordinates);
    for (LinearGroup &body : taken) groups.add(std::move(body));
}

}  // namespace holonomic::rigid
