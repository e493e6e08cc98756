/* Two rigid waters (SPC/E: 0.1 nm, 109.47 degrees) in one call, the third bond in place of the angle. */
#include "check.h"

int main(void)
{
    const double mass[6] = {15.9994, 1.008, 1.008, 15.9994, 1.008, 1.008}, length[3] = {0.1, 0.1, 0.16330};
    const int64_t pairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    hol_chains *water = NULL;

    ok(hol_chains_create(6, mass, &water));
    ok(hol_chains_add_molecules(water, 2, 3, 0, 3, pairs[0], length));
    shows("triangles", (double)hol_chains_n_of_shape(water, HOL_SHAPE_TRIANGLE), 2);
    shows("degrees of freedom", (double)hol_chains_degrees_of_freedom(water, 3), 12);
    hol_chains_destroy(water);
    return 0;
}
