/**
 * Many short chains of one kind, as every engine has them: in a box, by lists of atoms. What they give is what each
 * gives alone, bit for bit, and what physics demands.
 */
#include "check.h"
#include "random.h"

enum { RECTANGULAR = 4, BOXES = 5 };
static const double boxes[BOXES][9] = {
    {0, 0, 0, 0, 0, 0, 0, 0, 0},         {6.5, 0, 0, 0, 9.25, 0, 0, 0, 5.1},  {6.5, 0, 0, 0, 0, 0, 0, 0, 5.1},
    {-6.5, 0, 0, 0, 9.25, 0, 0, 0, 5.1}, {7, 0, 0, 2.5, 6.5, 0, -1.75, 2, 8},
};

/** Short chains of one kind, in the caller's order or by lists that run backwards, folded anyhow into a box. */
typedef struct crowd {
    int64_t n_chains, n_bonds, n_atoms;
    int64_t *atoms;
    double *mass, *length, *r, *v, *f;
    hol_chains *chains;
} crowd;

static crowd crowd_make(int64_t n_bonds, int listed, const double *box, uint64_t seed)
{
    crowd c = {37, n_bonds, 37 * (n_bonds + 1), NULL, NULL, NULL, NULL, NULL, NULL, NULL};
    const size_t size = 3 * (size_t)c.n_atoms;
    random_stream s = random_seed(seed);
    c.atoms = malloc((size_t)c.n_atoms * sizeof *c.atoms);
    c.mass = untouched(size), c.length = untouched(size);
    c.r = untouched(size), c.v = untouched(size), c.f = untouched(size);
    for (int64_t i = 0; i < c.n_atoms; ++i) {
        const int64_t atom = c.atoms[i] = listed ? c.n_atoms - 1 - i : i;
        double u[3];
        random_direction(&s, u);
        c.mass[atom] = c.length[atom] = 1;
        for (int x = 0; x < 3; ++x) {
            const int64_t before = i > 0 ? c.atoms[i - 1] : 0;
            c.r[3 * atom + x] = i % (n_bonds + 1) > 0 ? c.r[3 * before + x] + u[x] : 3 * random_normal(&s);
            c.v[3 * atom + x] = random_normal(&s);
            c.f[3 * atom + x] = random_normal(&s);
        }
    }
    for (int64_t i = 0; i < c.n_atoms; ++i) /* by whole numbers of box vectors */
        for (int row = 0; row < 3; ++row) {
            const double n = (double)random_integer(&s, -2, 2);
            for (int x = 0; x < 3; ++x) c.r[3 * i + x] += n * box[3 * row + x];
        }
    CHECK(hol_chains_create(c.n_atoms, c.mass, &c.chains));
    if (listed)
        for (int64_t k = 0; k < c.n_chains; ++k)
            CHECK(hol_chains_add(c.chains, n_bonds, c.atoms + k * (n_bonds + 1), c.length));
    else
        CHECK(hol_chains_add_block(c.chains, c.n_chains, n_bonds, 0, c.length));
    CHECK(hol_chains_set_box(c.chains, box));
    return c;
}

static void crowd_free(crowd *c)
{
    hol_chains_destroy(c->chains);
    free(c->atoms), free(c->mass), free(c->length), free(c->r), free(c->v), free(c->f);
}

/** What the calls give, all of a crowd or of one chain. */
typedef struct outcome {
    double *lambda[3], *g, *projected, *moved, *pushed;
} outcome;

static outcome outcome_of(hol_chains *chains, int64_t n_bonds, int64_t n_atoms, const double *r, const double *v,
                          const double *f)
{
    const double dt = 0.01;
    const size_t size = 3 * (size_t)n_atoms;
    outcome o = {{untouched((size_t)n_bonds), untouched((size_t)n_bonds), untouched((size_t)n_bonds)},
                 untouched(size),
                 copy_of(v, size),
                 copy_of(r, size),
                 copy_of(v, size)};
    for (size_t i = 0; i < size; ++i) o.moved[i] += dt * v[i];
    CHECK(hol_forces(chains, r, v, f, o.lambda[0], NULL, o.g, HOL_WRITE, NULL));
    CHECK(hol_project_velocities(chains, r, o.projected, o.lambda[1], NULL));
    CHECK(hol_project_positions(chains, r, o.moved, o.pushed, dt, o.lambda[2], 0, NULL, NULL));
    return o;
}

static void outcome_free(outcome *o)
{
    for (int i = 0; i < 3; ++i) free(o->lambda[i]);
    free(o->g), free(o->projected), free(o->moved), free(o->pushed);
}

/** The same bits as alone, where nothing else decides how it is worked on. */
static void assert_as_alone(const crowd *c, const outcome *all, int64_t chain, const double *box)
{
    const size_t size = 3 * (size_t)(c->n_bonds + 1), n = (size_t)c->n_bonds;
    const double *const from[] = {c->r, c->v, c->f, all->g, all->projected, all->moved, all->pushed};
    double *part[7];
    for (int i = 0; i < 7; ++i) {
        part[i] = untouched(size);
        for (size_t e = 0; e < size; ++e)
            part[i][e] = from[i][3 * c->atoms[chain * (c->n_bonds + 1) + (int64_t)(e / 3)] + (int64_t)(e % 3)];
    }
    hol_chains *alone;
    CHECK(hol_chains_create(c->n_bonds + 1, c->mass, &alone));
    CHECK(hol_chains_add_block(alone, 1, c->n_bonds, 0, c->length));
    CHECK(hol_chains_set_box(alone, box));
    outcome one = outcome_of(alone, c->n_bonds, c->n_bonds + 1, part[0], part[1], part[2]);
    for (int i = 0; i < 3; ++i) assert_same_bits(one.lambda[i], all->lambda[i] + chain * c->n_bonds, n);
    assert_same_bits(one.g, part[3], size);
    assert_same_bits(one.projected, part[4], size);
    assert_same_bits(one.moved, part[5], size);
    assert_same_bits(one.pushed, part[6], size);
    outcome_free(&one);
    hol_chains_destroy(alone);
    for (int i = 0; i < 7; ++i) free(part[i]);
}

/** For rectangular boxes: the length of every bond, its rate, and its second derivative. */
static void assert_constrained(const crowd *c, const outcome *o, const double *box)
{
    for (int64_t i = 0; i < c->n_atoms; ++i) {
        if (i % (c->n_bonds + 1) == c->n_bonds) continue;
        const int64_t p = 3 * c->atoms[i], q = 3 * c->atoms[i + 1];
        double d2 = 0, rate = 0, second = 0;
        for (int x = 0; x < 3; ++x) {
            const double side = box[4 * x], per_side = side != 0 ? 1 / side : 0, dv = c->v[q + x] - c->v[p + x];
            double d = c->r[q + x] - c->r[p + x], moved = o->moved[q + x] - o->moved[p + x];
            d -= side * nearbyint(d * per_side);
            moved -= side * nearbyint(moved * per_side);
            d2 += moved * moved;
            rate += d * (o->projected[q + x] - o->projected[p + x]);
            second += d * (c->f[q + x] + o->g[q + x] - c->f[p + x] - o->g[p + x]) + dv * dv;
        }
        /* coordinates of up to 30 are rounded to 16 eps, a bond by twice that; forces and squares of up to 30 */
        CHECK_AT_MOST(fabs(d2 - 1), 200 * DBL_EPSILON);
        CHECK_AT_MOST(fabs(rate), 200 * DBL_EPSILON);
        CHECK_AT_MOST(fabs(second), 2000 * DBL_EPSILON);
    }
}

static void short_chains_of_one_kind_take_the_nearest_image(void **state)
{
    (void)state;
    for (int64_t n = 1; n <= 6; ++n)
        for (int b = 0; b < BOXES; ++b)
            for (int listed = 0; listed < 2; ++listed) {
                const double *const box = boxes[b];
                crowd c = crowd_make(n, listed, box, 70 + (uint64_t)(10 * n + b));
                outcome all = outcome_of(c.chains, c.n_chains * n, c.n_atoms, c.r, c.v, c.f);
                for (int64_t k = 0; k < c.n_chains; ++k) assert_as_alone(&c, &all, k, box);
                if (b < RECTANGULAR) assert_constrained(&c, &all, box);
                outcome_free(&all);
                crowd_free(&c);
            }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(short_chains_of_one_kind_take_the_nearest_image),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
