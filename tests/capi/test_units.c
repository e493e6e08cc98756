/** The same system in other units: powers of two scale every result exactly, any others give the right ones. */
#include "check.h"
#include "outputs.h"

static const double time_step = 0.004;

static const chain_kind kinds[] = {CHAIN_COIL, CHAIN_HETEROGENEOUS, CHAIN_LATTICE, CHAIN_MASSES_1E3};

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
    outputs p = outputs_of(&a, time_step), q = outputs_of(&b, time_step * time);
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
    outputs_free(&p);
    outputs_free(&q);
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
    /* also where products of lengths underflow or overflow; constraint forces have no unit of length if there are no
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
        for (int e = -480; e <= 480; e += 4) {
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
            free(scaled_g), free(scaled_v);
        }
        assert_int_equal(right, 241);
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
        cmocka_unit_test(powers_of_two_of_the_units_scale_every_result_exactly),
        cmocka_unit_test(lengths_in_any_unit_give_the_right_result_or_an_error),
        cmocka_unit_test(straight_chains_scale_exactly_too),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
