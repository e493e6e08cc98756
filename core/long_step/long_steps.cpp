#include "core/long_step/long_steps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "core/caller/box.hpp"
#include "core/kernels/atom.hpp"
#include "core/long_step/one_molecule.hpp"
#include "core/long_step/roots.hpp"
#include "core/reference.hpp"
#include "core/run/lane.hpp"
#include "core/run/outcomes.hpp"

namespace holonomic {

namespace {

constexpr std::int64_t most_rounds = 1000;  // of SHAKE
// Newton's method that takes more has lost its way.
constexpr int iterations_on_the_way = 14;
// In larger molecules a path may fail for other reasons than that it ends: what Newton's method has found stands.
constexpr std::int64_t most_watched = 256;
// Two roots that differ by less of a bond are one.
constexpr double same = 1e-3;

class LongSteps {
public:
    LongSteps(const Chains &chains, const PositionsCall &call, const Reference *reference, const Tally &tally)
        : chains_(chains), call_(call), reference_(reference), first_(tally), total_(tally) {}

    Tally run() {
        const Plan &plan = chains_.plan();
        for (const Plan::Chunk &chunk : plan.chunks) {
            if (chunk.shape == linear) {
                Lane first;
                const Unit unit = chains_.unit(plan, chunk, &first);
                for (std::int64_t i = 0; i < unit.count; ++i) {
                    const Lane lane = lane_of(unit, i);
                    look_at({&lane, nullptr, nullptr, nullptr}, lane.chain);
                }
                continue;
            }
            MoleculeLane first;
            const MoleculeUnit unit = chains_.unit(plan, chunk, &first);
            const bool mixed = unit.tree_batches && unit.count > 1;
            std::int64_t i = 0;
            for (std::int64_t f = 0; mixed && f < unit.n_batches; ++f)
                for (int l = 0; l < unit.tree_batches[f].n_trees; ++l, ++i)
                    look_at({nullptr, &unit.lanes[i], unit.tree_batches[f].elimination[l], nullptr},
                            unit.lanes[i].molecule);
            for (; i < unit.count; ++i) {
                const MoleculeLane lane = lane_of(unit, i);
                look_at({nullptr, &lane, unit.elimination, unit.tree_batches}, lane.molecule);
            }
        }
        total_.n_bad = first_.n_bad - n_solved_;
        if (total_.n_bad == 0)
            total_.first_bad = -1;
        else if (first_left_ >= 0)
            total_.first_bad = first_left_;
        return total_;
    }

private:
    // What coordinates carry, and four times that, so that nothing that has been solved looks as if it had not.
    double carried(const Molecule &m) const {
        double extent = 0, shortest = std::numeric_limits<double>::infinity();
        for (std::int64_t i = 0; i < m.n_atoms; ++i) {
            double x[3];
            read_atom(call_.r, m.atom(i), x);
            for (const double c : x) extent = std::max(extent, std::fabs(c));
        }
        for (std::int64_t k = 0; k < m.n_bonds; ++k) shortest = std::min(shortest, m.length(k));
        const double rounding = 8 * (call_.r.is_float ? 5.97e-8 : 1.11e-16) * (1 + extent / shortest);
        return 4 * std::max(call_.tolerance, rounding);
    }

    void look_at(const Planned &planned, std::int64_t number) {
        if (n_solved_ == first_.n_bad) return;
        const Molecule m = chains_.molecule(number);
        double trial = 0;
        for (std::int64_t k = 0; k < m.n_bonds; ++k) {
            double from[3], to[3], d[3];
            read_atom(call_.r, m.atom(m.i(k)), from);
            read_atom(call_.r, m.atom(m.j(k)), to);
            bond_vector(call_.box, from, to, d);
            const double a = m.length(k);
            const double error = std::fabs(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] - a * a) / (a * a);
            if (!(error <= trial)) trial = error;
        }
        if (trial <= carried(m)) return;
        Tally own = empty_tally();
        if (trial <= call_.worst_trial && try_to_solve(planned, m, own)) {
            ++n_solved_;
            add(total_, own);
            if (OutcomeOf *const outcomes = outcomes_under_way())
                outcomes[number] = {0, static_cast<std::int32_t>(own.iterations)};
        } else if (first_left_ < 0 || number < first_left_) {
            first_left_ = number;
        }
    }

    bool try_to_solve(const Planned &planned, const Molecule &m, Tally &own) {
        try {
            return solve(planned, m, own);
        } catch (const std::bad_alloc &) {
            return false;
        }
    }

    bool solve(const Planned &planned, const Molecule &m, Tally &own) {
        if (reference_) reference_->show(m.number);
        const StepBonds step(m, call_.r_ref, call_.box_ref, call_.r, call_.box);
        OneMolecule one(chains_, planned, m);
        one.read(call_);
        const double scale = 2 * call_.dt * call_.dt;
        const std::size_t n = one.lambda.size();
        std::vector<double> newton(n), tau(n);
        bool found = false;
        if (step.error() > far_from_lengths) {
            for (std::size_t k = 0; call_.guess && k < n; ++k)
                one.lambda[k] = call_.lambda[m.bond(static_cast<std::int64_t>(k))];
            PositionsCall first = call_;
            first.max_iterations = std::min(first.max_iterations, iterations_on_the_way);
            found = one.solve(first, own);
            for (std::size_t k = 0; k < n; ++k) newton[k] = scale * one.lambda[k];
            if (found && step.is_certified(newton)) return accept(one);
        }
        if (chains_.max_iterations < enough_iterations) return found && accept(one);
        std::int64_t solves = 0;
        const bool path = step.follow(4 * std::int64_t{chains_.max_iterations}, tau, solves);
        if (found && !path && m.n_bonds > most_watched) return accept(one);
        // Beyond the path's end SHAKE comes to anything, mostly to bonds that point backwards.
        if (!path && !(m.n_bonds <= most_watched && step.shake(most_rounds, tau) && step.is_certified(tau)))
            return false;
        if (found && step.distance(newton, tau) < same) return accept(one);
        // Newton's method from there, in the caller's arrays' precision.
        own = empty_tally();
        one.read(call_);
        for (std::size_t k = 0; k < n; ++k) one.lambda[k] = tau[k] / scale;
        PositionsCall last = call_;
        last.guess = true;
        if (!one.solve(last, own)) return false;
        for (std::size_t k = 0; k < n; ++k) newton[k] = scale * one.lambda[k];
        own.iterations += solves;
        return step.distance(newton, tau) < same && accept(one);
    }

    bool accept(const OneMolecule &one) const {
        one.write(call_);
        return true;
    }

    const Chains &chains_;
    const PositionsCall &call_;
    const Reference *const reference_;
    const Tally first_;
    Tally total_;
    std::int64_t n_solved_ = 0, first_left_ = -1;
};

}  // namespace

Tally finish_long_steps(const Chains &chains, const PositionsCall &call, const Reference *reference,
                        const Tally &tally) {
    return LongSteps(chains, call, reference, tally).run();
}

}  // namespace holonomic
