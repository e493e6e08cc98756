/* A bond across the border of a periodic box that a barostat has just made larger; and one that is longer than half the
 * box, whose image is told. */
#include "check.h"

int main(void)
{
    const double mass[2] = {1, 1}, length = 1;
    const double before[3][3] = {{10, 0, 0}, {0, 10, 0}, {0, 0, 10}},
                 after[3][3] = {{11, 0, 0}, {0, 11, 0}, {0, 0, 11}};
    const double r_ref[2][3] = {{9.5, 5, 5}, {0.5, 5, 5}}; /* one length apart in the old box */
    double r[2][3] = {{10.45, 5.5, 5.5}, {0.55, 5.5, 5.5}};
    hol_chains *chains = NULL;

    ok(hol_chains_create(2, mass, &chains));
    ok(hol_chains_add_block(chains, 1, 1, 0, &length));
    ok(hol_chains_set_box(chains, after[0]));
    ok(hol_chains_set_reference_box(chains, before[0])); /* of r_ref */
    ok(hol_project_positions(chains, r_ref[0], r[0], NULL, 1.0, NULL, 0, NULL, NULL));
    shows("distance", r[1][0] + 11 - r[0][0], 1);
    hol_chains_destroy(chains);

    const int64_t pair[2] = {0, 1}, image[3] = {1, 0, 0}; /* atom 1 is one box vector further on */
    const double wide = 7, x[2][3] = {{9, 5, 5}, {5, 5, 5}}, f[2][3] = {{-2, 0, 0}, {2, 0, 0}};
    int64_t told[3];
    double tension;
    ok(hol_chains_create(2, mass, &chains));
    ok(hol_chains_set_box(chains, after[0]));
    ok(hol_chains_add_bonds_with_images(chains, 1, pair, &wide, image));
    ok(hol_forces(chains, x[0], NULL, f[0], NULL, &tension, NULL, HOL_WRITE, NULL));
    shows("tension", tension, 2);
    ok(hol_chains_set_images(chains, image)); /* again, once atoms have been put back into the box */
    ok(hol_chains_images(chains, told));
    shows("its image", (double)told[0], 1);
    hol_chains_destroy(chains);
    return 0;
}
