// Position level of stars of three and four bonds, CH3, NH3 and CH4, a block in registers: Newton's method (theory
// (15)-(17)) for the multipliers (equations.hpp). Lanes that need more, such as a long step or a coarse move, or a
// light centre among very unequal masses, go the way of trees.
#pragma once

#include "core/kernels/molecules/star/equations.hpp"
#include "core/kernels/molecules/store.hpp"
#include "core/plan/elimination.hpp"

namespace holonomic::HOL_ISA::graph {

template <Inlined where, int N, class V, class Model = StarModel<N, V>>
struct StarPositions {
    const PositionsCall &call;
    const StarAtoms<where, N, V> &atoms;
    const MoleculeLane *lane;
    const StarKind<N, V> &m;
    Tally &tally;
    int64_t molecule(int i) const { return lane[i].molecule; }

    // D.D - a^2, and the largest part of a^2.
    inline HOL_FORCED V measure(const Vector3<V> *D, V *left) const {
        V worst = {}, sum = {};
        HOL_UNROLL
        for (int k = 0; k < N; ++k) {
            left[k] = mul_add(D[k].z, D[k].z, mul_add(D[k].y, D[k].y, mul_add(D[k].x, D[k].x, -m.a2[k])));
            worst = max(abs(left[k]) * m.per_a2[k], worst);
            sum = sum + left[k];
        }
        return mul_add(sum, V{}, worst);  // max() may lose a NaN, the sum keeps it
    }

    // Displacements by tau, and the bonds as they move.
    inline HOL_FORCED void move(const V *tau, const Vector3<V> *b, Vector3<V> *shift, Vector3<V> *D) const {
        shift[0] = m.w[0] * Model::pull(tau, b);
        HOL_UNROLL
        for (int k = 0; k < N; ++k) {
            shift[k + 1] = (-m.w[k + 1] * tau[k]) * b[k];
            D[k] = D[k] + (shift[k + 1] - shift[0]);
        }
    }

    // Lanes in which the pulls on an atom are so large that their rounding exceeds that of the coordinates.
    inline HOL_FORCED MaskOf<V> coarse_moves(const V *tau, V largest) const {
        return less(0.25 * (largest + m.a_min), Model::largest_move(m, tau));
    }

    // The lanes of `in_use`. Returns those that are done.
    __attribute__((noinline)) unsigned solve(MaskOf<V> in_use) const {
        Vector3<V> r[N + 1], b[N], D[N], shift[N + 1];
        V sigma[N], tau[Model::unknowns];
        atoms.read(call.r_ref, r);
        atoms.take_bonds(r, call.box_ref, b);
        atoms.read(call.r, r);
        atoms.take_bonds(r, call.box, D);
        V largest = {};
        HOL_UNROLL
        for (int k = 0; k <= N; ++k) largest = max(max(abs(r[k].x), abs(r[k].y)), max(abs(r[k].z), largest));
        V error = measure(D, sigma);
        const Limits<V> limits(call, largest * m.per_a_min);
        const MaskOf<V> untouched = in_use & less_equal(error, limits.accepted);
        const MaskOf<V> wanted = in_use & ~untouched & less_equal(error, Width<V>::all(call.far_trial));
        if (__builtin_expect(bits(untouched) == bits(in_use), 0) && !call.report) {  // nothing to do
            for (V &t : tau) t = V{};
            if (call.lambda) write_multipliers(tau, bits(untouched));
            return bits(untouched);
        }
        MaskOf<V> unsure = wanted;
        const Model model(m, b, D, sigma);
        const int64_t solves = solve_for_multipliers<N>(model, tau, unsure, call.max_iterations);
        unsure = unsure | ~model.is_even();
        if (__builtin_expect(bits(wanted) != all_of<V>, 0)) {
            HOL_UNROLL
            for (int k = 0; k < Model::unknowns; ++k) tau[k] = keep(wanted, tau[k]);
        }
        move(tau, b, shift, D);
        V left[N];
        error = measure(D, left);
        const unsigned moved =
                           bits(wanted & ~unsure & less_equal(error, limits.enough()) & ~coarse_moves(tau, largest)),
                       good = moved | bits(untouched);
        if (call.report) {
            HOL_UNROLL
            for (int k = 0; k < N; ++k) left[k] = abs(left[k]) * m.per_a2[k];
            note_worst_bond<N>(left, *this, error, good, tally);
        }
        if (call.lambda) write_multipliers(tau, good);
        if (!moved) return good;
        if (call.virial) add_virial(b, tau, moved);
        const bool mixed = moved != all_of<V> && good == all_of<V>;
        // What is right already moves by -0, which leaves every bit: no lane is masked.
        if (__builtin_expect(mixed, 0)) {
            HOL_UNROLL
            for (int k = 0; k <= N; ++k) {
                const Vector3<V> all = shift[k];
                put(shift[k],
                    Vector3<V>{keep_or_stay(all.x, moved), keep_or_stay(all.y, moved), keep_or_stay(all.z, moved)});
            }
        }
        atoms.move(call, shift, mixed ? all_of<V> : moved);
        count_moved(tally, __builtin_popcount(moved), solves);
        return good;
    }

    HOL_FORCED static V keep_or_stay(const V &a, unsigned moved) {
        return select(Width<V>::of_bits(moved), a, Width<V>::all(-0.0));
    }

    inline HOL_FORCED void write_multipliers(const V *tau, unsigned which) const {
        const V factor = Width<V>::all(0.5 / (call.dt * call.dt));
        V value[N];
        HOL_UNROLL
        for (int k = 0; k < N; ++k) value[k] = mul_add(tau[k], factor, V{});
        atoms.write_bonds(call.lambda, value, which);
    }

    // Of copies, so that the bonds themselves need not be in memory.
    inline HOL_FORCED void add_virial(const Vector3<V> *b, const V *tau, unsigned which) const {
        Vector3<V> bonds[N];
        V copies[N];
        HOL_UNROLL
        for (int k = 0; k < N; ++k) {
            bonds[k] = b[k];
            copies[k] = tau[k];
        }
        add_bonds_virial<N>(bonds, copies, 1 / (call.dt * call.dt), which, tally);
    }
};

struct StarPositionsVerb {
    static constexpr bool in_steps = true;
    template <int N, class V>
    using Kind = StarKind<N, V>;
    const PositionsCall &call;
    Tally &tally;
    template <Inlined where, int N, class V>
    unsigned solve(const StarAtoms<where, N, V> &atoms, const MoleculeLane *lane, const StarKind<N, V> &kind,
                   MaskOf<V> in_use) const {
        const StarPositions<where, N, V> ordinary = {call, atoms, lane, kind, tally};
        if constexpr (N == 4) {
            if (__builtin_expect((kind.light | kind.unequal) != 0, 0)) {
                const StarAtoms<anywhere, N, V> any_atoms = {atoms.at, atoms.centre};
                const StarPositions<anywhere, N, V, LightStarModel<V>> light = {call, any_atoms, lane, kind, tally};
                const MaskOf<V> lights = Width<V>::of_bits(kind.light),
                                others = in_use & ~Width<V>::of_bits(kind.light | kind.unequal);
                return (any(in_use & lights) ? light.solve(in_use & lights) : 0) |
                       (any(others) ? ordinary.solve(others) : 0);
            }
        }
        return ordinary.solve(in_use);
    }
};

}  // namespace holonomic::HOL_ISA::graph
