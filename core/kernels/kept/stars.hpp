// Kept factors of stars of three and four bonds, CH3, NH3 and CH4, in registers: bonds, and the inverse of theory (52)
// or (53d). star/linear.hpp has the equations, and solves them here, too; what its tests take from the matrix is kept.
#pragma once

#include "core/kernels/kept/blocks.hpp"
#include "core/kernels/kept/flagged.hpp"
#include "core/kernels/molecules/star/linear.hpp"

namespace holonomic::HOL_ISA::graph {

template <int N, class V>
struct KeptStar {
    double lanes[most_lanes];  // the first one: which are kept, bit by bit
    V w[N + 1], d[3 * N], q[N];
    V own[N], error[N];  // a multiplier alone, per right-hand side; (53a), in squares
    V inverse[N == 3 ? 7 : 11];

    void keep(const Star<N, V> &star, const V *masses, unsigned good) {
        lanes[0] = static_cast<double>(good);
        for (int k = 0; k <= N; ++k) w[k] = masses[k];
        const V shared = (w[0] * w[0]) * Width<V>::all(1 / (most_cancelled * most_cancelled));
        for (int k = 0; k < N; ++k) {
            const V of_one = star.of_one(k);
            put(*reinterpret_cast<Vector3<V> *>(d + 3 * k), star.d[k]);
            q[k] = star.q[k];
            own[k] = star.alone(k);
            error[k] = shared * (q[k] * (of_one * of_one));
        }
        keep_inverse(star);
    }
    inline HOL_FORCED void take(Star<N, V> &star) const {
        HOL_UNROLL
        for (int k = 0; k < N; ++k) {
            star.d[k] = {d[3 * k], d[3 * k + 1], d[3 * k + 2]};
            star.q[k] = q[k];
        }
        take_inverse(star);
    }

private:
    void keep_inverse(const Star<3, V> &star) {
        for (int k = 0, e = 0; k < 3; ++k)
            for (int l = k; l < 3; ++l, ++e) inverse[e] = star.adj[k][l];
        inverse[6] = star.r;
    }
    inline HOL_FORCED void take_inverse(Star<3, V> &star) const {
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) {
            HOL_UNROLL
            for (int l = k; l < 3; ++l) star.adj[k][l] = star.adj[l][k] = inverse[k == 0 ? l : k + l + 1];
        }
        star.r = inverse[6];
    }
    void keep_inverse(const Star<4, V> &star) {
        const FourBonds<V> &of = star.equations;
        const V all[11] = {of.per_a[0], of.per_a[1], of.per_a[2], of.per_a[3], of.N.x.x, of.N.x.y,
                           of.N.x.z,    of.N.y.y,    of.N.y.z,    of.N.z.z,    of.trace};
        for (int e = 0; e < 11; ++e) inverse[e] = all[e];
    }
    inline HOL_FORCED void take_inverse(Star<4, V> &star) const {
        FourBonds<V> &of = star.equations;
        of.w = w;
        of.b = star.d;
        HOL_UNROLL
        for (int k = 0; k < 4; ++k) {
            of.D[k] = star.d[k];
            of.per_a[k] = inverse[k];
        }
        const V *const m = inverse + 4;
        of.N = {{m[0], m[1], m[2]}, {m[1], m[3], m[4]}, {m[2], m[4], m[5]}};
        of.trace = m[6];
    }
};

// A star whose inverse is kept, for as long as it takes to solve.
template <int N, class V>
struct StarOfKept : Star<N, V> {
    const KeptStar<N, V> &kept;
    inline HOL_FORCED StarOfKept(const StarMasses<N, V> &masses, const KeptStar<N, V> &k)
        : Star<N, V>(masses), kept(k) {
        k.take(*this);
    }
    // What Star's says, of lanes in which nothing was lost.
    inline HOL_FORCED MaskOf<V> good(const V *y, const V *t) const {
        V T2 = {}, sum = {}, least = {}, size2[N];
        HOL_UNROLL
        for (int k = 0; k < N; ++k) {
            size2[k] = t[k] * t[k];
            T2 = k == 0 ? kept.q[0] * size2[0] : mul_add(kept.q[k], size2[k], T2);
            sum = k == 0 ? t[0] : sum + t[k];
        }
        HOL_UNROLL
        for (int k = 0; k < N; ++k) {
            const V alone = this->without_centre(k, y[k]) * kept.own[k],
                    left = mul_add(-T2, kept.error[k], mul_add(alone, alone, size2[k]));
            least = k == 0 ? left : min(left, least);
        }
        MaskOf<V> fine = ~less(least, V{});
        if (__builtin_expect(any(~fine), 0)) fine = fine | large_scales(*this, T2, y);
        if constexpr (N == 4) {
            const MaskOf<V> light = this->is_light();
            if (__builtin_expect(any(light), 0))
                fine = (fine & ~light) | (light & this->equations.keeps_digits(kept.q, y));
        }
        return finite(sum) & fine;
    }
    // The lanes in which the scales themselves are as large as the errors: |S^-1| times the right-hand sides, which are
    // no larger than their terms.
    HOL_NOINLINE MaskOf<V> large_scales(const StarOfKept &star, const V T2, const V *y) {
        V least = {};
        for (int k = 0; k < N; ++k) {
            V scale = {};
            for (int l = 0; l < N; ++l)
                scale = mul_add(abs(star.of_inverse(k, l)), abs(star.without_centre(l, y[l])), scale);
            const V left = mul_add(-T2, star.kept.error[k], scale * scale);
            least = k == 0 ? left : min(left, least);
        }
        return ~less(least, V{});
    }
};

template <int N>
struct KeepStars {
    static constexpr bool in_steps = false;
    template <int, class V>
    using Kind = StarMasses<N, V>;
    const KeepCall &call;

    template <Inlined where, class V>
    __attribute__((noinline)) unsigned solve(const StarAtoms<where, N, V> &atoms, const MoleculeLane *lane,
                                             const StarMasses<N, V> &m, MaskOf<V> in_use) const {
        typedef KeptStar<N, V> Stored;
        double *const room =
            call.kept->room(call.kept->owner, lane[0].molecule, static_cast<int64_t>(sizeof(Stored) / sizeof(double)));
        if (!room) return 0;
        Vector3<V> r[N + 1];
        Star<N, V> star(m);
        atoms.read(call.r, r);
        atoms.take_bonds(r, call.box, star.d);
        star.invert();
        const unsigned good = bits(in_use & star.is_regular());
        reinterpret_cast<Stored *>(room)->keep(star, m.w, good);
        return good;
    }
};

// Stars that closed forms don't answer for.
struct LeaveStars {
    unsigned char *const left;
    NextMolecules &ahead;
    static constexpr bool packed = true;
    template <class V>
    void block(const MoleculeLane *lane, int, bool, double *) const {
        leave(lane, 1, left);
    }
};

template <int N>
struct SolveStars {
    const KeptCall &call;
    const MoleculeUnit &unit;
    double *const scratch;
    Tally &tally;

    void solve() const {
        for_each_kept_block(unit,
                            [&](const auto &at, int64_t first, int used) HOL_FORCED { this->block(at, first, used); });
    }

private:
    template <class V>
    inline HOL_FORCED void block(const Atoms<V> &at, int64_t first, int used) const {
        const double *const from = call.kept->block[number_of(unit, first)];
        if (!from) return;
        const KeptStar<N, V> &kept = *reinterpret_cast<const KeptStar<N, V> *>(from);
        const unsigned lanes = ((1u << used) - 1) & static_cast<unsigned>(kept.lanes[0]);
        const bool in_a_row = unit.regular && at.layout == rows_in_order && used == Width<V>::lanes;
        const unsigned good =
            in_a_row ? solve<adjacent>(at, kept, lanes) : where_atoms_are(at, [&](auto where) HOL_FORCED {
                return this->template solve<decltype(where)::value>(at, kept, lanes);
            });
        if (__builtin_expect((lanes & ~good) != 0, 0)) solve_rest(first, used, lanes & ~good);
    }
    __attribute__((noinline)) void solve_rest(int64_t first, int used, unsigned rest) const {
        MoleculeLane lane[W];
        for (int i = 0; i < used; ++i) lane[i] = molecule_of(unit, first + i);
        solve_extended(call, *unit.elimination, lane, rest, scratch, tally);
    }
    template <Inlined where, class V>
    __attribute__((noinline)) unsigned solve(const Atoms<V> &at, const KeptStar<N, V> &kept, unsigned lanes) const {
        const StarAtoms<where, N, V> atoms = {at, unit.elimination->star_centre};
        StarMasses<N, V> m;
        HOL_UNROLL
        for (int k = 0; k <= N; ++k) m.w[k] = kept.w[k];
        StarOfKept<N, V> star(m, kept);
        V y[N];
        if (call.rhs)
            atoms.read_bonds(call.rhs, 0.5, y);
        else
            find_star_rhs(call.v, call.f, atoms, star, y);
        return finish_star(outputs_of(call), atoms, star, y, Width<V>::of_bits(lanes), tally);
    }
};

}  // namespace holonomic::HOL_ISA::graph
