// Rigid bodies that stand alone, side by side, in plain arithmetic. What does not come out in a lane is left to core,
// as it was.
#include "core/kernels/bodies/lanes.hpp"
#include "core/kernels/bodies/turn.hpp"
#include "core/kernels/isa/choose.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

namespace {

// The equations, once for all ways to read and write atoms. z: forces over masses; becomes accelerations.
template <int R>
__attribute__((noinline)) mask accelerate(const BodyKind &kind, const Frame<R> &at, const Frame<R> *rate, Frame<R> &z,
                                          Symmetric<R> *of_virial) {
    Symmetric<R> b = both_products(at, z);
    if (rate) {
        const Symmetric<R> square = products(*rate);
        HOL_UNROLL_FEW
        for (int p = 0; p < R; ++p) {
            HOL_UNROLL_FEW
            for (int q = p; q < R; ++q) b.of[p][q] = b.of[q][p] = mul_add(square.of[p][q], splat(2), b.of[p][q]);
        }
    }
    mask good = ~none();
    const Symmetric<R> lambda = solve(kind, errors_of(kind, at), b, good);
    if (of_virial) *of_virial = lambda;
    take_away(z, at, lambda);
    return good & finite(z.nothing());
}

template <int R>
__attribute__((noinline)) mask project(const BodyKind &kind, const Frame<R> &at, Frame<R> &rate,
                                       Symmetric<R> *of_virial) {
    mask good = ~none();
    take_excess(kind, rate);
    const Symmetric<R> lambda = solve(kind, errors_of(kind, at), both_products(at, rate), good);
    if (of_virial) *of_virial = lambda;
    take_away(rate, at, lambda);
    // What rounding leaves of the rates goes with a second projection.
    take_away(rate, at, by_the_diagonal(kind, both_products(at, rate)));
    return good & finite(rate.nothing());
}

template <int R>
__attribute__((noinline)) Turned restored(const BodyKind &kind, const Frame<R> &from, Frame<R> &change, int most,
                                          double slack) {
    Turned out;
    take_excess(kind, change);
    restore(kind, from, change, most, slack, out);
    return out;
}

// Lanes that there are bodies for.
unsigned used_lanes(const BodyBlock &block, mask good) { return bits(good) & ((1u << block.count) - 1); }

template <int R>
unsigned forces_of(const ForcesCall &call, const BodyBlock &block, double *scratch, BodyResult *results) {
    BodyLanes<R> atoms(block, scratch);
    const BodyKind &kind = block.kind;
    Frame<R> at, z, rate;
    atoms.template positions<1>(call.r, call.box, at);
    if (call.f.x)
        atoms.forces(call.f, z);
    else
        z.clear();
    if (call.v.x) atoms.template rates<1>(call.v, rate);
    Symmetric<R> lambda;
    const mask good = accelerate(kind, at, call.v.x ? &rate : nullptr, z, call.virial ? &lambda : nullptr);
    const unsigned lanes = used_lanes(block, good);
    if (call.virial) write_virial(at, lambda, kind.mass, block.count, results);
    if (call.g.x && lanes) atoms.write_forces(call, z, lanes);
    return lanes;
}

template <int R>
unsigned velocities_of(const VelocitiesCall &call, const BodyBlock &block, double *scratch, BodyResult *results) {
    BodyLanes<R> atoms(block, scratch);
    Frame<R> at, rate;
    atoms.template positions<1>(call.r, call.box, at);
    atoms.template rates<0>(call.v, rate);
    Symmetric<R> lambda;
    const unsigned lanes = used_lanes(block, project(block.kind, at, rate, call.virial ? &lambda : nullptr));
    if (call.virial) write_virial(at, lambda, block.kind.mass, block.count, results);
    if (lanes) atoms.write_velocities(call.v, rate, lanes);
    return lanes;
}

// The trial less the reference, t, has a frame of its own; what is off the frame goes, and the rest is brought back. So
// the rounding of all moves is relative to t.
template <int R>
unsigned positions_of(const PositionsCall &call, const BodyBlock &block, double *scratch, BodyResult *results) {
    BodyLanes<R> atoms(block, scratch);
    const BodyKind &kind = block.kind;
    Frame<R> from, change;
    atoms.template positions<0>(call.r_ref, call.box_ref, from);
    atoms.changes(call.r, call.box, from, change);
    Frame<R> trial = change;
    const Turned turned = restored(kind, from, change, call.max_iterations < 40 ? call.max_iterations : 40,
                                   call.r_ref.is_float ? 1e-8 : 1e-15);
    const vec squares = atoms.moves(change);
    // Crude or rigid already: the general solver decides.
    const double least = (call.r.is_float ? 1e-5 : 1e-10) * kind.extent, most = 0.5 * kind.extent;
    const mask good = turned.good & less(squares, splat(most * most)) & less(splat(least * least), squares) &
                      finite(change.nothing());
    const unsigned lanes = used_lanes(block, good);
    if (lanes == 0) return lanes;
    const bool carries_sites = call.v.x && kind.has_sites;
    Frame<R> rate;
    if (carries_sites) {
        atoms.template rates<0>(call.v, rate);
        for (int k = 0; k <= R; ++k) put(rate[k], add_times(rate[k], splat(1 / call.dt), change[k] - trial[k]));
    }
    if (call.virial) {
        for (int k = 0; k <= R; ++k) put(trial[k], change[k] - trial[k]);
        write_virial(from, trial, kind.mass / (call.dt * call.dt), block.count, results);
    }
    if (call.report) {
        for (int k = 0; k <= R; ++k) put(change[k], from[k] + change[k]);
        const vec error = largest_error(kind, errors_of(kind, change));
        for (int l = 0; l < block.count; ++l) {
            results[l].error = error[l];
            results[l].iterations = turned.rounds[l];
        }
    }
    atoms.write_moves(call, lanes);
    if (carries_sites) atoms.write_sites(call.v, rate, lanes);
    return lanes;
}

// Calls body(block, results) for all blocks of a unit: bits of the bodies that are done.
template <class Body>
HOL_INLINE uint64_t for_each_block(const BodyUnit &unit, BodyResult *results, const Body &body) {
    uint64_t done = 0;
    for (int first = 0; first < unit.count; first += W) {
        const int left = unit.count - first;
        BodyBlock block = {*unit.kind, {}, left < W ? left : W, unit.consecutive};
        HOL_UNROLL
        for (int l = 0; l < W; ++l) block.atoms[l] = unit.atoms[first + (l < block.count ? l : 0)];
        done |= static_cast<uint64_t>(body(block, results + first)) << first;
    }
    return done;
}

}  // namespace

int64_t bodies_scratch_bytes(int64_t n_atoms) { return 9 * n_atoms * static_cast<int64_t>(sizeof(vec)); }

uint64_t bodies_forces(const ForcesCall &call, const BodyUnit &unit, double *scratch, BodyResult *results) {
    return choose_number<1, 3>(unit.kind->rank, [&](auto rank) {
        return for_each_block(unit, results, [&](const BodyBlock &block, BodyResult *to) {
            return forces_of<rank>(call, block, scratch, to);
        });
    });
}

uint64_t bodies_velocities(const VelocitiesCall &call, const BodyUnit &unit, double *scratch, BodyResult *results) {
    return choose_number<1, 3>(unit.kind->rank, [&](auto rank) {
        return for_each_block(unit, results, [&](const BodyBlock &block, BodyResult *to) {
            return velocities_of<rank>(call, block, scratch, to);
        });
    });
}

uint64_t bodies_positions(const PositionsCall &call, const BodyUnit &unit, double *scratch, BodyResult *results) {
    return choose_number<1, 3>(unit.kind->rank, [&](auto rank) {
        return for_each_block(unit, results, [&](const BodyBlock &block, BodyResult *to) {
            return positions_of<rank>(call, block, scratch, to);
        });
    });
}

}  // namespace holonomic::HOL_ISA
