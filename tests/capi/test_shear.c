/**
 * Molecules in a flow, by the SLLOD equations of motion: r' = v + L r, v' = w (f + G) - L v. What the flow does to the
 * energy is known, - L : (sum m v (x) v + sum r (x) (f + G)) per time, and holds only if velocities obey
 * d.(v_j - v_i + L d) = 0 and the constraint forces that of the accelerations.
 */
#include "check.h"
#include "mixture.h"

enum { BEADS = 12, SIZE = 3 * BEADS };

static const double rate = 0.8, spring = 0.7;

typedef struct system {
    hol_chains *chains;
    const double *mass;
    double r[SIZE], v[SIZE], f[SIZE];
} fluid;

/** Springs to the origin; L v of a shear along x. */
static double forces(fluid *s)
{
    double energy = 0;
    for (int i = 0; i < SIZE; ++i) {
        s->f[i] = -spring * s->r[i];
        energy += 0.5 * spring * s->r[i] * s->r[i];
    }
    return energy;
}

static double kinetic(const fluid *s)
{
    double energy = 0;
    for (int i = 0; i < SIZE; ++i) energy += 0.5 * s->mass[i / 3] * s->v[i] * s->v[i];
    return energy;
}

/** Of the flow's work. */
static double power(const fluid *s)
{
    double virial[9], stress = 0;
    CHECK(hol_forces(s->chains, s->r, s->v, s->f, NULL, NULL, NULL, HOL_WRITE, virial));
    for (int i = 0; i < BEADS; ++i)
        stress += s->mass[i] * s->v[3 * i] * s->v[3 * i + 1] + s->r[3 * i + 1] * s->f[3 * i];
    return -rate * (stress + virial[1]);
}

static void kick(fluid *s, double h)
{
    for (int i = 0; i < SIZE; ++i) s->v[i] += h * s->f[i] / s->mass[i / 3];
}

/** v -= h L v */
static void turn(double *v, double h)
{
    for (int i = 0; i < BEADS; ++i) v[3 * i] -= h * rate * v[3 * i + 1];
}

/**
 * The flow r' = v + L r, v' = - L v for a time h, exactly, and onto the constraints: what moves the atoms is a change
 * of the velocities that they began with.
 */
static void drift(fluid *s, double h)
{
    double before[SIZE], unconstrained[SIZE];
    memcpy(before, s->r, sizeof before);
    for (int i = 0; i < SIZE; ++i) s->r[i] += h * (s->v[i] + (i % 3 == 0 ? rate * before[i + 1] : 0));
    memcpy(unconstrained, s->r, sizeof unconstrained);
    CHECK(hol_project_positions(s->chains, before, s->r, NULL, h, NULL, 0, NULL, NULL));
    for (int i = 0; i < SIZE; ++i) s->v[i] += (s->r[i] - unconstrained[i]) / h;
    turn(s->v, h);
}

typedef struct outcome {
    double balance, length, rate;
} outcome;

/** Energy gained beyond the work, and the largest errors. */
static outcome run(const mixture *m, double time, int steps, int with_rate)
{
    const double L[9] = {0, rate, 0, 0, 0, 0, 0, 0, 0}, dt = time / steps;
    fluid s;
    outcome out = {0, 0, 0};
    s.chains = m->chains;
    s.mass = m->mass;
    memcpy(s.r, m->r, sizeof s.r);
    memcpy(s.v, m->v, sizeof s.v);
    for (int i = 0; i < SIZE; ++i) s.r[i] -= m->r[i % 3];
    CHECK(hol_chains_set_box_rate(m->chains, L));
    CHECK(hol_project_velocities(m->chains, s.r, s.v, NULL, NULL));
    const double start = forces(&s) + kinetic(&s);
    double work = 0.5 * dt * power(&s), potential = 0;
    for (int step = 1; step <= steps; ++step) {
        kick(&s, 0.5 * dt);
        drift(&s, dt);
        potential = forces(&s);
        kick(&s, 0.5 * dt);
        if (!with_rate) CHECK(hol_chains_set_box_rate(m->chains, NULL));
        CHECK(hol_project_velocities(m->chains, s.r, s.v, NULL, NULL));
        CHECK(hol_chains_set_box_rate(m->chains, L));
        hol_worst worst;
        CHECK(hol_violation(m->chains, s.r, s.v, &worst));
        out.length = fmax(out.length, worst.length);
        out.rate = fmax(out.rate, worst.rate);
        work += (step == steps ? 0.5 : 1) * dt * power(&s);
    }
    out.balance = fabs(potential + kinetic(&s) - start - work);
    return out;
}

static void check_flow(molecule_kind kind, int64_t n, int64_t size)
{
    mixture m = mixture_of_kind(kind, n, size, size, ONE_AFTER_THE_OTHER, 60);
    assert_int_equal(m.n_atoms, BEADS);
    const outcome coarse = run(&m, 2, 500, 1), fine = run(&m, 2, 1000, 1), wrong = run(&m, 2, 1000, 0);
    CHECK_AT_MOST(fine.length, 1e-13);
    CHECK_AT_MOST(fine.rate, 1e-13); /* speeds of about 3, bonds of 1.5 */
    CHECK_AT_MOST(coarse.balance, 2e-3);
    CHECK_AT_MOST(fine.balance, 0.27 * coarse.balance); /* of second order in the time step */
    CHECK_AT_MOST(100 * fine.balance, wrong.balance);
    CHECK_AT_MOST(0.1, wrong.rate);
    mixture_free(&m);
}

static void the_flow_does_the_work_that_the_energy_gains(void **state)
{
    (void)state;
    check_flow(MOLECULE_CHAIN, 1, 11);
    check_flow(MOLECULE_CHAIN, 3, 3);
    check_flow(MOLECULE_WATER, 4, 3);
    check_flow(MOLECULE_XH3, 3, 3);
    check_flow(MOLECULE_RING, 2, 6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_flow_does_the_work_that_the_energy_gains)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
