// Constraint forces of molecules, and multipliers for given right-hand sides.
#ifndef HOLONOMIC_KERNELS_GRAPH_FORCES_HPP
#define HOLONOMIC_KERNELS_GRAPH_FORCES_HPP

#include "core/kernels/graph/blocks.hpp"
#include "core/kernels/graph/doubtful.hpp"
#include "core/kernels/graph/load.hpp"
#include "core/kernels/graph/store.hpp"
#include "core/kernels/graph/triangle_blocks.hpp"

namespace holonomic {
namespace HOL_ISA {
namespace graph {

// Where the results of a linear solve go.
struct Outputs {
    const AtomArray *g;
    double *lambda, *tension;
    bool add, virial;
};

template <Layout layout, class V>
static inline void write_outputs(const Molecules<V> &x, const Outputs &out, unsigned which, Tally &tally) {
    if (out.lambda) write_bonds<false>(x, 0.5, out.lambda, which);
    if (out.tension) write_bonds<true>(x, 1, out.tension, which);
    if (out.virial) add_pulls_to_virial(x, which, tally);
    if (out.g->x) write_pulls<layout>(x, *out.g, out.add, which);
}

// Solves what has been loaded; the lanes that plain arithmetic answers for.
template <bool keep, class V>
static inline unsigned solve_loaded(Linear<V> &z) {
    z.template factorize_and_solve<keep>();
    MaskOf<V> good = z.x.in_use() & ~less(z.x.slack, V{});
    if (z.x.s.type == Schedule::graph) good = good & z.refine();
    return bits(good & finite_solution(z.x));
}

struct ForcesWork {
    const ForcesCall &call;
    const Schedule &schedule;
    const bool packed;
    Tally &tally;

    template <class V>
    void block(const MoleculeLane *lane, int used, bool masses_known, double *scratch) const {
        Memory<V> memory = {scratch};
        Linear<V> z(schedule, lane, used, call.box, call.r, memory);
        if (!masses_known) z.set_masses();
        if (!call.v.x) z.equations.velocity = nullptr;
        if (!call.f.x) z.equations.force = nullptr;
        z.equations.given = nullptr;
        with_layout(z.x.at, packed, [&](auto layout) { solve<decltype(layout)::value>(z, memory); });
    }

    template <Layout layout, class V>
    void solve(Linear<V> &z, Memory<V> memory) const {
        z.x.in = {&call.v, &call.f, nullptr, false};
        if (call.v.x && call.f.x)
            Loader<layout, squares | pulls, V>{z}.load();
        else if (call.f.x)
            Loader<layout, pulls, V>{z}.load();
        else if (call.v.x)
            Loader<layout, squares, V>{z}.load();
        else
            Loader<layout, 0, V>{z}.load();
        const unsigned good = solve_loaded<false>(z), rest = bits(z.x.in_use()) & ~good;
        write_outputs<layout>(z.x, {&call.g, call.lambda, call.tension, call.add, call.virial}, good, tally);
        if (__builtin_expect(rest != 0, 0)) solve_doubtful(call, schedule, z.x.lane, rest, memory.next, tally);
    }
};

struct SolveWork {
    const SolveCall &call;
    const Schedule &schedule;
    const bool packed;
    Tally &tally;

    template <class V>
    void block(const MoleculeLane *lane, int used, bool masses_known, double *scratch) const {
        Memory<V> memory = {scratch};
        Linear<V> z(schedule, lane, used, call.box, call.r, memory);
        if (!masses_known) z.set_masses();
        z.equations.velocity = z.equations.force = nullptr;
        with_layout(z.x.at, packed, [&](auto layout) { solve<decltype(layout)::value>(z, memory); });
    }

    template <Layout layout, class V>
    void solve(Linear<V> &z, Memory<V> memory) const {
        z.x.in = {nullptr, nullptr, call.rhs, false};
        Loader<layout, given, V>{z}.load();
        const unsigned good = solve_loaded<false>(z), rest = bits(z.x.in_use()) & ~good;
        write_outputs<layout>(z.x, {&call.g, call.lambda, call.tension, call.add, call.virial}, good, tally);
        if (__builtin_expect(rest != 0, 0)) solve_doubtful(call, schedule, z.x.lane, rest, memory.next, tally);
    }
};

}  // namespace graph
}  // namespace HOL_ISA
}  // namespace holonomic
#endif
