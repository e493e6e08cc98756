// Atoms of mass 0 that nail something rigid to a point in space: most often a massless site of it was meant.
#include <algorithm>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "core/index.hpp"
#include "core/molecules/chains.hpp"
#include "core/rigid/bodies.hpp"

namespace holonomic {

namespace {

using Atoms = std::vector<std::int64_t>;
using Neighbours = std::unordered_map<std::int64_t, Atoms>;

// Calls each(atom) for the atoms that two sorted lists have in common.
template <class Each>
void for_common(const Atoms &a, const Atoms &b, const Each &each) {
    const Atoms &few = a.size() < b.size() ? a : b, &many = a.size() < b.size() ? b : a;
    for (const std::int64_t atom : few)
        if (std::binary_search(many.begin(), many.end(), atom)) each(atom);
}

}  // namespace

void Chains::held_sites(unsigned char *held) const {
    std::fill(held, held + n_atoms_, static_cast<unsigned char>(0));
    Atoms pair(2 * at(n_bonds_));
    std::vector<std::int32_t> role(at(n_bonds_));
    pairs(pair.data());
    roles(role.data(), nullptr);
    // Who gives an infinite mass means that the atom is held.
    const auto is_held = [this](std::int64_t i) { return masses_.fixed(i) && !(bodies_ && bodies_->is_site(i)); };
    const auto is_massless = [&](std::int64_t i) { return is_held(i) && !masses_.infinite(i); };
    const auto for_constraints = [&](const auto &each) {
        for (std::size_t k = 0; k < role.size(); ++k)
            if (role[k] != static_cast<std::int32_t>(Role::fixed)) each(pair[2 * k] - base, pair[2 * k + 1] - base);
    };

    std::unordered_set<std::int64_t> tied;  // atoms that can move, at one of mass 0
    for_constraints([&](std::int64_t i, std::int64_t j) {
        if (is_massless(i) && !is_held(j)) tied.insert(j);
        if (is_massless(j) && !is_held(i)) tied.insert(i);
    });
    if (tied.empty()) return;

    // What is rigid: bodies, and triangles of bonds.
    std::unordered_set<std::int64_t> rigid;
    for (std::int64_t m = 0; bodies_ && m < bodies_->n_molecules(); ++m)
        for (const rigid::Part &part : bodies_->kind(m).parts)
            for (std::int32_t i = 0; i < bodies_->body(part).n_atoms; ++i)
                if (bodies_->body(part).is_rigid) rigid.insert(bodies_->atoms(m)[part.first_atom + i]);
    Neighbours tied_at;  // of any atom, those of its neighbours that are tied
    for_constraints([&](std::int64_t i, std::int64_t j) {
        if (tied.count(i)) tied_at[j].push_back(i);
        if (tied.count(j)) tied_at[i].push_back(j);
    });
    for (auto &its : tied_at) std::sort(its.second.begin(), its.second.end());
    for_constraints([&](std::int64_t i, std::int64_t j) {
        const auto a = tied_at.find(i), b = tied_at.find(j);
        if (a == tied_at.end() || b == tied_at.end()) return;
        for_common(a->second, b->second, [&](std::int64_t atom) { rigid.insert(atom); });
    });
    for_constraints([&](std::int64_t i, std::int64_t j) {
        if (is_massless(i) && rigid.count(j)) held[i] = 1;
        if (is_massless(j) && rigid.count(i)) held[j] = 1;
    });
}

}  // namespace holonomic
