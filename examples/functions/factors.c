/* Factors that are kept: one elimination for several right-hand sides. */
#include "check.h"

int main(void)
{
    const double mass[3] = {1, 1, 1}, length[2] = {1, 1};
    const double r[9] = {0, 0, 0, 1, 0, 0, 2, 0, 0}, pull[9] = {-3, 0, 0, 0, 0, 0, 3, 0, 0}, rhs[4] = {4, 0, 0, 4};
    const hol_const_view at = hol_const_view_rows(r), f = hol_const_view_rows(pull);
    double tension[2], g[9], lambda[4], forces[18];
    const hol_view to = hol_view_rows(g), each[2] = {hol_view_rows(forces), hol_view_rows(forces + 9)};
    hol_chains *chains = NULL;
    hol_factors *factors = NULL;

    ok(hol_chains_create(3, mass, &chains));
    ok(hol_chains_add_block(chains, 1, 2, 0, length));
    ok(hol_factors_create(chains, &factors));
    ok(hol_factors_update(factors, r)); /* at these positions; the rest may follow any number of times */
    ok(hol_factors_forces(factors, NULL, pull, NULL, tension, g, HOL_WRITE, NULL));
    shows("tension", tension[0], 3);
    ok(hol_factors_solve(factors, 2, rhs, lambda, NULL, HOL_WRITE, NULL)); /* Z is 8 on its diagonal and -4 beside it */
    shows("first solution", lambda[0], 2.0 / 3);
    shows("second solution", lambda[3], 2.0 / 3);
    ok(hol_factors_update_view(factors, &at));
    ok(hol_factors_forces_view(factors, NULL, &f, NULL, NULL, &to, HOL_WRITE, NULL));
    shows("force on the first atom", g[0], 3);
    ok(hol_factors_solve_view(factors, 2, rhs, lambda, each, HOL_WRITE, NULL));
    shows("again", lambda[0], 2.0 / 3);
    hol_factors_destroy(factors);
    hol_chains_destroy(chains);
    /* A binding's own refusal, so that nothing of an earlier failure is told. */
    shows("status", hol_error_remember(HOL_ERR_VALUE, "the binding refuses this"), HOL_ERR_VALUE);
    return 0;
}
