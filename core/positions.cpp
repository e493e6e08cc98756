#include "positions.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "diagnose.hpp"
#include "execute.hpp"
#include "forces.hpp"
#include "holonomic.h"

namespace holonomic {

namespace {

constexpr double epsilon = 2.220446049250313e-16;

// Newton's method on one long chain. The decisions are those of core/kernels/positions.inl.
class LongNewton {
public:
    LongNewton(const LongPositions &phases, const PositionsCall &call, const Lane &lane, const Team &team,
               double *store)
        : phases_(phases), call_(call), lane_(lane), team_(team), store_(store), blocks_(phases.blocks(lane.n_bonds)) {}

    void operator()(Tally &tally) {
        if (!attempt(false, call_.guess, tally) && !attempt(true, false, tally)) note_bad(lane_, tally);
    }

private:
    // Largest of what body(j, scratch) returns; NaN if any is.
    template <class Body>
    double largest(const Body &body) const {
        std::atomic<double> worst{0};
        Tally unused = empty_tally();
        team_.for_each(blocks_, unused, [&](std::int64_t j, double *scratch, Tally &) {
            const double e = body(j, scratch);
            double seen = worst.load();
            while ((e > seen || (std::isnan(e) && !std::isnan(seen))) && !worst.compare_exchange_weak(seen, e)) {
            }
        });
        return worst.load();
    }

    template <class Body>
    void all(const Body &body) const {
        Tally unused = empty_tally();
        team_.for_each(blocks_, unused, [&](std::int64_t j, double *scratch, Tally &) { body(j, scratch); });
    }

    double correct() const {
        return largest([&](std::int64_t j, double *scratch) {
            return phases_.correct(call_, lane_, j, store_, scratch);
        });
    }

    void finish(bool moved, std::int64_t solves, Tally &tally) const {
        team_.for_each(blocks_, tally, [&](std::int64_t j, double *scratch, Tally &part) {
            phases_.finish(call_, lane_, j, moved, store_, scratch, part);
        });
        tally.n_corrected += moved;
        tally.iterations = std::max(tally.iterations, solves);
    }

    double load(double &error) const {
        std::atomic<double> extent{0};
        error = largest([&](std::int64_t j, double *scratch) {
            LongTally part{0, 0};
            phases_.load(call_, lane_, j, store_, scratch, part);
            double seen = extent.load();
            while (part.extent > seen && !extent.compare_exchange_weak(seen, part.extent)) {
            }
            return part.error;
        });
        return extent.load();
    }

    bool attempt(bool careful, bool guess, Tally &tally) {
        double error;
        const double extent = load(error);
        double shortest = lane_.length_uniform;
        for (std::int64_t k = 0; lane_.length && k < lane_.n_bonds; ++k) shortest = std::min(shortest, lane_.length[k]);
        const double u = call_.r.is_float ? 5.97e-8 : 1.11e-16;
        const double carried = 8 * u * (1 + extent / shortest), done = std::max(call_.tolerance, 4 * epsilon);
        const double accepted = std::max(done, carried);
        if (!std::isfinite(error)) return false;
        if (error <= std::max(call_.tolerance, carried)) {
            finish(false, 0, tally);
            return true;
        }
        if (guess) {
            all([&](std::int64_t j, double *) { phases_.guess(call_, lane_, j, store_); });
            const double with_guess = correct();
            if (!(with_guess <= error)) return attempt(careful, false, tally);
            error = with_guess;
            if (error <= done) {
                finish(true, 0, tally);
                return true;
            }
        } else if (call_.guess) {  // tau holds the guess that is not to be used
            all([&](std::int64_t j, double *) { phases_.forget(lane_, j, store_); });
        }
        bool renew = true;
        for (std::int64_t i = 0; i < call_.max_iterations; ++i) {
            all([&](std::int64_t j, double *scratch) {
                phases_.solve(call_, lane_, j, renew, careful, store_, scratch);
            });
            if (!phases_.join(lane_, renew, store_)) return false;
            all([&](std::int64_t j, double *) { phases_.substitute(call_, lane_, j, store_); });
            const double before = error;
            error = correct();
            if (!std::isfinite(error)) return false;
            if (error <= done || (error > 0.25 * before && error <= accepted)) {
                finish(true, i + 1, tally);
                return true;
            }
            renew = careful || error > 1e-3 * before;
        }
        return false;
    }

    const LongPositions &phases_;
    const PositionsCall &call_;
    const Lane &lane_;
    const Team &team_;
    double *const store_;
    const std::int64_t blocks_;
};

struct PositionsWork final : Work {
    const PositionsCall &call;
    const Kernels &k = kernels();
    explicit PositionsWork(const PositionsCall &c) : call(c) {}
    void unit(const Unit &unit, double *scratch, Tally &tally) const override {
        k.positions(call, unit, scratch, tally);
    }
    std::int64_t long_blocks(std::int64_t n) const override { return k.long_positions.blocks(n); }
    std::int64_t long_bytes(std::int64_t n) const override { return k.long_positions.bytes(n); }
    void long_chain(const Lane &lane, const Team &team, double *store, Tally &tally) const override {
        LongNewton(k.long_positions, call, lane, team, store)(tally);
    }
};

}  // namespace

void project_positions(const Chains &chains, const AtomArray &r_ref, const AtomArray &r, const AtomArray &v, double dt,
                       double *lambda, bool guess, double *virial, hol_report *report) {
    const PositionsCall call{r_ref, r,     v, lambda, dt, guess, virial != nullptr, chains.tolerance,
                             chains.max_iterations, chains.box};
    const Tally tally = execute(chains, PositionsWork(call));
    if (report) {
        report->iterations = tally.iterations;
        report->n_corrected = tally.n_corrected;
        report->n_failed = tally.n_bad;
        report->chain = tally.worst_chain < 0 ? -1 : tally.worst_chain + chains.base;
        report->bond = tally.worst_chain < 0 ? -1 : tally.worst_bond + chains.base;
        report->max_error = tally.worst;
    }
    if (tally.n_bad > 0) {
        const NamedArray arrays[] = {{"reference position", &r_ref}, {"position", &r}, {"velocity", &v}};
        throw diagnose(chains, tally, arrays, 3, HOL_ERR_NO_CONVERGENCE);
    }
    if (virial) write_virial(tally, virial);
}

}  // namespace holonomic
