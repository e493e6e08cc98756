/* Any list of bonds: the library finds the molecules, here a tripod around atom 2 and a triangle. */
#include "check.h"

int main(void)
{
    const double mass[7] = {1, 1, 12, 1, 16, 1, 1}, length[6] = {1, 1, 1, 1, 1, 1.6};
    const int64_t pairs[6][2] = {{4, 5}, {2, 0}, {1, 2}, {3, 2}, {6, 4}, {5, 6}};
    int64_t molecule_of[6], n_atoms, n_bonds, bonds[3];
    int shape;
    hol_chains *chains = NULL;

    ok(hol_chains_create(7, mass, &chains));
    ok(hol_chains_add_bonds(chains, 6, pairs[0], length));

    shows("molecules", (double)hol_chains_n_molecules(chains), 2);
    shows("trees", (double)hol_chains_n_of_shape(chains, HOL_SHAPE_TREE), 1);
    shows("kinds", (double)hol_chains_n_kinds(chains), 2);
    ok(hol_chains_molecules_of_bonds(chains, molecule_of));
    shows("molecule of bond 0", (double)molecule_of[0], 1); /* numbered by their lowest atoms */
    ok(hol_chains_molecule(chains, 1, &shape, &n_atoms, &n_bonds));
    shows("a triangle", shape, HOL_SHAPE_TRIANGLE);
    shows("its bonds", (double)n_bonds, 3);
    ok(hol_chains_bonds(chains, 1, bonds)); /* 4-5, 4-6, 5-6: where they stand in the list */
    shows("its last bond", (double)bonds[2], 5);
    hol_chains_destroy(chains);
    return 0;
}
