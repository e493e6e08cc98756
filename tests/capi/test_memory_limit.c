/**
 * The bound on memory: what would take more is refused at once, nothing is changed, and more is allowed by a larger
 * one.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"

/** Bonds between neighbours of a cubic lattice of n^3 atoms, but every fifth. */
static int64_t lattice(int64_t n, int64_t *pairs)
{
    int64_t count = 0, seen = 0;
    for (int64_t i = 0; i < n * n * n; ++i) {
        const int64_t at[3] = {i % n, i / n % n, i / (n * n)}, step[3] = {1, n, n * n};
        for (int c = 0; c < 3; ++c)
            if (at[c] + 1 < n && seen++ % 5 != 0) {
                pairs[2 * count] = i;
                pairs[2 * count++ + 1] = i + step[c];
            }
    }
    return count;
}

typedef struct {
    hol_chains *chains;
    int64_t n_bonds, *pairs;
    double *lengths;
} scene;

/** A lattice, and two atoms beside it. */
static scene make(int64_t n)
{
    const int64_t n_atoms = n * n * n + 2;
    scene s = {NULL, 0, malloc(6 * (size_t)n_atoms * sizeof(int64_t)), malloc(3 * (size_t)n_atoms * sizeof(double))};
    s.n_bonds = lattice(n, s.pairs);
    for (int64_t k = 0; k < 3 * n_atoms; ++k) s.lengths[k] = 1;
    CHECK(hol_chains_create(n_atoms, s.lengths, &s.chains));
    return s;
}
static void destroy(scene s)
{
    hol_chains_destroy(s.chains);
    free(s.pairs), free(s.lengths);
}

static void what_takes_more_is_refused_and_nothing_is_changed(void **state)
{
    (void)state;
    scene s = make(8);
    const int64_t pair[2] = {512, 513}, before = hol_chains_memory(s.chains), limit = before + 150000;
    char number[32];
    CHECK(hol_chains_set_memory_limit(s.chains, limit));
    CHECK_FAILS(HOL_ERR_MEMORY, hol_chains_add_bonds(s.chains, s.n_bonds, s.pairs, s.lengths));
    snprintf(number, sizeof number, "%lld", (long long)limit);
    assert_message_names(number);
    assert_message_names("hol_chains_set_memory_limit");
    assert_message_names("atom 0");
    assert_int_equal(hol_chains_n_bonds(s.chains), 0);
    assert_int_equal(hol_chains_n_molecules(s.chains), 0);
    CHECK(hol_chains_add_bonds(s.chains, 1, pair, s.lengths)); /* what is small has room */
    CHECK(hol_chains_set_memory_limit(s.chains, 0));
    CHECK(hol_chains_add_bonds(s.chains, s.n_bonds, s.pairs, s.lengths));
    assert_int_equal(hol_chains_n_bonds(s.chains), s.n_bonds + 1);
    destroy(s);
}

static void a_molecule_that_fits_does_not_exceed_the_limit(void **state)
{
    (void)state;
    for (int64_t limit = 100000; limit < 100000000; limit *= 2) {
        scene s = make(8);
        CHECK(hol_chains_set_memory_limit(s.chains, limit));
        const int status = hol_chains_add_bonds(s.chains, s.n_bonds, s.pairs, s.lengths);
        assert_true(status == HOL_OK || status == HOL_ERR_MEMORY);
        if (status == HOL_OK) assert_true(hol_chains_memory(s.chains) <= limit);
        destroy(s);
    }
}

/** The elimination of a lattice of 8000 atoms fills gigabytes. */
static void a_large_lattice_is_counted_before_it_is_stored(void **state)
{
    (void)state;
    scene s = make(20);
    CHECK(hol_chains_set_memory_limit(s.chains, 50000000));
    const int status = hol_chains_add_bonds(s.chains, s.n_bonds, s.pairs, s.lengths);
    assert_true(status == HOL_OK ? hol_chains_memory(s.chains) <= 50000000 : status == HOL_ERR_MEMORY);
    destroy(s);
}

static void every_way_of_adding_has_the_limit(void **state)
{
    (void)state;
    enum { n = 20000 };
    double *masses = malloc(n * sizeof *masses);
    int64_t *atoms = malloc(n * sizeof *atoms);
    for (int64_t i = 0; i < n; ++i) masses[i] = 1, atoms[i] = i;
    hol_chains *c = NULL;
    CHECK(hol_chains_create(n, masses, &c));
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_memory_limit(c, -1));
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_set_memory_limit(NULL, 5));
    CHECK(hol_chains_set_memory_limit(c, 200000));
    CHECK_FAILS(HOL_ERR_MEMORY, hol_chains_add(c, n - 1, atoms, masses));
    CHECK_FAILS(HOL_ERR_MEMORY, hol_chains_add_block(c, 100, n / 100 - 1, 0, masses));
    CHECK_FAILS(HOL_ERR_MEMORY, hol_chains_add_bonds(c, n / 2, atoms, masses));
    CHECK_FAILS(HOL_ERR_MEMORY, hol_chains_add_molecules(c, n / 2, 2, 0, 1, atoms, masses));
    assert_int_equal(hol_chains_n_bonds(c), 0);
    hol_chains_destroy(c);
    free(masses), free(atoms);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_takes_more_is_refused_and_nothing_is_changed),
        cmocka_unit_test(a_molecule_that_fits_does_not_exceed_the_limit),
        cmocka_unit_test(a_large_lattice_is_counted_before_it_is_stored),
        cmocka_unit_test(every_way_of_adding_has_the_limit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
