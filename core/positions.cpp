#include "core/positions.hpp"

#include <algorithm>
#include <new>

#include "core/caller/box.hpp"
#include "core/caller/packed_array.hpp"
#include "core/check.hpp"
#include "core/long_step/long_steps.hpp"
#include "core/reference.hpp"
#include "core/rigid/parts.hpp"
#include "core/rigid/verbs.hpp"
#include "core/run/diagnose.hpp"
#include "core/run/outcomes.hpp"
#include "core/run/thread_memory.hpp"
#include "core/run/verb_work.hpp"

namespace holonomic {

namespace {

struct PositionsWork final
    : VerbWork<PositionsCall, &MoleculeKernels::positions, &Kernels::positions, &Kernels::long_positions> {
    PositionsWork(const PositionsCall &call, Staging &staging, const Reference *reference)
        : VerbWork(
              call, staging, [&](PositionsCall &c) { c.lambda = staging.results(call.lambda); },
              [&](PositionsCall &c) {
                  c.r_ref = reference ? reference->staged() : staging.atoms(call.r_ref);
                  c.r = staging.moved_atoms(call.r);
                  c.v = staging.moved_atoms(call.v);
              }) {}
    bool shares_paths() const override { return true; }
};

// Whether parts of a molecule are moved while others still read the reference: long chains in windows, paths.
bool moves_in_parts(const Plan &plan) {
    if (plan.longest > longest_lane) return true;
    return std::any_of(plan.shapes.begin(), plan.shapes.end(), [&](std::int32_t shape) {
        return plan.elimination_plans[static_cast<std::size_t>(shape)]->paths;
    });
}

// A copy of the caller's array in memory of this thread: of the atoms of active molecules.
AtomArray copy_of(const AtomArray &array, const Chains &chains) {
    const std::int64_t bytes = 3 * chains.n_atoms() * static_cast<std::int64_t>(sizeof(double));
    double *const copy = static_cast<double *>(thread_memory(Keep::reference, bytes));
    if (!copy && bytes > 0) throw std::bad_alloc();
    AtomArray to = packed_array(copy);
    chains.for_active([&](const Molecule &m) {
        for (std::int64_t i = 0; i < m.n_atoms; ++i) {
            double x[3];
            read_atom(array, m.atom(i), x);
            write_atom(to, m.atom(i), x);
        }
        return true;
    });
    to.packed = array.packed;
    if (!array.z) to.z = nullptr;
    return to;
}

Report report_of(const Chains &chains, const Tally &tally) {
    const bool none = tally.worst_chain < 0;
    return {tally.iterations,
            tally.n_corrected,
            tally.n_bad,
            none ? -1 : tally.worst_chain + chains.base,
            none ? -1 : tally.worst_bond + chains.base,
            tally.worst,
            true};
}

[[noreturn, gnu::noinline]] void throw_error_of(const Chains &chains, const Tally &tally, const PositionsCall &call,
                                                const Reference *reference, const Box &box_ref) {
    throw_error(chains, tally, [&](const Tally &bad) {
        Error error;
        if (chains.checks() != Checks::never && is_stretched(chains, bad.first_bad, call.r, bad.n_bad, &error))
            return error;
        if (reference) reference->show(bad.first_bad);
        return diagnose(chains, bad, box_ref,
                        {{"reference position", &call.r_ref}, {"position", &call.r}, {"velocity", &call.v}},
                        Status::no_convergence);
    });
}

// `reference`: what stands in for reference positions, or nullptr.
void project_from(const Chains &chains, PositionsCall &call, const Reference *reference, double *virial,
                  Report *report) {
    static const Box none{};
    const Box &box_ref = !reference || reference->winds() ? chains.box_of_reference() : none;
    if (reference) call.r_ref = reference->atoms();
    call.virial = virial != nullptr;
    call.report = report != nullptr;
    call.tolerance = chains.tolerance;
    call.max_iterations = chains.max_iterations;
    put_box(chains.box, call.box);
    put_box(box_ref, call.box_ref);
    constexpr double worst_trial = most_stretched * most_stretched - 1;
    static_assert(far_from_lengths < worst_trial && far_from_lengths_of_chains < worst_trial,
                  "all is tried up to there");
    call.far_trial = far_from_lengths;
    call.worst_trial = far_from_lengths_of_chains;
    const bool copies = call.r_ref.x == call.r.x && moves_in_parts(chains.plan());
    AtomArray kept;
    if (copies) {
        kept = call.r_ref;
        call.r_ref = copy_of(kept, chains);
    }
    Staging staging(chains);
    Tally tally = execute(chains, PositionsWork(call, staging, reference));
    staging.put_back();
    if (copies) call.r_ref = kept;
    if (tally.n_bad > 0) {
        call.far_trial = call.worst_trial = chains.checks() == Checks::never ? __builtin_inf() : worst_trial;
        tally = finish_long_steps(chains, call, reference, tally);
    }
    clear_unconstrained(chains, call.lambda);
    if (report) *report = report_of(chains, tally);
    if (tally.n_bad > 0) throw_error_of(chains, tally, call, reference, box_ref);
    if (virial) write_virial(tally, virial);
}

// What is compared with the lengths before anything is moved: once for a set of molecules, their lengths and the box.
// Apart from the call: most compare nothing.
[[gnu::noinline]] void compare(const Chains &chains, const PositionsCall &call, const AtomArray *bonds,
                               ReferenceError &reference_error) {
    const Cell &box = chains.box_of_reference();
    const BondVectors reference{bonds ? nullptr : &call.r_ref, bonds, bonds ? nullptr : &box};
    WorstLength worst = worst_length(chains, reference);
    rigid::worst_length(chains, call.r_ref, box, &worst);
    reference_error.set(worst);
    if (!chains.wants_fit()) return;
    check_reference(chains, reference, reference.r ? "in the reference" : "among the reference vectors");
    check_trial(chains, call.r);
    rigid::check_reference(chains, call.r_ref, box, "in the reference");
    chains.note_fit();
}

[[gnu::noinline]] void project_along(const Chains &chains, PositionsCall &call, const AtomArray &bonds, double *virial,
                                     Report *report) {
    const Reference reference(chains, bonds);
    project_from(chains, call, &reference, virial, report);
}

bool compares(const Chains &chains, const Report *report) {
    return chains.wants_fit() || (report && chains.checks() == Checks::never);
}

[[gnu::noinline]] void project_all(const Chains &chains, PositionsCall &call, const AtomArray *bonds, double *virial,
                                   Report *report, ReferenceError &reference_error) {
    if (bonds)
        rigid::refuse_bodies(chains,
                             "rigid bodies have no bond vectors to project along: hol_project_positions takes "
                             "reference positions");
    with_outcomes(chains, [&] {
        if (compares(chains, report)) compare(chains, call, bonds, reference_error);
        rigid::over_all(
            chains, nullptr, virial,
            [&](double *to) {
                if (!bonds) return project_from(chains, call, nullptr, to, report);
                project_along(chains, call, *bonds, to, report);
            },
            [&](double *to) {
                rigid::project_positions(chains, call.r_ref, call.r, call.v, call.dt, call.lambda, to, report);
            });
    });
}

}  // namespace

void project_positions(const Chains &chains, PositionsCall &call, const AtomArray *bonds, double *virial,
                       Report *report, ReferenceError &reference_error) {
    if (__builtin_expect(!bonds && chains.is_plain() && !compares(chains, report), 1))
        return project_from(chains, call, nullptr, virial, report);
    project_all(chains, call, bonds, virial, report, reference_error);
}

}  // namespace holonomic
