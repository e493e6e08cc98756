#include "core/positions.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <new>

#include "core/caller/view.hpp"
#include "core/forces.hpp"
#include "core/run/apart.hpp"
#include "core/run/diagnose.hpp"
#include "core/run/execute.hpp"
#include "holonomic.h"

namespace holonomic {

namespace {

constexpr double epsilon = 2.220446049250313e-16;

// In more solves than ordinary chains take, tau may have been much larger than it ends: its sum is rounded in that
// size, and the bonds have been moved by the summands.
constexpr std::int64_t most_solves = 5;

// Newton's method on one long chain. The decisions are those of core/kernels/newton/iterate.hpp.
class LongNewton {
public:
    LongNewton(const LongPositions &phases, const PositionsCall &call, const Lane &lane, const Team &team,
               double *store)
        : phases_(phases), call_(call), lane_(lane), team_(team), store_(store), blocks_(phases.blocks(lane.n_bonds)) {}

    void operator()(Tally &tally) {
        if (in_windows(tally)) return;
        if (!attempt(false, call_.guess, tally) && !attempt(true, false, tally)) note_bad(lane_, tally);
    }

private:
    // Makes `largest` at least e; NaN stays.
    static void raise(std::atomic<double> &largest, double e) {
        double seen = largest.load();
        while ((e > seen || (std::isnan(e) && !std::isnan(seen))) && !largest.compare_exchange_weak(seen, e)) {
        }
    }

    // Largest of what body(j, scratch) returns; NaN if any is.
    template <class Body>
    double largest(const Body &body) const {
        std::atomic<double> worst{0};
        Tally unused = empty_tally();
        team_.for_each(blocks_, unused,
                       [&](std::int64_t j, double *scratch, Tally &) { raise(worst, body(j, scratch)); });
        return worst.load();
    }

    template <class Body>
    void all(const Body &body) const {
        Tally unused = empty_tally();
        team_.for_each(blocks_, unused, [&](std::int64_t j, double *scratch, Tally &) { body(j, scratch); });
    }

    // In windows that know nothing of each other; false, with nothing written, where that does not do.
    bool in_windows(Tally &tally) const {
        if (call_.r_ref.x == call_.r.x) return false;  // the bonds of the reference are needed while atoms are moved
        const std::int64_t n = phases_.windows(lane_.n_bonds);
        std::atomic<bool> failed{false}, solved{false}, untouched{false};
        std::atomic<double> worst{0};
        Tally part = empty_tally();
        team_.for_each(n, part, [&](std::int64_t j, double *scratch, Tally &own) {
            if (failed) return;
            // Which bond has a window's largest error is looked for only if no other's is known to be larger.
            const double known = std::nextafter(worst.load(), -1.0);
            own.worst = known;
            own.worst_chain = lane_.chain;
            const WindowResult result = phases_.window(call_, lane_, j, store_, scratch, own);
            if (own.worst == known)
                own.worst_chain = -1;
            else
                raise(worst, own.worst);
            (result == window_failed ? failed : result == window_solved ? solved : untouched) = true;
        });
        if (failed || (solved && untouched)) return false;
        bool fit = true;
        Tally unused = empty_tally();
        if (solved)
            team_.for_each(1, unused, [&](std::int64_t, double *scratch, Tally &) {
                fit = phases_.windows_fit(call_, lane_, store_, scratch, part);
            });
        if (!fit) return false;
        team_.for_each(n, part, [&](std::int64_t j, double *scratch, Tally &own) {
            phases_.finish_window(call_, lane_, j, solved, store_, scratch, own);
        });
        part.n_corrected = solved;
        add(tally, part);
        return true;
    }

    double step(bool substitute) const {
        return largest([&](std::int64_t j, double *scratch) {
            return phases_.step(call_, lane_, j, substitute, store_, scratch);
        });
    }

    // Writes the results. Where single pulls move an atom so far that their rounding is more than the coordinates'
    // (light atoms between heavy ones in a taut chain), or may have done so on the way, goes on from the coordinates as
    // they are then rounded; if that does not end within the tolerance, everything is put back.
    bool finish(bool moved, std::int64_t solves, double reach, Tally &tally) {
        const bool unusual = depth_ == 0 && solves > most_solves;
        const auto pull = [&](std::int64_t j, double *) { return phases_.pull(lane_, j, store_); };
        const bool coarse = moved && (unusual || !(largest(pull) <= 0.25 * reach));
        if (!coarse) {
            write(moved, solves, tally);
            return true;
        }
        try {
            return settle(solves, tally);
        } catch (const std::bad_alloc &) {  // before anything was written; it must not leave a parallel region
            tally.out_of_memory = true;
            return false;
        }
    }

    bool settle(std::int64_t solves, Tally &tally) {
        const Saved saved(call_, lane_);
        // The second time the multipliers start at 0 in an array of their own, and are added.
        PositionsCall again = call_;
        std::vector<double> more(call_.lambda ? static_cast<std::size_t>(lane_.n_bonds) : 0);
        Lane alone = lane_;
        alone.first_bond = 0;
        again.lambda = call_.lambda ? more.data() : nullptr;
        again.guess = again.virial = false;
        Tally part = empty_tally();
        write(true, solves, part);
        LongNewton rest(phases_, again, alone, team_, store_);
        rest.depth_ = depth_ + 1;
        Tally settled = empty_tally();
        if (depth_ >= 4 || !rest.attempt(true, false, settled)) {
            saved.restore();
            tally.out_of_memory = tally.out_of_memory || settled.out_of_memory;
            return false;
        }
        for (std::size_t k = 0; k < more.size(); ++k)
            call_.lambda[lane_.first_bond + static_cast<std::int64_t>(k)] += more[k];
        part.worst = settled.worst;
        part.worst_bond = settled.worst_bond;
        add(tally, part);
        return true;
    }

    // What a chain's positions, velocities and multipliers were.
    class Saved {
    public:
        Saved(const PositionsCall &call, const Lane &lane) : call_(call), lane_(lane) {
            const std::size_t n = static_cast<std::size_t>(lane.n_bonds);
            r_.resize(3 * (n + 1));
            if (call.v.x) v_.resize(3 * (n + 1));
            for (std::size_t k = 0; k <= n; ++k) {
                read_atom(call.r, atom(k), &r_[3 * k]);
                if (call.v.x) read_atom(call.v, atom(k), &v_[3 * k]);
            }
            if (call.lambda)
                lambda_.assign(call.lambda + lane.first_bond, call.lambda + lane.first_bond + lane.n_bonds);
        }
        void restore() const {
            for (std::size_t k = 0; 3 * k < r_.size(); ++k) {
                write_atom(call_.r, atom(k), &r_[3 * k]);
                if (call_.v.x) write_atom(call_.v, atom(k), &v_[3 * k]);
            }
            std::copy(lambda_.begin(), lambda_.end(), call_.lambda + lane_.first_bond);
        }

    private:
        std::int64_t atom(std::size_t k) const {
            return lane_.atoms ? lane_.atoms[k] : lane_.first_atom + static_cast<std::int64_t>(k);
        }
        const PositionsCall &call_;
        const Lane &lane_;
        std::vector<double> r_, v_, lambda_;
    };

    void write(bool moved, std::int64_t solves, Tally &tally) const {
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
            raise(extent, part.extent);
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
        const double carried = 8 * u * (1 + extent / shortest), done = std::max(call_.tolerance, epsilon);
        const double accepted = std::max(call_.tolerance, carried);
        if (!std::isfinite(error)) return false;
        if (error <= accepted) {
            write(false, 0, tally);
            return true;
        }
        if (guess) {
            all([&](std::int64_t j, double *) { phases_.guess(call_, lane_, j, store_); });
            const double with_guess = step(false);
            if (!(with_guess <= error)) return attempt(careful, false, tally);
            error = with_guess;
            if (error <= done) {
                return finish(true, 0, extent + shortest, tally);
            }
        } else if (call_.guess) {  // tau holds the guess that is not to be used
            all([&](std::int64_t j, double *) { phases_.forget(lane_, j, store_); });
        }
        bool renew = true;
        double rate = error;  // new factors square the error
        for (std::int64_t i = 0; i < call_.max_iterations; ++i) {
            if (renew)
                all([&](std::int64_t j, double *scratch) {
                    phases_.factorize(call_, lane_, j, careful, store_, scratch);
                });
            if (!phases_.join(lane_, renew, store_)) return false;
            const double before = error, expected_error = rate * before;
            error = step(true);
            if (!std::isfinite(error)) return false;
            const bool floor = (expected_error < 0.125 * epsilon && error <= 4 * epsilon) || error > 0.25 * before;
            if (error <= done || (floor && error <= accepted)) {
                return finish(true, i + 1, extent + shortest, tally);
            }
            rate = error / before;
            double expected = error * rate;
            for (std::int64_t k = i + 2; k < 4; ++k) expected *= rate;
            renew = careful || (expected > 0.1 * epsilon && (i < 2 || rate > 1e-4));
            if (renew) rate = error;
        }
        return false;
    }

    const LongPositions &phases_;
    const PositionsCall &call_;
    const Lane &lane_;
    const Team &team_;
    double *const store_;
    const std::int64_t blocks_;
    int depth_ = 0;
};

struct PositionsWork final : Work {
    const Variants<PositionsCall> calls;
    const Kernels &k = kernels();
    PositionsWork(const PositionsCall &call, Apart &apart)
        : calls(
              call, apart, [&](PositionsCall &c) { c.lambda = apart.results(call.lambda); },
              [&](PositionsCall &c) {
                  c.r_ref = apart.atoms(call.r_ref);
                  c.r = apart.moved_atoms(call.r);
                  c.v = apart.moved_atoms(call.v);
              }) {}
    void unit(const Unit &unit, int where, double *scratch, Tally &tally) const override {
        kernels(unit).positions(calls[where], unit, scratch, tally);
    }
    void unit(const MoleculeUnit &unit, int where, double *scratch, Tally &tally) const override {
        k.molecules.positions(calls[where], unit, scratch, tally);
    }
    int images(int where, Images *images) const override {
        images[0] = {&calls[where].r_ref, &calls[where].box_ref};
        images[1] = {&calls[where].r, &calls[where].box};
        return 2;
    }
    std::int64_t long_blocks(std::int64_t n) const override { return k.long_positions.blocks(n); }
    std::int64_t long_bytes(std::int64_t n) const override { return k.long_positions.bytes(n); }
    void long_chain(const Lane &lane, int where, const Team &team, double *store, Tally &tally) const override {
        LongNewton(k.long_positions, calls[where], lane, team, store)(tally);
    }
};

}  // namespace

void project_positions(const Chains &chains, const AtomArray &r_ref, const AtomArray &r, const AtomArray &v, double dt,
                       double *lambda, bool guess, double *virial, hol_report *report) {
    const PositionsCall call{r_ref,
                             r,
                             v,
                             lambda,
                             dt,
                             guess,
                             virial != nullptr,
                             report != nullptr,
                             chains.tolerance,
                             chains.max_iterations,
                             chains.box,
                             chains.box_of_reference()};
    Apart apart(chains);
    const Tally tally = execute(chains, PositionsWork(call, apart));
    apart.put_back();
    clear_unconstrained(chains, lambda);
    if (report) {
        report->iterations = tally.iterations;
        report->n_corrected = tally.n_corrected;
        report->n_failed = tally.n_bad;
        report->chain = tally.worst_chain < 0 ? -1 : tally.worst_chain + chains.base;
        report->bond = tally.worst_chain < 0 ? -1 : tally.worst_bond + chains.base;
        report->max_error = tally.worst;
    }
    if (tally.out_of_memory) throw std::bad_alloc();
    if (tally.n_bad > 0) {
        const NamedArray arrays[] = {{"reference position", &r_ref}, {"position", &r}, {"velocity", &v}};
        throw diagnose(chains, tally, chains.box_of_reference(), arrays, 3, Status::no_convergence);
    }
    if (virial) write_virial(tally, virial);
}

}  // namespace holonomic
