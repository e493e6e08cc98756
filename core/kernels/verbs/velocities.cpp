// Velocity level of a block of chains: the solve of the forces with d . (v_k - v_{k-1}) on the right; v_i += w_i G_i.
// Velocities are read once, stay in lanes until they are right, and are written once.
#include "core/kernels/eliminate/listed.hpp"
#include "core/kernels/eliminate/projection.hpp"
#include "core/kernels/memory/load.hpp"
#include "core/kernels/memory/open.hpp"
#include "core/kernels/memory/outputs.hpp"
#include "core/kernels/memory/parts.hpp"
#include "core/kernels/memory/small.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

static mask forward_velocities(const Block &block, const Reader &in, const Projection &x, mask &calm) {
    return block.uniform_w ? forward<true, true>(block, in, x.s, x.v, calm)
                           : forward<false, true>(block, in, x.s, x.v, calm);
}

// With compensated products of unrounded bond vectors, which are good in all lanes.
static mask forward_extended(const Block &block, const Reader &in, const Projection &x) {
    in.load(0, block.n, x.s.D, x.s.D_low, x.s.t, x.v);
    block.uniform_w ? forward_extended<true>(block, x.s) : forward_extended<false>(block, x.s);
    return ~none();
}

// Makes the second substitution and writes the velocities of the lanes in `which` to `out`.
template <bool uniform>
HOL_NOINLINE void correct_and_store(const Block &block, const Projection &x, mask which, const Packed &out) {
    const Packed to = out;  // by value: its pointers stay in registers
    const AtomSink<write_> sink = {to};
#if HOL_FOURS
    static_cast<void>(which);
    move_velocities<uniform>(block, x, x.left, [&](long e, auto value) HOL_FORCED { sink.put(0, e, value); });
#else
    Pull<uniform> pull{block, x, x.left};
    const unsigned chosen = bits(which);
    const long full = block.n / W * W, fast = chosen == all_lanes ? block.n_min : 0;
    if (full < block.n) {
        vec3 value[W] = {};
        for (long k = block.n - 1; k >= full; --k) value[k - full] = pull.step(k);
        store_ragged(block, full + 1, &value->x, chosen, sink);
    }
    for (long k0 = full - W; k0 >= 0; k0 -= W) {
        vec value[3 * W];
        HOL_UNROLL
        for (long b = W - 1; b >= 0; --b) {
            const vec3 v = pull.step(k0 + b);
            value[3 * b] = v.x;
            value[3 * b + 1] = v.y;
            value[3 * b + 2] = v.z;
        }
        if (__builtin_expect(k0 + W <= fast, 1))
            store_chunk(k0 + 1, value, sink);
        else
            store_ragged(block, k0 + 1, value, chosen, sink);
    }
    store_first(pull.finish(), chosen, sink);
#endif
}

template <bool uniform>
HOL_NOINLINE void correct_and_scatter(const Block &block, const Projection &x, const AtomLists &at, double *out) {
    Pull<uniform> pull{block, x, x.left};
    for (long k = block.n - 1; k >= 0; --k) scatter<write_>(out, at, k + 1, pull.step(k));
    scatter<write_>(out, at, 0, pull.finish());
}

// Lists of atoms in packed arrays. True if the block is done; on false nothing was written.
static inline bool listed_velocities(const Block &block, const Lane *lane, const VelocitiesCall &call, Arena arena) {
    if (!call.r.packed || call.virial || call.strain || !listed(block, lane)) return false;
    const AtomLists at(lane);
    const Projection x(block.n, arena, nullptr);
    const Reader in(block, call.box, kept_rate, at, call.r, call.v, AtomArray{});
    mask calm, good = forward_velocities(block, in, x, calm);
    good = good & pull_back(block, x, true);
    if (any(~good)) return false;
    if (call.lambda) store_bonds(block, x.s.t, 0.5 * block.mass, good, call.lambda);
    choose([&](auto uniform) { correct_and_scatter<uniform>(block, x, at, base_of(call.v)); }, block.uniform_w);
    return true;
}

static void velocities_block(const Block &block, const Lane *lane, const VelocitiesCall &call, Arena arena,
                             Tally &tally) {
    if (block.staged && listed_velocities(block, lane, call, arena)) return;
    const Packed r = open(call.r, block, lane, arena, true), v = open(call.v, block, lane, arena, true);
    const Projection x(block.n, arena, call.strain);
    mask rest = block.in_use(), calm = none(), tried = none();  // as in forces.cpp
    for (int extended = 0; extended < 2 && any(rest); ++extended) {
        Reader in(block, call.box, kept_rate, r, v, v, extended);
        in.strain = call.strain;
        mask good = extended ? forward_extended(block, in, x) & tried : forward_velocities(block, in, x, calm);
        if (!extended) tried = ~good & (calm | all_if(call.rescaled));
        good = good & pull_back(block, x, !call.v.is_float) & rest;
        rest = rest & ~good;
        if (!any(good)) continue;
        if (call.lambda) store_bonds(block, x.s.t, 0.5 * block.mass, good, call.lambda);
        if (call.virial) add_virial(block.n, x.s.D, x.s.t, good, block.mass, tally);
        choose([&](auto uniform) { correct_and_store<uniform>(block, x, good, v); }, block.uniform_w);
        close(call.v, block, lane, good, v, false);
    }
    if (any(rest)) note_bad(block, rest, tally);
}

// Out of line and by value: rates of the box are rare.
HOL_NOINLINE vec stretching_of(const double *strain, vec3 d) { return stretching(strain, d); }

// Does molecules from `first` on. Returns the first one that is not done. `given`: the block of a regular unit.
template <class View, bool uniform, bool boxed, bool virial>
static int64_t velocities_of_molecules(const VelocitiesCall &call, const Unit &unit, const Block &given, int64_t first,
                                       Tally &tally) {
    constexpr int N = View::bonds;
    const auto r = View::array(call.r), v = View::array(call.v);
    BlockMasses<View> masses(given);
    const Block &block = masses.block;
    const int64_t end = View::end(unit, first);
    for (int64_t n; (n = View::next(first, end)) > 0; first += n) {
        vec3 D[N];
        vec t[N], left[N + 1], L[N + 1], pivots[N], elements[vectors_of<N>];
        const View view(unit, first, n);
        masses.take(view);
        view.fetch_next(r);
        view.fetch_next(v);
        load_bonds<boxed, false>(call.box, view, r, elements, D);
        load_molecules(view, v, elements);
        const auto source = view.source(r, call.box);
        const Projection x({D, t, L, pivots}, reinterpret_cast<vec3 *>(elements), left);
        Sweep<uniform, true, decltype(view.source(r, call.box))> sweep{block, source, x.s};
        HOL_UNROLL
        for (int k = 0; k < N; ++k) {
            vec b = rate_of(D[k], x.v[k], x.v[k + 1]);
            if (__builtin_expect(call.strain != nullptr, 0)) b = b + stretching_of(call.strain, D[k]);
            sweep.step(
                k, [&]() HOL_FORCED { return b; }, k % 4 == 0, false);
        }
        FirstPull<uniform> pull(block, x, N);
        HOL_UNROLL
        for (int k = N - 1; k >= 0; --k) pull.step(k);
        pull.finish();
        if (__builtin_expect(call.strain != nullptr, 0)) {
            HOL_UNROLL
            for (int k = 0; k < N; ++k) left[k] = left[k] + stretching_of(call.strain, D[k]);
        }
        substitute(N, x.correction());
        if (__builtin_expect(any(sweep.flag() | ~x.finite(N)), 0)) break;
        if (virial || (N >= fewest_with_virial && __builtin_expect(call.virial, 0)))
            count_virial<N>(D, t, n, block.mass, tally);
        Pull<uniform> correction{block, x, left};
        HOL_UNROLL
        for (int k = N - 1; k >= 0; --k) x.v[k + 1] = correction.step(k);
        x.v[0] = correction.finish();
        if (call.lambda) store_multipliers(view, t, 0.5 * block.mass, call.lambda);
        store_molecules<write_>(view, elements, v);
    }
    return first;
}

static int64_t small_velocities(const VelocitiesCall &call, const Unit &unit, Block &block, int64_t first,
                                Tally &tally) {
    const bool boxed = call.box.lattice != Box::none;
    const auto kernel = [&](auto view, auto uniform, auto in_box) {
        typedef typename decltype(view)::type View;
        constexpr bool equal = decltype(uniform)::value && View::alike, with_box = decltype(in_box)::value;
        return with_virial_or_not<View, with_box>(call.virial, [&](auto virial, auto box) {
            return velocities_of_molecules<View, equal, box, virial>(call, unit, block, first, tally);
        });
    };
    if (call.r.packed && call.v.packed) return any_molecules(unit, block, first, boxed, true, kernel);
    return reads_columns(call) ? molecules_in_columns(unit, block, first, boxed, true, kernel) : first;
}

// Arrays that are not packed. False if nothing has been done.
static bool velocities_in_parts(const VelocitiesCall &call, const Unit &unit, double *scratch, Tally &tally) {
    if (reads_columns(call) && fit_columns(unit, call.box.lattice != Box::none)) return false;
    return in_packed_parts(call, unit, tally, [=](const VelocitiesCall &c, const Unit &u, Tally &own) {
        for_each_block(c, u, scratch, own, velocities_block, small_velocities);
    });
}

void velocities(const VelocitiesCall &call, const Unit &unit, double *scratch, Tally &tally) {
    if (!call.r.packed && velocities_in_parts(call, unit, scratch, tally)) return;
    for_each_block(call, unit, scratch, tally, velocities_block, small_velocities);
}

}  // namespace holonomic::HOL_ISA
