#include "core/impose.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/caller/box.hpp"
#include "core/caller/packed_array.hpp"
#include "core/error.hpp"
#include "core/kernels/tally.hpp"
#include "core/rigid/parts.hpp"
#include "core/rigid/verbs.hpp"
#include "core/run/diagnose.hpp"
#include "core/run/outcomes.hpp"
#include "core/solve.hpp"

namespace holonomic {

namespace {

// In one step a bond's length is to change by no more than this part of it, and its vector by no more than twice that:
// Newton's method is good for what is nearly linear.
constexpr double most_change = 0.3;
// Below this error steps are whole ones, which square it, so that one that does not lessen it has met the rounding.
constexpr double nearly_there = 1e-9;
// Steps for each iteration that a projection may take: where masses lie decades apart, what is short for the light ones
// takes the heavy ones nowhere.
constexpr std::int64_t steps_per_iteration = 20;
// Steps may end where they go round in circles (cages). What SHAKE does, bond after bond, is slow but takes no notice
// of that: after so many rounds of it another attempt begins elsewhere.
constexpr int rounds_before[] = {100, 1000};

enum class State : unsigned char { on_the_way, arrived, lost };

struct Progress {
    State state = State::on_the_way;
    std::int32_t steps = 0;
    double error = std::numeric_limits<double>::infinity();
    std::int64_t bond = -1;  // with that error
};

class Approach {
public:
    Approach(const Chains &chains, const AtomArray &r)
        : chains_(chains), x_(static_cast<std::size_t>(3 * chains.n_atoms())), g_(x_.size()),
          rhs_(static_cast<std::size_t>(chains.n_bonds())), progress_(static_cast<std::size_t>(chains.n_chains())) {
        chains.for_active([&](const Molecule &m) {
            read(r, m);
            return true;
        });
    }

    void run(const AtomArray &r) {
        walk();
        for (const int rounds : rounds_before)
            if (begin_again(r, rounds)) walk();
    }

    const Progress &of(const Molecule &m) const { return progress_[static_cast<std::size_t>(m.number)]; }
    const double *position(std::int64_t atom) const { return &x_[static_cast<std::size_t>(3 * atom)]; }

private:
    static double *at(std::vector<double> &vectors, std::int64_t atom) {
        return &vectors[static_cast<std::size_t>(3 * atom)];
    }
    Progress &of(const Molecule &m) { return progress_[static_cast<std::size_t>(m.number)]; }

    void read(const AtomArray &r, const Molecule &m) {
        for (std::int64_t i = 0; i < m.n_atoms; ++i) read_atom(r, m.atom(i), at(x_, m.atom(i)));
    }

    // Molecules that have not arrived begin where so many rounds take them. Whether there are any.
    bool begin_again(const AtomArray &r, int rounds) {
        bool any = false;
        chains_.for_active([&](const Molecule &m) {
            Progress &p = of(m);
            if (p.state == State::arrived) return true;
            any = true;
            read(r, m);
            for (int round = 0; round < rounds; ++round) sweep(m);
            ++p.steps;
            p.state = State::on_the_way;
            p.error = std::numeric_limits<double>::infinity();
            return true;
        });
        return any;
    }

    // Newton's steps of all molecules that are on their way, until none is or they have had enough.
    void walk() {
        for (std::int64_t step = 0; survey() && step < steps_per_iteration * chains_.max_iterations; ++step) {
            std::fill(g_.begin(), g_.end(), 0.0);  // stays where a molecule can't be solved
            solve_equations(chains_, packed_array(x_.data()), rhs_.data(),
                            {nullptr, nullptr, packed_array(g_.data()), false, false});
            chains_.for_active([&](const Molecule &m) {
                if (of(m).state == State::on_the_way) move(m);
                return true;
            });
        }
    }

    // Each bond by itself gets its length, along itself. Atoms on each other are left to their other bonds.
    void sweep(const Molecule &m) {
        for (std::int64_t k = 0; k < m.n_bonds; ++k) {
            double d[3];
            bond(m, k, d);
            const double dd = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], a = m.length(k);
            const double w_i = m.w(m.i(k)), w_j = m.w(m.j(k));
            if (!(dd > 0) || w_i + w_j == 0) continue;
            const double part = (a / std::sqrt(dd) - 1) / (w_i + w_j);
            for (int c = 0; c < 3; ++c) {
                at(x_, m.atom(m.i(k)))[c] -= part * w_i * d[c];
                at(x_, m.atom(m.j(k)))[c] += part * w_j * d[c];
            }
        }
    }

    void bond(const Molecule &m, std::int64_t k, double *d) const {
        bond_vector(chains_.box, position(m.atom(m.i(k))), position(m.atom(m.j(k))), d);
    }

    // Measures all errors, and writes what a step is to do: 0 for molecules that have arrived. Whether any is on its
    // way.
    bool survey() {
        bool any = false;
        chains_.for_active([&](const Molecule &m) {
            Progress &p = of(m);
            if (p.state == State::on_the_way) measure(m, p);
            if (p.state == State::on_the_way)
                any = true;
            else
                for (std::int64_t k = 0; k < m.n_bonds; ++k) rhs_[static_cast<std::size_t>(m.bond(k))] = 0;
            return true;
        });
        return any;
    }

    void measure(const Molecule &m, Progress &p) {
        const double before = p.error;
        double shortest = std::numeric_limits<double>::infinity(), largest = 0;
        p.error = 0;
        for (std::int64_t k = 0; k < m.n_bonds; ++k) {
            double d[3];
            bond(m, k, d);
            const double dd = d[0] * d[0] + d[1] * d[1] + d[2] * d[2], a = m.length(k);
            const double error = std::fabs(dd - a * a) / (a * a), length = std::sqrt(dd);
            const double aim = std::min(std::max(a, length / (1 + most_change)), length * (1 + most_change));
            rhs_[static_cast<std::size_t>(m.bond(k))] = dd - aim * aim;
            shortest = std::min(shortest, a);
            for (int c = 0; c < 3; ++c) largest = std::max(largest, std::fabs(position(m.atom(m.j(k)))[c]));
            if (!(error <= p.error)) {
                p.error = error;
                p.bond = k;
            }
            if (!std::isfinite(error)) {
                p.state = State::lost;
                return;
            }
        }
        const double rounding = 4 * std::numeric_limits<double>::epsilon() * (1 + largest / shortest);
        if (p.error <= std::max(chains_.tolerance, rounding) || (p.error < nearly_there && p.error > before / 4))
            p.state = State::arrived;
    }

    void move(const Molecule &m) {
        double largest = 0;
        for (std::int64_t k = 0; k < m.n_bonds; ++k) {
            double d[3], change = 0;
            bond(m, k, d);
            for (int c = 0; c < 3; ++c) {
                const double u = shift(m, m.j(k), c) - shift(m, m.i(k), c);
                change += u * u;
            }
            const double ratio = change / (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
            if (!(ratio <= largest)) largest = ratio;
        }
        Progress &p = of(m);
        if (!(largest > 0) || !std::isfinite(largest)) {  // not solved, or nothing that moves
            p.state = p.error < nearly_there ? State::arrived : State::lost;
            return;
        }
        const double part = std::min(1.0, 2 * most_change / std::sqrt(largest));
        for (std::int64_t i = 0; i < m.n_atoms; ++i)
            for (int c = 0; c < 3; ++c) at(x_, m.atom(i))[c] += part * shift(m, i, c);
        ++p.steps;
    }

    double shift(const Molecule &m, std::int64_t i, int c) const {
        return m.w(i) * g_[static_cast<std::size_t>(3 * m.atom(i) + c)];
    }

    const Chains &chains_;
    std::vector<double> x_, g_, rhs_;
    std::vector<Progress> progress_;
};

void finish(const Chains &chains, const AtomArray &r, const Approach &approach, Report *report) {
    Report found{0, 0, 0, -1, -1, 0, true};
    Tally tally = empty_tally();
    OutcomeOf *const outcomes = outcomes_under_way();
    chains.for_active([&](const Molecule &m) {
        const Progress &p = approach.of(m);
        if (outcomes) note_outcome(outcomes[m.number], p.state == State::arrived, p.steps);
        found.iterations = std::max<std::int64_t>(found.iterations, p.steps);
        if (p.state != State::arrived) {
            note_bad(m.number, tally);
            return true;
        }
        if (found.chain < 0 || p.error > found.max_error) {
            found.max_error = p.error;
            found.chain = m.number + chains.base;
            found.bond = p.bond < 0 ? chains.base : p.bond + chains.base;
        }
        if (p.steps == 0) return true;
        ++found.n_corrected;
        for (std::int64_t i = 0; i < m.n_atoms; ++i)
            if (m.w(i) != 0) write_atom(r, m.atom(i), approach.position(m.atom(i)));
        return true;
    });
    found.n_failed = tally.n_bad;
    if (report) *report = found;
    if (tally.n_bad == 0) return;
    // The reference is r itself.
    throw_diagnosis(chains, tally, {{"position", &r}, {"position", &r}}, Status::no_convergence);
}

}  // namespace

void impose(const Chains &chains, const AtomArray &r, Report *report) {
    Approach approach(chains, r);
    approach.run(r);  // of whose solves no outcomes are noted
    with_outcomes(chains, [&] {
        rigid::over_all(
            chains, nullptr, [&] { finish(chains, r, approach, report); }, [&] { rigid::impose(chains, r, report); });
    });
}

}  // namespace holonomic
