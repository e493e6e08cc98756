/** Functions of the inverse: layouts, index bases, boxes, and wrong arguments. */
#include "chain.h"
#include "check.h"
#include "from_one.h"
#include "input.h"
#include "inverse.h"
#include "layout.h"

static void views_and_index_base_give_the_same(void **state)
{
    (void)state;
    chain c = chain_make(CHAIN_COIL, 9, 2);
    hol_chains *chains = handle_of(&c);
    hol_inverse *inverse, *other;
    double a, b, bound[2][9], lambda[9], relative[2];
    CHECK(hol_forces(chains, c.r, c.v, c.f, lambda, NULL, NULL, HOL_WRITE, NULL));
    CHECK(hol_inverse_create(chains, 0, c.r, &inverse));
    hol_chains *counted = from_one(chains);
    laid_out r = lay_out(&layouts[1], 10, c.r, 3), v = lay_out(&layouts[2], 10, c.v, 3),
             f = lay_out(&layouts[1], 10, c.f, 3);
    CHECK(hol_inverse_create_view(counted, 1, INPUT(&r.view), &other));
    for (int64_t i = 0; i < 9; ++i) {
        CHECK(hol_inverse_entry(inverse, HOL_PHYSICAL, i, 3, &a));
        CHECK(hol_inverse_entry(other, HOL_PHYSICAL, i + 1, 4, &b));
        assert_true(a == b);
    }
    CHECK(hol_inverse_error_bound(inverse, c.v, c.f, lambda, bound[0], relative));
    CHECK(hol_inverse_error_bound_view(other, INPUT(&v.view), INPUT(&f.view), lambda, bound[1], relative + 1));
    assert_same_bits(bound[0], bound[1], 9);
    assert_true(relative[0] == relative[1]);
    CHECK(hol_inverse_error_bound_view(other, NULL, INPUT(&f.view), lambda, NULL, relative + 1));
    CHECK_FAILS(HOL_ERR_INDEX, hol_inverse_entry(other, HOL_PHYSICAL, 0, 1, &b));
    hol_inverse_destroy(other);
    CHECK_FAILS(HOL_ERR_INDEX, hol_inverse_create(counted, 0, c.r, &other));
    assert_null(other);
    laid_out_free(&r), laid_out_free(&v), laid_out_free(&f);
    hol_inverse_destroy(inverse);
    hol_chains_destroy(chains);
    hol_chains_destroy(counted);
    chain_free(&c);
}

static void box_is_applied(void **state)
{
    (void)state;
    const double box[9] = {9, 0, 0, 0, 9, 0, 0, 0, 9};
    chain c = chain_make(CHAIN_COIL, 12, 6);
    hol_inverse *inside = inverse_of(&c), *across;
    for (int64_t i = 0; i <= 12; ++i) c.r[3 * i + i % 3] += (double)(i % 4) * 9;
    hol_chains *chains = handle_of(&c);
    CHECK(hol_chains_set_box(chains, box));
    CHECK(hol_inverse_create(chains, 0, c.r, &across));
    double a[12], b[12];
    CHECK(hol_inverse_band(inside, HOL_UNIT_DIAGONAL, 0, a));
    CHECK(hol_inverse_band(across, HOL_UNIT_DIAGONAL, 0, b));
    for (int k = 0; k < 12; ++k) CHECK_AT_MOST(fabs(a[k] - b[k]), 1000 * DBL_EPSILON * a[k]); /* coordinates up to 30 */
    hol_inverse_destroy(inside);
    hol_inverse_destroy(across);
    hol_chains_destroy(chains);
    chain_free(&c);
}

static void errors_leave_outputs_untouched(void **state)
{
    (void)state;
    chain c = chain_make(CHAIN_COIL, 4, 2);
    hol_chains *chains = handle_of(&c);
    hol_inverse *inverse = (hol_inverse *)&c, *const x = inverse_of(&c);
    double *out = untouched(16), *lambda = copy_of(c.r, 4);
    CHECK_FAILS(HOL_ERR_NULL, hol_inverse_create(NULL, 0, c.r, &inverse));
    assert_null(inverse);
    CHECK_FAILS(HOL_ERR_NULL, hol_inverse_create(chains, 0, NULL, &inverse));
    CHECK_FAILS(HOL_ERR_NULL, hol_inverse_create(chains, 0, c.r, NULL));
    CHECK_FAILS(HOL_ERR_INDEX, hol_inverse_create(chains, 1, c.r, &inverse));
    CHECK_FAILS(HOL_ERR_INDEX, hol_inverse_create(chains, -1, c.r, &inverse));
    CHECK_FAILS(HOL_ERR_NULL, hol_inverse_create_view(chains, 0, NULL, &inverse));
    CHECK_FAILS(HOL_ERR_NULL, hol_inverse_entry(NULL, 0, 0, 0, out));
    CHECK_FAILS(HOL_ERR_NULL, hol_inverse_entry(x, 0, 0, 0, NULL));
    CHECK_FAILS(HOL_ERR_VALUE, hol_inverse_entry(x, 2, 0, 0, out));
    CHECK_FAILS(HOL_ERR_INDEX, hol_inverse_entry(x, 0, 4, 0, out));
    CHECK_FAILS(HOL_ERR_INDEX, hol_inverse_entry(x, 0, 0, -1, out));
    CHECK_FAILS(HOL_ERR_NULL, hol_inverse_row(NULL, 0, 0, out));
    CHECK_FAILS(HOL_ERR_NULL, hol_inverse_row(x, 0, 0, NULL));
    CHECK_FAILS(HOL_ERR_VALUE, hol_inverse_row(x, -1, 0, out));
    CHECK_FAILS(HOL_ERR_INDEX, hol_inverse_row(x, 0, INT64_MIN, out));
    CHECK_FAILS(HOL_ERR_NULL, hol_inverse_band(NULL, 0, 0, out));
    CHECK_FAILS(HOL_ERR_NULL, hol_inverse_band(x, 0, 0, NULL));
    CHECK_FAILS(HOL_ERR_VALUE, hol_inverse_band(x, 0, -1, out));
    CHECK_FAILS(HOL_ERR_VALUE, hol_inverse_band(x, 7, 0, out));
    CHECK_FAILS(HOL_ERR_NULL, hol_inverse_matrix(NULL, 0, out));
    CHECK_FAILS(HOL_ERR_NULL, hol_inverse_matrix(x, 0, NULL));
    CHECK_FAILS(HOL_ERR_VALUE, hol_inverse_matrix(x, 3, out));
    CHECK_FAILS(HOL_ERR_NULL, hol_inverse_condition(NULL, out));
    CHECK_FAILS(HOL_ERR_NULL, hol_inverse_condition(x, NULL));
    CHECK_FAILS(HOL_ERR_NULL, hol_inverse_error_bound(NULL, c.v, c.f, lambda, out, out + 4));
    CHECK_FAILS(HOL_ERR_NULL, hol_inverse_error_bound(x, c.v, c.f, NULL, out, out + 4));
    lambda[2] = NAN;
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_inverse_error_bound(x, c.v, c.f, lambda, out, out + 4));
    lambda[2] = 0;
    c.f[4] = INFINITY;
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_inverse_error_bound(x, c.v, c.f, lambda, out, out + 4));
    assert_message_names("atom 1");
    c.r[7] = NAN;
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_inverse_create(chains, 0, c.r, &inverse));
    assert_null(inverse);
    memcpy(c.r + 6, c.r + 3, 3 * sizeof(double));
    CHECK_FAILS(HOL_ERR_DEGENERATE, hol_inverse_create(chains, 0, c.r, &inverse));
    assert_message_names("bond 1");
    assert_untouched(out, 16);
    assert_int_equal(hol_inverse_n_bonds(NULL), 0);
    hol_inverse_destroy(NULL);
    hol_inverse_destroy(x);
    hol_chains_destroy(chains);
    free(out), free(lambda);
    chain_free(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(views_and_index_base_give_the_same),
        cmocka_unit_test(box_is_applied),
        cmocka_unit_test(errors_leave_outputs_untouched),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
