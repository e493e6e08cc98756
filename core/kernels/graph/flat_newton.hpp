// Newton's method for the positions of one large molecule: the matrix of new bonds D times reference bonds
// b as it stands, factored along a list (flat_list.hpp). Bonds and moves are found four at a time, the triangular
// solves one by one.
#ifndef HOLONOMIC_KERNELS_GRAPH_FLAT_NEWTON_HPP
#define HOLONOMIC_KERNELS_GRAPH_FLAT_NEWTON_HPP

#include "core/kernels/graph/flat_rows.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

// As Newton (newton.hpp) for iterate().
struct FlatNewton {
    const FlatList &s;
    double *mass;  // -w_0, w_0, -w_1, .. , 0
    Rows moves, D, b, new_D;
    double *tau, *t, *r;  // t: what is left of a length, then its correction; r: 1 / pivot
    double *lower, *upper, *a2, *per_a2;
    double *stretch;  // |D| / a of the bonds that the factors were made of
    bool displaced;   // `moves` are those of tau
    bool moved;       // the bonds are not D any more
    bool eliminated;  // t has been taken through the new factors already

    static int64_t values(const FlatList &s) {
        return 2 * in_fours(s.n_atoms + 2) + 4 * (s.n_atoms + 3 * (in_fours(s.n_bonds) + 4)) + 6 * in_fours(s.n_bonds) +
               2 * in_fours(s.n_entries) + 4;
    }
    FlatNewton(const FlatList &list, Memory<double> &memory)
        : s(list), displaced(false), moved(false), eliminated(false) {
        const int64_t bonds = in_fours(s.n_bonds), entries = in_fours(s.n_entries);
        moves = {memory.values(4 * s.n_atoms)};
        D = {memory.values(4 * bonds)};
        b = {memory.values(4 * bonds)};
        new_D = {memory.values(4 * (bonds + 4))};  // first the coordinates: a connected molecule has one atom more
        lower = memory.values(entries);
        upper = memory.values(entries);
        tau = memory.values(bonds);
        t = memory.values(bonds);
        r = memory.values(bonds);
        a2 = memory.values(bonds);
        per_a2 = memory.values(bonds);
        stretch = memory.values(bonds);
        mass = memory.values(2 * in_fours(s.n_atoms + 2));
    }

    struct Errors {
        Row worst, sum;  // max() may lose a NaN, the sum keeps it
        double largest() const { return largest_of(worst) + 0 * ((sum[0] + sum[1]) + (sum[2] + sum[3])); }
    };
    HOL_FORCED Row &four(double *values, int64_t k) const { return *reinterpret_cast<Row *>(values + k); }

    // D.D - a^2 of bonds k .. k + 3.
    HOL_FORCED Row excess_of(int64_t k, const Row *d) const {
        const Lanes3 at = turned(d[0], d[1], d[2], d[3]);
        return multiply_add(at.z, at.z, multiply_add(at.y, at.y, multiply_add(at.x, at.x, -four(a2, k))));
    }
    // What is left of their lengths. Not of their squares: a change of |D|, which is D/|D| . dD, is nearly what it was
    // when the factors were made, as bonds are stretched more than they turn; that of D.D grows with |D|. So with the
    // factors of D_0, of which row k is D_0 . dD, |D_0| (|D| - a). `fresh`: the factors will be those of this D.
    template <bool fresh>
    HOL_FORCED void measure(int64_t k, const Row *d, Errors &errors) const {
        const Row sigma = excess_of(k, d), excess = sigma * four(per_a2, k);
        errors.worst = larger(absolute(excess), errors.worst);
        errors.sum = errors.sum + sigma;
        if (fresh) {
            const Row root = root_of(in_row(1) + excess);
            four(stretch, k) = root;
            four(t, k) = sigma * (root / (in_row(1) + root));
        } else {  // 2 (sqrt(1 + e) - 1) / e
            const Row e = smaller(larger(excess, in_row(-0.5)), in_row(0.5));
            four(t, k) = (in_row(0.5) * four(stretch, k)) *
                         (sigma * multiply_add(e, multiply_add(in_row(0.125), e, in_row(-0.25)), in_row(1)));
        }
    }
    double open() {
        Errors errors = {};
        for (int64_t k = 0; k < s.n_bonds; k += 4) measure<true>(k, &D[k], errors);
        return errors.largest();
    }
    void forget(Flag which) {
        if (!which.set) return;
        for (int64_t k = 0; k < in_fours(s.n_bonds); ++k) tau[k] = 0;
        displaced = false;
    }

    HOL_FORCED Row moved_bond(int64_t k) const {
        return D[k] + (moves.at_four_times(s.to[k]) - moves.at_four_times(s.from[k]));
    }
    // |D.D - a^2| / a^2 of the bonds as they are.
    double error_of(int64_t k) const {
        const int64_t first = k / 4 * 4;
        Row d[4];
        for (int i = 0; i < 4; ++i) d[i] = moved ? moved_bond(first + i) : D[first + i];
        return absolute(excess_of(first, d))[k - first] * per_a2[k];
    }

    // Displacements, times w only in the end.
    __attribute__((noinline)) void displace() {
        if (displaced) return;
        displaced = true;
        for (int64_t i = 0; i < s.n_atoms; ++i) moves[i] = Row{};
        for (int64_t k = 0; k < s.n_bonds; ++k) {
            const Row pull = in_row(tau[k]) * b[k];
            Row &from = moves.at_four_times(s.from[k]), &to = moves.at_four_times(s.to[k]);
            from = from + pull;
            to = to - pull;
        }
        for (int64_t i = 0; i < s.n_atoms; ++i) moves[i] = in_row(mass[2 * i + 1]) * moves[i];
    }
    // Bonds as moved, and what is left of them.
    __attribute__((noinline)) double move() {
        displace();
        Errors errors = {};
        for (int64_t k = 0; k < s.n_bonds; k += 4) {
            const Row d[4] = {moved_bond(k), moved_bond(k + 1), moved_bond(k + 2), moved_bond(k + 3)};
            measure<false>(k, d, errors);
        }
        moved = true;
        return errors.largest();
    }

    // Factors for the bonds as they are; the first solve with them follows.
    void first_factors() { factorize({true}); }
    __attribute__((noinline)) void factorize(Flag) {
        Errors unused = {};
        for (int64_t k = 0; moved && k < s.n_bonds; k += 4) {
            HOL_UNROLL
            for (int i = 0; i < 4; ++i) new_D[k + i] = moved_bond(k + i);
            measure<true>(k, &new_D[k], unused);
        }
        assemble(moved ? new_D : D);
        eliminate();
        eliminated = true;
    }
    void assemble(const Rows &d) {
        for (int64_t k = 0; k < s.n_bonds; k += 4) {
            double w[4];
            for (int i = 0; i < 4; ++i) w[i] = mass[s.from[k + i] / 2 + 1] + mass[s.to[k + i] / 2 + 1];
            const Row q = sums_of(d[k] * b[k], d[k + 1] * b[k + 1], d[k + 2] * b[k + 2], d[k + 3] * b[k + 3]);
            *reinterpret_cast<Row *>(r + k) = Row{w[0], w[1], w[2], w[3]} * q;
        }
        for (int64_t e = 0; e < s.n_entries; e += 4) {
            const int32_t *const row = s.row_4 + e, *const column = s.column_4 + e, *const m = s.mass + e;
            const Row w = {mass[m[0]], mass[m[1]], mass[m[2]], mass[m[3]]};
            Row p[4], q[4];
            HOL_UNROLL
            for (int i = 0; i < 4; ++i) {
                p[i] = d.at_four_times(row[i]) * b.at_four_times(column[i]);
                q[i] = d.at_four_times(column[i]) * b.at_four_times(row[i]);
            }
            *reinterpret_cast<Row *>(lower + e) = w * sums_of(p[0], p[1], p[2], p[3]);
            *reinterpret_cast<Row *>(upper + e) = w * sums_of(q[0], q[1], q[2], q[3]);
        }
    }

    __attribute__((noinline)) void eliminate() {
        const int32_t *update = s.update;
        for_columns_up(s, [&](int32_t k, int32_t first, int32_t n) HOL_FORCED {
            const int32_t *const row = s.row + first;
            double *const l = lower + first, *const u = upper + first;
            const double inverse = r[k] = 1 / r[k], y = t[k];
            HOL_UNROLL
            for (int32_t a = 0; a < n; ++a) {
                const double la = l[a], ua = u[a], ur = ua * inverse;
                HOL_UNROLL
                for (int32_t c = 0; c < a; ++c, ++update) {  // l and u of c are multiplied already
                    lower[*update] = mul_add(-la, u[c], lower[*update]);
                    upper[*update] = mul_add(-ua, l[c], upper[*update]);
                }
                r[row[a]] = mul_add(-la, ur, r[row[a]]);
                l[a] = la * inverse;
                u[a] = ur;
                t[row[a]] = mul_add(-l[a], y, t[row[a]]);
            }
        });
    }

    // Corrections for what is left, in t, added to tau.
    __attribute__((noinline)) void solve(Flag) {
        if (!eliminated) solve_up(s, lower, t);
        eliminated = displaced = false;
        solve_down(s, upper, r, t, [&](int32_t k, double x) HOL_FORCED { tau[k] = tau[k] + x; });
    }
};

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
