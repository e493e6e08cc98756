/**
 * Results that must be the same to the last bit: wherever a chain stands among others, on any number of threads, in any
 * layout, in every repetition, and scaled by a power of two.
 */
#include "assembly.h"
#include "check.h"
#include "random.h"

enum { VERBS = 3 };

/** All outputs of the three verbs for an assembly. */
typedef struct outputs {
    double *lambda[VERBS]; /* per bond: forces, velocities, positions */
    double *atoms[VERBS];  /* per atom: g; v; r */
    double *moved;         /* v after hol_project_positions */
    double *tension;
    double virial[VERBS][9];
} outputs;

static const double time_step = 0.004;

/** Positions after a drift with the velocities. */
static double *drift(const assembly *a, double dt)
{
    double *r = copy_of(a->r, assembly_size(a));
    for (size_t i = 0; i < assembly_size(a); ++i) r[i] += dt * a->v[i];
    return r;
}

static outputs compute(const assembly *a, double dt)
{
    outputs o;
    const size_t n = (size_t)a->n_bonds, size = assembly_size(a);
    for (int k = 0; k < VERBS; ++k) o.lambda[k] = untouched(n);
    o.tension = untouched(n);
    o.atoms[0] = untouched(size);
    CHECK(hol_forces(a->chains, a->r, a->v, a->f, o.lambda[0], o.tension, o.atoms[0], HOL_WRITE, o.virial[0]));
    o.atoms[1] = copy_of(a->v, size);
    CHECK(hol_project_velocities(a->chains, a->r, o.atoms[1], o.lambda[1], o.virial[1]));
    o.atoms[2] = drift(a, dt);
    o.moved = copy_of(a->v, size);
    CHECK(hol_project_positions(a->chains, a->r, o.atoms[2], o.moved, dt, o.lambda[2], 0, o.virial[2], NULL));
    return o;
}

static void release(outputs *o)
{
    for (int k = 0; k < VERBS; ++k) {
        free(o->lambda[k]);
        free(o->atoms[k]);
    }
    free(o->tension);
    free(o->moved);
}

static void assert_same_outputs(const assembly *a, const outputs *p, const outputs *q, int sums_too)
{
    for (int k = 0; k < VERBS; ++k) {
        assert_same_bits(p->lambda[k], q->lambda[k], (size_t)a->n_bonds);
        assert_same_bits(p->atoms[k], q->atoms[k], assembly_size(a));
        if (sums_too) assert_same_bits(p->virial[k], q->virial[k], 9);
    }
    assert_same_bits(p->moved, q->moved, assembly_size(a));
    assert_same_bits(p->tension, q->tension, (size_t)a->n_bonds);
}

/** Chain i of one set of outputs against chain j of another. */
static void assert_same_chain(const assembly *a, int64_t i, const outputs *p, const assembly *b, int64_t j,
                              const outputs *q)
{
    const size_t n = (size_t)assembly_bonds(a, i), size = 3 * (n + 1);
    assert_int_equal(assembly_bonds(b, j), n);
    double *x = untouched(size), *y = untouched(size);
    for (int k = 0; k < VERBS + 1; ++k) {
        assembly_take(a, i, k < VERBS ? p->atoms[k] : p->moved, x);
        assembly_take(b, j, k < VERBS ? q->atoms[k] : q->moved, y);
        assert_same_bits(x, y, size);
        assert_same_bits((k < VERBS ? p->lambda[k] : p->tension) + a->first_bond[i],
                         (k < VERBS ? q->lambda[k] : q->tension) + b->first_bond[j], n);
    }
    free(x);
    free(y);
}

static const chain_kind kinds[] = {CHAIN_COIL, CHAIN_HETEROGENEOUS, CHAIN_LATTICE, CHAIN_MASSES_1E3};

static void repeated_calls_give_the_same_bits(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, 37, 1, 60, IN_ORDER, 1);
    outputs first = compute(&a, time_step);
    for (int i = 0; i < 3; ++i) {
        outputs again = compute(&a, time_step);
        assert_same_outputs(&a, &first, &again, 1);
        release(&again);
    }
    release(&first);
    assembly_free(&a);
}

static void a_chain_gives_the_same_bits_alone_and_among_others(void **state)
{
    (void)state;
    for (size_t kind = 0; kind < sizeof kinds / sizeof *kinds; ++kind) {
        assembly a = assembly_of_kind(kinds[kind], 41, 1, 70, SCATTERED, 2 + kind);
        outputs together = compute(&a, time_step);
        for (int64_t c = 0; c < a.n_chains; ++c) {
            chain one = assembly_chain(&a, c);
            assembly b = assembly_make(&one, 1, IN_ORDER, 0);
            outputs alone = compute(&b, time_step);
            assert_same_chain(&a, c, &together, &b, 0, &alone);
            release(&alone);
            assembly_free(&b);
            chain_free(&one);
        }
        release(&together);
        assembly_free(&a);
    }
}

static void a_chain_gives_the_same_bits_in_every_place_among_equals(void **state)
{
    (void)state;
    /* copies of one chain among 1 to 19 copies: it stands in every lane of full and of partly filled blocks */
    static const int64_t lengths[] = {1, 2, 3, 4, 5, 7, 8, 16, 31, 33, 100, 600};
    for (size_t l = 0; l < sizeof lengths / sizeof *lengths; ++l) {
        chain parts[19];
        for (int i = 0; i < 19; ++i) parts[i] = chain_make(CHAIN_HETEROGENEOUS, lengths[l], 5);
        assembly b = assembly_make(parts, 1, IN_ORDER, 0);
        outputs alone = compute(&b, time_step);
        for (int n = 2; n <= 19; ++n) {
            assembly a = assembly_make(parts, n, n % 2 ? IN_ORDER : SCATTERED, (uint64_t)n);
            outputs many = compute(&a, time_step);
            for (int c = 0; c < n; ++c) assert_same_chain(&a, c, &many, &b, 0, &alone);
            release(&many);
            assembly_free(&a);
        }
        release(&alone);
        assembly_free(&b);
        for (int i = 0; i < 19; ++i) chain_free(parts + i);
    }
}

static void a_chain_gives_the_same_bits_in_a_block_and_by_its_atoms(void **state)
{
    (void)state;
    for (int64_t bonds = 1; bonds <= 12; ++bonds) {
        chain parts[11];
        for (int i = 0; i < 11; ++i) parts[i] = chain_make(CHAIN_COIL, bonds, 70 + (uint64_t)i);
        assembly a = assembly_make(parts, 11, IN_ORDER, 0);
        /* lengths are for the position level only; the block takes one set for all */
        for (int64_t k = 0; k < a.n_bonds; ++k) a.length[k] = 1;
        hol_chains_destroy(a.chains);
        CHECK(hol_chains_create(a.n_atoms, a.mass, &a.chains));
        CHECK(hol_chains_add_block(a.chains, 11, bonds, 0, a.length));
        outputs block = compute(&a, time_step);
        hol_chains_destroy(a.chains);
        CHECK(hol_chains_create(a.n_atoms, a.mass, &a.chains));
        for (int64_t c = 0; c < 11; ++c) CHECK(hol_chains_add(a.chains, bonds, a.atoms + a.first[c], a.length));
        outputs listed = compute(&a, time_step);
        assert_same_outputs(&a, &block, &listed, 1);
        release(&block);
        release(&listed);
        assembly_free(&a);
        for (int i = 0; i < 11; ++i) chain_free(parts + i);
    }
}

static void a_long_chain_gives_the_same_bits_alone_and_among_others(void **state)
{
    (void)state;
    static const int64_t lengths[] = {5000, 3, 20000, 1, 700, 5000, 12};
    chain parts[7];
    for (int i = 0; i < 7; ++i) parts[i] = chain_make(CHAIN_HETEROGENEOUS, lengths[i], 31 + (uint64_t)i);
    assembly a = assembly_make(parts, 7, SCATTERED, 8);
    outputs together = compute(&a, time_step);
    for (int c = 0; c < 7; ++c) {
        assembly b = assembly_make(parts + c, 1, IN_ORDER, 0);
        outputs alone = compute(&b, time_step);
        assert_same_chain(&a, c, &together, &b, 0, &alone);
        release(&alone);
        assembly_free(&b);
        chain_free(parts + c);
    }
    release(&together);
    assembly_free(&a);
}

static void every_number_of_threads_gives_the_same_bits(void **state)
{
    (void)state;
    static const int64_t longest[3] = {5, 60, 3000};
    for (int i = 0; i < 3; ++i) {
        assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, i < 2 ? 700 : 9, 1, longest[i], SCATTERED, 3);
        outputs one = compute(&a, time_step);
        for (int threads = 2; threads <= 5; ++threads) {
            CHECK(hol_chains_set_threads(a.chains, threads));
            outputs several = compute(&a, time_step);
            assert_same_outputs(&a, &one, &several, 1);
            release(&several);
        }
        release(&one);
        assembly_free(&a);
    }
}

static void scale_array(double *x, size_t n, double factor)
{
    for (size_t i = 0; i < n; ++i) x[i] *= factor;
}

/** The same system in other units, which are powers of two of the old ones. */
static void assert_scales(chain_kind kind, double mass, double length, double time, uint64_t seed)
{
    assembly a = assembly_of_kind(kind, 23, 1, 50, IN_ORDER, seed);
    chain parts[23];
    for (int c = 0; c < 23; ++c) {
        parts[c] = assembly_chain(&a, c);
        const size_t atoms = (size_t)parts[c].n_bonds + 1;
        scale_array(parts[c].mass, atoms, mass);
        scale_array(parts[c].length, atoms - 1, length);
        scale_array(parts[c].r, 3 * atoms, length);
        scale_array(parts[c].v, 3 * atoms, length / time);
        scale_array(parts[c].f, 3 * atoms, mass * length / time / time);
    }
    assembly b = assembly_make(parts, 23, IN_ORDER, seed + 1);
    outputs p = compute(&a, time_step), q = compute(&b, time_step * time);
    const size_t n = (size_t)a.n_bonds, size = assembly_size(&a);
    const double force = mass * length / time / time;
    scale_array(p.lambda[0], n, force / length);
    scale_array(p.tension, n, force);
    scale_array(p.atoms[0], size, force);
    scale_array(p.virial[0], 9, force * length);
    scale_array(p.lambda[1], n, force / length * time);
    scale_array(p.atoms[1], size, length / time);
    scale_array(p.virial[1], 9, force * length * time);
    scale_array(p.lambda[2], n, force / length);
    scale_array(p.atoms[2], size, length);
    scale_array(p.moved, size, length / time);
    scale_array(p.virial[2], 9, force * length);
    assert_same_outputs(&a, &p, &q, 1);
    release(&p);
    release(&q);
    assembly_free(&a);
    assembly_free(&b);
    for (int c = 0; c < 23; ++c) chain_free(parts + c);
}

static void powers_of_two_of_the_units_scale_every_result_exactly(void **state)
{
    (void)state;
    for (size_t kind = 0; kind < sizeof kinds / sizeof *kinds; ++kind) {
        assert_scales(kinds[kind], 1, 0x1p-33, 1, 50); /* lengths in metres */
        assert_scales(kinds[kind], 0x1p-86, 1, 1, 51); /* masses in kilograms */
        assert_scales(kinds[kind], 1, 1, 0x1p-50, 52); /* times in seconds */
        assert_scales(kinds[kind], 0x1p-86, 0x1p-33, 0x1p-43, 53);
        assert_scales(kinds[kind], 0x1p+86, 0x1p+33, 0x1p+43, 54);
    }
}

static double largest_difference(const double *a, const double *b, size_t n)
{
    double worst = 0;
    for (size_t i = 0; i < n; ++i) worst = fmax(worst, fabs(a[i] - b[i]));
    return worst;
}

static void lengths_in_any_unit_give_the_right_result_or_an_error(void **state)
{
    (void)state;
    /* where products of lengths underflow or overflow; constraint forces have no unit of length if there are no
     * velocities, nor have projected velocities */
    static const int64_t bonds[] = {1, 3, 8, 100, 600};
    for (int c = 0; c < 5; ++c) {
        chain one = chain_make(CHAIN_COIL, bonds[c], 60);
        assembly a = assembly_make(&one, 1, IN_ORDER, 0);
        const size_t size = assembly_size(&a);
        double *g = untouched(size), *v = copy_of(a.v, size), *r = copy_of(a.r, size);
        CHECK(hol_forces(a.chains, a.r, NULL, a.f, NULL, NULL, g, HOL_WRITE, NULL));
        CHECK(hol_project_velocities(a.chains, a.r, v, NULL, NULL));
        int right = 0;
        for (int e = -500; e <= 500; e += 4) {
            double *scaled_g = untouched(size), *scaled_v = copy_of(a.v, size);
            for (size_t i = 0; i < size; ++i) r[i] = ldexp(a.r[i], e);
            const int forces = hol_forces(a.chains, r, NULL, a.f, NULL, NULL, scaled_g, HOL_WRITE, NULL);
            if (forces == HOL_OK)
                CHECK_AT_MOST(largest_difference(scaled_g, g, size), 1e-12);
            else
                assert_untouched(scaled_g, size);
            const int velocities = hol_project_velocities(a.chains, r, scaled_v, NULL, NULL);
            if (velocities == HOL_OK)
                CHECK_AT_MOST(largest_difference(scaled_v, v, size), 1e-12);
            else
                assert_same_bits(scaled_v, a.v, size);
            right += forces == HOL_OK && velocities == HOL_OK;
            if (abs(e) <= 136) assert_true(forces == HOL_OK && velocities == HOL_OK);
            free(scaled_g), free(scaled_v);
        }
        assert_true(right < 251); /* else this has not been where numbers end */
        free(g), free(v), free(r);
        assembly_free(&a);
        chain_free(&one);
    }
}

static void straight_chains_scale_exactly_too(void **state)
{
    (void)state;
    /* the case in which the library compensates products: thresholds must not depend on units */
    static const chain_kind straight[] = {CHAIN_NEARLY_STRAIGHT, CHAIN_STRAIGHT, CHAIN_ROD_MASSES_1E9, CHAIN_TAUT,
                                          CHAIN_OFFSET_1E6};
    for (size_t i = 0; i < sizeof straight / sizeof *straight; ++i) {
        chain one = chain_make(straight[i], 64, 3);
        assembly a = assembly_make(&one, 1, IN_ORDER, 0);
        double *lambda = untouched(64), *small = untouched(64);
        CHECK(hol_forces(a.chains, a.r, a.v, a.f, lambda, NULL, NULL, HOL_WRITE, NULL));
        scale_array(a.r, assembly_size(&a), 0x1p-33);
        scale_array(a.v, assembly_size(&a), 0x1p-33);
        scale_array(a.f, assembly_size(&a), 0x1p-33);
        CHECK(hol_forces(a.chains, a.r, a.v, a.f, small, NULL, NULL, HOL_WRITE, NULL));
        assert_same_bits(lambda, small, 64);
        free(lambda);
        free(small);
        assembly_free(&a);
        chain_free(&one);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(repeated_calls_give_the_same_bits),
        cmocka_unit_test(a_chain_gives_the_same_bits_alone_and_among_others),
        cmocka_unit_test(a_chain_gives_the_same_bits_in_every_place_among_equals),
        cmocka_unit_test(a_chain_gives_the_same_bits_in_a_block_and_by_its_atoms),
        cmocka_unit_test(a_long_chain_gives_the_same_bits_alone_and_among_others),
        cmocka_unit_test(every_number_of_threads_gives_the_same_bits),
        cmocka_unit_test(powers_of_two_of_the_units_scale_every_result_exactly),
        cmocka_unit_test(lengths_in_any_unit_give_the_right_result_or_an_error),
        cmocka_unit_test(straight_chains_scale_exactly_too),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
