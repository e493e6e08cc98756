/* How far positions and velocities are from the constraints, and where. */
#include "check.h"

int main(void)
{
    const double mass[3] = {1, 1, 1}, length[2] = {1, 1};
    double r[3][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1.5, 0}}, v[3][3] = {{0, 0, 0}, {0.5, 0, 0}, {0.5, 0, 0}};
    const hol_const_view view = hol_const_view_rows(r[0]);
    hol_worst worst;
    hol_chains *chains = NULL;

    ok(hol_chains_create(3, mass, &chains));
    ok(hol_chains_add_block(chains, 1, 2, 0, length));
    ok(hol_violation(chains, r[0], v[0], &worst));
    shows("|d.d - a^2| / a^2", worst.length, 1.25);
    shows("in bond", (double)worst.length_bond, 1);
    shows("|d.(v_j - v_i)|", worst.rate, 0.5);
    shows("in bond", (double)worst.rate_bond, 0);
    ok(hol_violation_view(chains, &view, NULL, &worst));
    shows("without velocities", worst.rate, 0);
    double left[2], rate[2]; /* of each bond */
    ok(hol_residuals(chains, r[0], v[0], left, rate));
    shows("(d.d - a^2) / a^2 of the first", left[0], 0);
    shows("of the second", left[1], 1.25);
    ok(hol_residuals_view(chains, &view, NULL, left, NULL));
    hol_chains_destroy(chains);
    return 0;
}
