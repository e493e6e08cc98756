/* Velocities where the box changes and the atoms with it: d.(v_rel + L d) = 0 for each bond, L the rate of the box. */
#include <math.h>
#include <string.h>

#include "check.h"

static double dot(const double *a, const double *b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* y = L x */
static void turn(const double L[3][3], const double *x, double *y)
{
    for (int i = 0; i < 3; ++i) y[i] = dot(L[i], x);
}

int main(void)
{
    const double mass[3] = {1, 2, 3}, length[2] = {1, 1}, box[9] = {10, 0, 0, 0, 10, 0, 0, 0, 10};
    const double L[3][3] = {{0.01, 0.2, 0}, {0, 0.02, 0}, {0, 0, -0.01}}; /* shear along x, and a barostat */
    const double r[3][3] = {{9.6, 5, 5}, {0.2, 5.8, 5}, {0.2, 6.4, 5.8}}; /* the first bond crosses a face */
    const double before[3][3] = {{0.3, -0.2, 0.5}, {-1, 0.4, 0.1}, {0.2, 0.9, -0.7}};
    double v[3][3], rhs[2], g[3][3], d[2][3], turned[3], whole[3][3], shifted[3][3];
    hol_chains *chains = NULL, *free_chains = NULL;

    memcpy(v, before, sizeof v);
    ok(hol_chains_create(3, mass, &chains));
    ok(hol_chains_add_block(chains, 1, 2, 0, length));
    ok(hol_chains_set_box(chains, box));

    /* Any layout and box: the rates as right-hand sides, with images as the box has them. */
    for (int k = 0; k < 2; ++k) {
        double wanted[3];
        for (int c = 0; c < 3; ++c) {
            d[k][c] = r[k + 1][c] - r[k][c];
            d[k][c] -= 10 * round(d[k][c] / 10);
        }
        turn(L, d[k], turned);
        for (int c = 0; c < 3; ++c) wanted[c] = v[k + 1][c] - v[k][c] + turned[c];
        rhs[k] = 2 * dot(d[k], wanted);
    }
    ok(hol_solve(chains, r[0], rhs, NULL, g[0], HOL_WRITE, NULL)); /* g: the impulses, m dv */
    for (int i = 0; i < 3; ++i)
        for (int c = 0; c < 3; ++c) v[i][c] += g[i][c] / mass[i];
    for (int k = 0; k < 2; ++k) {
        double relative[3];
        turn(L, d[k], turned);
        for (int c = 0; c < 3; ++c) relative[c] = v[k + 1][c] - v[k][c] + turned[c];
        shows("rate of a bond", 1 + dot(d[k], relative), 1);
    }
    for (int c = 0; c < 3; ++c) {
        double momentum = 1;
        for (int i = 0; i < 3; ++i) momentum += mass[i] * (v[i][c] - before[i][c]);
        shows("change of the momentum", momentum, 1);
    }

    /* Whole molecules: the motion v + L (r - r_0), projected as it is. */
    memcpy(whole[0], r[0], sizeof r[0]);
    for (int i = 1; i < 3; ++i)
        for (int c = 0; c < 3; ++c) whole[i][c] = whole[i - 1][c] + d[i - 1][c];
    for (int i = 0; i < 3; ++i) {
        double from_first[3];
        for (int c = 0; c < 3; ++c) from_first[c] = whole[i][c] - whole[0][c];
        turn(L, from_first, turned);
        for (int c = 0; c < 3; ++c) shifted[i][c] = before[i][c] + turned[c];
    }
    memcpy(g, shifted, sizeof g);
    ok(hol_chains_create(3, mass, &free_chains));
    ok(hol_chains_add_block(free_chains, 1, 2, 0, length));
    ok(hol_project_velocities(free_chains, whole[0], shifted[0], NULL, NULL));
    for (int i = 0; i < 3; ++i)
        for (int c = 0; c < 3; ++c) shows("the same velocity", before[i][c] + shifted[i][c] - g[i][c], v[i][c]);
    hol_chains_destroy(free_chains);
    hol_chains_destroy(chains);
    return 0;
}
