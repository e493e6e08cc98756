/** Bodies by mass, centre and inertia, whose mass points stand for them: against Euler's equations of the tensor. */
#include "check.h"
#include "random.h"

enum { SITES = 3, MOST = 4 + SITES };

static void cross(const double *a, const double *b, double *c)
{
    for (int x = 0; x < 3; ++x) c[x] = a[(x + 1) % 3] * b[(x + 2) % 3] - a[(x + 2) % 3] * b[(x + 1) % 3];
}

static void times(const double A[9], const double *x, double *y)
{
    for (int i = 0; i < 3; ++i) y[i] = A[3 * i] * x[0] + A[3 * i + 1] * x[1] + A[3 * i + 2] * x[2];
}

/** x of A x = b, by Cramer's rule. */
static void solve(const double A[9], const double *b, double *x)
{
    double c[3][3];
    for (int i = 0; i < 3; ++i) cross(A + 3 * ((i + 1) % 3), A + 3 * ((i + 2) % 3), c[i]); /* rows of the cofactors */
    const double det = A[0] * c[0][0] + A[1] * c[0][1] + A[2] * c[0][2];
    for (int i = 0; i < 3; ++i) x[i] = (c[0][i] * b[0] + c[1][i] * b[1] + c[2][i] * b[2]) / det;
}

/** A rotation from a random quaternion. */
static void rotation(random_stream *s, double R[9])
{
    double q[4], square = 0;
    for (int k = 0; k < 4; ++k) q[k] = random_normal(s), square += q[k] * q[k];
    for (int i = 0; i < 3; ++i) {
        const double e[3] = {i == 0, i == 1, i == 2};
        double t[3], u[3];
        cross(q + 1, e, t);
        cross(q + 1, t, u);
        for (int x = 0; x < 3; ++x) R[3 * x + i] = e[x] + 2 * (q[0] * t[x] + u[x]) / square;
    }
}

/** Q diag(moments) Q^T */
static void turned(const double *moments, const double Q[9], double *I)
{
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            I[3 * i + j] = 0;
            for (int p = 0; p < 3; ++p) I[3 * i + j] += Q[3 * i + p] * moments[p] * Q[3 * j + p];
        }
}

/** mass points behind which massless sites stand */
typedef struct body {
    int64_t n_points, n;
    double M, centre[3], inertia[9], axes[9], mass[MOST], place[3 * MOST];
} body;

static body make(const double *moments, uint64_t seed)
{
    body b = {.M = 3.7, .centre = {0.3, -1.2, 2}};
    random_stream s = random_seed(seed);
    rotation(&s, b.axes);
    turned(moments, b.axes, b.inertia);
    CHECK(hol_equimomental_points(b.M, b.centre, b.inertia, &b.n_points, b.mass, b.place));
    b.n = b.n_points + SITES;
    for (int64_t a = b.n_points; a < b.n; ++a) {
        double x[3];
        for (int p = 0; p < 3; ++p) x[p] = random_normal(&s);
        if (moments[0] == 0) x[1] = x[2] = 0; /* on the line; else anywhere, off the plane, too */
        times(b.axes, x, b.place + 3 * a);
        for (int k = 0; k < 3; ++k) b.place[3 * a + k] += b.centre[k];
    }
    return b;
}

static hol_chains *chains_of(const body *b)
{
    int64_t atoms[MOST];
    hol_chains *chains;
    for (int64_t a = 0; a < b->n; ++a) atoms[a] = a;
    CHECK(hol_chains_create(b->n, b->mass, &chains));
    CHECK(hol_chains_add_rigid(chains, 1, &b->n, atoms, b->place, 0, NULL, NULL));
    return chains;
}

static void check_moments(const body *b)
{
    double mass = 0, first[3] = {0}, second[9] = {0};
    for (int64_t a = 0; a < b->n_points; ++a) {
        double x[3], square = 0;
        mass += b->mass[a];
        for (int k = 0; k < 3; ++k) x[k] = b->place[3 * a + k] - b->centre[k], square += x[k] * x[k];
        for (int i = 0; i < 3; ++i) {
            first[i] += b->mass[a] * x[i];
            for (int j = 0; j < 3; ++j) second[3 * i + j] += b->mass[a] * ((i == j) * square - x[i] * x[j]);
        }
    }
    CHECK_AT_MOST(fabs(mass - b->M), 4e-15);
    for (int i = 0; i < 3; ++i) CHECK_AT_MOST(fabs(first[i]), 4e-15);
    for (int e = 0; e < 9; ++e) CHECK_AT_MOST(fabs(second[e] - b->inertia[e]), 2e-14);
}

/** Places and velocities of a body that is turned by R, at C, with V and omega. */
static void move(const body *b, const double R[9], const double *V, const double *omega, double *r, double *v)
{
    for (int64_t a = 0; a < b->n; ++a) {
        double x[3], y[3], turn[3];
        for (int k = 0; k < 3; ++k) x[k] = b->place[3 * a + k] - b->centre[k];
        times(R, x, y);
        cross(omega, y, turn);
        for (int k = 0; k < 3; ++k) r[3 * a + k] = 0.5 - k + y[k], v[3 * a + k] = V[k] + turn[k];
    }
}

static void check_euler(const body *b, const double *moments)
{
    double R[9], A[9], I[9], V[3], omega[3], r[3 * MOST], v[3 * MOST], f[3 * MOST] = {0}, g[3 * MOST];
    double force[3] = {0}, torque[3] = {0}, L[3], gyro[3], alpha[3];
    random_stream s = random_seed(5);
    rotation(&s, R);
    for (int k = 0; k < 3; ++k) V[k] = random_normal(&s), omega[k] = random_normal(&s);
    for (int i = 0; i < 3; ++i) times(R, (double[3]){b->axes[i], b->axes[3 + i], b->axes[6 + i]}, A + 3 * i);
    double axes[9]; /* columns */
    for (int i = 0; i < 9; ++i) axes[i] = A[3 * (i % 3) + i / 3];
    if (moments[0] == 0) { /* no turn about the line, and a moment about it that is not asked for */
        const double along = omega[0] * A[0] + omega[1] * A[1] + omega[2] * A[2];
        for (int k = 0; k < 3; ++k) omega[k] -= along * A[k];
    }
    const double apart[3] = {moments[0] == 0 ? 1 : moments[0], moments[1], moments[2]};
    turned(apart, axes, I);
    move(b, R, V, omega, r, v);
    for (int64_t e = 3 * b->n_points; e < 3 * b->n; ++e) f[e] = random_normal(&s);
    for (int64_t a = b->n_points; a < b->n; ++a) {
        double x[3], t[3];
        for (int k = 0; k < 3; ++k) x[k] = r[3 * a + k] - (0.5 - k), force[k] += f[3 * a + k];
        cross(x, f + 3 * a, t);
        for (int k = 0; k < 3; ++k) torque[k] += t[k];
    }
    times(I, omega, L);
    cross(omega, L, gyro);
    for (int k = 0; k < 3; ++k) torque[k] -= gyro[k];
    solve(I, torque, alpha);

    hol_chains *chains = chains_of(b);
    assert_int_equal(hol_chains_degrees_of_freedom(chains, 3), moments[0] == 0 ? 5 : 6);
    CHECK(hol_forces(chains, r, v, f, NULL, NULL, g, HOL_WRITE, NULL));
    for (int64_t a = 0; a < b->n; ++a) {
        double x[3], along[3], turn[3], centripetal[3];
        for (int k = 0; k < 3; ++k) x[k] = r[3 * a + k] - (0.5 - k);
        cross(alpha, x, along);
        cross(omega, x, turn);
        cross(omega, turn, centripetal);
        for (int k = 0; k < 3; ++k) {
            const double wanted = force[k] / b->M + along[k] + centripetal[k];
            if (a < b->n_points)
                CHECK_AT_MOST(fabs((f[3 * a + k] + g[3 * a + k]) / b->mass[a] - wanted), 2e-13);
            else
                CHECK_AT_MOST(fabs(f[3 * a + k] + g[3 * a + k]), 2e-13);
        }
    }
    hol_chains_destroy(chains);
}

/** Angular momentum of a free body about its centre, and twice its energy, by its tensor turned with it. */
static void check_flight(const body *b)
{
    double R[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, r[3 * MOST], v[3 * MOST], ref[3 * MOST], L[2][3] = {{0}},
           energy[2] = {0};
    const double V[3] = {0.1, 0.2, -0.1}, omega[3] = {0.7, -0.4, 0.9};
    move(b, R, V, omega, r, v);
    hol_chains *chains = chains_of(b);
    CHECK(hol_project_velocities(chains, r, v, NULL, NULL)); /* no turn about a line */
    for (int step = 0; step <= 2000; ++step) {
        if (step % 2000 == 0)
            for (int64_t a = 0; a < b->n_points; ++a) {
                double x[3], u[3], l[3];
                for (int k = 0; k < 3; ++k)
                    x[k] = r[3 * a + k] - (0.5 - k) - 0.01 * step * V[k], u[k] = v[3 * a + k] - V[k];
                cross(x, u, l);
                for (int k = 0; k < 3; ++k)
                    L[step / 2000][k] += b->mass[a] * l[k], energy[step / 2000] += b->mass[a] * u[k] * u[k];
            }
        memcpy(ref, r, sizeof r);
        for (int64_t e = 0; e < 3 * b->n; ++e) r[e] += 0.01 * v[e];
        CHECK(hol_project_positions(chains, ref, r, v, 0.01, NULL, 0, NULL, NULL));
        CHECK(hol_project_velocities(chains, r, v, NULL, NULL));
    }
    double of_tensor[3];
    times(b->inertia, omega, of_tensor);
    for (int k = 0; k < 3; ++k) {
        CHECK_AT_MOST(fabs(L[1][k] - L[0][k]), 1e-11);
        CHECK_AT_MOST(fabs(L[0][k] - of_tensor[k]), 1e-13);
    }
    CHECK_AT_MOST(fabs(energy[1] - energy[0]), 1e-11);
    hol_chains_destroy(chains);
}

static const double kinds[][3] = {{2, 3, 4}, {1.3, 1.3, 1.3}, {0.5, 4, 4.2}, {1, 2, 3}, {1.5, 1.5, 3}, {0, 2.5, 2.5}};

static void moments_and_motions_are_those_of_the_tensor(void **state)
{
    (void)state;
    const int64_t n[] = {4, 4, 4, 3, 3, 2};
    for (int k = 0; k < 6; ++k)
        for (uint64_t seed = 1; seed < 4; ++seed) {
            const body b = make(kinds[k], seed);
            assert_int_equal(b.n_points, n[k]);
            check_moments(&b);
            check_euler(&b, kinds[k]);
            check_flight(&b);
        }
}

/** Six digits of a flat and of a linear body: the moments are kept as far as these go. */
static void digits_of_a_file_leave_a_body_flat_or_linear(void **state)
{
    (void)state;
    const double flat[9] = {1.23457, 0, 0, 0, 2.34568, 0, 0, 0, 3.58026}, rod[9] = {0, 0, 0, 0, 2.5, 0, 0, 0, 2.500001};
    double mass[4], places[12];
    int64_t n;
    CHECK(hol_equimomental_points(1, NULL, flat, &n, mass, places));
    assert_int_equal(n, 3);
    CHECK(hol_equimomental_points(1, NULL, rod, &n, mass, places));
    assert_int_equal(n, 2);
}

static void tensors_of_no_distribution_of_mass_are_refused(void **state)
{
    (void)state;
    const double one[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const struct {
        double mass, inertia[9];
        const char *words;
    } bad[] = {
        {0, {1, 0, 0, 0, 1, 0, 0, 0, 1}, "the mass is 0"},
        {NAN, {1, 0, 0, 0, 1, 0, 0, 0, 1}, "the mass is"},
        {INFINITY, {1, 0, 0, 0, 1, 0, 0, 0, 1}, "the mass is inf"},
        {1, {1, 0, 0, 0, 1, NAN, 0, 0, 1}, "element yz"},
        {1, {0}, "that is a point"},
        {1, {1, 0.1, 0, 0.2, 1, 0, 0, 0, 1}, "not symmetric: its element xy"},
        {1, {1, 0, 0, 0, -1, 0, 0, 0, 1}, "element yy is -1"},
        {1, {1, 2, 0, 2, 1, 0, 0, 0, 2}, "the principal moment -1"},
        {1, {1, 0, 0, 0, 2, 0, 0, 0, 4}, "principal moments 1, 2 and 4"},
        {1, {0, 0, 0, 0, 0, 0, 0, 0, 1}, "principal moments 0, 0 and 1"},
        {1, {1, 0, 0, 0, 1.5, 0, 0, 0, 2.5001}, "above the sum of the others"},
    };
    double mass[4] = {-7, -7, -7, -7}, places[12] = {-7};
    int64_t n = -7;
    for (size_t k = 0; k < sizeof bad / sizeof *bad; ++k) {
        CHECK_FAILS(HOL_ERR_VALUE, hol_equimomental_points(bad[k].mass, NULL, bad[k].inertia, &n, mass, places));
        assert_message_names(bad[k].words);
    }
    CHECK_FAILS(HOL_ERR_VALUE, hol_equimomental_points(1, (double[3]){0, NAN, 0}, one, &n, mass, places));
    assert_message_names("the centre's y");
    CHECK_FAILS(HOL_ERR_NULL, hol_equimomental_points(1, NULL, NULL, &n, mass, places));
    CHECK_FAILS(HOL_ERR_NULL, hol_equimomental_points(1, NULL, one, NULL, mass, places));
    CHECK_FAILS(HOL_ERR_NULL, hol_equimomental_points(1, NULL, one, &n, NULL, places));
    CHECK_FAILS(HOL_ERR_NULL, hol_equimomental_points(1, NULL, one, &n, mass, NULL));
    assert_true(n == -7 && mass[0] == -7 && places[0] == -7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(moments_and_motions_are_those_of_the_tensor),
        cmocka_unit_test(digits_of_a_file_leave_a_body_flat_or_linear),
        cmocka_unit_test(tensors_of_no_distribution_of_mass_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
