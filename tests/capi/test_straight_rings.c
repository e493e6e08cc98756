/**
 * Rings with straight parts, of which all bonds of a line are rounded alike. No pivot of their matrices is small, but
 * eigenvalues are, and the errors of all bonds of a line add up: a solver that looks at pivots alone misses its bound.
 */
#include "check.h"
#include "equations.h"
#include "mixture.h"
#include "molecule_solution.h"

enum { MOST_BENDS = 48, MOST_ATOMS = 128 };

/** Half a ring: a straight side, then bends. The other half has the opposites of these bonds. */
typedef struct plan {
    int tail; /* how many bonds lead up to the side, in line with it */
    int side; /* how many bonds the side has */
    int n_bends;
    double u[3]; /* along the side */
    double bend[MOST_BENDS][3];
} plan;

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/** Neither nearly straight on nor nearly at right angles, so that a bend hands on part of a pull. */
static int is_bend(const double a[3], const double b[3])
{
    return fabs(dot(a, b)) > 0.2 && fabs(dot(a, b)) < 0.5;
}

static plan plan_of(int tail, int side, int n_bends, random_stream *s)
{
    plan p = {tail, side, n_bends, {0}, {{0}}};
    random_direction(s, p.u);
    for (int k = 0; k < n_bends;) {
        random_direction(s, p.bend[k]);
        const double *before = k > 0 ? p.bend[k - 1] : p.u;
        if (is_bend(p.bend[k], before) && (k < n_bends - 1 || is_bend(p.bend[k], p.u))) ++k;
    }
    return p;
}

/** A plan in a plane: each side has a tip of two bonds, out from its end and back to the other side. */
static plan flat_plan(int side, random_stream *s)
{
    plan p = plan_of(0, side, 2, s);
    double across[3];
    const double out = dot(p.bend[0], p.u);
    for (int x = 0; x < 3; ++x) across[x] = p.bend[0][x] - out * p.u[x];
    for (int x = 0; x < 3; ++x) {
        p.bend[0][x] = 0.5 * p.u[x] + across[x];
        p.bend[1][x] = -0.5 * p.u[x] + across[x];
    }
    return p;
}

/** So that sums of bonds are exact, and all bonds of a line have the same bits. */
static double coarse(double x)
{
    return ldexp(nearbyint(ldexp(x, 44)), -44);
}

/** The molecule, without forces. Atom i along tail and ring has the number *first + i, modulo the number of atoms. */
static molecule walk(const plan *p, int64_t *first, random_stream *s)
{
    double r[MOST_ATOMS][3] = {{0}};
    double length[2]; /* along a line, in turn */
    for (int k = 0; k < 2; ++k) length[k] = 0.5 + 0.5 * random_uniform(s);
    const int half = p->side + p->n_bends, n = p->tail + 2 * half;
    molecule m = molecule_empty();
    for (int i = 0; i + 1 < n; ++i) {
        const int k = i < p->tail ? i - p->tail : (i - p->tail) % half, back = i >= p->tail + half;
        for (int x = 0; x < 3; ++x) {
            const double d = k < p->side ? length[k & 1] * p->u[x] : p->bend[k - p->side][x];
            r[i + 1][x] = r[i][x] + (back ? -coarse(d) : coarse(d));
        }
    }
    *first = random_integer(s, 0, n - 1);
    for (int i = 0; i < n; ++i) molecule_add_atom(&m, 1, r[(i + n - *first) % n]);
    for (int i = 0; i < n; ++i) molecule_add_bond(&m, (i + *first) % n, ((i + 1 < n ? i + 1 : p->tail) + *first) % n);
    molecule_finish(&m, s);
    memset(m.f, 0, 3 * sizeof *m.f * (size_t)n);
    return m;
}

static double *force(const molecule *m, int64_t first, int64_t i)
{
    return m->f + 3 * ((first + i) % m->n_atoms);
}

/** Takes the forces as velocities too. All masses are one, so that both have the same multipliers. */
static molecule pulled(molecule m)
{
    memcpy(m.v, m.f, 3 * sizeof *m.f * (size_t)m.n_atoms);
    return m;
}

static molecule ring_pulled_at_its_tips(int side, random_stream *s)
{
    const plan p = flat_plan(side, s);
    int64_t first;
    molecule m = walk(&p, &first, s);
    for (int x = 0; x < 3; ++x) {
        force(&m, first, side + 1)[x] = p.u[x];
        force(&m, first, m.n_atoms - 1)[x] = -p.u[x];
    }
    return pulled(m);
}

/** A line of tail and side is pulled at both ends, and the bends at random. */
static molecule ring_with_a_tail(int tail, int side, random_stream *s)
{
    const plan p = plan_of(tail, side, 5, s);
    int64_t first;
    molecule m = walk(&p, &first, s);
    for (int x = 0; x < 3; ++x) {
        force(&m, first, 0)[x] = -p.u[x];
        force(&m, first, tail + side)[x] = p.u[x];
        for (int k = 1; k < 6; ++k) force(&m, first, tail + side + k)[x] = 0.5 * random_normal(s);
        for (int k = 1; k < 5; ++k) force(&m, first, tail + 2 * side + 5 + k)[x] = 0.5 * random_normal(s);
    }
    return pulled(m);
}

/** A ring of a hundred bonds, pulled at the ends of its straight sides. */
static molecule long_ring(int side, random_stream *s)
{
    const plan p = plan_of(0, side, 50 - side, s);
    int64_t first;
    molecule m = walk(&p, &first, s);
    for (int x = 0; x < 3; ++x)
        for (int half = 0; half < 2; ++half) {
            force(&m, first, 50 * half)[x] = random_normal(s);
            force(&m, first, 50 * half + side)[x] = random_normal(s);
        }
    return pulled(m);
}

/** Multipliers, and forces or velocities, within the bound of tests/oracle/molecules/README.md. */
static void assert_near(const molecule *part, const double *lambda, const double *vectors,
                        const molecule_solution *exact, const long double *expected, const long double *scale)
{
    const long double unit = oracle_bound(part->n_bonds) * DBL_EPSILON;
    for (int64_t k = 0; k < part->n_bonds; ++k)
        CHECK_AT_MOST(fabsl(lambda[k] - exact->lambda[k]), unit * exact->lambda_scale[k]);
    for (int64_t i = 0; i < 3 * part->n_atoms; ++i) CHECK_AT_MOST(fabsl(vectors[i] - expected[i]), unit * scale[i / 3]);
}

/** Right-hand sides that give the multipliers of the forces, but for their rounding. */
static double *right_hand_side(const mixture *m)
{
    double *rhs = untouched((size_t)m->n_bonds);
    for (int64_t k = 0; k < m->n_bonds; ++k) {
        const int64_t i = m->pairs[2 * k], j = m->pairs[2 * k + 1];
        rhs[k] = 0;
        for (int x = 0; x < 3; ++x)
            rhs[k] += 2 * (m->r[3 * j + x] - m->r[3 * i + x]) * (m->f[3 * j + x] - m->f[3 * i + x]);
    }
    return rhs;
}

/** All parts at once, so that lanes are filled. Frees the parts. */
static void assert_solutions(molecule *parts, int n, uint64_t seed)
{
    mixture m = mixture_make(parts, n, MIXED, seed);
    const size_t bonds = (size_t)m.n_bonds, vectors = mixture_size(&m);
    double *lambda = untouched(bonds), *g = untouched(vectors), *mu = untouched(bonds), *v = copy_of(m.v, vectors);
    double *rhs = right_hand_side(&m), *solved = untouched(bonds), *pull = untouched(vectors);
    CHECK(hol_forces(m.chains, m.r, NULL, m.f, lambda, NULL, g, HOL_WRITE, NULL));
    CHECK(hol_project_velocities(m.chains, m.r, v, mu, NULL));
    CHECK(hol_solve(m.chains, m.r, rhs, solved, pull, HOL_WRITE, NULL));
    for (int p = 0; p < n; ++p) {
        const molecule *part = parts + p;
        const molecule_problem problem = molecule_problem_of(part);
        double of_bonds[MOST_ATOMS], of_atoms[3 * MOST_ATOMS], given[MOST_ATOMS];
        molecule_solution exact; /* of the velocities, and so of the forces: see pulled() */
        assert_int_equal(molecule_velocities(&problem, &exact), 0);
        mixture_take_bonds(&m, p, lambda, of_bonds);
        mixture_take(&m, p, g, of_atoms);
        assert_near(part, of_bonds, of_atoms, &exact, exact.g, exact.g_scale);
        mixture_take_bonds(&m, p, mu, of_bonds);
        mixture_take(&m, p, v, of_atoms);
        assert_near(part, of_bonds, of_atoms, &exact, exact.moved, exact.moved_scale);
        leave_roundings_of_rates(part, of_atoms, &exact);
        molecule_solution_free(&exact);
        if (p % 4 != 0) continue; /* the widest margin of the three, and wide numbers take time */
        mixture_take_bonds(&m, p, rhs, given);
        assert_int_equal(molecule_solve(&problem, given, &exact), 0);
        mixture_take_bonds(&m, p, solved, of_bonds);
        mixture_take(&m, p, pull, of_atoms);
        assert_near(part, of_bonds, of_atoms, &exact, exact.g, exact.g_scale);
        molecule_solution_free(&exact);
    }
    for (int p = 0; p < n; ++p) molecule_free(parts + p);
    free(lambda), free(g), free(mu), free(v), free(rhs), free(solved), free(pull);
    mixture_free(&m);
}

enum { EACH = 24 };

static int each(void)
{
    return quick_run() ? 2 : EACH;
}

static void rings_with_two_parallel_sides_are_solved_to_the_bound(void **state)
{
    (void)state;
    random_stream s = random_seed(1);
    for (int side = 3; side <= 25; side += quick_run() ? 11 : 1) {
        molecule parts[EACH];
        for (int p = 0; p < each(); ++p) parts[p] = ring_pulled_at_its_tips(side, &s);
        assert_solutions(parts, each(), (uint64_t)side);
    }
}

static void straight_tails_that_go_on_as_a_side_of_a_ring_are_solved_to_the_bound(void **state)
{
    (void)state;
    static const int tails[] = {1, 3, 8, 13};
    random_stream s = random_seed(2);
    for (size_t t = 0; t < sizeof tails / sizeof *tails; ++t)
        for (int side = 3; side <= 16; side += quick_run() ? 13 : 1) {
            molecule parts[EACH];
            for (int p = 0; p < each(); ++p) parts[p] = ring_with_a_tail(tails[t], side, &s);
            assert_solutions(parts, each(), (uint64_t)side);
        }
}

static void long_rings_with_straight_pieces_are_solved_to_the_bound(void **state)
{
    (void)state;
    random_stream s = random_seed(3);
    for (int side = 10; side <= 45; side += quick_run() ? 35 : 5) {
        molecule parts[EACH];
        for (int p = 0; p < each(); ++p) parts[p] = long_ring(side, &s);
        assert_solutions(parts, each(), (uint64_t)side);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rings_with_two_parallel_sides_are_solved_to_the_bound),
        cmocka_unit_test(straight_tails_that_go_on_as_a_side_of_a_ring_are_solved_to_the_bound),
        cmocka_unit_test(long_rings_with_straight_pieces_are_solved_to_the_bound),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
