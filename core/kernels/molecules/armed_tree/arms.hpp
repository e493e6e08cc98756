// Arms of one large molecule (core/plan/elimination.hpp), each as a chain inside of it: the inner bonds of its W
// segments are eliminated at once, without knowing anything else (eliminate/segment.hpp). What a segment leaves to the
// separators at its two ends is the matrix [c, -f; -f, E] with a = E c - f^2, and T and y on the right: so the joining
// of verbs/segments.cpp, which subtracts nothing, can go from either end to the other, whichever is the upper one.
#pragma once

#include "core/kernels/eliminate/segment.hpp"
#include "core/kernels/molecules/armed_tree/atoms.hpp"

namespace holonomic::HOL_ISA::graph {

HOL_INLINE Lane chain_of(const EliminationPlan::Arm &arm, const MoleculeLane &molecule) {
    Lane lane = {};
    lane.n_bonds = arm.n_bonds - 1;
    lane.first_atom = molecule.first_atom + arm.first_atom;
    lane.atoms = molecule.atoms ? molecule.atoms + arm.first_atom : nullptr;
    lane.w = molecule.w + arm.first_atom;
    lane.first_bond = molecule.first_bond + arm.first_bond;
    lane.chain = molecule.molecule;
    return lane;
}

HOL_INLINE Summary *summaries_of(const ArmedTree &z, int32_t a) {
    return reinterpret_cast<Summary *>(store_of(z.x.s, z.arms, a));
}

// Calls body(a, arena, tally) for all arms, from the last one on if `backwards`, on the threads that there are.
template <class Body>
HOL_INLINE void for_arms(const ArmedTree &z, bool backwards, Tally &tally, const Body &body) {
    const EliminationPlan &s = z.x.s;
    const Arms &arms = z.arms;
    const auto share = [&](int64_t j, double *scratch, Tally &part) {
        const int32_t i = static_cast<int32_t>(backwards ? s.n_shares - 1 - j : j);
        const Arena arena(scratch == arms.scratch ? arms.work : scratch, longest_cut);
        for (int32_t a = s.share_start[i]; a < s.share_start[i + 1]; ++a)
            body(backwards ? s.share_start[i] + s.share_start[i + 1] - 1 - a : a, arena, part);
    };
    typedef decltype(share) Share;
    if (const LongTeam *const team = z.team) {
        team->run(
            team->threads, s.n_shares, tally,
            [](const void *context, int64_t j, double *scratch, Tally &part) {
                (*static_cast<const Share *>(context))(j, scratch, part);
            },
            &share);
        return;
    }
    for (int64_t j = 0; j < s.n_shares; ++j) {
        Tally part = empty_tally();
        share(j, arms.work, part);
        add(tally, part);
    }
}

// Eliminates the inner bonds of all arms. The terms have the numbers of Terms in memory/packed.hpp.
static inline void eliminate_arms(const ArmedTree &z) {
    const Molecules<double> &x = z.x;
    Tally unused = empty_tally();
    const AtomArray none = {}, &f = x.in.f ? *x.in.f : none;
    for_arms(z, false, unused, [&](int32_t a, const Arena &arena, Tally &) {
        const EliminationPlan::Arm &arm = x.s.arm[a];
        const Cut cut = cut_in_order(x.s, z.arms, a);
        const Lane lane = chain_of(arm, x.lane[0]);
        Summary *const all = summaries_of(z, a);
        x.w[arm.bottom + 1] = x.lane[0].w[x.s.atom_of[arm.bottom + 1]];  // for siblings.hpp at the lowest atom
        bool alone = cut.n_bonds % W != 0;
        for (int64_t j = 0; !alone && j < cut.blocks; ++j) {
            eliminate_block(z.terms, *x.box, cut, lane, j, *x.r, *x.in.v, f, false, reinterpret_cast<double *>(all),
                            arena, x.in.strain);
            alone = any(all[j].flag);
        }
        z.arms.alone[a] = alone;
    });
}

// Goes up an arm: takes E and the right-hand side y, which its lowest bond gets from below, through the segments to the
// highest bond. Returns false, with nothing changed, if a joint is flagged.
static inline bool up_segments(const ArmedTree &z, int32_t a) {
    const Molecules<double> &x = z.x;
    const EliminationPlan::Arm &arm = x.s.arm[a];
    Summary *const all = summaries_of(z, a);
    BondRow<double> &low = x.row[arm.bottom], &high = x.row[arm.top()];
    const int64_t n = cut_of(arm).blocks * W;
    double E = low.E, y = low.t, r = 0, u = 0;
    for (int64_t k = 0; k < n; ++k) {
        const int64_t j = arm.ascending ? k : n - 1 - k;
        const int i = static_cast<int>(j % W);
        Summary &s = all[j / W];
        if (arm.ascending && k > 0) y += s.b[i];
        const double below = arm.ascending ? s.c[i] : s.E[i], above = arm.ascending ? s.E[i] : s.c[i];
        const double P = E + below, sum = y + (arm.ascending ? s.T[i] : s.y[i]), S = above * E + s.a[i];
        if (is_flagged_join(s, i, S, arm.ascending ? P : S, arm.ascending ? 1.0 : E)) return false;
        s.t[i] = sum / P;
        s.up[i] = s.f[i] / P;
        if (k == 0) {
            r = 1 / P;
            u = s.t[i];
        }
        E = S / P;
        y = (arm.ascending ? s.y[i] : s.T[i]) + s.up[i] * sum;
        if (!arm.ascending && j > 0) y += s.b[i];
    }
    low.r = r;
    low.E = u;  // what siblings.hpp compares with
    high.E = E;
    high.t = high.t + y;
    return true;
}

HOL_NOINLINE void up_arm(ArmedTree &z, int32_t a) {
    const EliminationPlan::Arm &arm = z.x.s.arm[a];
    unsigned char &alone = z.arms.alone[a];
    load_index(z, arm.top());
    if (!alone && up_segments(z, a)) return;
    alone = 1;
    for (int32_t index = arm.bottom + 1; index < arm.top(); ++index) load_index(z, index);
    for (int32_t index = arm.bottom + 1; index <= arm.top(); ++index) up_one(z, index);
}

// Goes down an arm and finds the multipliers of its separators.
HOL_NOINLINE void down_arm(ArmedTree &z, int32_t a, bool look) {
    const Molecules<double> &x = z.x;
    const EliminationPlan::Arm &arm = x.s.arm[a];
    if (z.arms.alone[a]) {
        for (int32_t index = arm.top(); index > arm.bottom; --index) down_atom(z, index, look);
        return;
    }
    Summary *const all = summaries_of(z, a);
    const int64_t blocks = cut_of(arm).blocks, n = blocks * W;
    double t = x.row[arm.top()].t;
    if (arm.ascending) all[blocks].t[0] = t;
    bool good = true;
    for (int64_t k = 0; k < n; ++k) {
        const int64_t j = arm.ascending ? n - 1 - k : k;
        Summary &s = all[j / W];
        const int i = static_cast<int>(j % W);
        const double lower = s.t[i] + s.up[i] * t;
        s.t[i] = arm.ascending ? lower : t;  // of the separator that the segment begins with
        t = lower;
        good = good && t - t == 0;
    }
    if (!arm.ascending) all[blocks].t[0] = t;
    x.row[arm.bottom].t = t;
    if (!good) z.x.margin = -1;
}

// Of atoms between indices, and of bonds between bond indices.
HOL_NOINLINE void write_range(const Molecules<double> &x, bool weighted, const EliminationPlan::Stretch &range,
                              const LinearOutputs &out, MoleculesVirial<double> &virial) {
    const int32_t first = range.first_index, end = range.end_index;
    if (out.lambda) write_bonds<false>(x, 0.5, out.lambda, 1, first, end);
    if (out.tension) write_bonds<true>(x, 1, out.tension, 1, first, end);
    for (int32_t k = first; k < end && out.virial; ++k) virial.add(x.row[k].d, x.row[k].t * x.row[k].d);
    if (!out.g->x) return;
    write_indices(x, *out.g, range.first, range.end, [&](int32_t index) {
        const Vector3<double> pull = pull_on(x, index);
        if (weighted) return add_times(read(*out.g, x.at, x.s.atom_of[index]), x.w[index], pull);
        return out.add ? read(*out.g, x.at, x.s.atom_of[index]) + pull : pull;
    });
}

// The outputs of an arm that was worked on atom by atom.
HOL_NOINLINE void write_alone(const Molecules<double> &x, bool weighted, const EliminationPlan::Arm &arm,
                              const LinearOutputs &out, Tally &tally) {
    const int32_t first = arm.ascending ? arm.bottom : arm.bottom + 1;
    MoleculesVirial<double> virial;
    write_range(x, weighted, {arm.bottom + 1, arm.top() + 1, first, first + arm.n_bonds - 1, -1}, out, virial);
    if (out.virial) virial.count(1, 1, tally);
}

// Writes the outputs of the arms. weighted: v += w G, with v in place of G.
HOL_NOINLINE void write_arms(const ArmedTree &z, bool weighted, const LinearOutputs &out, Tally &tally) {
    const Molecules<double> &x = z.x;
    const SegmentOutputs outputs = {{}, false, out.lambda, out.tension, splat(0.5), 1.0, out.virial};
    for_arms(z, true, tally, [&](int32_t a, const Arena &arena, Tally &part) {
        const EliminationPlan::Arm &arm = x.s.arm[a];
        if (z.arms.alone[a]) return write_alone(x, weighted, arm, out, part);
        const Cut cut = cut_in_order(x.s, z.arms, a);
        const Lane lane = chain_of(arm, x.lane[0]);
        double *const store = store_of(x.s, z.arms, a);
        for (int64_t j = cut.blocks; j-- > 0;)
            finish_block(weighted, *x.box, *x.r, *out.g, weighted || out.add, outputs, cut, lane, j, store, arena,
                         part);
    });
}

}  // namespace holonomic::HOL_ISA::graph
