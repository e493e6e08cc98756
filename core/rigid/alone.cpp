#include "core/rigid/alone.hpp"

#include "core/rigid/alone_frame.hpp"

namespace holonomic::rigid {

namespace {

constexpr int most_passes = 12;

template <int R>
bool forces_of(const Lone &lone, const AtomArray &r, const Box &box, const AtomArray &v, const AtomArray &f,
               const AtomArray &g, bool add, double *virial) {
    const Body &body = lone.body;
    unfold(lone, r, box, lone.x);
    if (!are_finite(lone.x, body.n_atoms)) return false;
    const Frame<R> at = frame_of<R>(body, lone.x);
    Frame<R> z{};
    for (std::int32_t a = 0; f.x && a < body.n_atoms; ++a) {
        double x[3];
        read_atom(f, lone.atoms[a], x);
        const double *const y = body.y_rounded.data() + static_cast<std::ptrdiff_t>(a) * R;
        for (int c = 0; c < 3; ++c) {
            z.c[c] += body.inverse_mass * x[c];
            for (int p = 0; p < R; ++p) z.u[p][c] += body.inverse_mass * y[p] * x[c];
        }
    }
    double S[R][R], b[R][R], lambda[R][R];
    products<R>(at.u, S);
    for (int p = 0; p < R; ++p)
        for (int q = 0; q < R; ++q) b[p][q] = dot(at.u[p], z.u[q]) + dot(at.u[q], z.u[p]);
    if (v.x) {
        const Frame<R> rate = rates_of<R>(lone, v);
        if (!is_finite(rate)) return false;
        for (int p = 0; p < R; ++p)
            for (int q = 0; q < R; ++q) b[p][q] += 2 * dot(rate.u[p], rate.u[q]);
    }
    if (!solve<R>(S, b, lambda, most_passes)) return false;
    take_away<R>(z.u, at.u, lambda);
    if (!is_finite(z)) return false;
    add_virial<R>(at.u, lambda, body.mass, virial);
    for (std::int32_t a = 0; g.x && a < body.n_atoms; ++a) {
        double x[3], force[3] = {0, 0, 0}, before[3] = {0, 0, 0};
        at_atom<R>(body, a, z, x);
        if (f.x) read_atom(f, lone.atoms[a], force);
        if (add) read_atom(g, lone.atoms[a], before);
        const double m = body.masses[static_cast<std::size_t>(a)];
        for (int c = 0; c < 3; ++c) x[c] = before[c] + (m * x[c] - force[c]);
        write_atom(g, lone.atoms[a], x);
    }
    return true;
}

template <int R>
bool velocities_of(const Lone &lone, const AtomArray &r, const Box &box, const AtomArray &v, double *virial) {
    const Body &body = lone.body;
    unfold(lone, r, box, lone.x);
    if (!are_finite(lone.x, body.n_atoms)) return false;
    const Frame<R> at = frame_of<R>(body, lone.x);
    Frame<R> rate = rates_of<R>(lone, v);
    if (!is_finite(rate)) return false;
    double S[R][R], b[R][R], lambda[R][R], first[R][R];
    products<R>(at.u, S);
    // What rounding leaves of the rates goes with a second projection.
    for (int pass = 0; pass < 2; ++pass) {
        for (int p = 0; p < R; ++p)
            for (int q = 0; q < R; ++q) b[p][q] = dot(at.u[p], rate.u[q]) + dot(at.u[q], rate.u[p]);
        if (!solve<R>(S, b, lambda, most_passes)) return false;
        take_away<R>(rate.u, at.u, lambda);
        if (pass == 0) std::copy(&lambda[0][0], &lambda[0][0] + R * R, &first[0][0]);
    }
    if (!is_finite(rate)) return false;
    add_virial<R>(at.u, first, body.mass, virial);
    for (std::int32_t a = 0; a < body.n_atoms; ++a) {
        double x[3];
        at_atom<R>(body, a, rate, x);
        write_atom(v, lone.atoms[a], x);
    }
    return true;
}

}  // namespace

bool forces_alone(const Lone &lone, const AtomArray &r, const Box &box, const AtomArray &v, const AtomArray &f,
                  const AtomArray &g, bool add, double *virial) {
    const auto solve_rank = lone.body.rank == 1 ? forces_of<1> : lone.body.rank == 2 ? forces_of<2> : forces_of<3>;
    return solve_rank(lone, r, box, v, f, g, add, virial);
}

bool velocities_alone(const Lone &lone, const AtomArray &r, const Box &box, const AtomArray &v, double *virial) {
    const auto solve_rank = lone.body.rank == 1   ? velocities_of<1>
                            : lone.body.rank == 2 ? velocities_of<2>
                                                  : velocities_of<3>;
    return solve_rank(lone, r, box, v, virial);
}

}  // namespace holonomic::rigid
