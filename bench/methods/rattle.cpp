// Sweeps over the bonds, one at a time, until all are within the tolerance: Ryckaert, Ciccotti and Berendsen 1977 for
// positions, Andersen 1983 for velocities. A bond neither of whose atoms moved in the last sweep is not looked at
// again, as in Allen and Tildesley's programs.
#include <algorithm>
#include <cmath>
#include <memory>

#include "methods.hpp"

namespace bench {
namespace {

const std::int64_t sweeps_at_most = 200000;

struct Moved {
    std::vector<char> last, now;
    explicit Moved(std::size_t atoms) : last(atoms), now(atoms) {}
    void start() { std::fill(last.begin(), last.end(), char(1)); }
    bool bond(std::size_t k) const { return last[k] || last[k + 1]; }
    void mark(std::size_t k) { now[k] = now[k + 1] = 1; }
    void next() {
        last.swap(now);
        std::fill(now.begin(), now.end(), char(0));
    }
};

/// SHAKE along the bonds b of the reference positions; returns the number of sweeps.
std::int64_t shake(const Problem &p, const double *b, double tolerance, Moved &moved, double *r) {
    const std::size_t n = p.n();
    moved.start();
    moved.next();
    moved.start();
    for (std::int64_t sweep = 1; sweep <= sweeps_at_most; ++sweep) {
        bool done = true;
        double at[3] = {r[0], r[1], r[2]};  // of atom k, in registers: each bond waits for the one before it
        for (std::size_t k = 0; k < n; ++k) {
            double *r1 = r + 3 * k + 3, next[3] = {r1[0], r1[1], r1[2]};
            const double *bond = b + 3 * k;
            const double square = p.length[k] * p.length[k];
            const double d[3] = {next[0] - at[0], next[1] - at[1], next[2] - at[2]};
            const double excess = d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - square;
            if (moved.bond(k) && std::abs(excess) > tolerance * square) {
                const double along = d[0] * bond[0] + d[1] * bond[1] + d[2] * bond[2];
                const double t = excess / (2 * (p.w[k] + p.w[k + 1]) * along);
                const double pull = p.w[k] * t, push = p.w[k + 1] * t;
                for (int x = 0; x < 3; ++x) {
                    r1[x - 3] = at[x] + pull * bond[x];
                    r1[x] = next[x] -= push * bond[x];
                }
                moved.mark(k);
                done = false;
            }
            for (int x = 0; x < 3; ++x) at[x] = next[x];
        }
        if (done) return sweep - 1;
        moved.next();
    }
    return sweeps_at_most;
}

/// The same for velocities along the bonds d; a bond is done when |d.dv| dt <= tolerance d.d: relative to the drift.
std::int64_t rattle_velocities(const Problem &p, const double *d, double tolerance, Moved &moved, double *v) {
    const std::size_t n = p.n();
    moved.start();
    moved.next();
    moved.start();
    for (std::int64_t sweep = 1; sweep <= sweeps_at_most; ++sweep) {
        bool done = true;
        double at[3] = {v[0], v[1], v[2]};
        for (std::size_t k = 0; k < n; ++k) {
            double *v1 = v + 3 * k + 3, next[3] = {v1[0], v1[1], v1[2]};
            const double *bond = d + 3 * k;
            const double square = bond[0] * bond[0] + bond[1] * bond[1] + bond[2] * bond[2];
            const double rate = bond[0] * (next[0] - at[0]) + bond[1] * (next[1] - at[1]) + bond[2] * (next[2] - at[2]);
            if (moved.bond(k) && std::abs(rate) > tolerance * square) {
                const double t = rate / ((p.w[k] + p.w[k + 1]) * square);
                const double pull = p.w[k] * t, push = p.w[k + 1] * t;
                for (int x = 0; x < 3; ++x) {
                    v1[x - 3] = at[x] + pull * bond[x];
                    v1[x] = next[x] -= push * bond[x];
                }
                moved.mark(k);
                done = false;
            }
            for (int x = 0; x < 3; ++x) at[x] = next[x];
        }
        if (done) return sweep - 1;
        moved.next();
    }
    return sweeps_at_most;
}

}  // namespace

Method rattle(Level level, const Problem &p, double tolerance) {
    auto bonds = std::make_shared<std::vector<double>>(3 * p.n());
    auto moved = std::make_shared<Moved>(p.n() + 1);
    return {"rattle", tolerance_setting(tolerance), [&p, level, tolerance, bonds, moved](State &state) {
                state.iterations = 0;
                for (std::size_t c = 0; c < p.n_chains(); ++c) {
                    const std::size_t atom = 3 * p.first_atom(c);
                    for (std::size_t i = 0; i < 3 * p.n(); ++i) (*bonds)[i] = p.r[atom + i + 3] - p.r[atom + i];
                    const std::int64_t sweeps =
                        level == Level::position
                            ? shake(p, bonds->data(), tolerance, *moved, &state.r[atom])
                            : rattle_velocities(p, bonds->data(), tolerance, *moved, &state.v[atom]);
                    state.iterations = std::max(state.iterations, sweeps);
                }
            }};
}

}  // namespace bench
