/**
 * Whatever floating-point environment the caller has, traps (-ffpe-trap in Fortran), another rounding, denormal numbers
 * flushed: the library gives the bits that it gives in the default one, and leaves what it found.
 */
#define _GNU_SOURCE
#include <fenv.h>
#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

#include "check.h"
#include "everything.h"
#include "molecule.h"

#if defined(__GLIBC__) && (defined(__x86_64__) || defined(__i386__))
enum { CAN_TRAP = 1 };
static void trap(int what)
{
    fedisableexcept(FE_ALL_EXCEPT);
    feenableexcept(what);
}
static int trapped(void)
{
    return fegetexcept();
}
#else
enum { CAN_TRAP = 0 };
static void trap(int what)
{
    (void)what;
}
static int trapped(void)
{
    return 0;
}
#endif

#if defined(__SSE2__)
enum { FLUSHED = 0x8040 };
static void flush(int on)
{
    _mm_setcsr((_mm_getcsr() & ~(unsigned)FLUSHED) | (on ? FLUSHED : 0));
}
static int flushed(void)
{
    return (_mm_getcsr() & FLUSHED) == FLUSHED;
}
#else
static void flush(int on)
{
    (void)on;
}
static int flushed(void)
{
    return 0;
}
#endif

/** What a host may have set. */
typedef struct environment {
    const char *name;
    int traps, rounding, flushed, before; /* before: exceptions that there have been */
} environment;

static const environment environments[] = {
    {"the default one", 0, FE_TONEAREST, 0, 0},
    {"after an inexact result", 0, FE_TONEAREST, 0, FE_INEXACT},
    {"after everything", 0, FE_TONEAREST, 0, FE_ALL_EXCEPT},
    {"traps", FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW, FE_TONEAREST, 0, FE_INEXACT},
    {"traps of all", FE_ALL_EXCEPT, FE_TONEAREST, 0, 0},
    {"upward", 0, FE_UPWARD, 0, FE_INEXACT},
    {"downward", 0, FE_DOWNWARD, 0, 0},
    {"toward zero", 0, FE_TOWARDZERO, 0, FE_OVERFLOW},
    {"flushed", 0, FE_TONEAREST, 1, FE_INEXACT},
    {"all at once", FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW, FE_UPWARD, 1, FE_INEXACT},
};
enum { ENVIRONMENTS = sizeof environments / sizeof *environments };

/** Returns the exceptions that there have been then: what overflows may be inexact, too, as the processor has it. */
static int take_on(const environment *e)
{
    feclearexcept(FE_ALL_EXCEPT);
    feraiseexcept(e->before);
    fesetround(e->rounding);
    flush(e->flushed);
    trap(e->traps);
    return fetestexcept(FE_ALL_EXCEPT);
}

/** What is wrong about the environment that it should be; NULL: nothing. Then it is the default one. */
static const char *give_up(const environment *e, int before_call)
{
    const int traps = trapped(), rounding = fegetround(), small = flushed(), before = fetestexcept(FE_ALL_EXCEPT);
    fesetenv(FE_DFL_ENV);
    flush(0);
    if (CAN_TRAP && traps != e->traps) return "other traps";
    if (rounding != e->rounding) return "another rounding";
    if (small != flushed() && small != e->flushed) return "denormal numbers";
    return before == before_call ? NULL : "other sticky flags";
}

/** In all of them at once, and in one of the others in turn. */
static void check_scene(const scene *s, const char *name)
{
    static int turn = 0;
    ++turn;
    const record expected = everything_of(s);
    if (expected.n_good < 9) fail_msg("%s: hardly anything succeeds: %d calls", name, expected.n_good);
    for (int i = 0; i < ENVIRONMENTS; ++i) {
        if (i != turn % ENVIRONMENTS && i != ENVIRONMENTS - 1) continue;
        char what[160];
        snprintf(what, sizeof what, "%s, %s", name, environments[i].name);
        const int before = take_on(environments + i);
        const record found = everything_of(s);
        const char *wrong = give_up(environments + i, before);
        if (wrong) fail_msg("%s: %s afterwards", what, wrong);
        assert_same_record(&expected, &found, what);
        free(found.values);
    }
    free(expected.values);
}

static const double slab[9] = {90, 0, 0, 0, 90, 0, 0, 0, 0}, cell[9] = {90, 0, 0, 0, 80, 0, 0, 0, 85},
                    oblique[9] = {90, 0, 0, 11, 85, 0, 7, -9, 88}, two_vectors[9] = {90, 0, 0, 20, 85, 0, 0, 0, 0};
static const double *const boxes[] = {NULL, slab, cell, oblique, two_vectors};
enum { BOXES = sizeof boxes / sizeof *boxes };

/** Copies of a molecule, or of several of other sizes, as one list of bonds. */
static scene scene_of_kind(molecule_kind kind, int64_t n, int64_t size, int64_t more, uint64_t seed)
{
    scene s = scene_of_atoms(0);
    for (int64_t c = 0; c < n; ++c) {
        molecule m = molecule_make(kind, size + c * more, seed);
        const int64_t first = s.n_atoms;
        s.n_atoms += m.n_atoms;
        s.mass = realloc(s.mass, sizeof *s.mass * (size_t)s.n_atoms);
        double **const arrays[] = {&s.r, &s.v, &s.f, &s.moved};
        for (int a = 0; a < 4; ++a) {
            *arrays[a] = realloc(*arrays[a], sizeof **arrays[a] * 3 * (size_t)s.n_atoms);
            if (!*arrays[a] || !s.mass) abort();
        }
        memcpy(s.mass + first, m.mass, sizeof *s.mass * (size_t)m.n_atoms);
        memcpy(s.r + 3 * first, m.r, sizeof *s.r * 3 * (size_t)m.n_atoms);
        for (int64_t k = 0; k < m.n_bonds; ++k) scene_bond(&s, first + m.pairs[2 * k], first + m.pairs[2 * k + 1]);
        molecule_free(&m);
    }
    scene_finish(&s, seed);
    return s;
}

static void molecules_of_every_kind(void **state)
{
    (void)state;
    const int64_t copies[] = {1, 3, 5};
    int turn = 0;
    for (int kind = 0; kind < MOLECULE_KINDS; ++kind)
        for (int c = 0; c < 3; ++c)
            for (int more = 0; more < 2; ++more, ++turn) {
                if (quick_run() && turn % 11 != 0) continue;
                const int small = kind == MOLECULE_DENDRIMER || kind == MOLECULE_PEPTIDE;
                scene s = scene_of_kind((molecule_kind)kind, copies[c], small ? 2 : 5, more && !small, 17);
                s.box = boxes[turn % BOXES];
                check_scene(&s, molecule_kind_name((molecule_kind)kind));
                scene_free(&s);
            }
}

/** Atoms at the places of a lattice, their neighbours bonded: a chain, a sheet, a block. */
static void lattices(void **state)
{
    (void)state;
    const int64_t sides[][3] = {{2, 1, 1}, {6, 1, 1}, {3, 3, 1}, {5, 4, 1}, {3, 3, 2}};
    for (size_t i = 0; i < sizeof sides / sizeof *sides; ++i) {
        const int64_t *n = sides[i], far[] = {n[1] * n[2], n[2], 1};
        scene s = scene_of_atoms(n[0] * n[1] * n[2]);
        random_stream stream = random_seed(i);
        for (int64_t a = 0; a < s.n_atoms; ++a)
            for (int x = 0; x < 3; ++x) s.r[3 * a + x] = (double)(a / far[x] % n[x]) + 0.1 * random_normal(&stream);
        for (int64_t a = 0; a < s.n_atoms; ++a)
            for (int x = 0; x < 3; ++x)
                if (a / far[x] % n[x] + 1 < n[x]) scene_bond(&s, a, a + far[x]);
        scene_finish(&s, i);
        s.box = boxes[i % 2];
        check_scene(&s, "a lattice");
        scene_free(&s);
    }
}

/** All distances of 3 to 6 atoms, one of them held or none. */
static void cliques(void **state)
{
    (void)state;
    for (int64_t n = 3; n <= 6; ++n)
        for (int held = 0; held < 2; ++held) {
            scene s = scene_of_atoms(n);
            random_stream stream = random_seed((uint64_t)n);
            for (int64_t i = 0; i < 3 * n; ++i) s.r[i] = random_normal(&stream);
            for (int64_t i = 0; i < n; ++i)
                for (int64_t j = 0; j < i; ++j) scene_bond(&s, i, j);
            if (held) s.mass[0] = 0;
            scene_finish(&s, 5);
            check_scene(&s, "all distances");
            scene_free(&s);
        }
}

static void rigid_bodies(void **state)
{
    (void)state;
    const double places[][3][3] = {{{0, 0, 0}, {1.1, 0, 0}, {0, 0, 0}},
                                   {{-1.16, 0, 0}, {0, 0, 0}, {1.16, 0, 0}},
                                   {{0, 0, 0}, {.757, .586, 0}, {-.757, .586, 0}}};
    for (int what = 0; what < 3; ++what)
        for (int64_t copies = 1; copies <= 9; copies += 4)
            for (int box = 0; box < BOXES; ++box) {
                const int64_t size = what == 0 ? 2 : 3;
                scene s = scene_of_atoms(copies * size);
                s.n_copies = copies, s.size = size;
                s.places = copy_of(places[what][0], 9);
                for (int64_t i = 0; i < 3 * s.n_atoms; ++i)
                    s.r[i] = s.places[i % (3 * size)] + 3 * (double)(i / (3 * size));
                scene_finish(&s, 7);
                s.box = boxes[box];
                check_scene(&s, "bodies");
                scene_free(&s);
            }
}

/** So many that threads share them, molecules and bodies. */
static void threads_share_the_environment(void **state)
{
    (void)state;
    const double line[2][3] = {{0, 0, 0}, {1, 0, 0}};
    scene s = scene_of_kind(MOLECULE_XH2, 6000, 1, 0, 3);
    s.n_threads = 2;
    check_scene(&s, "threads");
    scene_free(&s);
    s = scene_of_atoms(16000);
    s.n_threads = 2;
    s.n_copies = 8000, s.size = 2;
    s.places = copy_of(line[0], 6);
    for (int64_t i = 0; i < s.n_atoms; ++i) s.r[3 * i] = (double)(i % 2);
    scene_finish(&s, 9);
    check_scene(&s, "threads, bodies");
    scene_free(&s);
}

static void partition_functions_and_the_tridiagonal_algebra(void **state)
{
    (void)state;
    const double masses[] = {0, 1, 1e6, 1e-9, 0, 2, INFINITY, 3, 1}, gamma[] = {0.5, -0.9, 1e300};
    double expected[12] = {0};
    for (int i = 0; i < ENVIRONMENTS; ++i) {
        double x[12] = {0};
        const int before = take_on(environments + i);
        const int found[] = {hol_partition_function(8, masses, x, x + 1, x + 2),
                             hol_partition_function(2, masses + 4, x + 3, x + 4, x + 5),
                             hol_tridiagonal_pivots(4, gamma, x + 6), hol_tridiagonal_solve(2, gamma, masses, x + 10)};
        const char *wrong = give_up(environments + i, before);
        if (wrong) fail_msg("%s: %s afterwards", environments[i].name, wrong);
        for (int k = 0; k < 4; ++k) assert_int_equal(found[k], k == 2 ? HOL_ERR_NOT_DEFINITE : HOL_OK);
        if (i == 0) memcpy(expected, x, sizeof x);
        assert_same_bits(expected, x, 12);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(molecules_of_every_kind),
        cmocka_unit_test(lattices),
        cmocka_unit_test(cliques),
        cmocka_unit_test(rigid_bodies),
        cmocka_unit_test(threads_share_the_environment),
        cmocka_unit_test(partition_functions_and_the_tridiagonal_algebra),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
