// An atom of so many arms that a table of all multipliers would be too large: O(n) numbers for n arms, and as many
// operations. Arm e is reduced by all others that are eliminated, by the inverse N_e of 1 + sum rho B D^T over them.
// Its multipliers are l_a = rho_a G_e.B_a with G_e = D_e N_e, so that sums over them are those of vectors. What comes
// before e and what comes behind it are added up apart, so that nothing is subtracted.
//
// Arms that don't give way, three at most, take their directions out of D and B, and get what that leaves of D_e. As e
// each of them has its multipliers one by one.
#pragma once

#include "core/kernels/extended/joint.hpp"

namespace holonomic::HOL_ISA::extended {

struct ManyArms {
    struct Arm {
        Wide3 G, B;    // B without what rigid arms take of it
        Wide3 V;       // sum l_a D_a over the arms that give way
        Wide3 behind;  // in a solve, of the arms behind this one
        Wide rho;      // 0 of what is not eliminated, or rigid
    };
    struct Head {
        int32_t n, n_rigid, rigid[4];
        Wide gram[9];
    };
    Head *head;
    Arm *arm;   // [n]
    Wide *row;  // [n] of each rigid arm

    ManyArms(Wide *table, int64_t n)
        : head(reinterpret_cast<Head *>(table)), arm(reinterpret_cast<Arm *>(table + 16)), row(table + 16 + 13 * n) {
        static_assert(sizeof(Arm) == 13 * sizeof(Wide) && sizeof(Head) <= 16 * sizeof(Wide), "values_of_many()");
    }
    int which_rigid(int e) const {
        for (int p = 0; p < head->n_rigid; ++p)
            if (head->rigid[p] == e) return p;
        return -1;
    }
    const Wide *row_of(int p) const { return row + static_cast<int64_t>(p) * head->n; }
};

// m += b d^T
HOL_INLINE void add_outer(Wide *m, const Wide3 &b, const Wide3 &d) {
    const Wide x[3] = {b.x, b.y, b.z}, y[3] = {d.x, d.y, d.z};
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) m[3 * r + c] += x[r] * y[c];
}
// v^T m
HOL_INLINE Wide3 from_left(const Wide3 &v, const Wide *m) {
    return {v.x * m[0] + v.y * m[3] + v.z * m[6], v.x * m[1] + v.y * m[4] + v.z * m[7],
            v.x * m[2] + v.y * m[5] + v.z * m[8]};
}
HOL_INLINE bool invert_with_one(const Wide *m, Wide *inverse) {
    Wide sum[9];
    for (int i = 0; i < 9; ++i) sum[i] = i % 4 == 0 ? wide(1) + m[i] : m[i];
    return invert(sum, inverse);
}

// Of the arms that give way, each(e, what is offered along it, whether that could be found).
template <class Each>
HOL_NOINLINE void reduce_by_vectors(const Joint &x, const ManyArms &all, const Each &each) {
    const auto directed = [&](int a) { return project(x, x.rigid_arms, x.D[a], true); };
    const auto add = [&](Wide *sum, int a) {  // with D as rigid arms leave it, and as it is
        const ManyArms::Arm &arm = all.arm[a];
        if (arm.rho.hi == 0) return;
        add_outer(sum, arm.B, arm.rho * directed(a));
        add_outer(sum + 9, arm.B, arm.rho * x.D[a]);
    };
    Wide sum[18] = {};
    for (int a = x.n; a-- > 0;) {
        all.arm[a].B = project(x, x.rigid_arms, x.B[a], false);
        for (int i = 0; i < 18; ++i) x.behind[18 * static_cast<int64_t>(a) + i] = sum[i];
        add(sum, a);
    }
    for (Wide &element : sum) element = wide(0);
    for (int e = 0; e < x.n; ++e) {
        if (all.which_rigid(e) >= 0) continue;
        ManyArms::Arm &arm = all.arm[e];
        Wide both[18], inverse[9];
        for (int i = 0; i < 18; ++i) both[i] = sum[i] + x.behind[18 * static_cast<int64_t>(e) + i];
        const bool good = invert_with_one(both, inverse);
        arm.G = good ? from_left(directed(e), inverse) : Wide3{};
        arm.V = from_left(arm.G, both + 9);
        each(e, x.w * dot(arm.G, arm.B), good);
        add(sum, e);
    }
}

// Reduces every arm by all others of x.others, whose E have been set.
template <class Each>
HOL_NOINLINE void reduce_many(Joint &x, Wide *table, const Each &each) {
    const ManyArms all(table, x.n);
    *all.head = {};
    all.head->n = x.n;
    for (int a = 0; a < x.n; ++a) all.arm[a] = {};
    eliminate_arms(x);  // notes what is lost
    for (int o = 0; o < x.n_others; ++o) {
        const int a = x.others[o];
        if (!x.rigid[a])
            all.arm[a].rho = x.rho[a];
        else if (all.head->n_rigid < 4)
            all.head->rigid[all.head->n_rigid++] = a;
    }
    if (x.w == 0 || x.n_rigid > 4 || (x.n_rigid > 0 && !take_rigid(x, x.rigid_arms) && x.n_rigid <= 3)) {
        for (int e = 0; e < x.n; ++e) each(e, wide(0), x.w == 0);
        return;
    }
    if (x.n_rigid <= 3) {
        for (int i = 0; i < 9; ++i) all.head->gram[i] = x.rigid_arms.gram[i];
        reduce_by_vectors(x, all, each);
    } else {
        for (int e = 0; e < x.n; ++e)
            if (all.which_rigid(e) < 0) each(e, wide(0), false);
    }
    const int n_others = x.n_others;
    for (int o = 0; o < n_others; ++o) {
        const int e = x.others[o], p = all.which_rigid(e);
        if (p < 0) continue;
        Wide *const row = all.row + static_cast<int64_t>(p) * x.n;
        for (int a = 0; a < x.n; ++a) row[a] = wide(0);
        x.others[o] = x.others[n_others - 1];
        x.n_others = n_others - 1;
        const bool good = eliminate_arms(x);
        if (good) multipliers(x, e, row);
        each(e, good ? offered(x, e, e) : wide(0), good);
        x.others[o] = e;
        x.n_others = n_others;
    }
}

// Sums over the multipliers of arms e, or of `only` one (or -1): each(e, sum l_a y_a), y(a) being asked for what is
// eliminated alone. d(a), b(a): the vectors D and B of arm a as they were when it was reduced.
template <class Y, class D, class B, class Each>
HOL_NOINLINE void sum_many(Wide *table, int n, int only, const Y &y, const D &d, const B &b, const Each &each) {
    const ManyArms all(table, n);
    const ManyArms::Head &head = *all.head;
    Wide3 c = {};  // what the rigid arms make of what is left of D
    for (int q = 0; q < head.n_rigid && head.n_rigid <= 3; ++q) {
        Wide sum = wide(0);
        for (int p = 0; p < head.n_rigid; ++p) sum += head.gram[3 * q + p] * y(head.rigid[p]);
        c = c + sum * b(head.rigid[q]);
    }
    const auto pull = [&](int a) {
        const ManyArms::Arm &arm = all.arm[a];
        if (arm.rho.hi == 0) return Wide3{};
        return (arm.rho * (head.n_rigid > 0 ? y(a) - dot(d(a), c) : y(a))) * arm.B;
    };
    Wide3 sum = {};
    for (int a = n; a-- > 0;) {
        all.arm[a].behind = sum;
        sum = sum + pull(a);
    }
    sum = {};
    for (int e = 0; e < n; ++e) {
        const int p = all.which_rigid(e);
        if (only >= 0 && e != only) {
            sum = sum + pull(e);
            continue;
        }
        if (p < 0) {
            const Wide of_vectors = dot(all.arm[e].G, sum + all.arm[e].behind);
            const Wide3 before = pull(e);
            each(e, head.n_rigid > 0 ? of_vectors + dot(d(e), c) : of_vectors);
            sum = sum + before;
            continue;
        }
        Wide of_row = wide(0);
        for (int a = 0; a < n; ++a)
            if (a != e && (all.arm[a].rho.hi != 0 || all.which_rigid(a) >= 0)) of_row += all.row_of(p)[a] * y(a);
        each(e, of_row);
    }
}

// Multiplier l_a of arm e.
template <class D, class B>
HOL_NOINLINE Wide multiplier_of_many(Wide *table, int n, int e, int a, const D &d, const B &b) {
    const ManyArms all(table, n);
    const int of_e = all.which_rigid(e), of_a = all.which_rigid(a);
    if (of_e >= 0) return all.row_of(of_e)[a];
    if (of_a < 0) return all.arm[a].rho * dot(all.arm[e].G, all.arm[a].B);
    Wide sum = wide(0);
    for (int q = 0; q < all.head->n_rigid; ++q)
        sum += dot(d(e) - all.arm[e].V, b(all.head->rigid[q])) * all.head->gram[3 * q + of_a];
    return sum;
}
// sum l_a D_a of arm e.
template <class D>
HOL_NOINLINE Wide3 directions_of_many(Wide *table, int n, int e, const D &d) {
    const ManyArms all(table, n);
    const int p = all.which_rigid(e);
    Wide3 sum = p < 0 ? all.arm[e].V : Wide3{};
    for (int a = 0; a < n && p >= 0; ++a)
        if (a != e) sum = sum + all.row_of(p)[a] * d(a);
    for (int q = 0; q < all.head->n_rigid && p < 0; ++q) {
        const int a = all.head->rigid[q];
        sum = sum + multiplier_of_many(table, n, e, a, d, d) * d(a);
    }
    return sum;
}

}  // namespace holonomic::HOL_ISA::extended
