// Position level of molecules that are no chains.
#include "core/kernels/molecules/armed_tree/linear.hpp"
#include "core/kernels/molecules/linear.hpp"
#include "core/kernels/molecules/network/verbs.hpp"
#include "core/kernels/molecules/positions.hpp"
#include "core/kernels/molecules/sparse_ldl/error_bound.hpp"
#include "core/kernels/molecules/sparse_ldl/linear.hpp"
#include "core/kernels/molecules/star/positions.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

using namespace graph;

// What a block takes at the greediest level, and the extended-precision solver behind it. That of a metric comes in its
// place.
template <class V>
static int64_t block_bytes(const EliminationPlan &s) {
    const int64_t linear = TreeLinear<V>::values(s), newton = TreeNewton<V>::values(s);
    return static_cast<int64_t>(sizeof(V)) * (linear > newton ? linear : newton);
}

template <class V>
static int64_t ldl_bytes(const LdlPlan &s) {
    const int64_t linear = LdlLinear<V>::values(s), newton = LdlNewton<V>::values(s);
    return static_cast<int64_t>(sizeof(V)) * (linear > newton ? linear : newton);
}

int64_t molecules_scratch_bytes(const EliminationPlan &s) {
    if (s.way.positions == Way::network) {
        const int64_t extended = s.extended ? s.extended->extended_bytes + 64 : 0,
                      own = HOL_NETWORKS::network_bytes(*s.network);
        return own > extended ? own : extended;
    }
    const int64_t most = s.ldl     ? (s.alone ? ldl_bytes<double>(*s.ldl) : ldl_bytes<vec>(*s.ldl))
                         : s.alone ? block_bytes<double>(s)
                                   : block_bytes<vec>(s),
                  paths = s.paths ? path_positions_bytes(s) : 0,
                  armed = ArmedTree::values(s) * static_cast<int64_t>(sizeof(double)),
                  more = armed > paths ? armed : paths, linear = (most > more ? most : more) + 64 + s.extended_bytes,
                  metric = metric_bytes(s);
    return linear > metric ? linear : metric;
}

// Blocks of molecules, those that have paths along these where they will do.
struct BlockPositionsWork : PositionsOfBlocks {
    template <class V>
    void block(const MoleculeLane *lane, int used, bool known, double *scratch) const {
        Way way = elimination.way.positions;
        if (way == Way::paths) {
            if (path_positions(call, elimination, *lane, team, scratch, tally)) return;
            way = elimination.way.without_paths;
            known = false;
        }
        by_way<V>(way, lane, used, known, scratch);
    }
};

static void positions_of_blocks(const PositionsCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    const Way way = unit.elimination->way.positions;
    if (unit.tree_batches && moves_in_batch(way)) return batches_positions(call, unit, scratch, tally);
    const bool packed = call.r.packed && call.r_ref.packed && (!call.v.x || call.v.packed);
    if (way == Way::network) return solve_networks(call, unit, packed, scratch, tally);
    if (way == Way::triangle)
        return for_each_triangle(TrianglePositionsVerb{call, tally}, unit, packed, scratch, reads_columns(call));
    NextMolecules ahead({&call.r_ref, &call.r, &call.v}, call.lambda);
    const BlockPositionsWork work = {{call, *unit.elimination, packed, tally, unit.team, ahead}};
    const StarPositionsVerb stars = {call, tally};
    if (way == Way::star && !call.guess &&
        (do_stars<3>(stars, work, unit, scratch) || do_stars<4>(stars, work, unit, scratch)))
        return;
    for_each_block(unit, scratch, ahead, work);
}

void molecules_positions(const PositionsCall &call, const MoleculeUnit &unit, double *scratch, Tally &tally) {
    molecules_in_parts(call, unit, tally, [=](const PositionsCall &c, const MoleculeUnit &u, Tally &own) {
        positions_of_blocks(c, u, scratch, own);
    });
}

}  // namespace holonomic::HOL_ISA
