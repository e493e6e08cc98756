/** Arrays of any layout: the same bits as from [n][3] arrays of doubles, and nothing written between the elements. */
#include "assembly.h"
#include "check.h"
#include "input.h"
#include "layout.h"
#include "positions.h"

#include <math.h>

static const double time_step = 0.004;

/** Rounds all data to float, so that float and double views hold the same numbers. */
static void round_to_float(assembly *a)
{
    for (size_t i = 0; i < assembly_size(a); ++i) {
        a->r[i] = (float)a->r[i];
        a->v[i] = (float)a->v[i];
        a->f[i] = (float)a->f[i];
    }
}

static void forces_through(const assembly *a, const layout *how, const layout *other, int mode)
{
    const size_t n = (size_t)a->n_bonds, size = assembly_size(a);
    double *lambda = untouched(n), *tension = untouched(n), *g = copy_of(a->v, size), virial[9];
    double *view_lambda = untouched(n), *view_tension = untouched(n), view_virial[9];
    CHECK(hol_forces(a->chains, a->r, a->v, a->f, lambda, tension, g, mode, virial));
    laid_out r = lay_out(how, a->n_atoms, a->r, 3), v = lay_out(other, a->n_atoms, a->v, 3);
    laid_out f = lay_out(how, a->n_atoms, a->f, 3), out = lay_out(other, a->n_atoms, a->v, 3);
    CHECK(hol_forces_view(a->chains, INPUT(&r.view), INPUT(&v.view), INPUT(&f.view), view_lambda, view_tension,
                          &out.view, mode, view_virial));
    assert_same_bits(lambda, view_lambda, n);
    assert_same_bits(tension, view_tension, n);
    assert_same_bits(virial, view_virial, 9);
    assert_laid_out(&out, g, other->name);
    assert_laid_out(&r, a->r, how->name);
    laid_out_free(&r), laid_out_free(&v), laid_out_free(&f), laid_out_free(&out);
    free(lambda), free(tension), free(g), free(view_lambda), free(view_tension);
}

static void forces_are_the_same_through_every_layout(void **state)
{
    (void)state;
    static const int64_t longest[] = {1, 3, 40, 2500};
    for (int l = 0; l < 4; l += quick_run() ? 2 : 1)
        for (int how = IN_ORDER; how <= SCATTERED; ++how) {
            assembly a =
                assembly_of_kind(CHAIN_HETEROGENEOUS, 13, l ? longest[l] / 2 : 1, longest[l], (arrangement)how, 41);
            round_to_float(&a);
            for (int i = 0; i < n_layouts; ++i)
                for (int mode = HOL_WRITE; mode <= HOL_ADD; ++mode) {
                    if (!quick_run() || mode == HOL_WRITE) forces_through(&a, &layouts[i], &layouts[i], mode);
                    if (!quick_run() || mode == HOL_ADD)
                        forces_through(&a, &layouts[i], &layouts[(i + 5) % n_layouts], mode);
                }
            assembly_free(&a);
        }
}

static void velocities_are_the_same_through_every_layout(void **state)
{
    (void)state;
    for (int how = IN_ORDER; how <= SCATTERED; ++how) {
        assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, 21, 1, 60, (arrangement)how, 42);
        round_to_float(&a);
        const size_t n = (size_t)a.n_bonds, size = assembly_size(&a);
        double *lambda = untouched(n), *v = copy_of(a.v, size), virial[9];
        CHECK(hol_project_velocities(a.chains, a.r, v, lambda, virial));
        for (int i = 0; i < n_layouts; ++i) {
            double *view_lambda = untouched(n), view_virial[9];
            laid_out r = lay_out(&layouts[(i + 3) % n_layouts], a.n_atoms, a.r, 3),
                     u = lay_out(&layouts[i], a.n_atoms, a.v, 3);
            CHECK(hol_project_velocities_view(a.chains, INPUT(&r.view), &u.view, view_lambda, view_virial));
            assert_same_bits(lambda, view_lambda, n);
            assert_same_bits(virial, view_virial, 9);
            assert_laid_out(&u, v, layouts[i].name);
            laid_out_free(&r), laid_out_free(&u);
            free(view_lambda);
        }
        free(lambda), free(v);
        assembly_free(&a);
    }
}

static void positions_are_the_same_through_every_layout_of_doubles(void **state)
{
    (void)state;
    for (int how = IN_ORDER; how <= SCATTERED + 2; ++how) { /* the last two: one long chain */
        assembly a = how <= SCATTERED ? assembly_of_kind(CHAIN_HETEROGENEOUS, 21, 1, 60, (arrangement)how, 43)
                                      : assembly_of_kind(CHAIN_HETEROGENEOUS, 1, 5000, 5000,
                                                         how == SCATTERED + 1 ? IN_ORDER : SCATTERED, 43);
        const size_t n = (size_t)a.n_bonds, size = assembly_size(&a);
        double *lambda = untouched(n), *start = drift(&a, time_step, 0), *q = copy_of(start, size),
               *v = copy_of(a.v, size), virial[9];
        hol_report report, view_report;
        CHECK(hol_project_positions(a.chains, a.r, q, v, time_step, lambda, 0, virial, &report));
        for (int i = 0; i < n_double_layouts; ++i) {
            double *view_lambda = untouched(n), view_virial[9];
            laid_out r = lay_out(&layouts[(i + 3) % n_double_layouts], a.n_atoms, a.r, 3);
            laid_out p = lay_out(&layouts[i], a.n_atoms, start, 3),
                     u = lay_out(&layouts[(i + 1) % n_double_layouts], a.n_atoms, a.v, 3);
            CHECK(hol_project_positions_view(a.chains, INPUT(&r.view), &p.view, &u.view, time_step, view_lambda, 0,
                                             view_virial, &view_report));
            assert_same_bits(lambda, view_lambda, n);
            assert_same_bits(virial, view_virial, 9);
            assert_laid_out(&p, q, layouts[i].name);
            assert_laid_out(&u, v, layouts[i].name);
            assert_memory_equal(&report, &view_report, sizeof report);
            laid_out_free(&r), laid_out_free(&p), laid_out_free(&u);
            free(view_lambda);
        }
        free(lambda), free(start), free(q), free(v);
        assembly_free(&a);
    }
}

static void float_positions_end_at_the_rounding_of_floats(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_COIL, 21, 1, 60, IN_ORDER, 44);
    round_to_float(&a);
    double *start = drift(&a, time_step, 0);
    for (int i = n_double_layouts; i < n_layouts; ++i) {
        laid_out r = lay_out(&layouts[i], a.n_atoms, a.r, 3), p = lay_out(&layouts[i], a.n_atoms, start, 3);
        laid_out v = lay_out(&layouts[i], a.n_atoms, a.v, 3);
        hol_report report;
        hol_worst worst;
        CHECK(
            hol_project_positions_view(a.chains, INPUT(&r.view), &p.view, &v.view, time_step, NULL, 0, NULL, &report));
        assert_int_equal(report.n_failed, 0);
        CHECK(hol_violation_view(a.chains, INPUT(&p.view), NULL, &worst));
        /* coordinates up to 20, each rounded by 2^-25 of itself; |d| changes by up to 2 sqrt(3) of that, |d|^2 by twice
           that, and a chain within the same tolerance before is not moved */
        CHECK_AT_MOST(worst.length, 20 * 0x1p-25 * 4 * 1.74 * 2);
        assert_true(gaps_untouched(&p) && gaps_untouched(&v));
        laid_out_free(&r), laid_out_free(&p), laid_out_free(&v);
    }
    free(start);
    assembly_free(&a);
}

/** All three verbs, of chains one behind the other, through a layout: the status and the bits of packed arrays. */
static void alike_through(const assembly *a, const double *start, const layout *how)
{
    const size_t n = (size_t)a->n_bonds, size = assembly_size(a);
    double *lambda = untouched(n), *view_lambda = untouched(n), *g = copy_of(a->v, size), *v = copy_of(a->v, size);
    double *q = copy_of(start, size), *u = copy_of(a->v, size);
    laid_out r = lay_out(how, a->n_atoms, a->r, 3), f = lay_out(how, a->n_atoms, a->f, 3);
    laid_out out = lay_out(how, a->n_atoms, a->v, 3), w = lay_out(how, a->n_atoms, a->v, 3);
    laid_out p = lay_out(how, a->n_atoms, start, 3), x = lay_out(how, a->n_atoms, a->v, 3);
    hol_report report, view_report;
    for (int mode = HOL_WRITE; mode <= HOL_ADD; ++mode) {
        for (size_t i = 0; how->element == HOL_FLOAT && i < size; ++i) g[i] = (float)g[i];
        const int status = hol_forces(a->chains, a->r, a->v, a->f, lambda, NULL, g, mode, NULL);
        assert_int_equal(status, hol_forces_view(a->chains, INPUT(&r.view), INPUT(&w.view), INPUT(&f.view), view_lambda,
                                                 NULL, &out.view, mode, NULL));
        assert_laid_out(&out, g, how->name);
        assert_same_bits(lambda, view_lambda, n);
    }
    const int of_v = hol_project_velocities(a->chains, a->r, v, lambda, NULL);
    assert_int_equal(of_v, hol_project_velocities_view(a->chains, INPUT(&r.view), &w.view, view_lambda, NULL));
    assert_laid_out(&w, v, how->name);
    assert_same_bits(lambda, view_lambda, n);
    if (how->element == HOL_DOUBLE) {
        const int of_r = hol_project_positions(a->chains, a->r, q, u, time_step, lambda, 0, NULL, &report);
        assert_int_equal(of_r, hol_project_positions_view(a->chains, INPUT(&r.view), &p.view, &x.view, time_step,
                                                          view_lambda, 0, NULL, &view_report));
        assert_laid_out(&p, q, how->name);
        assert_laid_out(&x, u, how->name);
        assert_same_bits(lambda, view_lambda, n);
        assert_memory_equal(&report, &view_report, sizeof report);
        /* once more, where nothing is left to do, and without what is optional */
        assert_int_equal(of_r, hol_project_positions(a->chains, a->r, q, NULL, time_step, NULL, 0, NULL, NULL));
        assert_int_equal(
            of_r, hol_project_positions_view(a->chains, INPUT(&r.view), &p.view, NULL, time_step, NULL, 0, NULL, NULL));
        assert_laid_out(&p, q, how->name);
    }
    laid_out_free(&r), laid_out_free(&f), laid_out_free(&out), laid_out_free(&w), laid_out_free(&p), laid_out_free(&x);
    free(lambda), free(view_lambda), free(g), free(v), free(q), free(u);
}

/** So many chains that they come in several parts, one of them bad or none. */
static void many_chains_are_the_same_through_every_layout(void **state)
{
    (void)state;
    static const int64_t bonds[] = {1, 2, 3, 4, 5, 6, 20, 60, 100, 127, 140};
    for (size_t b = 0; b < sizeof bonds / sizeof *bonds; ++b)
        for (int masses = quick_run() ? 1 : 0; masses < 2; ++masses)
            for (int bad = 0; bad < 2; ++bad) {
                assembly a = assembly_of_kind(masses ? CHAIN_HETEROGENEOUS : CHAIN_COIL, bonds[b] < 10 ? 203 : 23,
                                              bonds[b], bonds[b], IN_ORDER, 47);
                round_to_float(&a);
                double *start = drift(&a, time_step, 0);
                if (bad) a.r[3 * a.atoms[a.first[17]] + 1] = NAN;
                for (int i = 0; i < n_layouts; ++i) alike_through(&a, start, &layouts[i]);
                free(start);
                assembly_free(&a);
            }
}

static void flatten(assembly *a)
{
    for (int64_t c = 0; c < a->n_chains; ++c)
        for (int64_t i = 0; i <= assembly_bonds(a, c); ++i) {
            const int64_t z = 3 * a->atoms[a->first[c] + i] + 2;
            a->r[z] = a->v[z] = a->f[z] = 0;
        }
}

static void two_dimensions_give_the_bits_of_three_with_zero_z(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, 23, 1, 50, SCATTERED, 45);
    flatten(&a);
    const double short_step = 1e-5; /* some of the flattened bonds are very short */
    hol_chains *same_length;        /* the flattened bonds are shorter, so positions get lengths of their own */
    CHECK(hol_chains_create(a.n_atoms, a.mass, &same_length));
    for (int64_t c = 0; c < a.n_chains; ++c) {
        for (int64_t k = 0; k < assembly_bonds(&a, c); ++k) {
            const double *p = a.r + 3 * a.atoms[a.first[c] + k], *q = a.r + 3 * a.atoms[a.first[c] + k + 1];
            a.length[a.first_bond[c] + k] = hypot(q[0] - p[0], q[1] - p[1]);
        }
        CHECK(hol_chains_add(same_length, assembly_bonds(&a, c), a.atoms + a.first[c], a.length + a.first_bond[c]));
    }
    const size_t n = (size_t)a.n_bonds, size = assembly_size(&a);
    double *lambda = untouched(n), *flat_lambda = untouched(n), *g = copy_of(a.f, size), virial[9], flat_virial[9];
    double *v = copy_of(a.v, size), *start = drift(&a, short_step, 0), *q = copy_of(start, size),
           *u = copy_of(a.v, size);
    for (int i = 0; i < n_double_layouts; ++i) {
        laid_out fr = lay_out(&layouts[i], a.n_atoms, a.r, 2), fv = lay_out(&layouts[i], a.n_atoms, a.v, 2);
        laid_out ff = lay_out(&layouts[i], a.n_atoms, a.f, 2), fp = lay_out(&layouts[i], a.n_atoms, start, 2);
        memcpy(g, a.f, sizeof *g * size), memcpy(v, a.v, sizeof *v * size), memcpy(q, start, sizeof *q * size),
            memcpy(u, a.v, sizeof *u * size);
        CHECK(hol_forces(a.chains, a.r, a.v, a.f, lambda, NULL, g, HOL_ADD, virial));
        CHECK(hol_forces_view(a.chains, INPUT(&fr.view), INPUT(&fv.view), INPUT(&ff.view), flat_lambda, NULL, &ff.view,
                              HOL_ADD, flat_virial));
        assert_same_bits(lambda, flat_lambda, n);
        for (int k = 0; k < 9; ++k) assert_true(virial[k] == flat_virial[k]);
        assert_laid_out(&ff, g, layouts[i].name);
        CHECK(hol_project_positions(same_length, a.r, q, u, short_step, lambda, 0, virial, NULL));
        CHECK(hol_project_positions_view(same_length, INPUT(&fr.view), &fp.view, &fv.view, short_step, flat_lambda, 0,
                                         flat_virial, NULL));
        assert_same_bits(lambda, flat_lambda, n);
        assert_laid_out(&fp, q, layouts[i].name);
        assert_laid_out(&fv, u, layouts[i].name);
        laid_out_free(&fv);
        fv = lay_out(&layouts[i], a.n_atoms, a.v, 2);
        CHECK(hol_project_velocities(a.chains, a.r, v, lambda, virial));
        CHECK(hol_project_velocities_view(a.chains, INPUT(&fr.view), &fv.view, flat_lambda, flat_virial));
        assert_same_bits(lambda, flat_lambda, n);
        assert_laid_out(&fv, v, layouts[i].name);
        hol_worst worst, flat_worst;
        CHECK(hol_violation(a.chains, a.r, v, &worst));
        CHECK(hol_violation_view(a.chains, INPUT(&fr.view), INPUT(&fv.view), &flat_worst));
        assert_memory_equal(&worst, &flat_worst, sizeof worst);
        laid_out_free(&fr), laid_out_free(&fv), laid_out_free(&ff), laid_out_free(&fp);
    }
    free(lambda), free(flat_lambda), free(g), free(v), free(start), free(q), free(u);
    hol_chains_destroy(same_length);
    assembly_free(&a);
}

static void views_may_be_null_where_arrays_may(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_COIL, 3, 5, 5, IN_ORDER, 46);
    const hol_view r = {a.r, a.r + 1, a.r + 2, 24, HOL_DOUBLE, 0}, f = {a.f, a.f + 1, a.f + 2, 24, HOL_DOUBLE, 0};
    double lambda[15], view_lambda[15];
    CHECK(hol_forces(a.chains, a.r, NULL, a.f, lambda, NULL, NULL, HOL_WRITE, NULL));
    CHECK(hol_forces_view(a.chains, INPUT(&r), NULL, INPUT(&f), view_lambda, NULL, NULL, HOL_WRITE, NULL));
    assert_same_bits(lambda, view_lambda, 15);
    CHECK_FAILS(HOL_ERR_NULL,
                hol_forces_view(a.chains, NULL, NULL, INPUT(&f), view_lambda, NULL, NULL, HOL_WRITE, NULL));
    CHECK_FAILS(HOL_ERR_NULL,
                hol_forces_view(NULL, INPUT(&r), NULL, INPUT(&f), view_lambda, NULL, NULL, HOL_WRITE, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_project_velocities_view(a.chains, INPUT(&r), NULL, NULL, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_project_velocities_view(a.chains, NULL, &f, NULL, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_project_positions_view(a.chains, NULL, &r, NULL, 1, NULL, 0, NULL, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_project_positions_view(a.chains, INPUT(&r), NULL, NULL, 1, NULL, 0, NULL, NULL));
    hol_worst worst;
    CHECK_FAILS(HOL_ERR_NULL, hol_violation_view(a.chains, NULL, NULL, &worst));
    CHECK_FAILS(HOL_ERR_NULL, hol_violation_view(a.chains, INPUT(&r), NULL, NULL));
    assembly_free(&a);
}

static void views_that_describe_nothing_are_refused(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_COIL, 3, 5, 5, IN_ORDER, 47);
    const hol_view good = {a.r, a.r + 1, a.r + 2, 24, HOL_DOUBLE, 0}, flat = {a.r, a.r + 1, NULL, 24, HOL_DOUBLE, 0};
    hol_view wrong[8];
    for (int i = 0; i < 8; ++i) wrong[i] = good;
    wrong[0].x = NULL;
    wrong[1].y = NULL;
    wrong[2].stride = 0;
    wrong[3].stride = 20;
    wrong[4].element = 2;
    wrong[5].element = -1;
    wrong[6].reserved = 1;
    wrong[7].stride = 26;
    double *lambda = untouched(15), *g = untouched(54), *virial = untouched(9);
    const hol_view out = {g, g + 1, g + 2, 24, HOL_DOUBLE, 0};
    hol_worst worst;
    for (int i = 0; i < 8; ++i) {
        const int status = i < 2 ? HOL_ERR_NULL : HOL_ERR_VALUE;
        CHECK_FAILS(status,
                    hol_forces_view(a.chains, INPUT(&wrong[i]), NULL, NULL, lambda, NULL, &out, HOL_WRITE, virial));
        CHECK_FAILS(status, hol_forces_view(a.chains, INPUT(&good), INPUT(&wrong[i]), NULL, lambda, NULL, &out,
                                            HOL_WRITE, virial));
        CHECK_FAILS(status, hol_forces_view(a.chains, INPUT(&good), NULL, INPUT(&wrong[i]), lambda, NULL, &out,
                                            HOL_WRITE, virial));
        CHECK_FAILS(status,
                    hol_forces_view(a.chains, INPUT(&good), NULL, NULL, lambda, NULL, &wrong[i], HOL_WRITE, virial));
        CHECK_FAILS(status, hol_project_velocities_view(a.chains, INPUT(&wrong[i]), &out, lambda, virial));
        CHECK_FAILS(status, hol_project_velocities_view(a.chains, INPUT(&good), &wrong[i], lambda, virial));
        CHECK_FAILS(status,
                    hol_project_positions_view(a.chains, INPUT(&wrong[i]), &out, NULL, 1, lambda, 0, virial, NULL));
        CHECK_FAILS(status,
                    hol_project_positions_view(a.chains, INPUT(&good), &wrong[i], NULL, 1, lambda, 0, virial, NULL));
        CHECK_FAILS(status,
                    hol_project_positions_view(a.chains, INPUT(&good), &out, &wrong[i], 1, lambda, 0, virial, NULL));
        CHECK_FAILS(status, hol_violation_view(a.chains, INPUT(&wrong[i]), NULL, &worst));
        CHECK_FAILS(status, hol_violation_view(a.chains, INPUT(&good), INPUT(&wrong[i]), &worst));
    }
    /* two dimensions in one view, three in another */
    CHECK_FAILS(HOL_ERR_VALUE,
                hol_forces_view(a.chains, INPUT(&good), INPUT(&flat), NULL, lambda, NULL, &out, HOL_WRITE, virial));
    CHECK_FAILS(HOL_ERR_VALUE,
                hol_forces_view(a.chains, INPUT(&flat), NULL, NULL, lambda, NULL, &out, HOL_WRITE, virial));
    CHECK_FAILS(HOL_ERR_VALUE, hol_project_velocities_view(a.chains, INPUT(&flat), &out, lambda, virial));
    CHECK_FAILS(HOL_ERR_VALUE, hol_violation_view(a.chains, INPUT(&good), INPUT(&flat), &worst));
    assert_untouched(lambda, 15);
    assert_untouched(g, 54);
    assert_untouched(virial, 9);
    free(lambda), free(g), free(virial);
    assembly_free(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(forces_are_the_same_through_every_layout),
        cmocka_unit_test(velocities_are_the_same_through_every_layout),
        cmocka_unit_test(positions_are_the_same_through_every_layout_of_doubles),
        cmocka_unit_test(many_chains_are_the_same_through_every_layout),
        cmocka_unit_test(float_positions_end_at_the_rounding_of_floats),
        cmocka_unit_test(two_dimensions_give_the_bits_of_three_with_zero_z),
        cmocka_unit_test(views_may_be_null_where_arrays_may),
        cmocka_unit_test(views_that_describe_nothing_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
