// Where Newton's method loses its way in a long step: the solution is followed from the reference, where all
// multipliers are 0. At t it fulfils the rows of positions reference + t (trial - reference), but for 1 - t of what the
// reference itself leaves of them. Steps in t are as long as Newton's method halves what is left at least twice.
#include <algorithm>
#include <cmath>

#include "core/index.hpp"
#include "core/rigid/system.hpp"

namespace holonomic::rigid {

namespace {

bool differs(const PairVector &a, const PairVector &b) {
    const Vector3<double> d = rounded(a - b);
    return d.x != 0 || d.y != 0 || d.z != 0;
}

// |d.d - a^2| / a^2: where a step may begin, and where it is done.
constexpr double near = 0.3, close = 1e-9;
constexpr double first_step = 0.25, shortest_step = 1.0 / 512;
constexpr int most_solves = 100, solves_a_step = 6, few = 3;

}  // namespace

int System::follow(const Conformation &from, const Conformation &to, DoublePair *multipliers) const {
    for (std::size_t k = 0; k < s_.bonds.size(); ++k)  // a cycle that goes round the box another way than it did
        if (s_.bonds[k].row >= 0 && differs(to.shift[k], from.shift[k])) return 0;
    const std::int32_t n = s_.n_rows;
    double *const tau = path_, *const accepted = path_ + n, *const slope = path_ + 2 * n;
    std::fill(path_, path_ + 3 * std::int64_t{n}, 0.0);
    residuals(from, c);
    // q as tau moves it, and what is left of the rows, in x_.
    const auto move = [&](double part) {
        for (std::int32_t i = 0; i < s_.n_nodes; ++i) to.q[i] = from.q[i] + part * (start_[i] - from.q[i]);
        for (std::int32_t k = 0; k < n; ++k) move_along(from, k, tau[k], to.q);
        residuals(to, residual_);
        double error = 0;
        for (std::int32_t k = 0; k < n; ++k) {
            x_[k] = rounded(residual_[k] - (1 - part) * c[k]);
            const double one = 2 * std::fabs(x_[k]) / s_.scale[at(k)];
            if (!(one <= error)) error = one;  // keeps a NaN
        }
        return error;
    };
    int solves = 0;
    const auto correct = [&](double part) {
        double error = move(part);
        for (int i = 0; error < near && solves < most_solves; ++i) {
            if (error <= close) return i;
            if (i == solves_a_step) break;
            differentiate(to);
            if (assemble(plain_, to, from) >= 0) break;
            plain_.solve(s_, x_);
            ++solves;
            for (std::int32_t k = 0; k < n; ++k) tau[k] += x_[k];
            const double before = error;
            error = move(part);
            if (!(error <= close || 4 * error < before)) break;
        }
        return -1;
    };
    double done = 0;
    for (double step = first_step; done < 1;) {
        const double next = std::min(done + step, 1.0);
        for (std::int32_t k = 0; k < n; ++k) tau[k] = accepted[k] + (next - done) * slope[k];
        const int i = correct(next);
        if (i < 0) {
            step = 0.5 * (next - done);
            if (step < shortest_step || solves >= most_solves) return 0;
            continue;
        }
        for (std::int32_t k = 0; k < n; ++k) {
            slope[k] = (tau[k] - accepted[k]) / (next - done);
            accepted[k] = tau[k];
        }
        done = next;
        if (i <= few) step *= 2;
    }
    for (std::int32_t k = 0; k < n; ++k) multipliers[k] = as_pair(tau[k]);
    return std::max(solves, 1);
}

}  // namespace holonomic::rigid
