/**
 * hol_metric as a call: what is asked and what is not, layouts, boxes, threads, inactive and bad chains, every error.
 */
#include "assembly.h"
#include "check.h"
#include "input.h"
#include "layout.h"

/** All outputs of one call. */
typedef struct results {
    size_t chains, size;
    double *log_det, *log_det_z, energy, *force;
} results;

static results blank(const assembly *a)
{
    results x = {(size_t)a->n_chains, assembly_size(a), NULL, NULL, 0, NULL};
    x.log_det = untouched(x.chains);
    x.log_det_z = untouched(x.chains);
    x.force = untouched(x.size);
    double *pattern = untouched(1);
    x.energy = *pattern;
    free(pattern);
    return x;
}

static void discard(results *x)
{
    free(x->log_det), free(x->log_det_z), free(x->force);
}

static int metric(const assembly *a, results *x)
{
    return hol_metric(a->chains, a->r, 1.5, x->log_det, x->log_det_z, &x->energy, x->force, HOL_WRITE);
}

static void assert_equal(const results *x, const results *y)
{
    assert_same_bits(x->log_det, y->log_det, x->chains);
    assert_same_bits(x->log_det_z, y->log_det_z, x->chains);
    assert_same_bits(&x->energy, &y->energy, 1);
    assert_same_bits(x->force, y->force, x->size);
}

static void assert_all_untouched(const results *x)
{
    assert_untouched(x->log_det, x->chains);
    assert_untouched(x->log_det_z, x->chains);
    assert_untouched(&x->energy, 1);
    assert_untouched(x->force, x->size);
}

static void outputs_do_not_depend_on_which_others_are_asked_for(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, 21, 1, 700, SCATTERED, 1);
    results all = blank(&a), one = blank(&a);
    CHECK(metric(&a, &all));
    CHECK(hol_metric(a.chains, a.r, 1.5, one.log_det, NULL, NULL, NULL, HOL_WRITE));
    CHECK(hol_metric(a.chains, a.r, 1.5, NULL, one.log_det_z, NULL, NULL, HOL_WRITE));
    CHECK(hol_metric(a.chains, a.r, 1.5, NULL, NULL, &one.energy, NULL, HOL_WRITE));
    CHECK(hol_metric(a.chains, a.r, 1.5, NULL, NULL, NULL, one.force, HOL_WRITE));
    assert_equal(&all, &one);
    CHECK(hol_metric(a.chains, a.r, 1.5, NULL, NULL, NULL, NULL, HOL_WRITE));
    discard(&all), discard(&one), assembly_free(&a);
}

static void energy_is_half_kt_times_the_sum_of_logarithms(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_COIL, 100, 1, 60, IN_ORDER, 2);
    results x = blank(&a);
    CHECK(metric(&a, &x));
    long double sum = 0;
    for (size_t c = 0; c < x.chains; ++c) sum += x.log_det[c];
    CHECK_AT_MOST(fabsl(x.energy - 0.75L * sum), 100 * DBL_EPSILON * fabsl(sum)); /* a rounding per chain */
    discard(&x), assembly_free(&a);
}

static void force_is_proportional_to_kt_and_can_be_added(void **state)
{
    (void)state;
    for (int how = IN_ORDER; how <= SCATTERED; ++how) {
        assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, 13, 1, 600, (arrangement)how, 3);
        results x = blank(&a), twice = blank(&a);
        CHECK(metric(&a, &x));
        CHECK(hol_metric(a.chains, a.r, 3, NULL, NULL, NULL, twice.force, HOL_WRITE));
        double *sum = copy_of(a.f, x.size);
        CHECK(hol_metric(a.chains, a.r, 1.5, NULL, NULL, NULL, sum, HOL_ADD));
        for (int64_t i = 0; i < a.first[a.n_chains - 1]; ++i) {
            const int64_t atom = a.atoms[i];
            for (int64_t e = 3 * atom; e < 3 * atom + 3; ++e) {
                assert_true(twice.force[e] == 2 * x.force[e]);
                assert_true(sum[e] == a.f[e] + x.force[e]);
            }
        }
        free(sum), discard(&x), discard(&twice), assembly_free(&a);
    }
}

static void every_layout_gives_the_same_bits(void **state)
{
    (void)state;
    for (int how = IN_ORDER; how <= SCATTERED; ++how) {
        assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, 15, 1, 400, (arrangement)how, 4);
        for (size_t i = 0; i < assembly_size(&a); ++i) a.r[i] = (float)a.r[i];
        results x = blank(&a), y = blank(&a);
        CHECK(metric(&a, &x));
        for (int l = 0; l < n_layouts; ++l) {
            laid_out r = lay_out(&layouts[l], a.n_atoms, a.r, 3);
            laid_out force = lay_out(&layouts[(l + 1) % n_layouts], a.n_atoms, x.force, 3);
            CHECK(hol_metric_view(a.chains, INPUT(&r.view), 1.5, y.log_det, y.log_det_z, &y.energy, &force.view,
                                  HOL_WRITE));
            memcpy(y.force, x.force, x.size * sizeof(double));
            collect(&force, y.force);
            if (force.view.element == HOL_DOUBLE) {
                assert_equal(&x, &y);
            } else {
                for (size_t i = 0; i < x.size; ++i)
                    assert_true(isnan(x.force[i]) || (float)x.force[i] == (float)y.force[i]);
            }
            assert_true(gaps_untouched(&force));
            laid_out_free(&r), laid_out_free(&force);
        }
        discard(&x), discard(&y), assembly_free(&a);
    }
}

static void threads_change_no_bit(void **state)
{
    (void)state;
    const int64_t longest[] = {9, 300, 40000};
    if (quick_run()) return; /* valgrind takes the memory of OpenMP's waiting threads for lost */
    for (int l = 0; l < 3; ++l) {
        assembly a = assembly_of_kind(CHAIN_NEARLY_STRAIGHT, l == 2 ? 3 : 400, longest[l] / 2, longest[l], IN_ORDER, 5);
        results x = blank(&a), y = blank(&a);
        CHECK(metric(&a, &x));
        CHECK(hol_chains_set_threads(a.chains, 3));
        CHECK(metric(&a, &y));
        assert_equal(&x, &y);
        discard(&x), discard(&y), assembly_free(&a);
    }
}

static void chains_across_a_box_are_the_same_to_rounding(void **state)
{
    (void)state;
    const double box[9] = {40, 0, 0, 5, 38, 0, -3, 7, 42};
    for (int64_t longest = 30; longest <= 900; longest *= 30) {
        assembly a = assembly_of_kind(CHAIN_COIL, 9, longest / 2, longest, SCATTERED, 6);
        results x = blank(&a), y = blank(&a);
        CHECK(metric(&a, &x));
        for (int64_t i = 0; i < a.n_atoms; ++i)
            for (int row = 0; row < 3; ++row)
                for (int c = 0; c < 3; ++c) a.r[3 * i + c] += (double)((i * (row + 2)) % 5 - 2) * box[3 * row + c];
        CHECK(hol_chains_set_box(a.chains, box));
        CHECK(metric(&a, &y));
        /* the shifted coordinates, up to 200, carry bonds of 1 with errors of 200 eps */
        for (size_t c = 0; c < x.chains; ++c)
            CHECK_AT_MOST(fabs(x.log_det[c] - y.log_det[c]), 1000 * 100 * DBL_EPSILON * fabs(x.log_det[c]));
        for (int64_t i = 0; i < 3 * a.n_atoms; ++i)
            if (!isnan(a.r[i])) CHECK_AT_MOST(fabs(x.force[i] - y.force[i]), 1e5 * DBL_EPSILON * 30);
        discard(&x), discard(&y), assembly_free(&a);
    }
}

static void inactive_chains_are_left_out(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_COIL, 20, 1, 500, IN_ORDER, 7);
    unsigned char active[20];
    results x = blank(&a), y = blank(&a);
    CHECK(metric(&a, &x));
    for (int c = 0; c < 20; ++c) active[c] = c % 3 != 1;
    CHECK(hol_chains_set_active(a.chains, active));
    CHECK(metric(&a, &y));
    long double sum = 0;
    for (int64_t c = 0; c < 20; ++c) {
        const size_t at = 3 * (size_t)a.atoms[a.first[c]], size = 3 * ((size_t)assembly_bonds(&a, c) + 1);
        if (active[c]) {
            sum += 0.75L * x.log_det[c];
            assert_same_bits(x.force + at, y.force + at, size);
            assert_same_bits(x.log_det + c, y.log_det + c, 1);
        } else {
            assert_untouched(y.force + at, size);
            assert_untouched(y.log_det + c, 1);
            assert_untouched(y.log_det_z + c, 1);
        }
    }
    CHECK_AT_MOST(fabsl(y.energy - sum), 20 * DBL_EPSILON * fabsl(sum));
    discard(&x), discard(&y), assembly_free(&a);
}

static void bad_chains_keep_their_outputs_and_the_others_are_complete(void **state)
{
    (void)state;
    const int64_t longest[] = {6, 30, 900};
    for (int l = 0; l < 3; ++l)
        for (int what = 0; what < 4; ++what) {
            assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, 17, longest[l] / 2, longest[l], IN_ORDER, 8);
            results x = blank(&a), y = blank(&a);
            CHECK(metric(&a, &x));
            for (int64_t c = 5; c <= 11; c += 6) { /* chains 5 and 11 */
                double *r = a.r + 3 * a.atoms[a.first[c] + (c == 5 ? 2 : assembly_bonds(&a, c))];
                if (what == 0) r[1] = NAN;
                if (what == 1) r[2] = INFINITY;
                if (what == 2) memcpy(r, r - 3, 3 * sizeof(double));
                if (what == 3) r[0] = 1e305, r[-3] = -1.7e308;
            }
            CHECK_FAILS(what == 2 ? HOL_ERR_DEGENERATE : HOL_ERR_NOT_FINITE, metric(&a, &y));
            int64_t first, n_bad;
            hol_error_location(&first, NULL, NULL, &n_bad);
            assert_int_equal(first, 5);
            assert_int_equal(n_bad, 2);
            assert_untouched(&y.energy, 1);
            for (int64_t c = 0; c < 17; ++c) {
                const size_t at = 3 * (size_t)a.atoms[a.first[c]], size = 3 * ((size_t)assembly_bonds(&a, c) + 1);
                if (c == 5 || c == 11) {
                    assert_untouched(y.force + at, size);
                    assert_untouched(y.log_det + c, 1);
                    assert_untouched(y.log_det_z + c, 1);
                } else {
                    assert_same_bits(x.force + at, y.force + at, size);
                    assert_same_bits(x.log_det + c, y.log_det + c, 1);
                    assert_same_bits(x.log_det_z + c, y.log_det_z + c, 1);
                }
            }
            discard(&x), discard(&y), assembly_free(&a);
        }
}

static void singular_chains_are_degenerate(void **state)
{
    (void)state;
    const double masses[2][4] = {{0, 1, 2, 0}, {INFINITY, 2, 1, 0}};
    const double r[12] = {0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0}, length[3] = {1, 1, 1}; /* taut */
    for (int i = 0; i < 2; ++i) {
        hol_chains *chains;
        double *out = untouched(15);
        CHECK(hol_chains_create(4, masses[i], &chains));
        CHECK(hol_chains_add_block(chains, 1, 3, 0, length));
        CHECK_FAILS(HOL_ERR_DEGENERATE, hol_metric(chains, r, 1, out, out + 1, out + 2, out + 3, HOL_WRITE));
        assert_untouched(out, 15);
        free(out);
        hol_chains_destroy(chains);
    }
}

static void wrong_arguments_write_nothing(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_COIL, 4, 3, 9, IN_ORDER, 9);
    results x = blank(&a);
    double *const ld = x.log_det, *const lz = x.log_det_z, *const u = &x.energy, *const f = x.force;
    CHECK_FAILS(HOL_ERR_NULL, hol_metric(NULL, a.r, 1, ld, lz, u, f, HOL_WRITE));
    CHECK_FAILS(HOL_ERR_NULL, hol_metric(a.chains, NULL, 1, ld, lz, u, f, HOL_WRITE));
    CHECK_FAILS(HOL_ERR_VALUE, hol_metric(a.chains, a.r, -1, ld, lz, u, f, HOL_WRITE));
    CHECK_FAILS(HOL_ERR_VALUE, hol_metric(a.chains, a.r, NAN, ld, lz, u, f, HOL_WRITE));
    CHECK_FAILS(HOL_ERR_VALUE, hol_metric(a.chains, a.r, INFINITY, ld, lz, u, f, HOL_WRITE));
    CHECK_FAILS(HOL_ERR_VALUE, hol_metric(a.chains, a.r, 1, ld, lz, u, f, 2));
    hol_view r = {a.r, a.r + 1, a.r + 2, 3 * sizeof(double), HOL_DOUBLE, 0}, flat = {f, f + 1, NULL, 16, HOL_DOUBLE, 0};
    CHECK_FAILS(HOL_ERR_NULL, hol_metric_view(NULL, INPUT(&r), 1, ld, lz, u, NULL, HOL_WRITE));
    CHECK_FAILS(HOL_ERR_NULL, hol_metric_view(a.chains, NULL, 1, ld, lz, u, NULL, HOL_WRITE));
    CHECK_FAILS(HOL_ERR_VALUE, hol_metric_view(a.chains, INPUT(&r), 1, ld, lz, u, &flat, HOL_WRITE));
    assert_all_untouched(&x);
    CHECK(metric(&a, &x)); /* the handle is as good as before */
    discard(&x), assembly_free(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(outputs_do_not_depend_on_which_others_are_asked_for),
        cmocka_unit_test(energy_is_half_kt_times_the_sum_of_logarithms),
        cmocka_unit_test(force_is_proportional_to_kt_and_can_be_added),
        cmocka_unit_test(every_layout_gives_the_same_bits),
        cmocka_unit_test(threads_change_no_bit),
        cmocka_unit_test(chains_across_a_box_are_the_same_to_rounding),
        cmocka_unit_test(inactive_chains_are_left_out),
        cmocka_unit_test(bad_chains_keep_their_outputs_and_the_others_are_complete),
        cmocka_unit_test(singular_chains_are_degenerate),
        cmocka_unit_test(wrong_arguments_write_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
