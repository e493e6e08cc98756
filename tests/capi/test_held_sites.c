/* hol_chains_held_sites: a massless atom in no body holds in space what it is bonded to, and is named where that is
 * rigid; anchors of chains, and atoms that are held on purpose, are not. */
#include "check.h"

static const double oh = 0.9572, hh = 1.5139, om = 0.1546;

static void expect(const hol_chains *chains, int n, const unsigned char *wanted)
{
    unsigned char held[16];
    memset(held, 7, sizeof held);
    CHECK(hol_chains_held_sites(chains, held));
    for (int i = 0; i < n; ++i)
        if (held[i] != wanted[i]) fail_msg("atom %d: %d", i, held[i]);
    assert_int_equal(held[n], 7);
}

static void a_site_that_is_bonded_to_a_rigid_molecule(void **state)
{
    (void)state;
    const double masses[12] = {16, 1, 1, 0, 16, 1, 1, 0, 16, 1, 1, 0}, hm = 0.8731;
    const unsigned char sites[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    const int64_t pairs[4][12] = {{0, 1, 0, 2, 1, 2, 0, 3},
                                  {0, 1, 0, 2, 1, 2, 0, 3, 1, 3},
                                  {3, 0, 0, 1, 2, 0, 2, 1, 1, 3, 2, 3},
                                  {0, 1, 0, 2, 0, 3, 1, 3}}; /* the site closes the only triangle */
    const double lengths[4][6] = {{oh, oh, hh, om}, {oh, oh, hh, om, hm}, {om, oh, oh, hh, hm, hm}, {oh, oh, om, hm}};
    const int n_bonds[4] = {4, 5, 6, 4};
    for (int k = 0; k < 4; ++k) {
        hol_chains *chains;
        CHECK(hol_chains_create(12, masses, &chains));
        CHECK(hol_chains_add_molecules(chains, 3, 4, 0, n_bonds[k], pairs[k], lengths[k]));
        expect(chains, 12, sites);
        hol_chains_destroy(chains);
    }
}

static void a_site_that_is_bonded_to_a_body(void **state)
{
    (void)state;
    const double masses[5] = {16, 1, 1, 0, 0};
    const double places[4][3] = {{0, 0, 0}, {0.6, 0.8, 0}, {0.6, -0.8, 0}, {0.1, 0, 0}};
    const int64_t three = 3, four = 4, atoms[4] = {0, 1, 2, 3}, bond[2] = {4, 1};
    const unsigned char of_body[5] = {0}, tied[5] = {0, 0, 0, 0, 1};
    hol_chains *chains;
    CHECK(hol_chains_create(5, masses, &chains));
    CHECK(hol_chains_add_rigid(chains, 1, &four, atoms, places[0], 0, NULL, NULL));
    expect(chains, 5, of_body);
    hol_chains_destroy(chains);
    CHECK(hol_chains_create(5, masses, &chains));
    CHECK(hol_chains_add_rigid(chains, 1, &three, atoms, places[0], 1, bond, &oh));
    expect(chains, 5, tied);
    hol_chains_destroy(chains);
}

static void anchors_and_what_is_held_on_purpose(void **state)
{
    (void)state;
    const double masses[6] = {0, 1, 1, 1, 0, 0}, held[4] = {16, 1, 1, INFINITY}, all[3] = {0};
    const int64_t chain[10] = {0, 1, 1, 2, 2, 3, 3, 4, 4, 5}, water[8] = {0, 1, 0, 2, 1, 2, 0, 3};
    const double ones[5] = {1, 1, 1, 1, 1}, lengths[4] = {oh, oh, hh, om};
    const unsigned char none[6] = {0};
    hol_chains *chains;
    CHECK(hol_chains_create(6, masses, &chains));
    expect(chains, 6, none);
    CHECK(hol_chains_add_bonds(chains, 5, chain, ones));
    expect(chains, 6, none);
    hol_chains_destroy(chains);
    CHECK(hol_chains_create(4, held, &chains));
    CHECK(hol_chains_add_bonds(chains, 4, water, lengths));
    expect(chains, 4, none);
    hol_chains_destroy(chains);
    CHECK(hol_chains_create(3, all, &chains)); /* a triangle of fixed atoms is no molecule */
    CHECK(hol_chains_add_bonds(chains, 3, water, lengths));
    expect(chains, 3, none);
    hol_chains_destroy(chains);
    assert_int_equal(hol_chains_held_sites(NULL, (unsigned char[1]){0}), HOL_ERR_NULL);
}

/* One atom of mass 0 with thousands of waters, in time that grows as they do; counted from 1. */
static void a_hub(void **state)
{
    (void)state;
    const int n = quick_run() ? 1000 : 20000, n_atoms = 3 * n + 1;
    double *const masses = malloc(sizeof *masses * (size_t)n_atoms), *const lengths =
                                                                         malloc(sizeof *lengths * 4 * (size_t)n);
    int64_t *const pairs = malloc(sizeof *pairs * 8 * (size_t)n);
    unsigned char *const held = malloc((size_t)n_atoms);
    for (int m = 0; m < n; ++m) {
        const int64_t o = 2 + 3 * m, four[8] = {o, o + 1, o, o + 2, o + 1, o + 2, 1, o};
        memcpy(pairs + 8 * m, four, sizeof four);
        memcpy(lengths + 4 * m, (double[4]){oh, oh, hh, om}, 4 * sizeof *lengths);
    }
    for (int i = 0; i < n_atoms; ++i) masses[i] = i > 0;
    hol_chains *chains;
    CHECK(hol_chains_create(n_atoms, masses, &chains));
    CHECK(hol_chains_set_index_base(chains, 1));
    CHECK(hol_chains_add_bonds(chains, 4 * n, pairs, lengths));
    CHECK(hol_chains_held_sites(chains, held));
    for (int i = 0; i < n_atoms; ++i) assert_int_equal(held[i], i == 0);
    hol_chains_destroy(chains);
    free(masses), free(lengths), free(pairs), free(held);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_site_that_is_bonded_to_a_rigid_molecule),
        cmocka_unit_test(a_site_that_is_bonded_to_a_body),
        cmocka_unit_test(anchors_and_what_is_held_on_purpose),
        cmocka_unit_test(a_hub),
    };
    return cmocka_run_group_tests_name("held_sites", tests, NULL, NULL);
}
