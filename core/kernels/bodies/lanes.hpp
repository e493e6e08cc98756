// Sums over the atoms of W rigid bodies, and what comes back to the atoms.
#pragma once

#include "core/kernels/bodies/atoms.hpp"
#include "core/kernels/bodies/off_plane.hpp"

namespace holonomic::HOL_ISA {

// The axes of vectors, taken from the first one. From: rows, or vectors.
HOL_INLINE vec3 first_of(const vec3 *x) { return {x[0].x, x[0].y, x[0].z}; }
template <class Each>
HOL_INLINE void for_each_of_rows(const vec3 *x, long a, long n, const Each &each) {
    for (; a < n; ++a) each(a, x[a]);
}
template <int R, class From>
HOL_NOINLINE void sum_axes(const From from, const BodyKind &kind, Frame<R> &to) {
    const double *const share = kind.share;
    Frame<R> sum;
    sum.clear();
    const vec3 origin = first_of(from);
    for_each_of_rows(from, 1, kind.n_atoms,
                     [&](long a, const vec3 &x) HOL_FORCED { sum.template take<1>(share + a * (1 + R), origin - x); });
    HOL_UNROLL_FEW
    for (int p = 1; p <= R; ++p) put(to[p], splat(kind.scale) * sum[p]);
}

// The sums of vectors by weights. Of forces they are taken per moment, the centre's weights are 1, and vectors are
// kept. Of rates and moves the excess of shares is taken; of rough rates, which no body takes into its next step, but
// its largest part. of_rough_axes: the centre is not wanted.
enum WhichSums { of_forces, of_rates, of_rough_rates, of_rough_axes };
template <int R, WhichSums what, class From>
HOL_NOINLINE void sum_all(const From from, const BodyKind &kind, const double *weights, long n, Frame<R> &to,
                          vec3 *kept = nullptr) {
    constexpr int first = what == of_rough_axes;
    Frame<R> sum;
    sum.clear();
    for_each_of_rows(from, 0, n, [&](long a, const vec3 &x) HOL_FORCED {
        if (what == of_forces) {
            put(kept[a], x);
            put(sum[0], sum[0] + x);
        }
        sum.template add<what == of_forces ? 1 : first>(weights + a * (1 + R), x);
    });
    if (what == of_rates) return take_excess(kind, sum, to);
    HOL_UNROLL_FEW
    for (int k = first; k <= R; ++k) put(to[k], splat(what == of_forces ? kind.per_moment[k] : kind.scale) * sum[k]);
}

// What vectors, taken from the first one, are off those of the axes. Returns the largest square.
template <int R, class From>
HOL_NOINLINE vec take_axes(const From from, const BodyKind &kind, const Frame<R> &__restrict axes, vec3 *off) {
    Frame<R> base;
    put(base[0], vec3{} - first_of(from));
    HOL_UNROLL_FEW
    for (int p = 1; p <= R; ++p) put(base[p], axes[p]);
    const double *const coordinates = kind.coordinates;
    const vec3 origin = base.at(coordinates);
    vec largest = {};
    for_each_of_rows(from, 0, kind.n_atoms, [&](long a, const vec3 &x) HOL_FORCED {
        vec3 t = x + origin;
        HOL_UNROLL_FEW
        for (int p = 1; p <= R; ++p) t = less_times(t, splat(coordinates[a * (1 + R) + p]), base[p]);
        put(off[a], t);
        largest = max(largest, dot(t, t));
    });
    return largest;
}

template <int R>
HOL_NOINLINE void write_at(const BodyKind &kind, const Frame<R> &__restrict frame, const BodyRows to) {
    const Frame<R> f = frame;
    const double *const coordinates = kind.coordinates;
    write_rows(to, kind.n_atoms, [&](long a) HOL_FORCED { return f.at(coordinates + a * (1 + R)); });
}

// m times the acceleration, less the force.
template <int R>
HOL_INLINE vec3 force_at(const Frame<R> &z, const double *coordinates, const double *masses, const vec3 *f, long a) {
    const vec3 u = z.at(coordinates + a * (1 + R));
    const vec m = splat(masses[a]);
    return {mul_sub(m, u.x, f[a].x), mul_sub(m, u.y, f[a].y), mul_sub(m, u.z, f[a].z)};
}
template <int R>
HOL_NOINLINE void write_forces_at(const BodyKind &kind, const Frame<R> &__restrict z, const vec3 *f,
                                  const BodyRows to) {
    const Frame<R> u = z;
    const double *const coordinates = kind.coordinates, *const masses = kind.masses;
    write_rows(to, kind.n_atoms, [&](long a) HOL_FORCED { return force_at(u, coordinates, masses, f, a); });
}

template <int R>
HOL_NOINLINE void add_moves(const BodyKind &kind, const Frame<R> &__restrict change, const vec3 *off, const BodyRows r,
                            const BodyRows v, double per_dt) {
    const Frame<R> t = change;
    const double *const coordinates = kind.coordinates;
    add_rows(r, v, kind.n_atoms, per_dt, [&](long a) HOL_FORCED { return t.at(coordinates + a * (1 + R)) - off[a]; });
}

// Of a block, in doubles.
HOL_INLINE int64_t scratch_of_block(int64_t n_atoms) { return 9 * n_atoms * W; }

template <int R>
struct BodyLanes : BodyBlock {
    vec3 *const x, *const y;  // [n_atoms] each
    double *const copy;       // of rows
    int64_t first_of_copy[W];

    BodyLanes(const BodyKind &k, double *scratch)
        : BodyBlock(k), x(reinterpret_cast<vec3 *>(scratch)), y(x + k.n_atoms),
          copy(reinterpret_cast<double *>(y + k.n_atoms)) {}

    // Stages that not every verb has (verbs/bodies.cpp).
    HOL_FORCED void compare() {}
    HOL_FORCED void find_turn() {}

    // Calls with(From) for the coordinates, or where there is a box for those of images from the first atom's.
    template <class With>
    HOL_FORCED void with_places(const AtomArray &array, const Box &box, const With &with) {
        const BodyRows rows = rows_of(array);
        if (__builtin_expect(box.lattice == Box::none, 1)) return with(rows);
        read_vectors(rows, kind.n_atoms, x);
        unfold(kind, box, x, y);
        with(static_cast<const vec3 *>(y));
    }
    HOL_FORCED void positions(const AtomArray &array, const Box &box, Frame<R> &to) {
        with_places(array, box, [&](auto from) HOL_FORCED { sum_axes<R>(from, kind, to); });
    }

    // Velocities of the atoms that have mass; what sites have is not looked at. Not from the first one's: it may be
    // that of a light atom which is far faster than all others.
    template <WhichSums what = of_rates>
    HOL_FORCED void rates(const AtomArray &array, Frame<R> &to) {
        sum_all<R, what>(rows_of(array, kind.has_sites_between), kind, kind.share, kind.n_heavy, to);
    }
    // Over masses; they are kept in y.
    HOL_FORCED void forces(const AtomArray &array, Frame<R> &to) {
        if (!array.x) {
            to.clear();
            for (long a = 0; a < kind.n_atoms; ++a) y[a].x = y[a].y = y[a].z = vec{};
            return;
        }
        sum_all<R, of_forces>(rows_of(array), kind, kind.coordinates, kind.n_atoms, to, y);
    }

    HOL_FORCED void write_forces(const ForcesCall &call, const Frame<R> &z, unsigned lanes) {
        const bool in_rows = takes_rows(call.g, lanes);
        if (__builtin_expect(in_rows && !call.add, 1)) return write_forces_at(kind, z, y, rows(call.g));
        for (long a = 0; a < kind.n_atoms; ++a) put(y[a], force_at(z, kind.coordinates, kind.masses, y, a));
        if (in_rows)
            add_rows(rows(call.g), {nullptr, first}, kind.n_atoms, 1, [&](long a) HOL_FORCED { return y[a]; });
        else if (call.add)
            add_some(call.g, 1, y, lanes);
        else
            write_some(call.g, y, lanes);
    }
    HOL_FORCED void write_velocities(const AtomArray &array, const Frame<R> &axes, const Frame<R> &rate,
                                     unsigned lanes) {
        write_rates(array, rate, lanes);
        if (has_off_plane<R>(kind)) write_site_velocities(array, axes, rate, nullptr, lanes);
    }
    HOL_FORCED void write_rates(const AtomArray &array, const Frame<R> &rate, unsigned lanes) {
        if (takes_rows(array, lanes)) return write_at(kind, rate, rows(array));
        for (long a = 0; a < kind.n_atoms; ++a) put(x[a], rate.at(kind.coordinates + a * (1 + R)));
        write_some(array, x, lanes);
    }

    // What positions are off those of the axes, in x; whether none is far.
    HOL_FORCED mask changes(const AtomArray &array, const Box &box, const Frame<R> &axes, Frame<R> &to) {
        vec largest;
        with_places(array, box, [&](auto from) HOL_FORCED { largest = take_axes<R>(from, kind, axes, x); });
        sum_all<R, of_rates>(static_cast<const vec3 *>(x), kind, kind.share, kind.n_atoms, to);
        return less(largest, splat(4 * kind.extent * kind.extent));
    }
    // Takes the normal of these axes, times heights, from what changes() has left in x.
    void take_heights(const Frame<R> &axes) {
        if constexpr (R == 2) {
            const vec3 normal = normal_of(axes);
            for (long a = 0; a < kind.n_atoms; ++a) put(x[a], less_times(x[a], splat(kind.height[a]), normal));
        }
    }
    // Moves atoms to where their changes are those of a frame, and velocities by these moves over dt.
    HOL_FORCED void write_moves(const PositionsCall &call, const Frame<R> &change, unsigned lanes) {
        const double per_dt = 1 / call.dt;
        if (takes_rows(call.r, lanes) && (!call.v.x || takes_rows(call.v, lanes)))
            return add_moves(kind, change, x, rows(call.r), rows(call.v), per_dt);
        for (long a = 0; a < kind.n_atoms; ++a) put(x[a], change.at(kind.coordinates + a * (1 + R)) - x[a]);
        add_some(call.r, 1, x, lanes);
        if (call.v.x) add_some(call.v, per_dt, x, lanes);
    }
    // axes: those that belong to the rate; flow: what flows with the box, or null.
    __attribute__((noinline)) void write_site_velocities(const AtomArray &array, const Frame<R> &axes,
                                                         const Frame<R> &rate, const double *flow,
                                                         unsigned lanes) const {
        vec3 turn = {};
        if constexpr (R == 2)
            if (kind.height) turn = normal_rate(axes, rate, flow);
        for (long a = 0; a < kind.n_atoms; ++a) {
            if (kind.masses[a] != 0) continue;
            vec3 u = rate.at(kind.coordinates + a * (1 + R));
            if (kind.height) u = add_times(u, splat(kind.height[a]), turn);
            if (takes_rows(array, lanes)) {
                double *r[W], *to[W];
                rows_at(rows(array), 0, r);
                rows_at(r, 3 * a, to);
                graph::write_elements<3>(to, &u);
                continue;
            }
            for (int l = 0; l < W; ++l) {
                const double one[3] = {u.x[l], u.y[l], u.z[l]};
                if (lanes >> l & 1) write_atom(array, atoms[l][a], one);
            }
        }
    }

private:
    HOL_FORCED BodyRows rows_of(const AtomArray &array, bool without_sites = false) {
        if (__builtin_expect(without_sites || !in_a_row(array), 0))
            return copy_rows(array, copy, first_of_copy, without_sites);
        return rows(array);
    }
    HOL_FORCED bool takes_rows(const AtomArray &array, unsigned lanes) const {
        return in_a_row(array) && lanes == all_lanes;
    }
};

}  // namespace holonomic::HOL_ISA
