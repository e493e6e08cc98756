// Position level of one long chain in segments: the phases of an iteration.
#include "core/kernels/memory/values.hpp"
#include "core/kernels/memory/virial.hpp"
#include "core/kernels/newton/phases.hpp"
#include "core/kernels/newton/segment_outputs.hpp"
#include "core/kernels/newton/segment_steps.hpp"

namespace holonomic {
namespace HOL_ISA {

int64_t segments_bytes(int64_t n_bonds) {
    const Cut cut(n_bonds);
    return cut.blocks * NewtonSegments::vectors(cut.longest()) * static_cast<int64_t>(sizeof(vec));
}

void load_segments(const PositionsCall &call, const Lane &lane, int64_t j, double *store, double *scratch,
                   LongTally &tally) {
    const Cut cut(lane.n_bonds);
    const NewtonSegments x(store, cut.longest(), j);
    SegmentBlock s = segment_block(cut, j, lane);
    Arena arena(scratch, longest_piece);
    const Packed r_ref = open_segments(call.r_ref, s, lane, arena, true),
                 r = open_segments(call.r, s, lane, arena, true);
    s.block.uniform_w = true;
    load_bond_vectors(s.block, call.box_ref, r_ref, x.b);
    load_bond_vectors(s.block, call.box, r, x.D);
    *x.summary = NewtonSummary{};
    segment_errors(s, lane, x);
    const double factor = 2 * call.dt * call.dt * unit_of(lane);
    const int64_t end = lane.first_bond + lane.n_bonds;
    for (long k = 0; k < s.block.n; ++k) x.tau[k] = vec{};
    for (long k = 0; call.guess && k < s.block.n; ++k)
        for (int i = 0; i < W; ++i) {
            const int64_t bond = s.block.first_bond[i] + k;
            x.tau[k][i] = call.guess && k < s.block.len[i] && bond < end ? factor * call.lambda[bond] : 0.0;
        }
    const vec largest = extent(s.block, r);
    for (int i = 0; i < W; ++i) {
        tally.extent = largest[i] > tally.extent ? largest[i] : tally.extent;
        const double e = x.summary->error[i];
        tally.error = e > tally.error || e != e ? e : tally.error;
        if (tally.error != tally.error) return;
    }
}

// Starts from the guess in tau: it becomes the first correction.
void start_from_guess(const PositionsCall &, const Lane &lane, int64_t j, double *store) {
    const Cut cut(lane.n_bonds);
    const NewtonSegments x(store, cut.longest(), j);
    const SegmentBlock s = segment_block(cut, j, lane);
    for (long k = 0; k < s.block.n; ++k) {
        x.s[k] = x.tau[k];
        x.tau[k] = vec{};
    }
    for (int i = 0; i < W; ++i) {
        const long k = s.own[i] - 1;
        x.summary->last.x[i] = x.s[k][i] * x.b[k].x[i];
        x.summary->last.y[i] = x.s[k][i] * x.b[k].y[i];
        x.summary->last.z[i] = x.s[k][i] * x.b[k].z[i];
    }
}

// Drops a guess in tau.
void forget_guess(const Lane &lane, int64_t j, double *store) {
    const Cut cut(lane.n_bonds);
    const NewtonSegments x(store, cut.longest(), j);
    for (int64_t k = 0; k <= cut.longest(); ++k) x.tau[k] = vec{};
}

// Eliminates with the Jacobian at D and substitutes forward. The bond behind each segment is taken from its owner.
void factorize_segments(const PositionsCall &, const Lane &lane, int64_t j, bool careful, double *store,
                        double *scratch) {
    const Cut cut(lane.n_bonds);
    const NewtonSegments x(store, cut.longest(), j);
    SegmentBlock s = segment_block(cut, j, lane);
    const bool has_next = j + 1 < cut.blocks;
    const NewtonSegments beyond(store, cut.longest(), has_next ? j + 1 : j);
    for (int i = 0; i < W; ++i) {
        const long k = s.own[i];
        if (k >= s.block.n || i == s.last) continue;
        const NewtonSegments &owner = i + 1 < W ? x : beyond;
        const int from = i + 1 < W ? i + 1 : 0;
        x.D[k].x[i] = owner.D[0].x[from];
        x.D[k].y[i] = owner.D[0].y[from];
        x.D[k].z[i] = owner.D[0].z[from];
    }
    Arena arena(scratch, longest_piece);
    set_segment_masses(s, lane, arena);
    if (s.block.uniform_w)
        eliminate_segments<true>(s, x, careful);
    else
        eliminate_segments<false>(s, x, careful);
    Ascent a = {vec{}, vec{}, x.summary->first_up};
    for (long k = 1; k < s.own_max; ++k) {
        vec sigma = half_excess(x.D[k], a2_of(s, lane, k));
        if (k >= s.own_min) sigma = keep(owned(s, k), sigma);
        a.bond(s, x, k, sigma, k + 1 >= s.own_min);
    }
}

// Solves for the separators; false if that gives no finite numbers.
bool join_segments(const Lane &lane, bool renew, double *store) {
    const Cut cut(lane.n_bonds);
    const double w0 = relative_w(lane, 0);
    double E = 0, y = 0;
    for (int64_t j = 0; j < cut.blocks; ++j) {
        const NewtonSegments x(store, cut.longest(), j);
        NewtonSummary &s = *x.summary;
        if (j == 0) E = w0 * dot(x.D[0], x.b[0])[0];
        for (int i = 0; i < W; ++i) {
            if (renew) {
                const double P = E + s.c[i];
                E = (s.E[i] * E + s.a[i]) / P;
                s.P[i] = P;
                s.join_down[i] = s.down[i] / P;
                s.join_up[i] = s.up[i] / P;
            }
            const double yhat = (y + s.s[i]) + s.T[i];
            s.t[i] = yhat / s.P[i];
            y = s.y[i] + s.join_down[i] * yhat;
        }
    }
    double t = 0;
    for (int64_t j = cut.blocks - 1; j >= 0; --j) {
        NewtonSummary &s = *NewtonSegments(store, cut.longest(), j).summary;
        for (int i = W - 1; i >= 0; --i) {
            const double behind = t;
            t = s.t[i] + s.join_up[i] * behind;
            s.t[i] = t;
            if (!(t - t == 0)) return false;
            const double end = s.last_u[i] + s.last_fP[i] * t + s.last_up[i] * behind;
            s.last.x[i] = end * s.last_b.x[i];
            s.last.y[i] = end * s.last_b.y[i];
            s.last.z[i] = end * s.last_b.z[i];
        }
    }
    return true;
}

// With `substitute`, moves the bonds by the corrections that those of the separators lead to, and substitutes forward
// what that leaves of their lengths; else by the corrections in s. Returns the largest error of the block.
double step_segments(const PositionsCall &, const Lane &lane, int64_t j, bool substitute, double *store,
                     double *scratch) {
    const Cut cut(lane.n_bonds);
    const NewtonSegments x(store, cut.longest(), j);
    SegmentBlock s = segment_block(cut, j, lane);
    Arena arena(scratch, longest_piece);
    set_segment_masses(s, lane, arena);
    const bool has_next = j + 1 < cut.blocks;
    if (substitute)
        descend(s, x,
                next_of(x.summary->t, has_next,
                        has_next ? NewtonSegments(store, cut.longest(), j + 1).summary->t[0] : 0.0));
    const vec3 last = x.summary->last;
    vec3 previous = {};
    if (j > 0) {
        const vec3 before = NewtonSegments(store, cut.longest(), j - 1).summary->last;
        previous.x[0] = before.x[W - 1];
        previous.y[0] = before.y[W - 1];
        previous.z[0] = before.z[W - 1];
    }
    for (int i = 1; i < W; ++i) {
        previous.x[i] = last.x[i - 1];
        previous.y[i] = last.y[i - 1];
        previous.z[i] = last.z[i - 1];
    }
    const vec error =
        substitute ? move_segments<true>(s, lane, x, previous) : move_segments<false>(s, lane, x, previous);
    x.summary->error = error;
    double worst = 0;
    for (int i = 0; i < W; ++i) {
        if (error[i] != error[i]) return error[i];
        worst = error[i] > worst ? error[i] : worst;
    }
    return worst;
}

// Largest w |tau| a of the block: how far single pulls move an atom (see coarse_moves).
double largest_pull(const Lane &lane, int64_t j, double *store) {
    const Cut cut(lane.n_bonds);
    const NewtonSegments x(store, cut.longest(), j);
    double largest = 0;
    if (!lane.w && !lane.length) {
        const SegmentBlock s = segment_block(cut, j, lane);
        vec most = {};
        for (long k = 0; k < s.own_max; ++k) most = max(most, abs(x.tau[k]));
        for (int i = 0; i < W; ++i) largest = most[i] > largest ? most[i] : largest;
        return largest * relative_w(lane, 0) * lane.length_uniform;
    }
    for (int i = 0; i < W; ++i) {
        const int64_t first = cut.first(j * W + i), n = cut.length(j * W + i);
        for (int64_t k = 0; k < n; ++k) {
            const double w0 = relative_w(lane, first + k);
            const double w1 = relative_w(lane, first + k + 1);
            const double a = lane.length ? lane.length[first + k] : lane.length_uniform;
            const double pull = (w0 > w1 ? w0 : w1) * abs(x.tau[k][i]) * a;
            largest = pull > largest ? pull : largest;
        }
    }
    return largest;
}

// Writes r, v and lambda, and adds to the sums; with `moved` false the chain was within the tolerance as it came.
void finish_segments(const PositionsCall &call, const Lane &lane, int64_t j, bool moved, double *store, double *scratch,
                     Tally &tally) {
    const Cut cut(lane.n_bonds);
    const NewtonSegments x(store, cut.longest(), j);
    SegmentBlock s = segment_block(cut, j, lane);
    Arena arena(scratch, longest_piece);
    note_worst_bond(s, lane, x, tally);
    if (moved) {
        set_segment_masses(s, lane, arena);
        const auto move = [&](const AtomArray &array, const vec *t) {
            if (!array.x) return;
            Arena staging = arena;
            const Packed out = open_segments(array, s, lane, staging, false);
            const bool add = in_place(array, lane), uniform = s.block.uniform_w;
            if (add)
                uniform ? move_segment_atoms<true>(s, j, x, t, AtomSink<add_>{out})
                        : move_segment_atoms<false>(s, j, x, t, AtomSink<add_>{out});
            else
                uniform ? move_segment_atoms<true>(s, j, x, t, AtomSink<write_>{out})
                        : move_segment_atoms<false>(s, j, x, t, AtomSink<write_>{out});
            close_segments(array, s, j, lane, out, true);
        };
        move(call.r, x.tau);
        if (call.v.x) {
            for (long k = 0; k < s.block.n; ++k) x.up[k] = (1 / call.dt) * x.tau[k];
            move(call.v, x.up);
        }
        if (call.virial) add_segment_virial(s, x, splat(1 / (unit_of(lane) * call.dt * call.dt)), tally);
    }
    if (!call.lambda) return;
    if (!moved)
        for (long k = 0; k < s.own_max; ++k) x.tau[k] = vec{};
    store_bonds(own_block(s), x.tau, splat(0.5 / (call.dt * call.dt) / unit_of(lane)), first_lanes(W), call.lambda);
}

}  // namespace HOL_ISA
}  // namespace holonomic
