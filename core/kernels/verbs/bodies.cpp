// Rigid bodies that stand alone, side by side, in plain arithmetic. What does not come out in a lane is left to core,
// as it was.
#include "core/kernels/bodies/frame.hpp"
#include "core/kernels/isa/choose.hpp"
#include "core/kernels/verbs/verbs.hpp"

namespace holonomic::HOL_ISA {

namespace {

// Lanes that there are bodies for.
unsigned used_lanes(const BodyUnit &unit, mask good) { return bits(good & first_lanes(unit.count)); }

template <int R>
unsigned forces_of(const ForcesCall &call, const BodyUnit &unit, vec3 *scratch, BodyResult *results) {
    const BodyKind &kind = *unit.kind;
    const long n = kind.n_atoms;
    vec3 *const x = scratch, *const y = scratch + n;
    read_bodies(call.r, unit, y);
    const Frame<R> at = axes_of<R>(kind, call.box, y, x);
    Frame<R> z{};
    if (call.f.x) {
        read_bodies(call.f, unit, y);
        const double *place = kind.place;
        for (long a = 0; a < n; ++a, place += 1 + R) z.add(place, y[a]);
        HOL_UNROLL_FEW
        for (int k = 0; k <= R; ++k) z[k] = splat(kind.inverse_mass) * z[k];
    }
    const Symmetric<R> s = products(at);
    Symmetric<R> b = both_products(at, z);
    mask good = at.is_finite();
    if (call.v.x) {
        read_bodies(call.v, unit, x);
        const Frame<R> rate = rates_of<R, false>(kind, x);
        good = good & rate.is_finite();
        const Symmetric<R> square = products(rate);
        for (int p = 0; p < R; ++p)
            for (int q = 0; q < R; ++q) b.of[p][q] = b.of[p][q] + 2 * square.of[p][q];
    }
    const Symmetric<R> lambda = solve(kind, s, b, good);
    take_away(z, at, lambda);
    good = good & z.is_finite();
    const unsigned lanes = used_lanes(unit, good);
    if (call.virial) write_virial(at, lambda, kind.mass, results);
    if (!call.g.x || lanes == 0) return lanes;
    if (call.add) read_bodies(call.g, unit, x);
    const double *place = kind.place;
    for (long a = 0; a < n; ++a, place += 1 + R) {
        const vec m = splat(kind.masses[a]);
        const vec3 f = call.f.x ? y[a] : vec3{}, u = z.at(place);
        const vec3 g = {mul_sub(m, u.x, f.x), mul_sub(m, u.y, f.y), mul_sub(m, u.z, f.z)};
        x[a] = call.add ? x[a] + g : g;
    }
    write_bodies(call.g, unit, x, lanes);
    return lanes;
}

template <int R>
unsigned velocities_of(const VelocitiesCall &call, const BodyUnit &unit, vec3 *scratch, BodyResult *results) {
    const BodyKind &kind = *unit.kind;
    const long n = kind.n_atoms;
    vec3 *const x = scratch, *const v = scratch + n;
    read_bodies(call.r, unit, v);
    const Frame<R> at = axes_of<R>(kind, call.box, v, x);
    read_bodies(call.v, unit, v);
    Frame<R> rate = rates_of<R, true>(kind, v);
    const Symmetric<R> s = products(at);
    mask good = at.is_finite() & rate.is_finite();
    const Symmetric<R> lambda = solve(kind, s, both_products(at, rate), good);
    take_away(rate, at, lambda);
    // What rounding leaves of the rates goes with a second projection.
    take_away(rate, at, first_solution(kind, both_products(at, rate)));
    if (call.virial) write_virial(at, lambda, kind.mass, results);
    good = good & rate.is_finite();
    const unsigned lanes = used_lanes(unit, good);
    if (lanes == 0) return lanes;
    const double *place = kind.place, *low = kind.place_low;
    for (long a = 0; a < n; ++a, place += 1 + R, low += 1 + R) v[a] = rate.at(place, low);
    write_bodies(call.v, unit, v, lanes);
    return lanes;
}

// Newton's method for U^T U = L^2, along `from`. Its matrix is all but diagonal: corrections by the diagonal stand for
// its solution. Where an error will be below rounding after a correction, it is not looked at again.
template <int R>
struct Restored {
    Frame<R> u;
    Symmetric<R> total{};
    mask good;
    vec error{};
    int iterations[W] = {};

    HOL_FORCED Restored(const BodyKind &kind, const Frame<R> &from, const Frame<R> &trial, int most) : u(trial) {
        good = from.is_finite() & trial.is_finite();
        mask busy = good;
        vec before = splat(1);
        for (int round = 0; round < most && any(busy); ++round) {
            Symmetric<R> e = products(u);
            vec x[R][R];
            const vec now = largest_error(kind, e);
            mask sound = finite(now);
            HOL_UNROLL_FEW
            for (int p = 0; p < R; ++p) {
                HOL_UNROLL_FEW
                for (int q = 0; q < R; ++q) x[p][q] = dot(u[1 + p], from[1 + q]);
                e.of[p][p] = e.of[p][p] - kind.square[p];
                sound = sound & less(splat(0.3 * kind.square[p]), x[p][p]);
            }
            good = good & (sound | ~busy);
            const vec enough = splat(3 * epsilon);
            busy =
                busy & sound & ~less_equal(now, enough) & ~(less(now, 32 * epsilon - vec{}) & less(0.5 * before, now));
            if (!any(busy)) break;
            Symmetric<R> step = first_solution(kind, e);
            correct(kind, x, e, busy, step);
            correct(kind, x, e, busy, step);
            HOL_UNROLL_FEW
            for (int p = 0; p < R; ++p) {
                HOL_UNROLL_FEW
                for (int q = 0; q < R; ++q) {
                    step.of[p][q] = keep(busy, step.of[p][q]);
                    total.of[p][q] = total.of[p][q] + step.of[p][q];
                }
            }
            take_away(u, from, step);
            const unsigned moving = bits(busy);
            for (int l = 0; l < W; ++l) iterations[l] += static_cast<int>(moving >> l & 1);
            busy = busy & ~less(16 * now * now, epsilon * before);
            before = now;
        }
        good = good & ~busy;
    }
};

// Velocities of sites are those of the body at their places.
template <int R>
HOL_NOINLINE void carry_sites(const BodyKind &kind, vec3 *v) {
    const Frame<R> rate = rates_of<R, false>(kind, v);
    const double *place = kind.place;
    for (long a = 0; a < kind.n_atoms; ++a, place += 1 + R)
        if (kind.masses[a] == 0) v[a] = rate.at(place);
}

// The trial less the reference, t, has a frame of its own; what is off the frame goes, and the rest is brought back. So
// the rounding of all moves is relative to t.
template <int R>
unsigned positions_of(const PositionsCall &call, const BodyUnit &unit, vec3 *scratch, BodyResult *results) {
    const BodyKind &kind = *unit.kind;
    const long n = kind.n_atoms;
    vec3 *const raw = scratch, *const t = scratch + n, *const v = scratch + 2 * n;
    read_bodies(call.r_ref, unit, raw);
    unfold(kind, call.box_ref, raw, t);
    const Frame<R> from = frame_of<R>(kind, t);
    read_bodies(call.r, unit, raw);
    unfold(kind, call.box, raw, t);
    Frame<R> change{}, trial;
    const double *place = kind.place, *share = kind.share, *low = kind.share_low;
    for (long a = 0; a < n; ++a, place += 1 + R, share += 1 + R, low += 1 + R) {
        t[a] = t[a] - from.at(place);
        change.add(low, t[a]);
        change.add(share, t[a]);
    }
    HOL_UNROLL_FEW
    for (int k = 0; k <= R; ++k) trial[k] = from[k] + change[k];
    Restored<R> restored(kind, from, trial, call.max_iterations < 40 ? call.max_iterations : 40);
    take_away(change, from, restored.total);
    vec largest = {};
    place = kind.place, low = kind.place_low;
    for (long a = 0; a < n; ++a, place += 1 + R, low += 1 + R) {
        const vec3 moved = change.at(place, low) - t[a];
        largest = max(max(max(largest, abs(moved.x)), abs(moved.y)), abs(moved.z));
        t[a] = moved;
        raw[a] = raw[a] + moved;
    }
    // Crude or rigid already: the general solver decides.
    const mask good = restored.good & less(largest, splat(0.5 * kind.extent)) &
                      ~less(largest, splat((call.r.is_float ? 1e-5 : 1e-10) * kind.extent));
    const unsigned lanes = used_lanes(unit, good);
    if (lanes == 0) return lanes;
    if (call.virial) write_virial(from, restored.total, kind.mass / (call.dt * call.dt), results);
    if (call.report) {
        const vec error = largest_error(kind, products(restored.u));
        for (int l = 0; l < W; ++l) {
            results[l].error = error[l];
            results[l].iterations = restored.iterations[l];
        }
    }
    write_bodies(call.r, unit, raw, lanes);
    if (!call.v.x) return lanes;
    read_bodies(call.v, unit, v);
    const double per_dt = 1 / call.dt;
    for (long a = 0; a < n; ++a) v[a] = add_times(v[a], splat(per_dt), t[a]);
    if (kind.has_sites) carry_sites<R>(kind, v);
    write_bodies(call.v, unit, v, lanes);
    return lanes;
}

}  // namespace

int64_t bodies_scratch_bytes(int64_t n_atoms) { return 9 * n_atoms * static_cast<int64_t>(sizeof(vec)); }

unsigned bodies_forces(const ForcesCall &call, const BodyUnit &unit, double *scratch, BodyResult *results) {
    return choose_number<1, 3>(unit.kind->rank, [&](auto rank) {
        return forces_of<rank>(call, unit, reinterpret_cast<vec3 *>(scratch), results);
    });
}

unsigned bodies_velocities(const VelocitiesCall &call, const BodyUnit &unit, double *scratch, BodyResult *results) {
    return choose_number<1, 3>(unit.kind->rank, [&](auto rank) {
        return velocities_of<rank>(call, unit, reinterpret_cast<vec3 *>(scratch), results);
    });
}

unsigned bodies_positions(const PositionsCall &call, const BodyUnit &unit, double *scratch, BodyResult *results) {
    return choose_number<1, 3>(unit.kind->rank, [&](auto rank) {
        return positions_of<rank>(call, unit, reinterpret_cast<vec3 *>(scratch), results);
    });
}

}  // namespace holonomic::HOL_ISA
