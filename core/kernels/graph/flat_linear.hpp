// Linear equations of one large molecule with cycles: A t = b as it stands, L D L^T along a list (flat_list.hpp), and a
// proof that no refinement is needed. With |.| by elements, what is found solves equations that are off by a few
// roundings of
//
//     R = |L| D |L^T| |t| + sum over both ends i of w_i |d| sum over the bonds of i of |t| |d|
//
// (elimination and substitutions; the products d.d' and w). Where R is no more than the terms that an equation is made
// of, all errors are of the size of its scale |A^-1| S. Elsewhere, or where a pivot is small, linear.hpp refines.
#ifndef HOLONOMIC_KERNELS_GRAPH_FLAT_LINEAR_HPP
#define HOLONOMIC_KERNELS_GRAPH_FLAT_LINEAR_HPP

#include "core/kernels/graph/flat_rows.hpp"
#include "core/kernels/graph/load.hpp"
#include "core/kernels/graph/proof.hpp"
#include "core/kernels/graph/virial.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

struct FlatLinear {
    const FlatList &s;
    const MoleculeLane &lane;
    const Atoms<double> at;
    const Box &box;
    const Inputs &in;
    double *mass;  // -w_0, w_0, -w_1, .. , 0
    Rows pull;     // first the coordinates; then G, and the sum of |t| |d| of an atom's bonds
    Rows v, a;     // velocities, later |a| as it was; w f, then w (f + G), or v + w G where right-hand sides are rates
    Rows d;        // bonds
    double *t, *E, *r;        // right-hand sides, then multipliers; pivots; 1 / pivot
    double *lower, *size;     // |d|
    double *diagonal, *back;  // of A; R

    static int64_t values(const FlatList &s) {
        return 2 * in_fours(s.n_atoms + 2) + 12 * static_cast<int64_t>(s.n_atoms) + 10 * in_fours(s.n_bonds) +
               in_fours(s.n_entries);
    }
    FlatLinear(const FlatList &list, const MoleculeLane &l, const Box &b, const Inputs &inputs, Memory<double> memory)
        : s(list), lane(l), at(&l, 1), box(b), in(inputs) {
        const int64_t bonds = in_fours(s.n_bonds);
        pull = {memory.values(4 * static_cast<int64_t>(s.n_atoms))};
        v = {memory.values(4 * static_cast<int64_t>(s.n_atoms))};
        a = {memory.values(4 * static_cast<int64_t>(s.n_atoms))};
        d = {memory.values(4 * bonds)};
        mass = memory.values(2 * in_fours(s.n_atoms + 2));
        lower = memory.values(in_fours(s.n_entries));
        t = memory.values(bonds);
        E = memory.values(bonds);
        r = memory.values(bonds);
        size = memory.values(bonds);
        diagonal = memory.values(bonds);
        back = memory.values(bonds);
    }
    HOL_INLINE Row &four(double *values, int64_t k) { return *reinterpret_cast<Row *>(values + k); }

    template <Layout layout, int terms>
    __attribute__((noinline)) void load(const AtomArray &coordinates) const {
        for (int32_t i = 0; i < s.n_atoms; ++i) {
            mass[2 * s.place_of[i]] = -lane.w[i];
            mass[2 * s.place_of[i] + 1] = lane.w[i];
        }
        mass[2 * s.n_atoms] = 0;
        read_atoms<layout>(coordinates, at, s, pull);
        find_bonds(s.from, s.to, s.n_bonds, box, pull, d);
        if (terms & (squares | rates)) read_atoms<layout>(*in.v, at, s, terms & rates ? a : v);
        if (terms & pulls) {
            for (int32_t i = 0; i < s.n_atoms; ++i)
                a[s.place_of[i]] = in_row(lane.w[i]) * read_row_of<layout>(*in.f, at, i);
        } else if (!(terms & rates)) {
            for (int32_t i = 0; i < s.n_atoms; ++i) a[i] = Row{};
        }
        for (int64_t k = 0; k < s.n_bonds; k += 4) {
            Row e[4] = {}, q[4];
            HOL_UNROLL
            for (int i = 0; i < 4; ++i) {
                const int32_t from = s.from[k + i], to = s.to[k + i];
                const Row &bond = d[k + i];
                q[i] = bond * bond;
                if (terms & squares) {
                    const Row dv = v.at_four_times(to) - v.at_four_times(from);
                    e[i] = dv * dv;
                }
                if (terms & (pulls | rates))
                    e[i] = multiply_add(bond, a.at_four_times(to) - a.at_four_times(from), e[i]);
            }
            const Row square = sums_of(q[0], q[1], q[2], q[3]);
            four(t, k) = sums_of(e[0], e[1], e[2], e[3]);
            HOL_UNROLL
            for (int i = 0; i < 4; ++i) {
                E[k + i] = diagonal[k + i] = (mass[s.from[k + i] / 2 + 1] + mass[s.to[k + i] / 2 + 1]) * square[i];
                size[k + i] = __builtin_sqrt(square[i]);
            }
        }
        if (terms & given)
            for (int32_t k = 0; k < s.n_bonds; ++k) t[k] = 0.5 * in.rhs[lane.first_bond + s.bond_of[k]];
        if ((terms & rates) && in.strain)
            for (int32_t k = 0; k < s.n_bonds; ++k) t[k] = t[k] + stretching(in.strain, vector_of(d[k]));
    }

    // The entries of A off its diagonal.
    __attribute__((noinline)) void assemble() const {
        for (int64_t e = 0; e < s.n_entries; e += 4) {
            const int32_t *const row = s.row_4 + e, *const column = s.column_4 + e, *const m = s.mass + e;
            Row p[4];
            HOL_UNROLL
            for (int i = 0; i < 4; ++i) p[i] = d.at_four_times(row[i]) * d.at_four_times(column[i]);
            four(lower, e) = Row{mass[m[0]], mass[m[1]], mass[m[2]], mass[m[3]]} * sums_of(p[0], p[1], p[2], p[3]);
        }
    }

    // Right-hand sides with it.
    __attribute__((noinline)) void eliminate() const {
        const int32_t *update = s.update;
        for_columns_up(s, [&](int32_t k, int32_t first, int32_t n) HOL_FORCED {
            const int32_t *const row = s.row + first;
            double *const l = lower + first;
            const double inverse = r[k] = 1 / E[k], y = t[k];
            HOL_UNROLL
            for (int32_t i = 0; i < n; ++i) {
                const double li = l[i], lr = li * inverse;
                HOL_UNROLL
                for (int32_t j = 0; j < i; ++j, ++update)  // l of j is multiplied already
                    lower[*update] = mul_add(-li, l[j], lower[*update]);
                E[row[i]] = mul_add(-li, lr, E[row[i]]);
                t[row[i]] = mul_add(-lr, y, t[row[i]]);
                l[i] = lr;
            }
        });
    }

    // Back, with the part of R that elimination and substitutions have.
    __attribute__((noinline)) void substitute_back() const {
        for_columns_down(s, [&](int32_t k, int32_t first, int32_t n) HOL_FORCED {
            const int32_t *const row = s.row + first;
            const double *const l = lower + first;
            double x = t[k] * r[k], sum = 0;
            HOL_UNROLL
            for (int32_t e = 0; e < n; ++e) {
                const double part = l[e] * t[row[e]];
                x = x - part;
                sum = sum + abs(part);
            }
            const double all = E[k] * (abs(x) + sum);
            back[k] = all;
            HOL_UNROLL
            for (int32_t e = 0; e < n; ++e) back[row[e]] = mul_add(abs(l[e]), all, back[row[e]]);
            t[k] = x;
        });
    }
    // Another right-hand side, in t.
    __attribute__((noinline)) void solve_again() const {
        solve_up(s, lower, t);
        solve_down(s, lower, r, t, [](int32_t, double) HOL_FORCED {});
    }

    // The rates of the bonds as they are, d.(v_j - v_i), into t.
    void find_rates() const {
        for (int64_t k = 0; k < s.n_bonds; k += 4) {
            Row e[4];
            HOL_UNROLL
            for (int i = 0; i < 4; ++i)
                e[i] = d[k + i] * (a.at_four_times(s.to[k + i]) - a.at_four_times(s.from[k + i]));
            four(t, k) = sums_of(e[0], e[1], e[2], e[3]);
        }
        for (int32_t k = 0; k < s.n_bonds && in.strain; ++k) t[k] = t[k] + stretching(in.strain, vector_of(d[k]));
    }

    // G of all atoms, and beside it the sum of |t| |d|.
    __attribute__((noinline)) void find_pulls() const {
        const RowBits opposite = {INT64_MIN, INT64_MIN, INT64_MIN, 0};
        for (int64_t i = 0; i < s.n_atoms; ++i) pull[i] = Row{};
        for (int64_t k = 0; k < s.n_bonds; ++k) {
            Row p = in_row(t[k]) * d[k];
            p[3] = abs(t[k]) * size[k];
            Row &from = pull.at_four_times(s.from[k]), &to = pull.at_four_times(s.to[k]);
            from = from + p;
            to = to + reinterpret_cast<Row>(reinterpret_cast<RowBits>(p) ^ opposite);
        }
    }
    // What they do to a, of which v keeps what it was made of.
    __attribute__((noinline)) void add_pulls() const {
        for (int64_t i = 0; i < s.n_atoms; ++i) {
            v[i] = absolute(a[i]);
            a[i] = multiply_add(in_row(mass[2 * i + 1]), pull[i], a[i]);
        }
    }

    // The terms of bond k's equation in absolute values.
    __attribute__((noinline)) double terms_of(int32_t k) const {
        const int32_t end[2] = {s.from[k], s.to[k]};
        double sum = 0, velocity[2][3] = {};
        for (int e = 0; e < 2; ++e) {
            const Row product = d[k] * a.at_four_times(end[e]);
            sum += abs((product[0] + product[1]) + product[2]);
            const int64_t number = at.number(0, s.atom_of[end[e] / 4]);
            double f[3] = {};
            if (in.v && in.v->x) read_row(*in.v, number, velocity[e]);
            if (in.f && in.f->x) read_row(*in.f, number, f);
            for (int c = 0; c < 3; ++c) sum += mass[end[e] / 2 + 1] * abs(d[k][c] * f[c]);
            for (int c = 0; c < 3 && in.rates; ++c) sum += abs(d[k][c] * velocity[e][c]);
        }
        if (in.rhs) sum += abs(0.5 * in.rhs[lane.first_bond + s.bond_of[k]]);
        for (int x = 0, e = 0; x < 3 && in.strain; ++x)
            for (int y = x; y < 3; ++y, ++e) sum += abs(in.strain[e] * d[k][x] * d[k][y]);
        for (int c = 0; c < 3 && !in.rates; ++c)
            sum += (velocity[1][c] - velocity[0][c]) * (velocity[1][c] - velocity[0][c]);
        return sum;
    }

    // Whether t needs no correction. A part of the terms does for most bonds.
    __attribute__((noinline)) bool is_proven() const {
        const double most = most_backward(s.n_bonds);
        for (int64_t k = 0; k < s.n_bonds; k += 4) {
            Row p[4], q[4], input[4], T = {};
            HOL_UNROLL
            for (int i = 0; i < 4; ++i) {
                const Row &from = a.at_four_times(s.from[k + i]), &to = a.at_four_times(s.to[k + i]);
                p[i] = d[k + i] * from;
                q[i] = d[k + i] * to;
                input[i] = absolute(d[k + i]) * (v.at_four_times(s.from[k + i]) + v.at_four_times(s.to[k + i]));
                T[i] = from[3] + to[3];
            }
            const Row part = absolute(sums_of(p[0], p[1], p[2], p[3])) + absolute(sums_of(q[0], q[1], q[2], q[3])) +
                             sums_of(input[0], input[1], input[2], input[3]);
            four(back, k) = multiply_add(four(size, k), T, four(back, k));
            const Row left = multiply_add(in_row(most), part, -four(back, k)),
                      pivot = multiply_add(in_row(-least_proven_pivot), four(diagonal, k), four(E, k));
            for (int i = 0; i < 4 && k + i < s.n_bonds; ++i) {
                if (!(pivot[i] > 0)) return false;
                if (__builtin_expect(left[i] >= 0, 1)) continue;
                if (!(back[k + i] <= most * terms_of(static_cast<int32_t>(k + i)))) return false;
            }
        }
        return true;
    }

    // Reads the molecule and solves; false where that is in doubt.
    template <Layout layout, int terms>
    bool solve(const AtomArray &coordinates) const {
        load<layout, terms>(coordinates);
        assemble();
        eliminate();
        substitute_back();
        find_pulls();
        add_pulls();
        return is_proven();
    }

    void write_bonds(double factor, double *out) const {
        for (int32_t k = 0; k < s.n_bonds; ++k) out[lane.first_bond + s.bond_of[k]] = mul_add(factor, t[k], 0.0);
    }
    void write_tensions(double *out) const {
        for (int32_t k = 0; k < s.n_bonds; ++k) out[lane.first_bond + s.bond_of[k]] = mul_add(t[k], size[k], 0.0);
    }
    void add_virial(Tally &tally) const {
        MoleculesVirial<double> virial;
        for (int32_t k = 0; k < s.n_bonds; ++k) {
            const Vector3<double> bond = vector_of(d[k]);
            virial.add(bond, t[k] * bond);
        }
        virial.count(1, 1, tally);
    }
    bool writable(int32_t atom) const { return !lane.shared || !lane.shared[atom]; }
};

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
