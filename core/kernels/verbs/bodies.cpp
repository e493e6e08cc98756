// Rigid bodies that stand alone, side by side, in plain arithmetic. What does not come out in a lane is left to core,
// as it was.
#include "core/kernels/bodies/lanes.hpp"
#include "core/kernels/bodies/turn.hpp"
#include "core/kernels/isa/choose.hpp"
#include "core/kernels/memory/prefetch.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

namespace {

template <int R>
HOL_INLINE mask project_with_virial(const BodyKind &kind, const Frame<R> &at, const Half<R> &more, Frame<R> &z,
                                    bool virial, int count, BodyResult *results) {
    if (__builtin_expect(!virial, 1)) return project(kind, at, more, z, static_cast<Frame<R> *>(nullptr));
    Frame<R> taken;
    taken.clear();
    const mask good = project(kind, at, more, z, &taken);
    write_virial(kind, at, taken, 1, count, results);
    return good;
}

// By how much atoms are moved, beside the masses.
template <int R>
HOL_INLINE vec square_of_moves(const BodyKind &kind, const Frame<R> &trial, const Frame<R> &change) {
    vec sum = {};
    HOL_UNROLL_FEW
    for (int p = 1; p <= R; ++p) {
        const vec3 m = change[p] - trial[p];
        sum = mul_add(splat(kind.square[p - 1]), dot(m, m), sum);
    }
    return sum;
}

// What a verb does with a block: read(), compare() and find_turn() if it is positions, solve(), which returns the lanes
// that are good, and write() for these.
template <int R>
struct ForcesOf : BodyLanes<R> {
    using BodyLanes<R>::kind;
    const ForcesCall &call;
    Frame<R> at, z;
    Half<R> of_rates;

    ForcesOf(const ForcesCall &c, const BodyKind &k, double *scratch) : BodyLanes<R>(k, scratch), call(c) {}

    HOL_FORCED void read() {
        this->positions(call.r, call.box, at);
        this->forces(call.f, z);
        if constexpr (R == 2)
            if (has_off_plane<R>(kind)) carry_to_axes(kind, at, this->y, z);
        if (!call.v.x) return of_rates.clear();
        Frame<R> rate;
        this->template rates<of_rough_axes>(call.v, rate);
        twice_products(rate, of_rates);
    }
    HOL_FORCED mask solve(BodyResult *results) {
        const mask good = project_with_virial(kind, at, of_rates, z, call.virial, this->count, results);
        if constexpr (R == 2)
            if (has_off_plane<R>(kind) && call.virial) add_virial_of_sites(kind, at, this->y, this->count, results);
        return good;
    }
    HOL_FORCED void write(unsigned lanes) {
        if (call.g.x) this->write_forces(call, z, lanes);
    }
};

template <int R>
struct VelocitiesOf : BodyLanes<R> {
    using BodyLanes<R>::kind;
    const VelocitiesCall &call;
    Frame<R> at, rate;

    VelocitiesOf(const VelocitiesCall &c, const BodyKind &k, double *scratch) : BodyLanes<R>(k, scratch), call(c) {}

    HOL_FORCED void read() {
        this->positions(call.r, call.box, at);
        this->rates(call.v, rate);
    }
    HOL_FORCED mask solve(BodyResult *results) {
        Half<R> none;
        none.clear();
        return project_with_virial(kind, at, none, rate, call.virial, this->count, results);
    }
    HOL_FORCED void write(unsigned lanes) { this->write_velocities(call.v, at, rate, lanes); }
};

// The trial less the reference, t, has a frame of its own; what is off the frame goes, and the rest is brought back. So
// the rounding of all moves is relative to t.
template <int R>
struct PositionsOf : BodyLanes<R> {
    using BodyLanes<R>::kind;
    const PositionsCall &call;
    Frame<R> from, trial, change, rate;
    Turn<R> turn;
    mask near;

    PositionsOf(const PositionsCall &c, const BodyKind &k, double *scratch) : BodyLanes<R>(k, scratch), call(c) {}

    HOL_FORCED void read() { this->positions(call.r_ref, call.box_ref, from); }
    HOL_FORCED void compare() {
        near = this->changes(call.r, call.box, from, trial);
        if (has_sites_to_write()) this->template rates<of_rough_rates>(call.v, rate);
        if (R > 1) prepare(kind, from, trial, turn);
    }
    HOL_FORCED void find_turn() {
        turn.rounds = splat(1);
        if (R == 1) return;
        if (R == 2) {
            turn.good = turn_plane(kind, turn.a, turn.good, turn.g);
            return;
        }
        if (kind.is_spherical) {
            turn.good = turn_sphere(turn.a, turn.good, turn.g);
            return;
        }
        const int most = call.max_iterations < 40 ? call.max_iterations : 40;
        turn.good = solve_turn(kind, turn.a, most, turn.good, turn.g, turn.rounds);
    }
    HOL_FORCED mask solve(BodyResult *results) {
        mask good;
        put(change[0], trial[0]);
        if constexpr (R == 1) {
            put(change[1], trial[1]);
            good = restore_line(from, change);
        } else {
            good = finish(kind, turn, call.r_ref.is_float ? 1e-8 : 2e-15, change);
        }
        // Crude or rigid already: the general solver decides.
        const double least = (call.r.is_float ? 1e-5 : 1e-10) * kind.extent;
        good = good & near & less(splat(least * least), square_of_moves(kind, trial, change)) & finite(change.sum());
        if (__builtin_expect(call.virial || call.report, 0)) report(results);
        return good;
    }
    HOL_FORCED void write(unsigned lanes) {
        if (has_off_plane<R>(kind)) this->take_heights(end_of_axes());
        this->write_moves(call, change, lanes);
        if (has_sites_to_write()) write_sites(lanes);
    }

private:
    Frame<R> end_of_axes() const {
        Frame<R> end = change;
        for (int k = 1; k <= R; ++k) put(end[k], from[k] + change[k]);
        return end;
    }
    __attribute__((noinline)) void report(BodyResult *results) {
        Frame<R> moved, end = end_of_axes();
        for (int k = 1; k <= R; ++k) put(moved[k], change[k] - trial[k]);
        if (call.virial) write_virial(kind, from, moved, 1 / (call.dt * call.dt), this->count, results);
        const vec error = largest_of(errors_of(end));
        for (int l = 0; l < this->count; ++l) {
            results[l].error = error[l];
            results[l].iterations = static_cast<int>(turn.rounds[l]);
        }
    }
    bool has_sites_to_write() const { return call.v.x && kind.has_sites; }
    // Velocities of sites are those of the body at their places: the rate before, and what the moves make of it.
    __attribute__((noinline)) void write_sites(unsigned lanes) {
        const vec per_dt = splat(1 / call.dt);
        HOL_UNROLL_FEW
        for (int k = 0; k <= R; ++k) put(rate[k], add_times(rate[k], per_dt, change[k] - trial[k]));
        this->write_site_velocities(call.v, end_of_axes(), rate, call.flow, lanes);
    }
};

// Calls the stages of a verb for all blocks of a unit: bits of the bodies that are done. Two blocks at a time: what is
// solved for is one long chain of sums and products, in which there is time for another one.
template <class Verb, class Call>
uint64_t for_each_block(const Call &call, const BodyUnit &unit, NextMolecules ahead, double *scratch,
                        BodyResult *results) {
    const BodyKind &kind = *unit.kind;
    Verb of[2] = {{call, kind, scratch}, {call, kind, scratch + scratch_of_block(kind.n_atoms)}};
    // What large ones are made of would not stay in the first cache until it is written.
    const int most = kind.n_atoms > 24 ? 1 : 2;
    // Smaller ones a processor fetches by itself.
    const bool fetches = unit.large && kind.n_atoms >= 12;
    uint64_t done = 0;
    for (int body = 0; body < unit.count; body += most * W) {
        const int n = body + W < unit.count ? most : 1;
        unsigned lanes[2];
        if (fetches) {
            ahead.begin(kind.n_atoms);
            const int next = body + most * W, end = next + most * W < unit.count ? next + most * W : unit.count;
            for (int i = next; i < end; ++i) ahead.add(unit.first[i] / 3);
            ahead.fetch();
        }
        for (int i = 0; i < n; ++i) {
            of[i].set(unit, body + i * W);
            of[i].read();
        }
        for (int i = 0; i < n; ++i) of[i].compare();
        ahead.fetch();
        for (int i = 0; i < n; ++i) of[i].find_turn();
        for (int i = 0; i < n; ++i) lanes[i] = bits(of[i].solve(results + body + i * W)) & ((1u << of[i].count) - 1);
        ahead.fetch();
        for (int i = 0; i < n; ++i) {
            if (lanes[i]) of[i].write(lanes[i]);
            done |= static_cast<uint64_t>(lanes[i]) << (body + i * W);
        }
        ahead.fetch_the_rest();
    }
    return done;
}

}  // namespace

int64_t bodies_scratch_bytes(int64_t n_atoms) {
    return 2 * scratch_of_block(n_atoms) * static_cast<int64_t>(sizeof(double));
}

uint64_t bodies_forces(const ForcesCall &call, const BodyUnit &unit, double *scratch, BodyResult *results) {
    return choose_number<1, 3>(unit.kind->rank, [&](auto rank) {
        return for_each_block<ForcesOf<rank>>(call, unit, NextMolecules({&call.r, &call.f, &call.v, &call.g}), scratch,
                                              results);
    });
}

uint64_t bodies_velocities(const VelocitiesCall &call, const BodyUnit &unit, double *scratch, BodyResult *results) {
    return choose_number<1, 3>(unit.kind->rank, [&](auto rank) {
        return for_each_block<VelocitiesOf<rank>>(call, unit, NextMolecules({&call.r, &call.v}), scratch, results);
    });
}

uint64_t bodies_positions(const PositionsCall &call, const BodyUnit &unit, double *scratch, BodyResult *results) {
    return choose_number<1, 3>(unit.kind->rank, [&](auto rank) {
        return for_each_block<PositionsOf<rank>>(call, unit, NextMolecules({&call.r_ref, &call.r, &call.v}), scratch,
                                                 results);
    });
}

}  // namespace holonomic::HOL_ISA
