// Where the library cuts a molecule, asked of its core.
#include <cstdio>
#include <cstdlib>

#include "core/molecules/planned/elimination_plan.hpp"
#include "core/plan/paths.hpp"
#include "core/plan/sparse_ldl.hpp"
#include "cuts.hpp"
#include "seam_molecule.hpp"

namespace stress
{

namespace
{

using holonomic::EliminationPlan;
using holonomic::LdlPlan;
using holonomic::PathPlan;
using atoms = std::vector<std::int64_t>;

/** Where arms begin and end, which is also where shares do; where the segments of any number of lanes meet. */
void add_arms(const EliminationPlan &s, std::vector<atoms> &all)
{
    atoms ends, segments;
    for (int a = 0; a < s.n_arms; ++a) {
        const EliminationPlan::Arm &arm = s.arm[a];
        for (const int n : {0, arm.n_bonds}) ends.push_back(arm.first_atom + n);
        for (const int lanes : lane_counts)
            for (const std::int64_t n : segments_of_arm(lanes, arm.n_bonds)) segments.push_back(arm.first_atom + n);
    }
    all.push_back(ends);
    all.push_back(segments);
}

/** Atoms of the top, and those about which indices go on in another tile. */
void add_tiles_of_tree(const EliminationPlan &s, std::vector<atoms> &all)
{
    atoms top, cut;
    const EliminationPlan::Runs &runs = s.runs;
    for (int i = runs.tile_start[s.n_tiles]; i < runs.tile_start[s.n_tiles + 1]; ++i)
        for (int n = 0; n < runs.run[i].count; ++n) top.push_back(s.atom_of[runs.index[runs.run[i].first + n]]);
    for (int p = 1; p < s.n_tiles; ++p)
        for (const int step : {-1, 0}) cut.push_back(s.atom_of[p * holonomic::indices_of_tile + step]);
    all.push_back(top);
    all.push_back(cut);
}

void add_paths(const PathPlan &p, std::vector<atoms> &all)
{
    atoms ends, sections, overlaps;
    for (int i = 0; i < p.n_paths; ++i) {
        const PathPlan::Path &path = p.path[i];
        for (const int n : {0, path.own, path.own_end, path.n_bonds}) ends.push_back(path.first_atom + n);
    }
    for (int i = 0; i < p.n_sections; ++i)
        if (p.section[i].from > p.path[p.section[i].path].own)
            sections.push_back(p.path[p.section[i].path].first_atom + p.section[i].from);
    for (int k = 0; k < p.n_kinds; ++k)
        for (int l = 0; l < p.kind[k].n_overlaps * p.kind[k].count; ++l)
            for (int i = 0; i < PathPlan::n_reaches; ++i) {
                const PathPlan::Overlap &overlap = p.overlap[p.kind[k].first_overlap + l];
                const int reach = PathPlan::reach(i);
                const PathPlan::Path &path = p.path[overlap.path];
                overlaps.push_back(path.first_atom + (overlap.backwards ? path.n_bonds - reach : reach));
            }
    all.push_back(ends);
    all.push_back(sections);
    all.push_back(overlaps);
}

/** Guests, and the atoms of the bonds about which tiles change. */
void add_tiles(const EliminationPlan &s, std::vector<atoms> &all)
{
    atoms ghosts, cut;
    for (int t = 0; t < s.ldl->n_tiles; ++t) {
        const LdlPlan::Tile &tile = s.ldl->tile[t];
        for (int site = tile.own_end; site < tile.end_site; ++site) ghosts.push_back(s.ldl->atom_of[site]);
        for (int k = t > 0 ? tile.first - 1 : tile.end; k < tile.first + 1; ++k)
            for (const int *end : {s.atom_i, s.atom_j}) cut.push_back(end[s.ldl->bond_of[k]]);
    }
    all.push_back(ghosts);
    all.push_back(cut);
}

}  // namespace

std::vector<atoms> seams_of(seam_shape shape, const seam_graph &g)
{
    const std::vector<std::int32_t> pairs(g.pairs.begin(), g.pairs.end());
    const auto s = holonomic::make_elimination_plan(static_cast<std::int32_t>(g.parent.size()),
                                                    static_cast<std::int32_t>(pairs.size() / 2), pairs.data(), nullptr);
    std::vector<atoms> all;
    if (shape == ARMS) add_arms(*s, all);
    if (shape == PATHS && s->paths) add_paths(*s->paths, all);
    if (shape == TREE_TILES && s->n_tiles > 1) add_tiles_of_tree(*s, all);
    if (shape == TILES && s->ldl && !s->paths) add_tiles(*s, all);
    bool cut = !all.empty();
    for (const atoms &list : all) cut = cut && !list.empty();
    if (cut) return all;
    std::printf("%s: the molecule is not cut any more\n", seam_shape_name(shape));
    std::exit(1);
}

}  // namespace stress
