/** Rigid bodies in motion: against the solution of the free top, and what must be conserved. */
#include "check.h"
#include "random.h"

/* sn and cn of Jacobi by Gauss' means (Abramowitz and Stegun 16.4). */
static void elliptic(double u, double k, double *sn, double *cn, double *dn)
{
    double a[20] = {1}, c[20] = {k}, b = sqrt(1 - k * k);
    int n = 0;
    for (; fabs(c[n]) > 1e-17 && n < 18; ++n) {
        a[n + 1] = (a[n] + b) / 2;
        c[n + 1] = (a[n] - b) / 2;
        b = sqrt(a[n] * b);
    }
    double phi = ldexp(a[n] * u, n);
    for (int i = n; i > 0; --i) phi = (phi + asin(c[i] / a[i] * sin(phi))) / 2;
    *sn = sin(phi), *cn = cos(phi), *dn = sqrt(1 - k * k * *sn * *sn);
}

static void cross(const double *a, const double *b, double *c)
{
    for (int x = 0; x < 3; ++x) c[x] = a[(x + 1) % 3] * b[(x + 2) % 3] - a[(x + 2) % 3] * b[(x + 1) % 3];
}

/* Pairs of atoms on three axes, with distances from the centre: the moments of inertia ascend. */
static const double top_mass[6] = {3, 3, 2, 2, 1, 1}, arm[3] = {1.5, 1.2, 0.7};

/* The largest error of the angular velocity in the body's frame at the end, relative to its largest component. */
static double error_of_top(double dt, int n_steps)
{
    double r[18] = {0}, v[18], ref[18], I[3], L[3] = {0}, energy = 0, momentum = 0;
    const int64_t six = 6, atoms[6] = {0, 1, 2, 3, 4, 5};
    hol_chains *chains;
    for (int p = 0; p < 3; ++p) r[6 * p + p] = arm[p], r[6 * p + 3 + p] = -arm[p];
    for (int p = 0; p < 3; ++p) {
        const int q = (p + 1) % 3, s = (p + 2) % 3;
        I[p] = 2 * (top_mass[2 * q] * arm[q] * arm[q] + top_mass[2 * s] * arm[s] * arm[s]);
    }
    assert_true(I[0] < I[1] && I[1] < I[2]);
    const double omega[3] = {0.9, 0, 1.6};
    for (int i = 0; i < 6; ++i) cross(omega, r + 3 * i, v + 3 * i);
    for (int p = 0; p < 3; ++p) {
        L[p] = I[p] * omega[p];
        energy += I[p] * omega[p] * omega[p]; /* twice it */
        momentum += L[p] * L[p];
    }
    CHECK(hol_chains_create(6, top_mass, &chains));
    CHECK(hol_chains_add_rigid(chains, 1, &six, atoms, r, 0, NULL, NULL));
    for (int s = 0; s < n_steps; ++s) {
        memcpy(ref, r, sizeof r);
        for (int i = 0; i < 18; ++i) r[i] += dt * v[i];
        CHECK(hol_project_positions(chains, ref, r, v, dt, NULL, 0, NULL, NULL));
        CHECK(hol_project_velocities(chains, r, v, NULL, NULL));
    }
    hol_chains_destroy(chains);
    /* Landau and Lifshitz, Mechanics, section 37, for momentum^2 > 2 E I_2 */
    const double t = dt * n_steps, u = energy * I[2] - momentum, w = momentum - energy * I[0];
    assert_true(momentum > energy * I[1]);
    const double k = sqrt((I[1] - I[0]) * u / ((I[2] - I[1]) * w));
    double f[3], exact[3], worst = 0;
    elliptic(t * sqrt((I[2] - I[1]) * w / (I[0] * I[1] * I[2])), k, f + 1, f, f + 2);
    exact[0] = sqrt(u / (I[0] * (I[2] - I[0]))) * f[0];
    exact[1] = sqrt(u / (I[1] * (I[2] - I[1]))) * f[1];
    exact[2] = sqrt(w / (I[2] * (I[2] - I[0]))) * f[2];
    for (int p = 0; p < 3; ++p) {
        double along = 0;
        for (int x = 0; x < 3; ++x) along += L[x] * (r[6 * p + x] - r[6 * p + 3 + x]) / (2 * arm[p]);
        worst = fmax(worst, fabs(along / I[p] - exact[p]));
    }
    return worst / 1.6;
}

static void a_free_top_follows_the_elliptic_functions_to_second_order(void **state)
{
    (void)state;
    const double coarse = error_of_top(0.02, 500), fine = error_of_top(0.01, 1000);
    CHECK_AT_MOST(coarse, 5e-3);
    CHECK_AT_MOST(fabs(coarse / fine - 4), 0.2);
}

/* Two rings, a bond between them, an atom at each end; a spring between the ends. */
enum { RINGS = 14 };
static double pull(const double *r, double *f)
{
    double d[3], s = 0;
    memset(f, 0, sizeof(double) * 3 * RINGS);
    for (int x = 0; x < 3; ++x) d[x] = r[3 * 13 + x] - r[3 * 12 + x], s += d[x] * d[x];
    for (int x = 0; x < 3; ++x) f[3 * 12 + x] = 3 * d[x], f[3 * 13 + x] = -3 * d[x];
    return 1.5 * s;
}

static void rings_in_a_row_keep_energy_and_momenta(void **state)
{
    (void)state;
    const int n_steps = quick_run() ? 50 : 3000;
    const double dt = 2e-3;
    double mass[RINGS], place[36], r[3 * RINGS], v[3 * RINGS], f[3 * RINGS], ref[3 * RINGS];
    const int64_t sizes[2] = {6, 6}, atoms[12] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11},
                  pairs[6] = {0, 9, 12, 3, 6, 13};
    const double length[3] = {1.5, 1.5, 1.5};
    hol_chains *chains;
    for (int i = 0; i < RINGS; ++i) mass[i] = i < 12 ? 12 : 15;
    for (int i = 0; i < 12; ++i) {
        const double angle = acos(-1.0) / 3 * i;
        place[3 * i] = 1.4 * cos(angle), place[3 * i + 1] = 1.4 * sin(angle), place[3 * i + 2] = 0;
        for (int x = 0; x < 3; ++x) r[3 * i + x] = place[3 * i + x] + (x == 0 && i > 5 ? 4.3 : 0);
    }
    for (int x = 0; x < 3; ++x) {
        r[3 * 12 + x] = r[3 * 3 + x] - (x == 0 ? 0.9 : x == 2 ? 1.2 : 0);
        r[3 * 13 + x] = r[3 * 6 + x] + (x == 0 ? 0.9 : x == 1 ? 1.2 : 0);
    }
    random_stream s = random_seed(3);
    for (int i = 0; i < 3 * RINGS; ++i) v[i] = 0.4 * random_normal(&s);
    CHECK(hol_chains_create(RINGS, mass, &chains));
    CHECK(hol_chains_add_rigid(chains, 2, sizes, atoms, place, 3, pairs, length));
    CHECK(hol_project_velocities(chains, r, v, NULL, NULL));
    double potential = pull(r, f), energy[2], P[2][3], L[2][3], largest = 0;
    for (int step = 0; step <= n_steps; ++step) {
        const int end = step != 0;
        energy[end] = potential;
        memset(P[end], 0, sizeof P[end]), memset(L[end], 0, sizeof L[end]);
        for (int i = 0; i < RINGS; ++i) {
            double l[3];
            cross(r + 3 * i, v + 3 * i, l);
            for (int x = 0; x < 3; ++x) {
                energy[end] += 0.5 * mass[i] * v[3 * i + x] * v[3 * i + x];
                P[end][x] += mass[i] * v[3 * i + x];
                L[end][x] += mass[i] * l[x];
            }
        }
        largest = fmax(largest, fabs(energy[end] - energy[0]));
        memcpy(ref, r, sizeof r);
        for (int i = 0; i < 3 * RINGS; ++i) v[i] += dt / 2 * f[i] / mass[i / 3], r[i] += dt * v[i];
        CHECK(hol_project_positions(chains, ref, r, v, dt, NULL, 0, NULL, NULL));
        potential = pull(r, f);
        for (int i = 0; i < 3 * RINGS; ++i) v[i] += dt / 2 * f[i] / mass[i / 3];
        CHECK(hol_project_velocities(chains, r, v, NULL, NULL));
    }
    hol_worst worst;
    CHECK(hol_violation(chains, r, v, &worst));
    CHECK_AT_MOST(worst.length, 2e-14);
    CHECK_AT_MOST(worst.rate, 1e-13);
    CHECK_AT_MOST(largest, 1e-4 * energy[0]);
    for (int x = 0; x < 3; ++x) CHECK_AT_MOST(fabs(P[1][x] - P[0][x]), 1e-10);
    for (int x = 0; x < 3; ++x) CHECK_AT_MOST(fabs(L[1][x] - L[0][x]), 1e-9);
    hol_chains_destroy(chains);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_free_top_follows_the_elliptic_functions_to_second_order),
        cmocka_unit_test(rings_in_a_row_keep_energy_and_momenta),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
