/**
 * Steps that are so long that Newton's method loses its way: the library's root beside the root that is followed from
 * the reference in small steps, and SHAKE run to its end. Both are of this file alone.
 */
#include "check.h"
#include "random.h"

enum { MOST = 10, MOST_BONDS = 10 };

typedef struct molecule {
    const char *name;
    int n_atoms, n_bonds;
    int64_t pairs[2 * MOST_BONDS];
    double masses[MOST], r[3 * MOST];
} molecule;

#define T 0.0629
static const molecule molecules[] = {
    {"methane by nine of ten distances",
     5,
     9,
     {0, 1, 0, 2, 0, 3, 0, 4, 1, 2, 1, 3, 1, 4, 2, 3, 2, 4},
     {12, 1, 1, 1, 1},
     {0, 0, 0, T, T, T, T, -T, -T, -T, T, -T, -T, -T, T}},
    {"CH4", 5, 4, {0, 1, 0, 2, 0, 3, 0, 4}, {12, 1, 1, 1, 1}, {0, 0, 0, T, T, T, T, -T, -T, -T, T, -T, -T, -T, T}},
    {"CH3", 4, 3, {0, 1, 0, 2, 0, 3}, {12, 1, 1, 1}, {0, 0, 0, T, T, T, T, -T, -T, -T, T, -T}},
    {"water", 3, 3, {0, 1, 0, 2, 1, 2}, {16, 1, 1}, {0, 0, 0, 0.0957, 0, 0, -0.024, 0.0926, 0}},
    /* Martini's cholesterol: 0.4904, 0.6019, 0.2719, 0.7237, 0.5376 nm, hinged along its third distance */
    {"cholesterol",
     4,
     5,
     {0, 1, 0, 2, 1, 2, 1, 3, 2, 3},
     {77.22, 38.69, 159.65, 39.44},
     {0, 0, 0, 0.4904, 0, 0, 0.53889, 0.26745, 0, 1.02, 0.49, 0.15}},
    {"chain of five",
     6,
     5,
     {0, 1, 1, 2, 2, 3, 3, 4, 4, 5},
     {1, 2, 1, 3, 1, 1},
     {0, 0, 0, 1, 0, 0, 1.3, 0.9, 0, 1.2, 1.4, 0.8, 2, 1.6, 1.2, 2.4, 1, 1.9}},
    {"ring of six",
     6,
     6,
     {0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 0, 5},
     {1, 1, 1, 1, 1, 1},
     {1, 0, .4, .5, .87, -.4, -.5, .87, .4, -1, 0, -.4, -.5, -.87, .4, .5, -.87, -.4}},
    {"tree",
     10,
     9,
     {0, 1, 0, 2, 0, 3, 3, 4, 3, 5, 3, 6, 6, 7, 6, 8, 6, 9},
     {12, 1, 1, 12, 1, 1, 12, 1, 1, 1},
     {0, 0,    0,    -.3, 1, 0,    -.3, -.5, .9,   -.4, -.6, -1.3, -1.4, -.6, -1.4,
      0, -1.6, -1.2, .3,  0, -2.5, 0,   1,   -2.5, 1.4, 0,   -2.5, 0,    -.5, -3.4}},
};
enum { MOLECULES = sizeof molecules / sizeof *molecules };

/** Bonds of a step: reference b, positions to be projected D, lengths a; tau is 2 dt^2 lambda. */
typedef struct step {
    const molecule *m;
    double ref[3 * MOST], r[3 * MOST], a[MOST_BONDS];
} step;

static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void difference(const molecule *m, int k, const double *r, double *d)
{
    for (int x = 0; x < 3; ++x) d[x] = r[3 * m->pairs[2 * k + 1] + x] - r[3 * m->pairs[2 * k] + x];
}

/** Positions at part t of the way, moved by tau. */
static void positions_at(const step *s, double t, const double *tau, double *r)
{
    const molecule *m = s->m;
    for (int e = 0; e < 3 * m->n_atoms; ++e) r[e] = s->ref[e] + t * (s->r[e] - s->ref[e]);
    for (int k = 0; k < m->n_bonds; ++k) {
        double b[3];
        difference(m, k, s->ref, b);
        const int64_t i = m->pairs[2 * k], j = m->pairs[2 * k + 1];
        for (int x = 0; x < 3; ++x) {
            r[3 * i + x] += tau[k] * b[x] / m->masses[i];
            r[3 * j + x] -= tau[k] * b[x] / m->masses[j];
        }
    }
}

/** One of Newton's steps by dense elimination with pivots; returns the largest error before it. */
static double newton(const step *s, double t, double *tau)
{
    const molecule *m = s->m;
    const int n = m->n_bonds;
    double r[3 * MOST], A[MOST_BONDS][MOST_BONDS + 1], worst = 0;
    positions_at(s, t, tau, r);
    for (int k = 0; k < n; ++k) {
        double d[3];
        difference(m, k, r, d);
        A[k][n] = (dot(d, d) - s->a[k] * s->a[k]) / 2;
        worst = fmax(worst, fabs(2 * A[k][n]) / (s->a[k] * s->a[k]));
        for (int l = 0; l < n; ++l) {
            double b[3], w = 0;
            difference(m, l, s->ref, b);
            for (int p = 0; p < 2; ++p)
                for (int q = 0; q < 2; ++q)
                    if (m->pairs[2 * k + p] == m->pairs[2 * l + q])
                        w += (p == q ? 1 : -1) / m->masses[m->pairs[2 * k + p]];
            A[k][l] = w * dot(d, b);
        }
    }
    for (int c = 0; c < n; ++c) {
        int pivot = c;
        for (int k = c + 1; k < n; ++k)
            if (fabs(A[k][c]) > fabs(A[pivot][c])) pivot = k;
        for (int l = c; l <= n; ++l) {
            const double swap = A[c][l];
            A[c][l] = A[pivot][l];
            A[pivot][l] = swap;
        }
        for (int k = c + 1; k < n; ++k)
            for (int l = n; l >= c; --l) A[k][l] -= A[k][c] / A[c][c] * A[c][l];
    }
    for (int k = n; k-- > 0;) {
        for (int l = k + 1; l < n; ++l) A[k][n] -= A[k][l] * A[l][n];
        A[k][n] /= A[k][k];
        tau[k] += A[k][n];
    }
    return worst;
}

/** Follows the root; returns how far it comes, 1 if to the end, where r is written. */
static double follow(const step *s, double *r)
{
    double tau[MOST_BONDS] = {0}, slope[MOST_BONDS] = {0}, t = 0, h = 0.01;
    while (t < 1) {
        if (h < 1e-7) return t;
        const double next = fmin(t + h, 1), length = next - t;
        double guess[MOST_BONDS], before[3 * MOST], after[3 * MOST], error = 1, moved = 0;
        for (int k = 0; k < s->m->n_bonds; ++k) guess[k] = tau[k] + length * slope[k];
        positions_at(s, next, guess, before);
        for (int i = 0; i < 8 && error > 1e-14; ++i) error = newton(s, next, guess);
        positions_at(s, next, guess, after);
        for (int e = 0; e < 3 * s->m->n_atoms; ++e) moved = fmax(moved, fabs(after[e] - before[e]) / s->a[0]);
        if (!(error < 1e-12) || !(moved < 0.02)) {
            h = length / 2;
            continue;
        }
        for (int k = 0; k < s->m->n_bonds; ++k) {
            slope[k] = (guess[k] - tau[k]) / length;
            tau[k] = guess[k];
        }
        t = next;
        if (moved < 0.005) h = fmin(2 * h, 0.02);
    }
    positions_at(s, 1, tau, r);
    return 1;
}

/** SHAKE, bond after bond, to its end. */
static int shake(const step *s, double *r)
{
    const molecule *m = s->m;
    memcpy(r, s->r, sizeof s->r);
    for (int round = 0; round < 20000; ++round) {
        double worst = 0;
        for (int k = 0; k < m->n_bonds; ++k) {
            const int64_t i = m->pairs[2 * k], j = m->pairs[2 * k + 1];
            const double w_i = 1 / m->masses[i], w_j = 1 / m->masses[j];
            double b[3], d[3];
            difference(m, k, s->ref, b);
            difference(m, k, r, d);
            const double left = dot(d, d) - s->a[k] * s->a[k], g = left / (2 * (w_i + w_j) * dot(d, b));
            worst = fmax(worst, fabs(left) / (s->a[k] * s->a[k]));
            for (int x = 0; x < 3; ++x) {
                r[3 * i + x] += g * w_i * b[x];
                r[3 * j + x] -= g * w_j * b[x];
            }
        }
        if (!(worst < 1e6)) return 0;
        if (worst < 1e-14) return 1;
    }
    return 0;
}

/** A conformation turned at random, and a step that turns it by an angle and shakes its atoms. */
static step draw(const molecule *m, random_stream *stream, double angle, double noise)
{
    step s = {m, {0}, {0}, {0}};
    double axis[3], size = 0;
    for (int x = 0; x < 3; ++x) {
        axis[x] = random_normal(stream);
        size += axis[x] * axis[x];
    }
    for (int x = 0; x < 3; ++x) axis[x] /= sqrt(size);
    memcpy(s.ref, m->r, sizeof s.ref);
    for (int k = 0; k < m->n_bonds; ++k) {
        double d[3];
        difference(m, k, s.ref, d);
        s.a[k] = sqrt(dot(d, d));
    }
    for (int i = 0; i < m->n_atoms; ++i) {
        const double *x = s.ref + 3 * i, along = dot(axis, x);
        for (int c = 0; c < 3; ++c) {
            const int d = (c + 1) % 3, e = (c + 2) % 3;
            s.r[3 * i + c] = cos(angle) * x[c] + (1 - cos(angle)) * along * axis[c] +
                             sin(angle) * (axis[d] * x[e] - axis[e] * x[d]) + noise * s.a[0] * random_normal(stream);
        }
    }
    return s;
}

static double distance(const step *s, const double *r, const double *other)
{
    double most = 0;
    for (int e = 0; e < 3 * s->m->n_atoms; ++e) most = fmax(most, fabs(r[e] - other[e]) / s->a[0]);
    return most;
}

static hol_chains *chains_of(const step *s)
{
    hol_chains *chains;
    CHECK(hol_chains_create(s->m->n_atoms, s->m->masses, &chains));
    CHECK(hol_chains_add_bonds(chains, s->m->n_bonds, s->m->pairs, s->a));
    CHECK(hol_chains_set_checks(chains, HOL_NEVER));
    return chains;
}

/* Whatever the path comes to is found, nothing else is; where SHAKE comes to an end beside it, it is the same. */
static void long_steps_come_to_the_root_of_the_reference(void **state)
{
    (void)state;
    random_stream stream = random_seed(51);
    const int trials = quick_run() ? 4 : 120;
    for (int which = 0; which < MOLECULES; ++which) {
        int found = 0, refused = 0, by_shake = 0, other = 0;
        for (int trial = 0; trial < trials; ++trial) {
            const double size = 0.3 + 0.15 * (trial % 4);
            const step s = draw(molecules + which, &stream, 1.2 * size, 0.3 * size);
            double r[3 * MOST], path[3 * MOST], shaken[3 * MOST];
            hol_chains *chains = chains_of(&s);
            memcpy(r, s.r, sizeof r);
            const int status = hol_project_positions(chains, s.ref, r, NULL, 1, NULL, 0, NULL, NULL);
            const double end = follow(&s, path);
            if (status == HOL_OK) {
                ++found;
                if (end < 1) fail_msg("%s, step %d: solved, but the path ends at %g", s.m->name, trial, end);
                /* both are solved to some roundings, which pivots of 1e-3 enlarge */
                CHECK_AT_MOST(distance(&s, r, path), 1e-11);
                if (shake(&s, shaken)) {
                    ++by_shake;
                    other += distance(&s, r, shaken) > 1e-6;
                }
            } else {
                ++refused;
                assert_int_equal(status, HOL_ERR_NO_CONVERGENCE);
                if (end == 1) fail_msg("%s, step %d: refused, but the path goes to its end", s.m->name, trial);
                assert_memory_equal(r, s.r, sizeof(double) * 3 * (size_t)s.m->n_atoms);
            }
            hol_chains_destroy(chains);
        }
        print_message("%s: %d found, %d of them by SHAKE, %d elsewhere; %d refused\n", molecules[which].name, found,
                      by_shake, other, refused);
        if (!quick_run()) CHECK_AT_MOST(20 * other, by_shake);
    }
}

/* The step that OpenMM's users meet: Newton's method goes astray, SHAKE needs 500 rounds. */
static void methane_by_nine_distances_is_where_shake_comes_to(void **state)
{
    (void)state;
    step s = {molecules, {0}, {0}, {0}};
    static const double ref[] = {0,      0,     0,      -.0924, -.0267, .0515, .0147, -.0667,
                                 -.0851, .0841, -.0097, .0688,  -.0064, .1031, -.0352},
                        trial[] = {.0023,  -.0047, .0126, -.0842, -.0233, .0293, -.0185, -.0557,
                                   -.0742, .0746,  .0369, .0379,  -.0293, .1106, -.0744};
    memcpy(s.ref, ref, sizeof ref);
    memcpy(s.r, trial, sizeof trial);
    for (int k = 0; k < s.m->n_bonds; ++k) {
        double d[3];
        difference(s.m, k, s.ref, d);
        s.a[k] = sqrt(dot(d, d));
    }
    hol_chains *chains = chains_of(&s);
    const double dt = 0.002;
    double r[15], v[15] = {0}, lambda[9], virial[9], shaken[3 * MOST], tau[MOST_BONDS] = {0}, moved[3 * MOST],
                  sum[9] = {0};
    hol_report report;
    memcpy(r, s.r, sizeof r);
    CHECK(hol_project_positions(chains, s.ref, r, v, dt, lambda, 0, virial, &report));
    assert_true(shake(&s, shaken));
    CHECK_AT_MOST(distance(&s, r, shaken), 1e-12);
    for (int k = 0; k < 9; ++k) {
        double b[3];
        tau[k] = 2 * dt * dt * lambda[k];
        difference(s.m, k, s.ref, b);
        for (int e = 0; e < 9; ++e) sum[e] -= 2 * lambda[k] * b[e / 3] * b[e % 3];
    }
    positions_at(&s, 1, tau, moved);
    CHECK_AT_MOST(distance(&s, r, moved), 1e-13);
    for (int e = 0; e < 15; ++e) CHECK_AT_MOST(fabs(v[e] * dt - (r[e] - s.r[e])), 1e-14);
    for (int e = 0; e < 9; ++e) CHECK_AT_MOST(fabs(virial[e] - sum[e]), 1e-12 * fabs(sum[0] + sum[4] + sum[8]));
    assert_int_equal(report.n_corrected, 1);
    assert_int_equal(report.n_failed, 0);
    assert_true(report.iterations > 5);
    CHECK_AT_MOST(report.max_error, 1e-14);
    hol_chains_destroy(chains);
}

/* A call with short steps, long ones and such as can't be made: each comes to what it does alone, to the bit. */
static void a_long_step_is_alone_what_it_is_among_others(void **state)
{
    (void)state;
    enum { COPIES = 40 };
    for (int which = 0; which < MOLECULES; ++which) {
        const molecule *const m = molecules + which;
        const int n = m->n_atoms, n_bonds = m->n_bonds;
        random_stream stream = random_seed(70 + (uint64_t)which);
        double *masses = calloc((size_t)(COPIES * n), sizeof *masses),
               *ref = calloc((size_t)(3 * COPIES * n), sizeof *ref), *r = calloc((size_t)(3 * COPIES * n), sizeof *r),
               *lambda = untouched((size_t)(COPIES * n_bonds));
        step all[COPIES];
        for (int c = 0; c < COPIES; ++c) {
            const double size = c % 3 == 0 ? 0.05 : c % 3 == 1 ? 0.5 : 0.9;
            all[c] = draw(m, &stream, size, 0.3 * size);
            memcpy(masses + c * n, m->masses, sizeof(double) * (size_t)n);
            memcpy(ref + 3 * c * n, all[c].ref, sizeof(double) * 3 * (size_t)n);
            memcpy(r + 3 * c * n, all[c].r, sizeof(double) * 3 * (size_t)n);
        }
        hol_chains *chains, *one = chains_of(all);
        CHECK(hol_chains_create(COPIES * n, masses, &chains));
        CHECK(hol_chains_add_molecules(chains, COPIES, n, 0, n_bonds, m->pairs, all->a));
        CHECK(hol_chains_set_checks(chains, HOL_NEVER));
        CHECK(hol_chains_set_outcomes(chains, which % 2));
        hol_report report;
        const int status = hol_project_positions(chains, ref, r, NULL, 0.1, lambda, 0, NULL, &report);
        int64_t first_bad = -1, n_bad = 0, bad = -1;
        int statuses[COPIES], worst = HOL_OK;
        if (which % 2) CHECK(hol_outcomes(chains, statuses, NULL));
        if (status != HOL_OK) hol_error_location(&bad, NULL, NULL, &n_bad);
        int counted = 0;
        for (int c = 0; c < COPIES; ++c) {
            double alone[3 * MOST], multipliers[MOST_BONDS];
            memcpy(alone, all[c].r, sizeof alone);
            const int what = hol_project_positions(one, all[c].ref, alone, NULL, 0.1, multipliers, 0, NULL, NULL);
            if (what != HOL_OK) {
                if (first_bad < 0) first_bad = c, worst = what;
                ++counted;
                assert_untouched(lambda + c * n_bonds, (size_t)n_bonds);
            } else {
                assert_same_bits(lambda + c * n_bonds, multipliers, (size_t)n_bonds);
            }
            assert_same_bits(r + 3 * c * m->n_atoms, alone, 3 * (size_t)m->n_atoms);
            if (which % 2) assert_int_equal(statuses[c], what);
        }
        assert_int_equal(status, worst);
        assert_int_equal(n_bad, counted);
        assert_int_equal(report.n_failed, counted);
        assert_int_equal(report.n_corrected, COPIES - counted);
        if (counted > 0) assert_int_equal(bad, first_bad);
        hol_chains_destroy(chains);
        hol_chains_destroy(one);
        free(masses), free(ref), free(r), free(lambda);
    }
}

enum { RUNGS = 100, LADDER = 2 * RUNGS, LADDER_BONDS = 3 * RUNGS - 2 };

/** Whether the symmetric part of the Jacobian w_kl D_k.b_l is positive definite: at most one root has that. */
static int is_the_one_root(const int64_t *pairs, const double *ref, const double *r)
{
    static double S[LADDER_BONDS][LADDER_BONDS];
    double b[LADDER_BONDS][3], D[LADDER_BONDS][3];
    for (int k = 0; k < LADDER_BONDS; ++k)
        for (int c = 0; c < 3; ++c) {
            b[k][c] = ref[3 * pairs[2 * k + 1] + c] - ref[3 * pairs[2 * k] + c];
            D[k][c] = r[3 * pairs[2 * k + 1] + c] - r[3 * pairs[2 * k] + c];
        }
    for (int k = 0; k < LADDER_BONDS; ++k)
        for (int l = 0; l <= k; ++l) {
            double w = 0;
            for (int i = 0; i < 2; ++i)
                for (int j = 0; j < 2; ++j)
                    if (pairs[2 * k + i] == pairs[2 * l + j]) w += i == j ? 1 : -1;
            S[k][l] = w * (dot(D[k], b[l]) + dot(D[l], b[k])) / 2;
            for (int i = 0; i < l; ++i) S[k][l] -= S[k][i] * S[l][i];
            if (k == l && !(S[k][k] > 1e-10)) return 0;
            S[k][l] = k == l ? sqrt(S[k][k]) : S[k][l] / S[l][l];
        }
    return 1;
}

/* Steps of a sixth to a half of a bond's square. What is found is the one root; the multipliers make it, and lengths
 * are right. */
static void a_long_step_of_a_large_graph_comes_to_its_one_root(void **state)
{
    (void)state;
    static int64_t pairs[2 * LADDER_BONDS];
    static double masses[LADDER], ref[3 * LADDER], r[3 * LADDER], start[3 * LADDER], a[LADDER_BONDS], tau[LADDER_BONDS];
    random_stream stream = random_seed(77);
    int64_t *pair = pairs;
    for (int i = 0; i < RUNGS; ++i) {
        *pair++ = 2 * i, *pair++ = 2 * i + 1;
        for (int j = 0; j < 2 && i > 0; ++j) *pair++ = 2 * i - 2 + j, *pair++ = 2 * i + j;
    }
    int far = 0, found = 0;
    for (int trial = 0; trial < (quick_run() ? 2 : 20); ++trial) {
        for (int i = 0; i < LADDER; ++i) {
            masses[i] = 1;
            const double at[3] = {i / 2, i % 2, 0.4 * (i / 2 % 2)};
            for (int c = 0; c < 3; ++c) {
                ref[3 * i + c] = at[c] + 0.05 * random_normal(&stream);
                start[3 * i + c] = r[3 * i + c] = ref[3 * i + c] + 0.035 * random_normal(&stream);
            }
        }
        double error = 0;
        for (int k = 0; k < LADDER_BONDS; ++k) {
            const double *from = ref + 3 * pairs[2 * k], *to = ref + 3 * pairs[2 * k + 1];
            a[k] = sqrt((to[0] - from[0]) * (to[0] - from[0]) + (to[1] - from[1]) * (to[1] - from[1]) +
                        (to[2] - from[2]) * (to[2] - from[2]));
            from = r + 3 * pairs[2 * k], to = r + 3 * pairs[2 * k + 1];
            const double d[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
            error = fmax(error, fabs(dot(d, d) / (a[k] * a[k]) - 1));
        }
        far += error > 0.15 && error < 0.5;
        hol_chains *chains;
        CHECK(hol_chains_create(LADDER, masses, &chains));
        CHECK(hol_chains_add_bonds(chains, LADDER_BONDS, pairs, a));
        if (hol_project_positions(chains, ref, r, NULL, sqrt(0.5), tau, 0, NULL, NULL) == HOL_OK) {
            ++found;
            assert_true(is_the_one_root(pairs, ref, r));
            for (int k = 0; k < LADDER_BONDS; ++k) {
                const double *from = r + 3 * pairs[2 * k], *to = r + 3 * pairs[2 * k + 1];
                const double d[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
                CHECK_AT_MOST(fabs(dot(d, d) / (a[k] * a[k]) - 1), 1e-12);
                for (int c = 0; c < 3; ++c) {
                    const double pull = tau[k] * (ref[3 * pairs[2 * k + 1] + c] - ref[3 * pairs[2 * k] + c]);
                    start[3 * pairs[2 * k] + c] += pull;
                    start[3 * pairs[2 * k + 1] + c] -= pull;
                }
            }
            for (int e = 0; e < 3 * LADDER; ++e) CHECK_AT_MOST(fabs(start[e] - r[e]), 1e-11);
        }
        hol_chains_destroy(chains);
    }
    print_message("%d long steps, %d found\n", far, found);
    assert_true(quick_run() || (far > 10 && found > 10));
}

/* Rods joined tip to tip; a body alone; a body with a bond. What can't be made in one step is no degenerate molecule.
 */
static void too_long_a_step_of_bodies_does_not_converge(void **state)
{
    (void)state;
    enum { RODS = 5, N = 4 * RODS };
    random_stream stream = random_seed(13);
    double masses[N], places[3 * N] = {0};
    int64_t sizes[RODS], atoms[N], bonds[2 * (RODS - 1)];
    double lengths[RODS - 1];
    for (int k = 0; k < RODS; ++k) {
        const double along[4] = {-0.2, 0.2, -0.5, 0.5};
        sizes[k] = 4;
        for (int i = 0; i < 4; ++i) {
            masses[4 * k + i] = i < 2;
            atoms[4 * k + i] = 4 * k + i;
            places[3 * (4 * k + i)] = along[i];
        }
        if (k + 1 < RODS) bonds[2 * k] = 4 * k + 3, bonds[2 * k + 1] = 4 * k + 6, lengths[k] = 0.1;
    }
    for (int joined = 0; joined < 2; ++joined) {
        int refused = 0, solved = 0;
        for (int trial = 0; trial < 60; ++trial) {
            double r[3 * N], x[3 * N], v[3 * N], tip[3] = {0, 0, 0};
            for (int k = 0; k < RODS; ++k) {
                double u[3], w[3];
                random_direction(&stream, u);
                random_direction(&stream, w);
                for (int i = 0; i < 4; ++i)
                    for (int c = 0; c < 3; ++c)
                        r[3 * (4 * k + i) + c] = tip[c] + (0.5 + places[3 * (4 * k + i)]) * u[c];
                for (int c = 0; c < 3; ++c) tip[c] += u[c] + 0.1 * w[c];
            }
            hol_chains *chains;
            CHECK(hol_chains_create(N, masses, &chains));
            CHECK(hol_chains_add_rigid(chains, RODS, sizes, atoms, places, joined ? RODS - 1 : 0, bonds, lengths));
            CHECK(hol_chains_set_checks(chains, HOL_NEVER));
            for (int e = 0; e < 3 * N; ++e) v[e] = random_normal(&stream);
            CHECK(hol_project_velocities(chains, r, v, NULL, NULL));
            const double dt = joined ? 0.02 : 0.15;
            for (int e = 0; e < 3 * N; ++e) x[e] = r[e] + dt * v[e];
            const int status = hol_project_positions(chains, r, x, NULL, dt, NULL, 0, NULL, NULL);
            if (status == HOL_OK) {
                ++solved;
            } else {
                ++refused;
                assert_int_equal(status, HOL_ERR_NO_CONVERGENCE);
            }
            hol_chains_destroy(chains);
        }
        print_message("%s: %d solved, %d refused\n", joined ? "rods tip to tip" : "rods alone", solved, refused);
        assert_true(refused > 5 && solved > 5);
    }
}

/* A reference that is collapsed is one all the same. */
static void a_collapsed_body_is_degenerate(void **state)
{
    (void)state;
    static const double masses[2] = {1, 1}, places[6] = {0, 0, 0, 1, 0, 0}, r[6] = {0};
    static const int64_t size = 2, atoms[2] = {0, 1};
    double x[6] = {0, 0, 0, 1.1, 0, 0};
    hol_chains *chains;
    CHECK(hol_chains_create(2, masses, &chains));
    CHECK(hol_chains_add_rigid(chains, 1, &size, atoms, places, 0, NULL, NULL));
    CHECK(hol_chains_set_checks(chains, HOL_NEVER));
    CHECK_FAILS(HOL_ERR_DEGENERATE, hol_project_positions(chains, r, x, NULL, 1, NULL, 0, NULL, NULL));
    hol_chains_destroy(chains);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(long_steps_come_to_the_root_of_the_reference),
        cmocka_unit_test(methane_by_nine_distances_is_where_shake_comes_to),
        cmocka_unit_test(a_long_step_is_alone_what_it_is_among_others),
        cmocka_unit_test(a_long_step_of_a_large_graph_comes_to_its_one_root),
        cmocka_unit_test(too_long_a_step_of_bodies_does_not_converge),
        cmocka_unit_test(a_collapsed_body_is_degenerate),
    };
    return cmocka_run_group_tests_name("long steps", tests, NULL, NULL);
}
