/* The position level for programs that keep bond vectors of the beginning of a step, not positions. */
#include "check.h"

int main(void)
{
    const double mass[4] = {1, 1, 1, 1}, length[3] = {1, 1, 1}, dt = 0.1;
    const double before[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 2, 1, 0};
    const int64_t pairs[6] = {0, 1, 2, 1, 2, 3}; /* the second bond is named from its other end */
    double b[9], r[12], r_with_positions[12];
    hol_chains *chains;
    ok(hol_chains_create(4, mass, &chains));
    ok(hol_chains_add_bonds(chains, 3, pairs, length));

    /* From the first atom of each bond to the second. */
    for (int k = 0; k < 3; ++k)
        for (int c = 0; c < 3; ++c) b[3 * k + c] = before[3 * pairs[2 * k + 1] + c] - before[3 * pairs[2 * k] + c];

    for (int i = 0; i < 12; ++i) r[i] = r_with_positions[i] = before[i] + 0.01 * ((i * 7) % 5 - 2);
    ok(hol_project_positions_along(chains, b, r, NULL, dt, NULL, 0, NULL, NULL));
    ok(hol_project_positions(chains, before, r_with_positions, NULL, dt, NULL, 0, NULL, NULL));
    for (int i = 0; i < 12; ++i) shows("coordinate", r[i], r_with_positions[i]);

    /* Separate arrays of x, y and z, as old programs have them. */
    double bx[3], by[3], bz[3];
    for (int k = 0; k < 3; ++k) {
        bx[k] = b[3 * k];
        by[k] = b[3 * k + 1];
        bz[k] = b[3 * k + 2];
    }
    const hol_const_view vectors = hol_const_view_parts(bx, by, bz);
    const hol_view positions = hol_view_rows(r);
    r[3] += 0.01;
    ok(hol_project_positions_along_view(chains, &vectors, &positions, NULL, dt, NULL, 0, NULL, NULL));
    shows("length of a bond",
          sqrt((r[3] - r[0]) * (r[3] - r[0]) + (r[4] - r[1]) * (r[4] - r[1]) + (r[5] - r[2]) * (r[5] - r[2])), 1);
    hol_chains_destroy(chains);
    return 0;
}
