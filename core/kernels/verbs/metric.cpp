// Metric determinant and Fixman force of blocks of chains, and of one long chain in windows (memory/cut.hpp).
#include "core/kernels/eliminate/deficits.hpp"
#include "core/kernels/memory/cut.hpp"
#include "core/kernels/memory/open.hpp"
#include "core/kernels/memory/outputs.hpp"
#include "core/kernels/tally.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

// Returns the logarithms of all bonds, or of those that are the window's own. Takes bad lanes out of `good`. The forces
// are the pulls of t and phi, which it leaves in x.t and x.u.
template <bool uniform>
HOL_NOINLINE MetricSums solve_metric(const Block &block, const MetricCall &call, const Packed &r, const Window *window,
                                     const Geometry &x, mask &good) {
    vec first = {}, end = block.lengths();
    for (int i = 0; window && i < W; ++i) {
        first[i] = static_cast<double>(window->skip[i]);
        end[i] = static_cast<double>(window->skip[i] + window->own.own[i]);
    }
    measure<uniform>(block, call.box, r, x, call.force.x != nullptr);
    const long n = block.n, whole = window ? 0 : block.n_min;
    Deficit<uniform> right = {x.delta(n - 1)};
#if HOL_FOURS
    // Deficits from the other end meanwhile.
    const auto from_behind = [&](long i) HOL_FORCED {
        const long k = n - 1 - i;
        x.f[k] = right.A;
        x.per_f[k] = right.F;
        if (k > 0) pass_back(block, x, k, right);
    };
#else
    const auto from_behind = [](long) HOL_FORCED {};
#endif
    const MetricSums sums =
        call.force.x ? eliminate_metric<uniform, true>(block, x, first, end, whole, call, good, from_behind)
                     : eliminate_metric<uniform, false>(block, x, first, end, whole, call, good, [](long) {});
    good = good & finite(sums.log_det) & finite(sums.log_det_z);
    if (!call.force.x || !any(good)) return sums;
#if HOL_FOURS
    turn_back<uniform>(block, x, call.kT);
#else
    for (long k = n - 1; k > 0; --k) {
        weigh_normal(block, x, k, right);
        turn(x, k, call.kT);
        pass_back(block, x, k, right);
    }
    turn(x, 0, call.kT);
#endif
    return sums;
}

static inline MetricSums solve_metric(const Block &block, const MetricCall &call, const Packed &r, const Window *window,
                                      const Geometry &x, mask &good) {
    return block.uniform_w ? solve_metric<true>(block, call, r, window, x, good)
                           : solve_metric<false>(block, call, r, window, x, good);
}

static void metric_block(const Block &block, const Lane *lane, const MetricCall &call, Arena arena, Tally &tally) {
    const Packed r = open(call.r, block, lane, arena, true);
    const Geometry x(block.n, arena);
    mask good = block.in_use();
    const MetricSums sums = solve_metric(block, call, r, nullptr, x, good);
    const unsigned which = bits(good);
    if (call.force.x && which) {
        const Packed out = open(call.force, block, lane, arena, false);
        store_pulls(block, x.u, x.t, good, call.add && in_place(call.force, block) ? add_ : write_, out);
        close(call.force, block, lane, good, out, call.add);
    }
    for (int i = 0; i < block.lanes; ++i) {
        if (!(which >> i & 1)) continue;
        if (call.log_det) call.log_det[block.chain[i]] = sums.log_det[i];
        if (call.log_det_z) call.log_det_z[block.chain[i]] = sums.log_det_z[i];
        tally.log_det += sums.log_det[i];
    }
    const mask rest = block.in_use() & ~good;
    if (any(rest)) note_bad(block, rest, tally);
}

void metric(const MetricCall &call, const Unit &unit, double *scratch, Tally &tally) {
    for_each_block(call, unit, scratch, tally, metric_block, no_molecules<MetricCall>, false);
}

// Keeps the forces of a window until all windows are known to be good: packed vectors of each lane's atoms, and which
// of these is the first that is the part's own.
struct KeptForces {
    Packed forces;
    double *first_own;
    static int64_t doubles(const Cut &cut) { return W * (1 + staged_size(cut.longest() + 2 * longest_margin)); }
    KeptForces(double *store, const Cut &cut, int64_t j) : first_own(store + j * doubles(cut)) {
        for (int i = 0; i < W; ++i)
            forces.lane[i] = first_own + W + i * staged_size(cut.longest() + 2 * longest_margin);
    }
};

int64_t long_metric_bytes(int64_t n_bonds) {
    const Cut cut = windows(n_bonds);
    return cut.blocks * KeptForces::doubles(cut) * static_cast<int64_t>(sizeof(double));
}

// Returns false if the chain can't be done in windows.
static bool metric_window(const MetricCall &call, const Lane &lane, int64_t j, const KeptForces &kept, Arena arena,
                          Tally &tally) {
    Window window;
    // The force on a part's last atom is t phi of the bond behind it less that of its own last bond. That phi has h of
    // the joint at its far end, too, and h the deficit f of the bond behind the joint: the margin counts from there.
    if (!open_window(call.r, call.box, lane, j, 1, arena, window)) return false;
    const Block &block = window.block;
    const Packed r = open(call.r, block, window.lane, arena, true);
    const Geometry x(block.n, arena);
    for (int i = 0; i < W; ++i) kept.first_own[i] = static_cast<double>(window.skip[i]);
    mask good = first_lanes(W);
    const MetricSums sums = solve_metric(block, call, r, &window, x, good);
    if (call.force.x) store_pulls(block, x.u, x.t, good, write_, kept.forces);
    tally.log_det += sum_lanes(sums.log_det);
    tally.log_det_z += sum_lanes(sums.log_det_z);
    return !any(~good);
}

bool long_metric(const MetricCall &call, const Lane &lane, const LongTeam &team, double *store, Tally &tally) {
    const Cut cut = windows(lane.n_bonds);
    bool failed = false;
    Tally sum = empty_tally(), unused = empty_tally();
    for_each_window(team, cut.blocks, sum, [&](int64_t j, double *scratch, Tally &part) {
        if (__atomic_load_n(&failed, __ATOMIC_RELAXED)) return;
        if (!metric_window(call, lane, j, KeptForces(store, cut, j), Arena(scratch, longest_cut), part))
            __atomic_store_n(&failed, true, __ATOMIC_RELAXED);
    });
    if (failed) return false;
    if (call.force.x)
        for_each_window(team, cut.blocks, unused, [&](int64_t j, double *, Tally &) {
            const KeptForces kept(store, cut, j);
            for (int i = 0; i < W; ++i) {
                const int64_t s = j * W + i;
                const long first = s == 0 ? 0 : 1, at = static_cast<long>(kept.first_own[i]) + first;
                unstage(call.force, lane, cut.first(s) + first, cut.length(s) - first, kept.forces.lane[i] + 3 * at,
                        call.add);
            }
        });
    if (call.log_det) call.log_det[lane.chain] = sum.log_det;
    if (call.log_det_z) call.log_det_z[lane.chain] = sum.log_det_z;
    tally.log_det += sum.log_det;
    return true;
}

}  // namespace holonomic::HOL_ISA
