// Sums over the atoms of W rigid bodies, and what comes back to the atoms.
#ifndef HOLONOMIC_KERNELS_BODIES_LANES_HPP
#define HOLONOMIC_KERNELS_BODIES_LANES_HPP

#include "core/kernels/bodies/atoms.hpp"

namespace holonomic::HOL_ISA {

template <int R>
struct BodyLanes {
    const BodyBlock &block;
    const BodyKind &kind;
    vec3 *const x, *const y;  // [n_atoms] each
    double *const copy;       // of rows

    HOL_FORCED BodyLanes(const BodyBlock &b, double *scratch)
        : block(b), kind(b.kind), x(reinterpret_cast<vec3 *>(scratch)), y(x + kind.n_atoms),
          copy(reinterpret_cast<double *>(y + kind.n_atoms)) {}

    // Calls each(a, coordinates from the first atom's).
    template <class Each>
    HOL_FORCED void for_each_place(const AtomArray &array, const Box &box, const Each &each) {
        const double *rows[W];
        block.rows(array, copy, rows);
        if (__builtin_expect(box.shape != Box::none, 0)) {
            unfold(kind, box, rows, x, y);
            for (long a = 0; a < kind.n_atoms; ++a) each(a, y[a]);
            return;
        }
        const vec3 origin = atom_of_rows(rows, 0);
        const vec ox = origin.x, oy = origin.y, oz = origin.z;
        for (long a = 0, n = kind.n_atoms; a < n; ++a) {
            const vec3 r = atom_of_rows(rows, a);
            each(a, vec3{r.x - ox, r.y - oy, r.z - oz});
        }
    }

    template <int first>
    HOL_FORCED void positions(const AtomArray &array, const Box &box, Frame<R> &to) {
        Frame<R> sum;
        sum.clear();
        const double *share = kind.share;
        for_each_place(array, box, [&](long, const vec3 &r) HOL_FORCED {
            sum.template add<first>(share, r);
            share += 1 + R;
        });
        to = sum;
    }

    // Velocities of the atoms that have mass; what sites have is not looked at. first: 1 leaves out the centre's.
    template <int first>
    HOL_FORCED void rates(const AtomArray &array, Frame<R> &to) {
        Frame<R> sum;
        sum.clear();
        const double *rows[W];
        block.rows(array, copy, rows);
        const double *share = kind.share;
        const double *const masses = kind.has_sites ? kind.masses : nullptr;
        for (long a = 0; a < kind.n_atoms; ++a, share += 1 + R)
            if (!masses || masses[a] != 0) sum.template add<first>(share, atom_of_rows(rows, a));
        to = sum;
    }
    // Of the masses.
    HOL_FORCED void forces(const AtomArray &array, Frame<R> &to) {
        Frame<R> sum;
        sum.clear();
        const double *rows[W];
        block.rows(array, copy, rows);
        const double *place = kind.place;
        vec3 *kept = y;
        for (long a = 0, n = kind.n_atoms; a < n; ++a, place += 1 + R) {
            const vec3 f = atom_of_rows(rows, a);
            put(*kept++, f);
            sum.add(place, f);
        }
        HOL_UNROLL_FEW
        for (int k = 0; k <= R; ++k) put(to[k], splat(kind.inverse_mass) * sum[k]);
    }

    // m times the acceleration, less the force that was read last.
    HOL_FORCED void write_forces(const ForcesCall &call, const Frame<R> z, unsigned lanes) {
        if (!call.f.x)
            for (long a = 0; a < kind.n_atoms; ++a) y[a].x = y[a].y = y[a].z = vec{};
        const auto force = [&](long a) HOL_FORCED {
            const vec m = splat(kind.masses[a]);
            const vec3 u = z.at(kind.place + a * (1 + R));
            return vec3{mul_sub(m, u.x, y[a].x), mul_sub(m, u.y, y[a].y), mul_sub(m, u.z, y[a].z)};
        };
        double *to[W];
        if (rows_to_write(call.g, lanes, to) && !call.add) return write_rows(kind, to, force);
        for (long a = 0; a < kind.n_atoms; ++a) put(y[a], force(a));
        if (!call.add)
            block.write_some(call.g, y, lanes);
        else
            add(call.g, 1, lanes, y);
    }
    HOL_FORCED void write_velocities(const AtomArray &array, const Frame<R> rate, unsigned lanes) {
        const auto velocity = [&](long a) HOL_FORCED { return rate.at(kind.place + a * (1 + R)); };
        double *to[W];
        if (rows_to_write(array, lanes, to)) return write_rows(kind, to, velocity);
        for (long a = 0; a < kind.n_atoms; ++a) put(x[a], velocity(a));
        block.write_some(array, x, lanes);
    }

    // What positions, from the first atom's, are off `from`, and the frame of that.
    HOL_FORCED void changes(const AtomArray &array, const Box &box, const Frame<R> from, Frame<R> &to) {
        Frame<R> sum;
        sum.clear();
        const double *place = kind.place, *share = kind.share;
        vec3 *t = x;
        for_each_place(array, box, [&](long, const vec3 &r) HOL_FORCED {
            const vec3 off = r - from.at(place);
            put(*t++, off);
            sum.add(share, off);
            place += 1 + R;
            share += 1 + R;
        });
        to = sum;
    }
    // Moves by which these changes become those of a frame; returns the sum of their squares.
    HOL_FORCED vec moves(const Frame<R> change) {
        vec sum[3] = {vec{}, vec{}, vec{}};
        for (long a = 0; a < kind.n_atoms; ++a) {
            const vec3 m = change.at(kind.place + a * (1 + R)) - x[a];
            sum[0] = mul_add(m.x, m.x, sum[0]);
            sum[1] = mul_add(m.y, m.y, sum[1]);
            sum[2] = mul_add(m.z, m.z, sum[2]);
            put(x[a], m);
        }
        return sum[0] + sum[1] + sum[2];
    }
    // Adds the moves to positions, and per_dt times them to velocities.
    HOL_FORCED void write_moves(const PositionsCall &call, unsigned lanes) {
        const double per_dt = 1 / call.dt;
        double *r[W], *v[W];
        if (rows_to_write(call.r, lanes, r) && (!call.v.x || rows_to_write(call.v, lanes, v))) {
            add_rows(kind, r, call.v.x ? v : nullptr, per_dt, x);
        } else {
            block.add_some(call.r, 1, x, lanes);
            if (call.v.x) block.add_some(call.v, per_dt, x, lanes);
        }
    }
    // Velocities of sites are those of the body at their places.
    HOL_FORCED void write_sites(const AtomArray &array, const Frame<R> rate, unsigned lanes) const {
        for (long a = 0; a < kind.n_atoms; ++a) {
            if (kind.masses[a] != 0) continue;
            const vec3 u = rate.at(kind.place + a * (1 + R));
            double of[3][W];
            store(of[0], u.x);
            store(of[1], u.y);
            store(of[2], u.z);
            for (int l = 0; l < W; ++l) {
                const double one[3] = {of[0][l], of[1][l], of[2][l]};
                if (lanes >> l & 1) write_atom(array, block.atoms[l][a], one);
            }
        }
    }

private:
    HOL_FORCED bool rows_to_write(const AtomArray &array, unsigned lanes, double **to) const {
        if (!block.in_a_row(array) || lanes != all_lanes) return false;
        HOL_UNROLL
        for (int l = 0; l < W; ++l) to[l] = block.row(array, l);
        return true;
    }
    HOL_FORCED void add(const AtomArray &array, double factor, unsigned lanes, const vec3 *moves) const {
        double *to[W];
        if (rows_to_write(array, lanes, to))
            add_rows(kind, to, nullptr, factor, moves);
        else
            block.add_some(array, factor, moves, lanes);
    }
};

}  // namespace holonomic::HOL_ISA
#endif
