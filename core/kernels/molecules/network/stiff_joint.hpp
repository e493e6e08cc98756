// Atoms of trees with children that hardly give way: light ones between heavy ones. The multiplier of such a child is a
// difference that is divided by what it offers. In twice the precision enough of it is left.
#pragma once

#include "core/kernels/molecules/network/tensor.hpp"
#include "core/kernels/molecules/scratch.hpp"
#include "core/kernels/molecules/twice.hpp"
#include "core/plan/sparse_ldl.hpp"

namespace holonomic::HOL_ISA::graph {

// y - D.a
HOL_INLINE double left_of(double y, const Vector3<double> &D, const Pair3<double> &a) {
    const Pair<double> left = subtract_pairs(
        {y, 0.0}, add_pairs(scale_pair(D.x, a.x), add_pairs(scale_pair(D.y, a.y), scale_pair(D.z, a.z))));
    return left.hi + left.lo;
}

struct StiffJoints {
    struct StiffJoint {
        Pair3<double> row[3];  // the inverse mass that children leave
    };
    StiffJoint *joint;
    int32_t *is;          // whether it is one; else nothing is known of it
    Pair3<double> *push;  // from the children's y

    static int64_t values_of_factor(int32_t n) { return in_fours(18 * static_cast<int64_t>(n)) + in_fours(n / 2 + 1); }
    static int64_t values(int32_t n) { return values_of_factor(n) + in_fours(6 * static_cast<int64_t>(n)); }
    StiffJoints(int32_t n, Memory<double> &of_factor, Memory<double> &memory)
        : joint(reinterpret_cast<StiffJoint *>(of_factor.values(in_fours(18 * static_cast<int64_t>(n))))),
          is(reinterpret_cast<int32_t *>(of_factor.values(in_fours(n / 2 + 1)))),
          push(reinterpret_cast<Pair3<double> *>(memory.values(in_fours(6 * static_cast<int64_t>(n))))) {}

    void begin(int32_t i, double w) const {
        const Tensor<double> mass = diagonal_tensor(w);
        for (int c = 0; c < 3; ++c) joint[i].row[c] = pairs_of(mass.row[c], Vector3<double>{});
    }
    // As add_offer() of tensor.hpp.
    void add_offer(int32_t i, double E, const Vector3<double> &b, const Vector3<double> &D) const {
        Pair3<double> *const row = joint[i].row;
        const Pair3<double> pushed = times(i, pairs_of(b, Vector3<double>{})),
                            by = add_pairs(scale_by(D.x, row[0]),
                                           add_pairs(scale_by(D.y, row[1]), scale_by(D.z, row[2])));
        const Pair<double> whole = add_pairs({E, 0.0}, dot_pairs(pairs_of(D, Vector3<double>{}), pushed));
        const Pair<double> along[3] = {pushed.x, pushed.y, pushed.z};
        for (int c = 0; c < 3; ++c) {
            const Pair<double> part = quotient(along[c], whole);
            row[c] = subtract_pairs(
                row[c], {multiply_pairs(part, by.x), multiply_pairs(part, by.y), multiply_pairs(part, by.z)});
        }
    }
    Tensor<double> mass(int32_t i) const {
        const Pair3<double> *const row = joint[i].row;
        return {{rounded(row[0]), rounded(row[1]), rounded(row[2])}};
    }
    double offered(int32_t i, const Vector3<double> &D, const Vector3<double> &b) const {
        const Vector3<double> none = {};
        const Pair<double> sum = dot_pairs(pairs_of(D, none), times(i, pairs_of(b, none)));
        return sum.hi + sum.lo;
    }
    void set_push(int32_t i, const Pair3<double> &sum) const { push[i] = sum; }
    // By its children, and by another pull.
    Pair3<double> acceleration(int32_t i) const { return times(i, push[i]); }
    Pair3<double> acceleration(int32_t i, const Pair3<double> &pull) const {
        return times(i, add_pairs(push[i], pull));
    }

private:
    static Pair3<double> scale_by(double f, const Pair3<double> &a) { return scale_pairs(f, a); }
    Pair3<double> times(int32_t i, const Pair3<double> &a) const {
        const Pair3<double> *const row = joint[i].row;
        return {dot_pairs(row[0], a), dot_pairs(row[1], a), dot_pairs(row[2], a)};
    }
    static Pair<double> quotient(const Pair<double> &a, const Pair<double> &b) {
        const double q = a.hi / b.hi;
        const Pair<double> left = subtract_pairs(a, scale_pair(q, b));
        return two_sum<double>(q, (left.hi + left.lo) / b.hi);
    }
};

}  // namespace holonomic::HOL_ISA::graph
