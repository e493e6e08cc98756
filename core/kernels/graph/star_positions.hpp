// Positions of stars: a block in registers; what that does not answer for is left to the general path.
#ifndef HOLONOMIC_KERNELS_GRAPH_STAR_POSITIONS_HPP
#define HOLONOMIC_KERNELS_GRAPH_STAR_POSITIONS_HPP

#include "core/kernels/graph/schedule.hpp"
#include "core/kernels/graph/star.hpp"
#include "core/kernels/graph/store.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

// The centre of a star of N bonds without fixed atoms; -1 if a shape is none.
template <int N>
static inline int centre_of_star(const Schedule &s) {
    if (s.type != Schedule::tree || s.n_bonds != N) return -1;
    for (int a = 0; a <= N; ++a)
        if (s.fixed[a]) return -1;
    for (int c = 0; c <= N; ++c) {
        bool all = true;
        for (int k = 0; k < N; ++k) all = all && (s.atom_i[k] == c || s.atom_j[k] == c);
        if (all) return c;
    }
    return -1;
}

// To the front, and back to its place.
template <class V>
HOL_NOINLINE void move_centre(Vector3<V> *atoms, int from, int to) {
    const Vector3<V> c = atoms[from];
    for (; from > to; --from) atoms[from] = atoms[from - 1];
    for (; from < to; ++from) atoms[from] = atoms[from + 1];
    atoms[to] = c;
}

template <Layout layout, int N, class V>
struct StarPositions {
    const PositionsCall &call;
    const MoleculeLane *lane;
    const Atoms<V> &at;
    const StarKind<N, V> &m;
    const int centre;
    Tally &tally;
    int64_t molecule(int i) const { return lane[i].molecule; }

    inline HOL_FORCED void read_atoms(const AtomArray &array, Vector3<V> *r) const {
        read_all<layout, N + 1>(array, at, r);
        if (__builtin_expect(centre == 0, 1)) return;
        Vector3<V> atoms[N + 1];
        copy(r, atoms);
        move_centre(atoms, centre, 0);
        copy(atoms, r);
    }
    inline HOL_FORCED void write_atoms(const AtomArray &array, Vector3<V> *r, unsigned which) const {
        if (__builtin_expect(centre != 0, 0)) {
            Vector3<V> atoms[N + 1];
            copy(r, atoms);
            move_centre(atoms, 0, centre);
            copy(atoms, r);
        }
        write_all<layout, N + 1>(array, at, r, which);
    }
    HOL_INLINE void copy(const Vector3<V> *from, Vector3<V> *to) {
        HOL_UNROLL
        for (int k = 0; k <= N; ++k) to[k] = from[k];
    }
    HOL_INLINE void take_bonds(const Vector3<V> *r, const Box &box, Vector3<V> *d) {
        HOL_UNROLL
        for (int k = 0; k < N; ++k) d[k] = r[k + 1] - r[0];
        take_images<N>(box, d);
    }

    // D.D - a^2, and the largest part of a^2.
    inline HOL_FORCED V measure(const Vector3<V> *D, V *left) const {
        V worst = {}, sum = {};
        HOL_UNROLL
        for (int k = 0; k < N; ++k) {
            left[k] = mul_add(D[k].z, D[k].z, mul_add(D[k].y, D[k].y, mul_add(D[k].x, D[k].x, -m.a2[k])));
            worst = max(abs(left[k]) * m.per_a2[k], worst);
            sum = sum + left[k];
        }
        return mul_add(sum, V{}, worst);  // max() may lose a NaN, the sum keeps it
    }

    // Displacements by tau, and the bonds as they move.
    inline HOL_FORCED void move(const V *tau, const Vector3<V> *b, Vector3<V> *shift, Vector3<V> *D) const {
        Vector3<V> pull = tau[0] * b[0];
        HOL_UNROLL
        for (int k = 1; k < N; ++k) pull = add_times(pull, tau[k], b[k]);
        shift[0] = m.w[0] * pull;
        HOL_UNROLL
        for (int k = 0; k < N; ++k) {
            shift[k + 1] = (-m.w[k + 1] * tau[k]) * b[k];
            D[k] = D[k] + (shift[k + 1] - shift[0]);
        }
    }

    // Lanes in which pulls on an atom are so large that their rounding is more than the coordinates'.
    inline HOL_FORCED MaskOf<V> coarse_moves(const V *tau, V largest) const {
        V pull = {};
        HOL_UNROLL
        for (int k = 0; k < N; ++k) pull = max(max(m.w[0], m.w[k + 1]) * abs(tau[k]), pull);
        return less(0.25 * (largest + m.a_min), pull * m.a_max);
    }

    // The lanes of `in_use`. Returns those that are done.
    __attribute__((noinline)) unsigned solve(MaskOf<V> in_use) const {
        Vector3<V> r[N + 1], b[N], D[N], shift[N + 1];
        V sigma[N], tau[N];
        read_atoms(call.r_ref, r);
        take_bonds(r, call.box_ref, b);
        read_atoms(call.r, r);
        take_bonds(r, call.box, D);
        V largest = {};
        HOL_UNROLL
        for (int k = 0; k <= N; ++k) largest = max(max(abs(r[k].x), abs(r[k].y)), max(abs(r[k].z), largest));
        V error = measure(D, sigma);
        const Limits<V> limits(call, largest, m.a_min);
        const MaskOf<V> untouched = in_use & less_equal(error, limits.accepted), wanted = in_use & ~untouched;
        MaskOf<V> unsure = wanted;
        const StarModel<N, V> model(m, b, D, sigma);
        const int64_t solves = solve_for_multipliers<N>(model, tau, unsure);
        HOL_UNROLL
        for (int k = 0; k < N; ++k) tau[k] = keep(wanted, tau[k]);
        move(tau, b, shift, D);
        V left[N];
        error = measure(D, left);
        const unsigned moved =
                           bits(wanted & ~unsure & less_equal(error, limits.enough()) & ~coarse_moves(tau, largest)),
                       good = moved | bits(untouched);
        if (call.report) {
            HOL_UNROLL
            for (int k = 0; k < N; ++k) left[k] = abs(left[k]) * m.per_a2[k];
            note_worst_bond<N>(left, *this, error, good, tally);
        }
        if (call.lambda) write_multipliers(tau, good);
        if (!moved) return good;
        if (call.virial) add_virial(b, tau, moved);
        HOL_UNROLL
        for (int k = 0; k <= N; ++k) r[k] = r[k] + shift[k];
        write_atoms(call.r, r, moved);
        if (call.v.x) {
            const V per_dt = Width<V>::all(1 / call.dt);
            read_atoms(call.v, r);
            HOL_UNROLL
            for (int k = 0; k <= N; ++k) r[k] = add_times(r[k], per_dt, shift[k]);
            write_atoms(call.v, r, moved);
        }
        tally.n_corrected += __builtin_popcount(moved);
        if (solves > tally.iterations) tally.iterations = solves;
        return good;
    }

    inline HOL_FORCED void write_multipliers(const V *tau, unsigned which) const {
        const V factor = Width<V>::all(0.5 / (call.dt * call.dt));
        V value[N];
        HOL_UNROLL
        for (int k = 0; k < N; ++k) value[k] = mul_add(tau[k], factor, V{});
        if (N == 3) return write_three<layout>(call.lambda, at, {value[0], value[1], value[2]}, which);
        for (int i = 0; i < at.lanes; ++i)
            for (int k = 0; k < N; ++k)
                if (which >> i & 1) call.lambda[at.bond[i] + k] = Width<V>::get(value[k], i);
    }

    // Of copies, so that the bonds themselves need not be in memory.
    inline HOL_FORCED void add_virial(const Vector3<V> *b, const V *tau, unsigned which) const {
        Vector3<V> bonds[N];
        V pulls[N];
        HOL_UNROLL
        for (int k = 0; k < N; ++k) {
            bonds[k] = b[k];
            pulls[k] = tau[k];
        }
        add_bonds_virial<N>(bonds, pulls, 1 / (call.dt * call.dt), which, tally);
    }
};

// Stars of N bonds; `general` does any molecule.
template <int N, class General>
struct StarWork {
    const PositionsCall &call;
    const General &general;
    const int centre;
    const bool packed;
    Tally &tally;
    StarKind<N, vec> known;
    StarKind<N, double> known_one;
    StarKind<N, vec> &kind_for(vec *) { return known; }
    StarKind<N, double> &kind_for(double *) { return known_one; }

    template <class V>
    void block(const MoleculeLane *lane, int used, bool same, double *scratch) {
        StarKind<N, V> &kind = kind_for(static_cast<V *>(nullptr));
        if (!same) kind.set(lane, used, centre);
        const Atoms<V> at(lane, Width<V>::lanes);
        const MaskOf<V> in_use = Width<V>::first(used);
        const unsigned good = with_layout(at, packed, [&](auto layout) {
            return StarPositions<decltype(layout)::value, N, V>{call, lane, at, kind, centre, tally}.solve(in_use);
        });
        for (unsigned rest = bits(in_use) & ~good; __builtin_expect(rest != 0, 0); rest &= rest - 1)
            general.template block<double>(lane + __builtin_ctz(rest), 1, false, scratch);
    }
};

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
