/* Options of a handle; each may be set again before any call. */
#include "check.h"

int main(void)
{
    const double mass[4] = {1, 1, 1, 1}, length = 1;
    const int64_t atoms[2] = {1, 2};
    const unsigned char active[2] = {1, 0};
    int64_t found[2];
    hol_chains *chains = NULL;

    ok(hol_chains_create(4, mass, &chains));
    ok(hol_chains_set_index_base(chains, 1)); /* as Fortran counts */
    ok(hol_chains_add(chains, 1, atoms, &length));
    ok(hol_chains_add_block(chains, 1, 1, 3, &length));
    ok(hol_chains_atoms(chains, 2, found));
    shows("first atom of chain 2", (double)found[0], 3);

    ok(hol_chains_set_threads(chains, 2));
    ok(hol_chains_set_tolerance(chains, 1e-10)); /* of hol_project_positions; 0: the rounding of the coordinates */
    ok(hol_chains_set_max_iterations(chains, 20));
    ok(hol_chains_set_memory_limit(chains, 1 << 30)); /* what cycles may fill; 0: a quarter of the machine's */
    ok(hol_chains_set_active(chains, active));        /* the second chain is left out of every call */
    shows("threads", hol_chains_threads(chains), 2);  /* each option tells what it is */
    shows("tolerance", hol_chains_tolerance(chains), 1e-10);
    shows("tolerance of lengths", hol_chains_length_tolerance(chains), 1e-3);
    shows("iterations", hol_chains_max_iterations(chains), 20);
    shows("memory", (double)hol_chains_memory_limit(chains), 1 << 30);
    shows("index base", hol_chains_index_base(chains), 1);
    shows("checks", hol_chains_checks(chains), HOL_AT_START);
    shows("bodies", hol_chains_bodies(chains), HOL_BODIES_FOUND);
    shows("outcomes", hol_chains_outcomes(chains), 0);
    unsigned char is_active[2];
    int64_t labels[4];
    double rate[9];
    ok(hol_chains_active(chains, is_active));
    shows("second chain", is_active[1], 0);
    ok(hol_chains_labels(chains, labels, NULL));
    shows("label of the first atom", (double)labels[0], 1);
    ok(hol_chains_box_rate(chains, rate));
    shows("rate of the box", rate[0], 0);
    shows("degrees of freedom", (double)hol_chains_degrees_of_freedom(chains, 3), 3 * 4 - 1);
    ok(hol_chains_set_active(chains, NULL));

    /* A replica with a box and a length of its own; what is known of the molecules is shared. */
    const double cube[9] = {9, 0, 0, 0, 9, 0, 0, 0, 9};
    double lengths[2], masses[4], box[9];
    int64_t pairs[4], removed[2];
    int roles[2];
    hol_chains *replica = NULL;
    ok(hol_chains_copy(chains, &replica));
    ok(hol_chains_set_box(replica, cube));
    ok(hol_chains_set_length(replica, 2, 1.5));
    ok(hol_chains_set_bodies(replica,
                             HOL_BODIES_GIVEN)); /* distances that depend on each other are refused from here */
    ok(hol_chains_lengths(replica, lengths));
    shows("second length", lengths[1], 1.5);
    ok(hol_chains_masses(replica, masses));
    shows("first mass", masses[0], 1);
    ok(hol_chains_box(replica, HOL_BOX, box));
    shows("side", box[0], 9);
    ok(hol_chains_pairs(replica, pairs));
    shows("first atom of the second bond", (double)pairs[2], 3);
    ok(hol_chains_roles(replica, roles, removed));
    shows("role", roles[0], HOL_ROLE_OWN);
    shows("freedoms removed", (double)removed[1], 1);
    hol_chains_destroy(replica);

    /* A massless atom in no body holds in space what it is bonded to: hardly meant of a site. */
    const double with_site[4] = {16, 1, 1, 0}, water[4] = {1, 1, 1.6, 0.15};
    const int64_t joined[8] = {0, 1, 0, 2, 1, 2, 0, 3};
    unsigned char held[4];
    hol_chains *nailed = NULL;
    ok(hol_chains_create(4, with_site, &nailed));
    ok(hol_chains_add_bonds(nailed, 4, joined, water));
    ok(hol_chains_held_sites(nailed, held));
    shows("a site that holds its water in space", held[3], 1);
    hol_chains_destroy(nailed);
    shows("version", hol_version_number() >= HOL_VERSION, 1);
    hol_chains_destroy(chains);
    return 0;
}
