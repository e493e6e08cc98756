#include "core/rigid/alone.hpp"

#include "core/rigid/alone_frame.hpp"

namespace holonomic::rigid {

namespace {

// Newton's method, whose matrix is all but diagonal: two corrections by its diagonal stand for its solution.
template <int R>
bool restore(const Body &body, const double (*from)[3], double (*u)[3], double (*total)[R], int *iterations,
             double *error) {
    double before = std::numeric_limits<double>::infinity();
    for (int p = 0; p < R; ++p)
        for (int q = 0; q < R; ++q) total[p][q] = 0;
    for (*iterations = 0; *iterations < 40; ++*iterations) {
        double E[R][R], X[R][R], lambda[R][R];
        products<R>(u, E);
        *error = 0;
        for (int p = 0; p < R; ++p) {
            E[p][p] -= body.square[p].hi;
            for (int q = 0; q < R; ++q) {
                *error = std::max(*error, std::fabs(E[p][q]) / (body.length[p] * body.length[q]));
                X[p][q] = dot(u[p], from[q]);
            }
            if (!(X[p][p] > 0.3 * body.square[p].hi)) return false;
        }
        if (!std::isfinite(*error)) return false;
        if (*error <= 3 * eps || (*error<32 * eps && * error> 0.5 * before)) return true;
        before = *error;
        solve<R>(X, E, lambda, 3);
        for (int p = 0; p < R; ++p)
            for (int q = p + 1; q < R; ++q) lambda[p][q] = lambda[q][p] = (lambda[p][q] + lambda[q][p]) / 2;
        take_away<R>(u, from, lambda);
        for (int p = 0; p < R; ++p)
            for (int q = 0; q < R; ++q) total[p][q] += lambda[p][q];
    }
    return false;
}

// The frame of trial positions in twice the precision, and what is not rigid in them. A rounding of y or m y / M, the
// same in every step, would turn the body a little in each: over dt that is an angular momentum that grows.
template <int R>
struct Trial {
    DoublePair c[3], u[R][3];

    Trial(const Body &body, const double *x) {
        for (int i = 0; i < 3; ++i) {
            c[i] = as_pair(0);
            for (int p = 0; p < R; ++p) u[p][i] = as_pair(0);
        }
        const DoublePair *share = body.share.data();
        for (std::int32_t a = 0; a < body.n_atoms; ++a, share += 1 + R, x += 3)
            for (int i = 0; i < 3 && share[0].hi > 0; ++i) {
                c[i] = c[i] + x[i] * share[0];
                for (int p = 0; p < R; ++p) u[p][i] = u[p][i] + x[i] * share[1 + p];
            }
    }
    Frame<R> rounded_frame() const {
        Frame<R> frame;
        for (int i = 0; i < 3; ++i) {
            frame.c[i] = rounded(c[i]);
            for (int p = 0; p < R; ++p) frame.u[p][i] = rounded(u[p][i]);
        }
        return frame;
    }
    // By how much an atom is off its place in the body.
    double rest(const Body &body, std::int32_t a, int i, double x) const {
        const DoublePair *const y = body.y.data() + static_cast<std::ptrdiff_t>(a) * R;
        DoublePair sum = c[i] - as_pair(x);
        for (int p = 0; p < R; ++p) sum = sum + y[p] * u[p][i];
        return rounded(sum);
    }
};

template <int R>
bool positions_of(const Lone &lone, const AtomArray &r_ref, const Box &box_ref, const AtomArray &r, const Box &box,
                  const AtomArray &v, double dt, double *virial, int *iterations, double *error) {
    const Body &body = lone.body;
    unfold(lone, r_ref, box_ref, lone.x);
    if (!are_finite(lone.x, body.n_atoms)) return false;
    const Frame<R> from = frame_of<R>(body, lone.x);
    unfold(lone, r, box, lone.x);
    if (!are_finite(lone.x, body.n_atoms)) return false;
    const Trial<R> trial(body, lone.x);
    Frame<R> to = trial.rounded_frame();
    // Crude or rigid already: the general solver decides.
    double off = 0, lambda[R][R];
    for (std::int32_t a = 0; a < body.n_atoms; ++a) {
        double x[3];
        at_atom<R>(body, a, to, x);
        for (int c = 0; c < 3; ++c) off = std::max(off, std::fabs(x[c] - lone.x[3 * a + c]));
    }
    for (int p = 0; p < R; ++p)
        for (int q = p; q < R; ++q)
            off = std::max(off, std::fabs(dot(to.u[p], to.u[q]) - (p == q ? body.square[p].hi : 0)) / body.length[0]);
    if (!(off < 0.5 * body.extent) || off < (r.is_float ? 1e-5 : 1e-10) * body.extent) return false;
    if (!restore<R>(body, from.u, to.u, lambda, iterations, error)) return false;
    add_virial<R>(from.u, lambda, body.mass / (dt * dt), virial);
    double change[R][3] = {};
    take_away<R>(change, from.u, lambda);
    bool sites = false;
    for (std::int32_t a = 0; a < body.n_atoms; ++a) {
        double x[3], moved[3];
        const double *const y = body.y_rounded.data() + static_cast<std::ptrdiff_t>(a) * R;
        read_atom(r, lone.atoms[a], x);
        for (int c = 0; c < 3; ++c) {
            moved[c] = trial.rest(body, a, c, lone.x[3 * a + c]);
            for (int p = 0; p < R; ++p) moved[c] += y[p] * change[p][c];
            x[c] += moved[c];
        }
        write_atom(r, lone.atoms[a], x);
        if (!v.x) continue;
        if (body.masses[static_cast<std::size_t>(a)] == 0) {
            sites = true;
            continue;
        }
        read_atom(v, lone.atoms[a], x);
        for (int c = 0; c < 3; ++c) x[c] += moved[c] / dt;
        write_atom(v, lone.atoms[a], x);
    }
    if (!sites) return true;
    const Frame<R> rate = rates_of<R>(lone, v);
    for (std::int32_t a = 0; a < body.n_atoms; ++a) {
        if (body.masses[static_cast<std::size_t>(a)] > 0) continue;
        double x[3];
        at_atom<R>(body, a, rate, x);
        write_atom(v, lone.atoms[a], x);
    }
    return true;
}

}  // namespace

bool positions_alone(const Lone &lone, const AtomArray &r_ref, const Box &box_ref, const AtomArray &r, const Box &box,
                     const AtomArray &v, double dt, double *virial, int *iterations, double *error) {
    const auto solve_rank = lone.body.rank == 1   ? positions_of<1>
                            : lone.body.rank == 2 ? positions_of<2>
                                                  : positions_of<3>;
    return solve_rank(lone, r_ref, box_ref, r, box, v, dt, virial, iterations, error);
}

}  // namespace holonomic::rigid
