/**
 * Atoms with one to three hydrogens, mixed as along a protein, with short chains between them: molecules of few kinds
 * whose neighbours in memory are of others. What a molecule gets is what it gets alone, bit for bit, and right.
 */
#include "check.h"
#include "mixture.h"
#include "molecule_solution.h"

enum { GROUPS = 9, MOST = 90 };

/** Bonds of a group from its first atom to each other one; or of a chain, or of one that has a fixed end. */
static const struct {
    double mass, light, length;
    int64_t n_bonds;
    int is_chain;
} groups[GROUPS] = {{12, 1, 0.109, 1, 0}, {14, 1, 0.101, 1, 0}, {12, 1, 0.109, 2, 0},
                    {12, 1, 0.109, 3, 0}, {14, 1, 0.101, 3, 0}, {14, 1, 0.101, 2, 0},
                    {16, 16, 0.15, 1, 1}, {12, 14, 0.15, 3, 1}, {0, 12, 0.154, 2, 1}};

static molecule make_group(int which, uint64_t seed)
{
    random_stream s = random_seed(1000 * (uint64_t)which + seed);
    molecule m = molecule_empty();
    double at[3], u[3];
    for (int x = 0; x < 3; ++x) at[x] = 2 * random_normal(&s);
    int64_t last = molecule_add_atom(&m, groups[which].mass, at);
    for (int64_t k = 0; k < groups[which].n_bonds; ++k) {
        double cosine = 1; /* no two bonds nearly along each other, as in molecules */
        while (fabs(cosine) > 0.8) {
            random_direction(&s, u);
            cosine = 0;
            for (int64_t l = 0; l < k; ++l) {
                const double *a = m.r + 3 * m.pairs[2 * l], *b = m.r + 3 * m.pairs[2 * l + 1];
                double c = 0;
                for (int x = 0; x < 3; ++x) c += u[x] * (b[x] - a[x]) / groups[which].length;
                cosine = fmax(cosine, fabs(c));
            }
        }
        const int64_t next = molecule_grow(&m, last, groups[which].light, groups[which].length, u);
        if (groups[which].is_chain) last = next;
    }
    molecule_finish(&m, &s);
    for (int64_t k = 0; k < m.n_bonds; ++k) m.length[k] = groups[which].length;
    return m;
}

/** n groups of all sorts in turn; `box`: 9 numbers or NULL. */
static mixture make_mixture(int64_t n, mixing how, const double *box, uint64_t seed)
{
    molecule parts[MOST] = {{0}};
    for (int64_t p = 0; p < n; ++p) parts[p] = make_group((int)((7 * p + p / 5) % GROUPS), seed + (uint64_t)p);
    mixture m = mixture_make(parts, n, how, seed);
    for (int64_t p = 0; p < n; ++p) molecule_free(parts + p);
    if (box) CHECK(hol_chains_set_box(m.chains, box));
    return m;
}

enum { RESULTS = 8, PER_BOND = 3 };
static const double dt = 2e-3;

/** lambda of each level; g, projected velocities, positions with velocities, pulls added to forces. */
typedef struct results {
    double *of[RESULTS];
    int status[3];
    hol_report report;
} results;

static results compute(const mixture *m, const double *drifted, int reported)
{
    results s;
    const size_t n = (size_t)m->n_bonds, size = mixture_size(m);
    for (int k = 0; k < RESULTS; ++k) s.of[k] = untouched(k < PER_BOND ? n : size);
    for (int k = 4; k < RESULTS; ++k) memcpy(s.of[k], k == 5 ? drifted : k == 7 ? m->f : m->v, size * sizeof(double));
    s.status[0] = hol_forces(m->chains, m->r, m->v, m->f, s.of[0], NULL, s.of[3], HOL_WRITE, NULL);
    const int again = hol_forces(m->chains, m->r, m->v, m->f, NULL, NULL, s.of[7], HOL_ADD, NULL);
    assert_int_equal(s.status[0], again);
    s.status[1] = hol_project_velocities(m->chains, m->r, s.of[4], s.of[1], NULL);
    s.status[2] =
        hol_project_positions(m->chains, m->r, s.of[5], s.of[6], dt, s.of[2], 0, NULL, reported ? &s.report : NULL);
    return s;
}

static void release(results *s)
{
    for (int k = 0; k < RESULTS; ++k) free(s->of[k]);
}

/** A part's numbers out of an array of results; returns how many. */
static size_t take(const mixture *m, int64_t part, int k, const double *from, double *out)
{
    if (k < PER_BOND)
        mixture_take_bonds(m, part, from, out);
    else
        mixture_take(m, part, from, out);
    return (size_t)(k < PER_BOND ? m->parts[part].n_bonds : 3 * m->parts[part].n_atoms);
}

static const double side[9] = {1.9, 0, 0, 0, 2.3, 0, 0, 0, 1.7};

/** All numbers of molecules, all remainders of blocks. */
static void mixed_groups_have_the_bits_of_each_alone(void **state)
{
    (void)state;
    for (int64_t n = 1; n <= MOST; n += n < 24 ? 1 : 11)
        for (int how = 0; how < 2; ++how)
            for (int boxed = 0; boxed < 2; ++boxed) {
                mixture m = make_mixture(n, (mixing)how, boxed ? side : NULL, 7 * (uint64_t)n);
                double *drifted = mixture_drifted(&m, dt);
                results all = compute(&m, drifted, n % 2 == 0);
                double worst = 0;
                for (int64_t p = 0; p < n; ++p) {
                    mixture one = mixture_make(m.parts + p, 1, ONE_AFTER_THE_OTHER, 0);
                    if (boxed) CHECK(hol_chains_set_box(one.chains, side));
                    double *start = mixture_drifted(&one, dt), a[12], b[12];
                    results alone = compute(&one, start, 1);
                    for (int k = 0; k < RESULTS; ++k) {
                        const size_t count = take(&m, p, k, all.of[k], a);
                        assert_int_equal(take(&one, 0, k, alone.of[k], b), count);
                        assert_same_bits(a, b, count);
                    }
                    worst = fmax(worst, alone.report.max_error);
                    free(start);
                    release(&alone);
                    mixture_free(&one);
                }
                if (n % 2 == 0) {
                    assert_same_bits(&all.report.max_error, &worst, 1);
                    assert_int_equal(all.report.n_corrected, n);
                }
                free(drifted);
                release(&all);
                mixture_free(&m);
            }
}

/** The bounds of tests/oracle/molecules/README.md, at every level. */
static void mixed_groups_agree_with_a_dense_solution(void **state)
{
    (void)state;
    mixture m = make_mixture(MOST, MIXED, NULL, 3);
    double *drifted = mixture_drifted(&m, dt);
    results all = compute(&m, drifted, 0);
    for (int level = 0; level < 3; ++level) assert_int_equal(all.status[level], HOL_OK);
    for (int64_t p = 0; p < MOST; ++p) {
        const molecule *part = m.parts + p;
        const molecule_problem problem = molecule_problem_of(part);
        const long double unit = oracle_bound(part->n_bonds) * DBL_EPSILON;
        double got[RESULTS][12];
        for (int k = 0; k < RESULTS; ++k) take(&m, p, k, all.of[k], got[k]);
        double *start = molecule_drifted(part, dt);
        molecule_solution exact[3];
        assert_int_equal(molecule_forces(&problem, exact), 0);
        assert_int_equal(molecule_velocities(&problem, exact + 1), 0);
        assert_int_equal(molecule_positions(&problem, start, NULL, part->length, dt, exact + 2), 0);
        for (int64_t k = 0; k < part->n_bonds; ++k)
            for (int level = 0; level < 3; ++level)
                CHECK_AT_MOST(fabsl(got[level][k] - exact[level].lambda[k]), unit * exact[level].lambda_scale[k]);
        for (int64_t i = 0; i < 3 * part->n_atoms; ++i) {
            CHECK_AT_MOST(fabsl(got[3][i] - exact[0].g[i]), unit * exact[0].g_scale[i / 3]);
            CHECK_AT_MOST(fabsl(got[7][i] - part->f[i] - exact[0].g[i]),
                          unit * (exact[0].g_scale[i / 3] + fabs(part->f[i])));
            CHECK_AT_MOST(fabsl(got[4][i] - exact[1].moved[i]), unit * exact[1].moved_scale[i / 3]);
            CHECK_AT_MOST(fabsl(got[5][i] - exact[2].moved[i]), unit * exact[2].moved_scale[i / 3]);
            const long double after = part->v[i] + (exact[2].moved[i] - start[i]) / dt;
            CHECK_AT_MOST(fabsl(got[6][i] - after), unit * (fabs(part->v[i]) + exact[2].moved_scale[i / 3] / dt));
        }
        free(start);
        for (int level = 0; level < 3; ++level) molecule_solution_free(exact + level);
    }
    free(drifted);
    release(&all);
    mixture_free(&m);
}

/** One bad molecule, wherever it stands in its block, and what is inactive: outputs as they were, the others complete.
 */
static void bad_and_inactive_groups_keep_their_outputs_and_the_others_are_complete(void **state)
{
    (void)state;
    enum { N = 41 };
    for (int64_t bad = 0; bad < N; bad += quick_run() ? 9 : 1)
        for (int how = 0; how < 2; ++how) {
            mixture m = make_mixture(N, (mixing)how, NULL, 11);
            int64_t molecules[3 * N], count;
            unsigned char active[N];
            CHECK(hol_chains_molecules_of_bonds(m.chains, molecules));
            const int64_t number = molecules[m.bonds[m.first_bond[bad]]];
            for (int64_t c = 0; c < N; ++c) active[c] = c == number || c % 5 != 3;
            CHECK(hol_chains_set_active(m.chains, active));
            double *drifted = mixture_drifted(&m, dt);
            results good = compute(&m, drifted, 1);
            m.r[3 * m.atoms[m.first_atom[bad] + 1] + 1] = NAN;
            results got = compute(&m, drifted, 1);
            for (int level = 0; level < 3; ++level) assert_int_equal(got.status[level], HOL_ERR_NOT_FINITE);
            int64_t chain;
            hol_error_location(&chain, NULL, NULL, &count);
            assert_int_equal(chain, number);
            assert_int_equal(count, 1);
            assert_int_equal(got.report.n_failed, 1);
            assert_int_equal(got.report.n_corrected, good.report.n_corrected - 1);
            double *blank = untouched(12);
            for (int64_t p = 0; p < N; ++p) {
                const int64_t c = molecules[m.bonds[m.first_bond[p]]];
                const double *const before[RESULTS] = {NULL, NULL, NULL, NULL, m.v, drifted, m.v, m.f};
                for (int k = 0; k < RESULTS; ++k) {
                    double a[12], b[12];
                    const size_t n = take(&m, p, k, got.of[k], a);
                    if (active[c] && p != bad)
                        take(&m, p, k, good.of[k], b);
                    else if (before[k])
                        take(&m, p, k, before[k], b);
                    assert_same_bits(a, (!active[c] || p == bad) && !before[k] ? blank : b, n);
                }
            }
            free(blank), free(drifted);
            release(&good), release(&got);
            mixture_free(&m);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(mixed_groups_have_the_bits_of_each_alone),
        cmocka_unit_test(mixed_groups_agree_with_a_dense_solution),
        cmocka_unit_test(bad_and_inactive_groups_keep_their_outputs_and_the_others_are_complete),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
