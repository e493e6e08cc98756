/* Velocities where the box changes and the atoms with it: d.(v_j - v_i + L d) = 0 for each bond, L the rate of the box.
 */
#include <math.h>
#include <string.h>

#include "check.h"

/* d.(v_j - v_i + L d) */
static double rate(const double L[3][3], const double *d, const double *vi, const double *vj)
{
    double sum = 0;
    for (int a = 0; a < 3; ++a) sum += d[a] * (vj[a] - vi[a] + L[a][0] * d[0] + L[a][1] * d[1] + L[a][2] * d[2]);
    return sum;
}

int main(void)
{
    const double mass[3] = {1, 2, 3}, length[2] = {1, 1}, box[9] = {10, 0, 0, 0, 10, 0, 0, 0, 10};
    const double L[3][3] = {{0.01, 0.2, 0}, {0, 0.02, 0}, {0, 0, -0.01}}; /* shear along x, and a barostat */
    const double r[3][3] = {{9.6, 5, 5}, {0.2, 5.8, 5}, {0.2, 6.4, 5.8}}; /* the first bond crosses a face */
    const double before[3][3] = {{0.3, -0.2, 0.5}, {-1, 0.4, 0.1}, {0.2, 0.9, -0.7}};
    double v[3][3], d[2][3], rhs[2], g[3][3];
    hol_worst worst;
    hol_chains *chains = NULL;

    memcpy(v, before, sizeof v);
    ok(hol_chains_create(3, mass, &chains));
    ok(hol_chains_add_block(chains, 1, 2, 0, length));
    ok(hol_chains_set_box(chains, box));
    ok(hol_chains_set_box_rate(chains, L[0])); /* before each call, as the barostat goes */
    ok(hol_project_velocities(chains, r[0], v[0], NULL, NULL));
    for (int k = 0; k < 2; ++k) {
        for (int c = 0; c < 3; ++c) {
            d[k][c] = r[k + 1][c] - r[k][c];
            d[k][c] -= 10 * round(d[k][c] / 10);
        }
        shows("1 + rate of a bond", 1 + rate(L, d[k], v[k], v[k + 1]), 1);
    }
    ok(hol_violation(chains, r[0], v[0], &worst));
    shows("1 + largest rate", 1 + worst.rate, 1);
    for (int c = 0; c < 3; ++c) {
        double momentum = 1;
        for (int i = 0; i < 3; ++i) momentum += mass[i] * (v[i][c] - before[i][c]);
        shows("1 + change of momentum", momentum, 1);
    }

    /* Any other rates that bonds shall have: the right-hand sides are what is to be taken away from them, twice. */
    for (int k = 0; k < 2; ++k) rhs[k] = 2 * rate(L, d[k], before[k], before[k + 1]);
    ok(hol_solve(chains, r[0], rhs, NULL, g[0], HOL_WRITE, NULL)); /* g: the impulses, m dv */
    for (int i = 0; i < 3; ++i)
        for (int c = 0; c < 3; ++c) shows("the same velocity", before[i][c] + g[i][c] / mass[i], v[i][c]);
    hol_chains_destroy(chains);
    return 0;
}
