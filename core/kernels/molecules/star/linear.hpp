// Forces and velocities of stars of three and four bonds, CH3, NH3 and CH4, in registers: the equations of joint.hpp
// with the centre as the root and S^-1 in closed form. Lanes for which that is not good enough go the general way.
#pragma once

#include "core/kernels/molecules/linear_level.hpp"
#include "core/kernels/molecules/star/atoms.hpp"
#include "core/kernels/molecules/star/four_bonds.hpp"
#include "core/kernels/molecules/tree/joint.hpp"

namespace holonomic::HOL_ISA::graph {

template <int N, class V>
struct Star;

// Bond vectors from the centre, and S = diag(w_k q_k) + w_0 D^T D with its inverse adj / det.
template <class V>
struct Star<3, V> {
    const StarMasses<3, V> &m;
    Vector3<V> d[3];
    V q[3], adj[3][3], r;  // r = 1 / det
    V margin;              // negative where too little was left of what was subtracted from

    inline HOL_FORCED Star(const StarMasses<3, V> &masses) : m(masses) {}

    // From d.
    inline HOL_FORCED void invert() {
        V S[3][3];
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) {
            q[k] = dot(d[k], d[k]);
            HOL_UNROLL
            for (int l = 0; l < k; ++l) S[k][l] = S[l][k] = m.w[0] * dot(d[k], d[l]);
            S[k][k] = (m.w[0] + m.w[k + 1]) * q[k];
        }
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) {
            const int a = (k + 1) % 3, b = (k + 2) % 3;
            const V whole = S[a][a] * S[b][b];
            adj[k][k] = mul_add(-S[a][b], S[a][b], whole);
            adj[a][b] = adj[b][a] = mul_add(S[k][a], S[k][b], -(S[k][k] * S[a][b]));
            const V left = mul_add(Width<V>::all(-least_part), whole, adj[k][k]);
            margin = k == 0 ? left : min(left, margin);
        }
        const V whole = S[0][0] * adj[0][0], det = mul_add(S[0][2], adj[0][2], mul_add(S[0][1], adj[0][1], whole));
        margin = min(mul_add(Width<V>::all(-least_part), whole, det), margin);
        r = Width<V>::all(1) / det;
    }
    inline HOL_FORCED Vector3<V> of_centre(const Vector3<V> &f) const { return (-m.w[0]) * f; }
    inline HOL_FORCED void solve(const V *y, V *t) {
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) t[k] = r * mul_add(adj[k][2], y[2], mul_add(adj[k][1], y[1], adj[k][0] * y[0]));
    }

    // For siblings.hpp: the reciprocal pivot, which is (S^-1)_kk; a multiplier alone, per right-hand side; a right-hand
    // side without the centre's part that is not in it.
    inline HOL_FORCED V of_one(int k) const { return adj[k][k] * r; }
    inline HOL_FORCED V alone(int k) const { return of_one(k); }
    inline HOL_FORCED V without_centre(int, const V &y) const { return y; }
    inline HOL_FORCED V of_inverse(int k, int l) const { return adj[k][l] * r; }

    // The lanes in which nothing was lost, and `least` of what was left is not negative. There det is above 0, or NaN.
    inline HOL_FORCED MaskOf<V> is_regular(const V &least) const {
        return ~less(least, V{}) & ordinary_squares<V>(r, r, most_of_three);
    }
    inline HOL_FORCED MaskOf<V> is_regular() const { return is_regular(margin); }
    // The lanes in which t of y is good: nothing was lost, and no multiplier is a small difference of large terms.
    inline HOL_FORCED MaskOf<V> good(const V *y, const V *t) const {
        V T2 = q[0] * (t[0] * t[0]), least = margin;
        HOL_UNROLL
        for (int k = 1; k < 3; ++k) T2 = mul_add(q[k], t[k] * t[k], T2);
        const V shared = (m.w[0] * m.w[0]) * ((1 / (most_cancelled * most_cancelled)) * T2);
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) {
            const V of_one = this->of_one(k), alone = y[k] * of_one;
            least = min(mul_add(-shared, q[k] * (of_one * of_one), mul_add(t[k], t[k], alone * alone)), least);
        }
        return finite(T2) & is_regular(least);
    }

    // G of all atoms.
    inline HOL_FORCED void pull(const V *t, Vector3<V> *g) const {
        HOL_UNROLL
        for (int k = 0; k < 3; ++k) {
            const Vector3<V> p = t[k] * d[k];
            g[0] = k == 0 ? p : g[0] + p;
            g[k + 1] = {-p.x, -p.y, -p.z};
        }
    }
};

// Four bonds, as four_bonds.hpp has them.
template <class V>
struct Star<4, V> {
    const StarMasses<4, V> &m;
    Vector3<V> d[4], force = {}, total;  // of the centre: its own, and with the sum of t_k d_k
    bool is_pulled = false;              // there is a force
    V q[4];
    FourBonds<V> equations;

    inline HOL_FORCED Star(const StarMasses<4, V> &masses) : m(masses) {}
    inline HOL_FORCED void invert() {
        HOL_UNROLL
        for (int k = 0; k < 4; ++k) q[k] = dot(d[k], d[k]);
        equations.set(m.w, d, d);
    }
    inline HOL_FORCED void solve(const V *y, V *t) { equations.solve(y, force, t, total); }

    // What the centre's force adds to w_k f_k in right-hand sides.
    inline HOL_FORCED Vector3<V> of_centre(const Vector3<V> &f) {
        force = f;
        is_pulled = true;
        return Vector3<V>{};
    }

    inline HOL_FORCED MaskOf<V> is_light() const {
        return less(least_light * min(min(m.w[1], m.w[2]), min(m.w[3], m.w[4])), m.w[0]);
    }

    // As of three bonds: (S^-1)_kk is at least 1 / S_kk, and at most 1 / a_k.
    inline HOL_FORCED V of_one(int k) const { return equations.per_a[k]; }
    inline HOL_FORCED V alone(int k) const { return m.share[k] * of_one(k); }
    inline HOL_FORCED V without_centre(int k, const V &y) const { return mul_add(-m.w[0], dot(d[k], force), y); }
    inline HOL_FORCED V of_inverse(int k, int l) const {
        const V of_centre = (m.w[0] * equations.per_a[l]) * dot(d[k], equations.N * d[l]);
        return equations.per_a[k] * (Width<V>::all(k == l) - of_centre);
    }
    inline HOL_FORCED MaskOf<V> is_regular() const {
        const V *const a = equations.a;
        return ordinary_squares(min(min(a[0], a[1]), min(a[2], a[3])), max(max(a[0], a[1]), max(a[2], a[3])));
    }
    // The lanes in which t of y is good.
    inline HOL_FORCED MaskOf<V> good(const V *y, const V *t) const {
        V T2 = q[0] * (t[0] * t[0]);
        HOL_UNROLL
        for (int k = 1; k < 4; ++k) T2 = mul_add(q[k], t[k] * t[k], T2);
        const V shared = (m.w[0] * m.w[0]) * ((1 / (most_cancelled * most_cancelled)) * T2);
        V least = shared;
        HOL_UNROLL
        for (int k = 0; k < 4; ++k) {
            const V of_one = this->of_one(k), alone = without_centre(k, y[k]) * this->alone(k);
            const V left = mul_add(-shared, q[k] * (of_one * of_one), mul_add(t[k], t[k], alone * alone));
            least = k == 0 ? left : min(left, least);
        }
        MaskOf<V> fine = ~less(least, V{});
        const MaskOf<V> light = is_light();
        if (__builtin_expect(any(light), 0)) fine = (fine & ~light) | (light & equations.keeps_digits(q, y));
        return finite(T2) & fine & is_regular();
    }

    // The pulls on a light centre are small beside their terms, and take away most of its force; those on another one
    // may be small beside its force.
    inline HOL_FORCED void pull(const V *t, Vector3<V> *g) const {
        HOL_UNROLL
        for (int k = 0; k < 4; ++k) {
            const Vector3<V> of_bond = t[k] * d[k];
            g[k + 1] = {-of_bond.x, -of_bond.y, -of_bond.z};
        }
        g[0] = total;
        if (!is_pulled) return;
        const MaskOf<V> light = is_light();
        const Vector3<V> left = total - force, sum = (g[1] + g[2]) + (g[3] + g[4]);
        g[0] = {select(light, left.x, -sum.x), select(light, left.y, -sum.y), select(light, left.z, -sum.z)};
    }
};

template <int N, class V, class Atoms>
HOL_INLINE void write_star_bonds(const Atoms &atoms, const V *t, double factor, double *out, unsigned which) {
    V value[N];
    HOL_UNROLL
    for (int k = 0; k < N; ++k) value[k] = mul_add(Width<V>::all(factor), t[k], V{});
    atoms.write_bonds(out, value, which);
}

// Right-hand sides, as load.hpp makes them.
template <Inlined where, class AnyStar, int N, class V>
HOL_INLINE void find_star_rhs(const AtomArray &v, const AtomArray &f, const StarAtoms<where, N, V> &atoms,
                              AnyStar &star, V *y) {
    Vector3<V> a[N + 1];
    HOL_UNROLL
    for (int k = 0; k < N; ++k) y[k] = V{};
    if (v.x) {
        atoms.read(v, a);
        HOL_UNROLL
        for (int k = 0; k < N; ++k) {
            const Vector3<V> dv = a[k + 1] - a[0];
            y[k] = dot(dv, dv);
        }
    }
    if (f.x) {
        atoms.read(f, a);
        const Vector3<V> first = star.of_centre(a[0]);
        HOL_UNROLL
        for (int k = 0; k < N; ++k) {
            const Vector3<V> d = star.d[k], sum = add_times(first, star.m.w[k + 1], a[k + 1]);
            y[k] = mul_add(d.z, sum.z, mul_add(d.y, sum.y, mul_add(d.x, sum.x, y[k])));
        }
    }
}

// Solves and writes. Returns the lanes that are done.
template <Inlined where, class AnyStar, int N, class V>
HOL_INLINE unsigned finish_star(const LinearOutputs &to, const StarAtoms<where, N, V> &atoms, AnyStar &star, const V *y,
                                MaskOf<V> in_use, Tally &tally) {
    V t[N];
    star.solve(y, t);
    const unsigned good = bits(in_use & star.good(y, t));
    if (!good) return good;
    if (to.lambda) write_star_bonds<N>(atoms, t, 0.5, to.lambda, good);
    if (to.tension) {
        V T[N];
        HOL_UNROLL
        for (int k = 0; k < N; ++k) T[k] = t[k] * sqrt(star.q[k]);
        write_star_bonds<N>(atoms, T, 1, to.tension, good);
    }
    if (to.virial) add_bonds_virial<N>(star.d, t, 1, good, tally);
    if (!to.g || !to.g->x) return good;
    Vector3<V> g[N + 1];
    star.pull(t, g);
    if (to.add) {
        Vector3<V> before[N + 1];
        atoms.read(*to.g, before);
        HOL_UNROLL
        for (int i = 0; i <= N; ++i) g[i] = before[i] + g[i];
    }
    atoms.write(*to.g, g, good);
    return good;
}

struct StarForcesVerb {
    static constexpr bool in_steps = false;
    template <int N, class V>
    using Kind = StarMasses<N, V>;
    const ForcesCall &call;
    Tally &tally;

    // Returns the lanes that are done.
    template <Inlined where, int N, class V>
    __attribute__((noinline)) unsigned solve(const StarAtoms<where, N, V> &atoms, const MoleculeLane *,
                                             const StarMasses<N, V> &m, MaskOf<V> in_use) const {
        Vector3<V> r[N + 1];
        V y[N];
        Star<N, V> star(m);
        atoms.read(call.r, r);
        atoms.take_bonds(r, call.box, star.d);
        star.invert();
        find_star_rhs(call.v, call.f, atoms, star, y);
        return finish_star(outputs_of(call), atoms, star, y, in_use, tally);
    }
};

// A second solve for the rates that the first leaves, as linear_level.hpp has it.
struct StarVelocitiesVerb {
    static constexpr bool in_steps = false;
    template <int N, class V>
    using Kind = StarMasses<N, V>;
    const VelocitiesCall &call;
    Tally &tally;

    // Returns the lanes that are done.
    template <Inlined where, int N, class V>
    __attribute__((noinline)) unsigned solve(const StarAtoms<where, N, V> &atoms, const MoleculeLane *,
                                             const StarMasses<N, V> &m, MaskOf<V> in_use) const {
        Vector3<V> r[N + 1], v[N + 1];
        V y[N], t[N], again[N];
        Star<N, V> star(m);
        atoms.read(call.r, r);
        atoms.take_bonds(r, call.box, star.d);
        star.invert();
        atoms.read(call.v, v);
        find_rates(call.strain, star, v, y);
        star.solve(y, t);
        const unsigned good = bits(in_use & star.good(y, t));
        if (!good) return good;
        if (call.lambda) write_star_bonds<N>(atoms, t, 0.5, call.lambda, good);
        if (call.virial) add_bonds_virial<N>(star.d, t, 1, good, tally);
        move(star, t, v);
        if (!call.v.is_float) {
            find_rates(call.strain, star, v, y);
            star.solve(y, again);
            move(star, again, v);
        }
        atoms.write(call.v, v, good);
        return good;
    }

    template <int N, class V>
    HOL_STATIC void find_rates(const double *strain, const Star<N, V> &star, const Vector3<V> *v, V *y) {
        HOL_UNROLL
        for (int k = 0; k < N; ++k) y[k] = dot(star.d[k], v[k + 1] - v[0]);
        for (int k = 0; k < N && strain; ++k) y[k] = y[k] + stretching(strain, star.d[k]);
    }
    template <int N, class V>
    HOL_STATIC void move(const Star<N, V> &star, const V *t, Vector3<V> *v) {
        Vector3<V> g[N + 1];
        star.pull(t, g);
        HOL_UNROLL
        for (int i = 0; i <= N; ++i) v[i] = add_times(v[i], star.m.w[i], g[i]);
    }
};

}  // namespace holonomic::HOL_ISA::graph
