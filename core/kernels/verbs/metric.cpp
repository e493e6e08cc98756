// Metric determinant and Fixman force of blocks of chains.
#include "core/kernels/eliminate/deficits.hpp"
#include "core/kernels/memory/open.hpp"
#include "core/kernels/memory/packed.hpp"
#include "core/kernels/memory/pulls.hpp"
#include "core/kernels/verbs/metric_long.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic {
namespace HOL_ISA {

template <bool uniform, bool boxed>
HOL_NOINLINE void metric_of_block(const Block &block, const Lane *lane, const MetricCall &call, Arena arena,
                                  Tally &tally) {
    const Packed r = open(call.r, block, lane, arena, true), absent = {};
    const Geometry x(block.n, arena);
    load_bonds<none_, uniform, boxed, true>(block, call.box, r, absent, absent, x.u, x.low, x.t);
    measure<uniform>(block, x);
    mask good = block.in_use();
    const MetricSums sums = eliminate_metric<uniform>(block, x, x.delta[0], vec{}, block.lengths(), call, good);
    good = good & finite(sums.log_det) & finite(sums.log_det_z);
    const unsigned which = bits(good);
    if (call.force.x && which) {
        vec f = x.delta[block.n - 1];
        for (long k = block.n - 1; k > 0; --k) {
            weigh_normal<uniform>(block, x, k, f);
            turn(x, k, call.kT);
            f = next_deficit(x, k, f);
        }
        turn(x, 0, call.kT);
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

static void metric_block(const Block &block, const Lane *lane, const MetricCall &call, Arena arena, Tally &tally) {
    const bool boxed = call.box.shape != Box::none;
    if (block.uniform_w)
        boxed ? metric_of_block<true, true>(block, lane, call, arena, tally)
              : metric_of_block<true, false>(block, lane, call, arena, tally);
    else
        boxed ? metric_of_block<false, true>(block, lane, call, arena, tally)
              : metric_of_block<false, false>(block, lane, call, arena, tally);
}

void metric(const MetricCall &call, const Unit &unit, double *scratch, Tally &tally) {
    for_each_block(call, unit, scratch, tally, metric_block, no_molecules<MetricCall>);
}

void long_metric_map(const MetricCall &call, const Lane &lane, int64_t j, double *store, double *scratch) {
    const Cut cut(lane.n_bonds);
    MetricWindow x = metric_window(cut, j, lane);
    Arena arena(scratch, longest_piece);
    set_segment_masses(x.s, lane, arena);
    if (x.s.block.uniform_w)
        map_window<true>(call, lane, x, arena, metric_summary(store, j));
    else
        map_window<false>(call, lane, x, arena, metric_summary(store, j));
}

// e and f at the ends of all windows. False if the chain is bad.
bool long_metric_join(const Lane &lane, double *store) {
    const int64_t blocks = Cut(lane.n_bonds).blocks;
    double e = metric_summary(store, 0).e_start[0], R = 0;
    for (int64_t j = 0; j < blocks; ++j) {
        MetricSummary &s = metric_summary(store, j);
        if (any(s.bad)) return false;
        for (int i = 0; i < W; ++i) {
            s.e_start[i] = e;
            e = (s.forward.a[i] * e + s.forward.b[i]) / (e + s.forward.d[i]);
        }
    }
    if (!(e > 0 && e - e == 0)) return false;  // the last pivot
    for (int64_t j = blocks - 1; j >= 0; --j) {
        MetricSummary &s = metric_summary(store, j);
        for (int i = W - 1; i >= 0; --i) {
            s.f_end[i] = s.delta[i] + R;
            if (!(R - R == 0)) return false;
            if ((j > 0 || i > 0) && !s.short_of_one[i])
                R = (s.mirrored.d[i] * R + s.mirrored.b[i]) / (R + s.mirrored.a[i]);
        }
    }
    return true;
}

void long_metric_finish(const MetricCall &call, const Lane &lane, int64_t j, double *store, double *scratch,
                        Tally &tally) {
    const Cut cut(lane.n_bonds);
    MetricWindow x = metric_window(cut, j, lane);
    Arena arena(scratch, longest_piece);
    set_segment_masses(x.s, lane, arena);
    if (x.s.block.uniform_w)
        finish_window<true>(call, lane, x, arena, metric_summary(store, j), tally);
    else
        finish_window<false>(call, lane, x, arena, metric_summary(store, j), tally);
}

int64_t long_metric_bytes(int64_t n_bonds) { return Cut(n_bonds).blocks * static_cast<int64_t>(sizeof(MetricSummary)); }

}  // namespace HOL_ISA
}  // namespace holonomic
