#include "core/molecules/planned/way.hpp"

#include <algorithm>

#include "core/molecules/given/lists.hpp"
#include "core/plan/sparse_ldl.hpp"

namespace holonomic {

namespace {

// A list has so many updates, or so many for each bond. An atom of n bonds brings n^3 / 6 of them.
constexpr std::int64_t short_list = 65536, updates_of_bond = 16;
constexpr std::int64_t most_bonds_at_atom = 3000;  // more updates than the largest list may have

// A large molecule of so many strands, of so many bonds in the mean, is a network: its unknowns are few, and soon
// found.
constexpr std::int64_t many_strands = 64, long_strand = 4;
// So is one whose elimination would take more bytes for each bond of its core.
constexpr std::int64_t bytes_of_core_bond = 2000;
// Small networks have an order for the extended-precision solver, for what does not converge, if it takes no more.
constexpr std::int32_t largest_with_extended = 8192;
constexpr std::int64_t extended_bytes_of_core_bond = 4000;

// Positions of larger trees go by sparse LDL^T in any case: it streams from memory what a batch of trees fetches.
constexpr std::int32_t largest_positions_in_batch = 65536;

// The centre of a star of three or four bonds without fixed atoms, by local atom; or -1.
std::int32_t centre_of_star(const EliminationPlan &s) {
    if (s.type != EliminationPlan::tree || (s.n_bonds != 3 && s.n_bonds != 4)) return -1;
    for (std::int32_t a = 0; a < s.n_atoms; ++a)
        if (s.fixed[a]) return -1;
    for (std::int32_t c = 0; c < s.n_atoms; ++c) {
        std::int32_t bonds = 0;
        for (std::int32_t k = 0; k < s.n_bonds; ++k) bonds += s.atom_i[k] == c || s.atom_j[k] == c;
        if (bonds == s.n_bonds) return c;
    }
    return -1;
}

// Positions of a large tree that is a batch of trees by itself, too.
bool moves_as_batch(const EliminationPlan &s) { return s.n_tiles > 0 && s.n_bonds <= largest_positions_in_batch; }

Way forces_of(const EliminationPlan &s) {
    if (s.network) return Way::network;
    if (s.type == EliminationPlan::triangle) return Way::triangle;
    if (s.n_arms > 0) return Way::armed_tree;
    if (s.n_tiles > 0) return Way::large_tree;
    if (s.ldl) return Way::sparse_ldl;
    if (s.type == EliminationPlan::ring && s.n_tree == 0) return Way::ring;
    return s.star_centre >= 0 ? Way::star : Way::tree;
}

// Arms and stars save what right-hand sides that are given don't need.
Way given_of(const EliminationPlan &s) {
    const Way forces = forces_of(s);
    if (forces == Way::armed_tree) return s.ldl ? Way::sparse_ldl : Way::tree;
    return forces == Way::star ? Way::tree : forces;
}

Way positions_of(const EliminationPlan &s, bool along_paths) {
    if (s.network) return Way::network;
    if (s.type == EliminationPlan::triangle) return Way::triangle;
    if (along_paths) return Way::paths;
    if (s.ldl) return Way::sparse_ldl;
    if (s.n_tiles > 0) return Way::large_tree;
    if (s.type == EliminationPlan::ring && s.n_tree == 0) return Way::ring;
    return s.star_centre >= 0 ? Way::star : Way::tree;
}

// Products from unrounded bonds need few children at an atom, or a ring without trees.
Way metric_of(const EliminationPlan &s) {
    if (s.type == EliminationPlan::tree && s.max_children <= most_decomposed) return Way::tree;
    return s.type == EliminationPlan::ring && s.n_tree == 0 ? Way::ring : Way::extended;
}

}  // namespace

bool is_ring(const EliminationPlan &s, std::int32_t most_trees) {
    if (s.n_core != s.n_core_atoms) return false;
    return s.n_tree == 0 || (s.n_bonds <= largest_graph_in_lanes && most_trees <= most_on_ring);
}

bool has_short_ldl(const EliminationPlan &s, const Lists &bonds) {
    if (s.type != EliminationPlan::graph && !is_large_tree(s)) return false;
    std::int64_t updates = 0;  // six of them
    for (std::int32_t i = 0; i < s.n_atoms; ++i) {
        const std::int64_t n = bonds.size(i);
        if (n > most_bonds_at_atom) return false;
        updates += n * (n - 1) * (n - 2);
    }
    return s.n_bonds <= largest_in_ldl &&
           updates / 6 <= std::max(short_list, updates_of_bond * static_cast<std::int64_t>(s.n_bonds));
}

bool is_mostly_strands(const EliminationPlan &s, std::int64_t ends) {
    return ends >= 2 * many_strands && 2 * static_cast<std::int64_t>(s.n_core) >= long_strand * ends;
}

std::int64_t most_bytes_of_ldl(const EliminationPlan &s) {
    return bytes_of_core_bond * static_cast<std::int64_t>(s.n_core);
}

std::int64_t most_bytes_of_extended(const EliminationPlan &s) {
    return s.n_bonds <= largest_with_extended ? extended_bytes_of_core_bond * static_cast<std::int64_t>(s.n_core) : 0;
}

bool is_large_tree(const EliminationPlan &s) { return s.type == EliminationPlan::tree && s.n_bonds > largest_in_lanes; }

bool is_mostly_arms(const EliminationPlan &s, std::int64_t bonds_in_arms) { return 2 * bonds_in_arms >= s.n_bonds; }

// Not where most atoms stand one behind the other.
bool fills_lanes(const EliminationPlan &s, std::int64_t elements) {
    return elements <= 3 * static_cast<std::int64_t>(s.n_bonds);
}

// A graph that would have a long list is a network.
bool takes_ldl(const EliminationPlan &s, const Lists &bonds) {
    return !moves_as_batch(s) && (s.type == EliminationPlan::graph || has_short_ldl(s, bonds));
}
bool may_have_paths(const EliminationPlan &s) { return !moves_as_batch(s) && s.n_bonds > largest_in_lanes; }

void choose_ways(EliminationPlan &s) {
    s.star_centre = centre_of_star(s);
    s.way = {forces_of(s), given_of(s), positions_of(s, s.paths), metric_of(s), positions_of(s, false)};
    s.alone = s.network || s.n_bonds > (s.ldl ? largest_graph_in_lanes : largest_in_lanes);
}

// A star has kernels of its own.
bool mixes(const EliminationPlan &s) { return s.type == EliminationPlan::tree && !s.alone && s.n_bonds > 4; }

bool has_shares(const EliminationPlan &s, bool paths) {
    return s.network || (paths && s.paths) || (s.ldl && s.ldl->n_subtrees > 0) || (s.n_arms > 0 && s.n_shares > 1);
}

}  // namespace holonomic
