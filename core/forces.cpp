#include "core/forces.hpp"

#include <algorithm>
#include <new>

#include "core/caller/box.hpp"
#include "core/caller/packed_array.hpp"
#include "core/rigid/parts.hpp"
#include "core/rigid/verbs.hpp"
#include "core/run/diagnose.hpp"
#include "core/run/outcomes.hpp"
#include "core/run/thread_memory.hpp"
#include "core/run/verb_work.hpp"
#include "core/solve.hpp"

namespace holonomic {

namespace {

struct ForcesWork final : VerbWork<ForcesCall, &MoleculeKernels::forces, &Kernels::forces, &Kernels::long_forces> {
    ForcesWork(const ForcesCall &call, Staging &staging)
        : VerbWork(
              call, staging,
              [&](ForcesCall &c) {
                  c.lambda = staging.results(call.lambda);
                  c.tension = staging.results(call.tension);
              },
              [&](ForcesCall &c) {
                  c.r = staging.atoms(call.r);
                  c.v = staging.atoms(call.v);
                  c.f = staging.atoms(call.f);
                  c.g = staging.summed_atoms(call.g, call.add);
              }) {}
};

// With a box that changes, by the equations for given right-hand sides: such forces are asked for now and then.
[[gnu::noinline]] Tally forces_in_motion(const Chains &chains, const double *L, const ForcesCall &call) {
    const std::int64_t bytes = chains.n_bonds() * static_cast<std::int64_t>(sizeof(double));
    double *const rhs = static_cast<double *>(thread_memory(Keep::right_hand_sides, bytes));
    if (!rhs && bytes > 0) throw std::bad_alloc();
    right_hand_sides(chains, chains.box, L, call.r, call.v, call.f, rhs);
    return solve_equations(chains, call.r, rhs, {call.lambda, call.tension, call.g, call.add, call.virial});
}

__attribute__((always_inline)) inline Tally forces_at_rest(const Chains &chains, ForcesCall &call) {
    AtomArray *const inputs[] = {&call.r, &call.v, &call.f};
    unify_layout(inputs, 3);
    Staging staging(chains);
    const Tally tally = execute(chains, ForcesWork(call, staging));
    staging.put_back();
    clear_unconstrained(chains, call.lambda);
    clear_unconstrained(chains, call.tension);
    return tally;
}

void forces_of_bonds(const Chains &chains, ForcesCall &call, double *virial) {
    call.virial = virial != nullptr;
    put_box(chains.box, call.box);
    const BoxRate *const rate = chains.box_rate();
    const Tally tally = rate ? forces_in_motion(chains, rate->L, call) : forces_at_rest(chains, call);
    if (tally.n_bad > 0)
        throw_diagnosis(chains, tally, {{"position", &call.r}, {"velocity", &call.v}, {"force", &call.f}});
    if (virial) write_virial(tally, virial);
}

}  // namespace

void right_hand_sides(const Chains &chains, const Box &box, const double *L, const AtomArray &r, const AtomArray &v,
                      const AtomArray &f, double *rhs) {
    for (std::int64_t number = 0; number < chains.n_chains(); ++number) {
        if (!chains.is_active(number)) continue;
        const Molecule m = chains.molecule(number);
        for (std::int64_t k = 0; k < m.n_bonds; ++k) {
            const std::int64_t i = m.i(k), j = m.j(k);
            double x[2][3], u[2][3] = {}, a[2][3] = {}, d[3];
            read_atom(r, m.atom(i), x[0]);
            read_atom(r, m.atom(j), x[1]);
            if (v.x) {
                read_atom(v, m.atom(i), u[0]);
                read_atom(v, m.atom(j), u[1]);
            }
            if (f.x) {
                read_atom(f, m.atom(i), a[0]);
                read_atom(f, m.atom(j), a[1]);
            }
            bond_vector(box, x[0], x[1], d);
            double sum = 0;
            for (int c = 0; c < (r.z ? 3 : 2); ++c) {
                const double flow = L[3 * c] * d[0] + L[3 * c + 1] * d[1] + L[3 * c + 2] * d[2];
                const double speed = (u[1][c] - u[0][c]) + flow;
                sum += d[c] * (m.w(j) * a[1][c] - m.w(i) * a[0][c]) + speed * speed;
            }
            rhs[m.bond(k)] = 2 * sum;
        }
    }
}

namespace {

[[gnu::noinline]] void forces_of_all(const Chains &chains, ForcesCall &call, double *virial) {
    with_outcomes(chains, [&] {
        rigid::over_all(
            chains, call.add ? nullptr : &call.g, virial, [&](double *to) { forces_of_bonds(chains, call, to); },
            [&](double *to) {
                rigid::forces(chains, call.r, call.v, call.f, call.lambda, call.tension, call.g, call.add, to);
            });
    });
}

}  // namespace

void forces(const Chains &chains, ForcesCall &call, double *virial) {
    if (__builtin_expect(chains.is_plain(), 1)) return forces_of_bonds(chains, call, virial);
    forces_of_all(chains, call, virial);
}

}  // namespace holonomic
