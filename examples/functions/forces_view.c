/* The same for arrays as a program has them: x, y, z apart in single precision, and two dimensions (no z). */
#include "check.h"

int main(void)
{
    const double mass[3] = {0, 1, 1}, length[2] = {1, 1};
    float x[3] = {0, 1, 2}, y[3] = {0, 0, 0}, vx[3] = {0, 0, 0}, vy[3] = {0, 1, 2};
    const hol_const_view r = {x, y, NULL, sizeof(float), HOL_FLOAT, 0}, v = {vx, vy, NULL, sizeof(float), HOL_FLOAT, 0};
    double tension[2];
    hol_chains *chains = NULL;

    ok(hol_chains_create(3, mass, &chains));
    ok(hol_chains_add_block(chains, 1, 2, 0, length));
    ok(hol_forces_view(chains, &r, &v, NULL, NULL, tension, NULL, HOL_WRITE, NULL));
    shows("inner tension", tension[0], 3);
    hol_chains_destroy(chains);
    return 0;
}
