/**
 * RATTLE with the library over many steps: reversible, conserving, and on the constraints at every step.
 * An argument sets the number of steps of the melt (default 4000).
 */
#include "assembly.h"
#include "check.h"
#include "melt.h"

static int64_t melt_steps = 4000;

/** Soft springs to the origin and a field: forces without noise of their own. */
static void simple_forces(const assembly *a, const double *r, double *f)
{
    for (int64_t i = 0; i < 3 * a->n_atoms; ++i) f[i] = -0.3 * r[i] + (i % 3 == 2 ? -0.5 * a->mass[i / 3] : 0);
}

static double simple_energy(const assembly *a, const double *r, const double *v)
{
    double sum = 0;
    for (int64_t i = 0; i < 3 * a->n_atoms; ++i)
        sum += a->mass[i / 3] * v[i] * v[i] / 2 + 0.15 * r[i] * r[i] + (i % 3 == 2 ? 0.5 * a->mass[i / 3] * r[i] : 0);
    return sum;
}

static void rattle(const assembly *a, double *r, double *v, double *f, double *before, double dt)
{
    const size_t size = assembly_size(a);
    memcpy(before, r, size * sizeof *r);
    for (size_t i = 0; i < size; ++i) {
        v[i] += dt / 2 * f[i] / a->mass[i / 3];
        r[i] += dt * v[i];
    }
    CHECK(hol_project_positions(a->chains, before, r, v, dt, NULL, 0, NULL, NULL));
    simple_forces(a, r, f);
    for (size_t i = 0; i < size; ++i) v[i] += dt / 2 * f[i] / a->mass[i / 3];
    CHECK(hol_project_velocities(a->chains, r, v, NULL, NULL));
}

static double largest_difference(const double *a, const double *b, size_t n)
{
    double worst = 0;
    for (size_t i = 0; i < n; ++i) worst = fmax(worst, fabs(a[i] - b[i]));
    return worst;
}

/** Distance from the start after `steps` forward, the velocities turned round, and as many steps back. */
static double there_and_back(const assembly *a, int steps, double dt)
{
    const size_t size = assembly_size(a);
    double *r = copy_of(a->r, size), *v = copy_of(a->v, size), *f = untouched(size), *before = untouched(size);
    CHECK(hol_project_velocities(a->chains, r, v, NULL, NULL));
    double *v0 = copy_of(v, size);
    simple_forces(a, r, f);
    for (int way = 0; way < 2; ++way) {
        for (int step = 0; step < steps; ++step) rattle(a, r, v, f, before, dt);
        for (size_t i = 0; i < size; ++i) v[i] = -v[i];
    }
    const double worst = fmax(largest_difference(r, a->r, size), largest_difference(v, v0, size));
    free(r), free(v), free(f), free(before), free(v0);
    return worst;
}

static void one_step_is_symmetric(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_COIL, 20, 1, 20, IN_ORDER, 121);
    /* one step and back: some roundings of coordinates up to 10, over dt for the velocities */
    CHECK_AT_MOST(there_and_back(&a, 1, 0.005), 40 * 10 * DBL_EPSILON / 0.005);
    assembly_free(&a);
}

static void trajectories_reversed_in_time_return_to_their_start(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_COIL, 20, 1, 20, IN_ORDER, 122);
    const double once = there_and_back(&a, 1, 0.005), many = there_and_back(&a, 200, 0.005);
    print_message("distance from the start: %.2g after one step and back, %.2g after 200\n", once, many);
    /* roundings of 400 steps, magnified as trajectories of chains of up to 20 bonds diverge in one unit of time, which
       is some decades at most; an irreversible step would leave the square or cube of dt, 1e-5 */
    CHECK_AT_MOST(many, 1e-9);
    assembly_free(&a);
}

static void energy_error_is_of_second_order_in_the_time_step(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_COIL, 10, 2, 12, IN_ORDER, 123);
    const size_t size = assembly_size(&a);
    CHECK(hol_project_velocities(a.chains, a.r, a.v, NULL, NULL));
    double error[2] = {0, 0};
    for (int fine = 0; fine < 2; ++fine) {
        double *r = copy_of(a.r, size), *v = copy_of(a.v, size), *f = untouched(size), *before = untouched(size);
        const double start = simple_energy(&a, r, v);
        simple_forces(&a, r, f);
        for (int step = 0; step < (fine ? 800 : 400); ++step) {
            rattle(&a, r, v, f, before, fine ? 0.001 : 0.002);
            error[fine] = fmax(error[fine], fabs(simple_energy(&a, r, v) - start));
        }
        free(r), free(v), free(f), free(before);
    }
    print_message("largest energy error: %.3g and %.3g at half the step\n", error[0], error[1]);
    CHECK_AT_MOST(error[1], error[0] / 3);
    assembly_free(&a);
}

static void angular_momentum_and_momentum_are_conserved_without_forces(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, 8, 1, 20, IN_ORDER, 124);
    const size_t size = assembly_size(&a);
    CHECK(hol_project_velocities(a.chains, a.r, a.v, NULL, NULL));
    double *r = copy_of(a.r, size), *v = copy_of(a.v, size), *before = untouched(size), dt = 0.001;
    for (int step = 0; step < 1000; ++step) {
        memcpy(before, r, size * sizeof *r);
        for (size_t i = 0; i < size; ++i) r[i] += dt * v[i];
        CHECK(hol_project_positions(a.chains, before, r, v, dt, NULL, 0, NULL, NULL));
        CHECK(hol_project_velocities(a.chains, r, v, NULL, NULL));
    }
    for (int64_t c = 0; c < a.n_chains; ++c) {
        long double p[3] = {0}, l[3] = {0}, size_l = 0, size_p = 0;
        for (int64_t n = 0; n <= assembly_bonds(&a, c); ++n) {
            const int64_t i = 3 * a.atoms[a.first[c] + n];
            const long double m = a.mass[i / 3];
            for (int x = 0; x < 3; ++x) {
                const int y = (x + 1) % 3, z = (x + 2) % 3;
                p[x] += m * ((long double)v[i + x] - a.v[i + x]);
                l[x] += m * ((long double)r[i + y] * v[i + z] - (long double)r[i + z] * v[i + y]);
                l[x] -= m * ((long double)a.r[i + y] * a.v[i + z] - (long double)a.r[i + z] * a.v[i + y]);
                size_p += m * fabs(v[i + x]);
                size_l += m * fabs(v[i + x]) * (fabs(r[i + y]) + fabs(r[i + z]));
            }
        }
        /* a thousand steps, each with some roundings of every position and velocity, added at random; a position is
           rounded by eps |r|, and its correction enters the velocity over dt, but before it is rounded */
        for (int x = 0; x < 3; ++x) {
            CHECK_AT_MOST(fabsl(p[x]), 100 * DBL_EPSILON * size_p);
            CHECK_AT_MOST(fabsl(l[x]), 100 * DBL_EPSILON * size_l);
        }
    }
    free(r), free(v), free(before);
    assembly_free(&a);
}

static void a_melt_conserves_energy_and_momentum_and_keeps_its_bonds(void **state)
{
    (void)state;
    const double dt = 0.005;
    melt m = melt_make(64, 32, 0.61, 7);
    for (int step = 0; step < 2000; ++step) {
        melt_step(&m, dt);
        if (step % 20 == 19) melt_rescale(&m);
    }
    m.worst_length = 0;
    m.iterations = m.steps = 0;
    /* the drift is the slope of a line fitted to the energy, per bead and unit of time */
    double sum_t = 0, sum_e = 0, sum_tt = 0, sum_te = 0, lowest = INFINITY, highest = -INFINITY;
    const double start = m.potential + melt_kinetic(&m);
    for (int64_t step = 0; step < melt_steps; ++step) {
        melt_step(&m, dt);
        const double t = (double)step * dt, e = (m.potential + melt_kinetic(&m) - start) / (double)m.n_atoms;
        sum_t += t, sum_e += e, sum_tt += t * t, sum_te += t * e;
        lowest = fmin(lowest, e), highest = fmax(highest, e);
    }
    const double n = (double)melt_steps, drift = (n * sum_te - sum_t * sum_e) / (n * sum_tt - sum_t * sum_t);
    double momentum[3] = {0, 0, 0};
    for (int64_t i = 0; i < 3 * m.n_atoms; ++i) momentum[i % 3] += m.v[i];
    print_message(
        "%lld steps: drift per bead and unit of time %.2g kT, energy within %.2g kT per bead, bond error %.2g, "
        "momentum %.2g, %.2f iterations per step\n",
        (long long)melt_steps, drift, highest - lowest, m.worst_length,
        fmax(fabs(momentum[0]), fmax(fabs(momentum[1]), fabs(momentum[2]))), (double)m.iterations / n);
    /* over a short run the bounded fluctuation of the energy looks like a drift of its size over the time */
    CHECK_AT_MOST(fabs(drift), 1e-6 + (melt_steps < 100000 ? 3 * (highest - lowest) / (n * dt) : 0));
    CHECK_AT_MOST(highest - lowest, 1e-2);
    CHECK_AT_MOST(m.worst_length, 1e-13);
    /* 2048 velocities of order one, rounded a few times in every step, added at random */
    for (int x = 0; x < 3; ++x) CHECK_AT_MOST(fabs(momentum[x]), 10 * DBL_EPSILON * sqrt(2048 * (n + 2000)));
    melt_free(&m);
}

int main(int argc, char **argv)
{
    if (argc > 1) melt_steps = atoll(argv[1]);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_step_is_symmetric),
        cmocka_unit_test(trajectories_reversed_in_time_return_to_their_start),
        cmocka_unit_test(energy_error_is_of_second_order_in_the_time_step),
        cmocka_unit_test(angular_momentum_and_momentum_are_conserved_without_forces),
        cmocka_unit_test(a_melt_conserves_energy_and_momentum_and_keeps_its_bonds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
