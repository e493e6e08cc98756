/** The caller's numbers of atoms and molecules, in messages. */
#include "check.h"
#include "from_one.h"
#include "mixture.h"

static void messages_show_the_labels_of_atoms_and_molecules(void **state)
{
    (void)state;
    mixture m = mixture_of_kind(MOLECULE_COMB, 5, 3, 4, ONE_AFTER_THE_OTHER, 1);
    int64_t *atoms = malloc(8 * (size_t)m.n_atoms), molecules[5] = {-7, 50, INT64_MAX, INT64_MIN, 0};
    double *v = copy_of(m.v, mixture_size(&m));
    char text[200];
    for (int64_t i = 0; i < m.n_atoms; ++i) atoms[i] = 90000 + 7 * i;
    const int64_t first = m.first_atom[2], bad = first + 3;
    hol_chains *const counted[2] = {m.chains, from_one(m.chains)};
    for (int base = 0; base < 2; ++base) {
        int64_t number, atom;
        v[3 * bad] = NAN;
        m.chains = counted[base];
        CHECK(hol_chains_set_labels(m.chains, atoms, molecules));
        CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_project_velocities(m.chains, m.r, v, NULL, NULL));
        snprintf(text, sizeof text, "molecule %d (label %lld): the velocity of atom %lld (label %lld) is", 2 + base,
                 (long long)INT64_MAX, (long long)bad + base, (long long)atoms[bad]);
        assert_message_names(text);
        hol_error_location(&number, NULL, &atom, NULL);
        assert_true(number == 2 + base && atom == bad + base);
        CHECK(hol_chains_set_labels(m.chains, atoms, NULL));
        CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_project_velocities(m.chains, m.r, v, NULL, NULL));
        snprintf(text, sizeof text, "molecule %d (with atom %lld (label %lld)): the", 2 + base, (long long)first + base,
                 (long long)atoms[first]);
        assert_message_names(text);
        CHECK(hol_chains_set_labels(m.chains, NULL, NULL));
        CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_project_velocities(m.chains, m.r, v, NULL, NULL));
        snprintf(text, sizeof text, "molecule %d: the velocity of atom %lld is", 2 + base, (long long)bad + base);
        assert_message_names(text);
        v[3 * bad] = 1;
    }
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_set_labels(NULL, atoms, NULL));
    m.chains = counted[0];
    hol_chains_destroy(counted[1]);
    free(atoms), free(v);
    mixture_free(&m);
}

static void a_bond_is_shown_by_the_labels_of_its_atoms(void **state)
{
    (void)state;
    const double mass[4] = {0, 1, 1, 0}, length[3] = {1, 1, 1};
    const int64_t labels[4] = {11, 12, 13, 14}, pairs[6] = {0, 1, 1, 2, 2, 3}, twice[4] = {1, 2, 2, 1};
    double r[12] = {0, 0, 0, 1, 0, 0, 1, 0, 0, 2, 0, 0}, g[12];
    hol_chains *chains = NULL, *other = NULL;
    CHECK(hol_chains_create(4, mass, &chains));
    CHECK(hol_chains_set_labels(chains, labels, NULL));
    CHECK_FAILS(HOL_ERR_DEGENERATE, hol_chains_add_bonds(chains, 2, twice, length));
    assert_message_names("(label 13)");
    CHECK(hol_chains_add_bonds(chains, 3, pairs, length));
    CHECK_FAILS(HOL_ERR_SHARED_ATOM, hol_chains_add_bonds(chains, 1, pairs + 2, length));
    assert_message_names("atom 1 (label 12)");
    CHECK_FAILS(HOL_ERR_SHARED_ATOM, hol_chains_add(chains, 1, pairs + 2, length));
    assert_message_names("atom 1 (label 12)");
    CHECK_FAILS(HOL_ERR_DEGENERATE, hol_forces(chains, r, NULL, NULL, NULL, NULL, g, HOL_WRITE, NULL));
    assert_message_names("atoms 1 (label 12) and 2 (label 13)");
    for (int i = 0; i < 12; ++i) r[i] = i % 3 == 0 ? i / 3 : 0; /* taut between the fixed ends */
    CHECK_FAILS(HOL_ERR_DEGENERATE, hol_forces(chains, r, NULL, NULL, NULL, NULL, g, HOL_WRITE, NULL));
    assert_message_names("(label 14)");
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_set_masses(chains, r + 1));
    assert_message_names("(label 12)");
    hol_chains_destroy(chains);

    /* molecules that are added later have no label of their own */
    const double free_mass[4] = {1, 1, 1, 1};
    const int64_t five[1] = {5};
    double v[12] = {0};
    CHECK(hol_chains_create(4, free_mass, &other));
    CHECK(hol_chains_add_block(other, 1, 1, 0, length));
    CHECK(hol_chains_set_labels(other, NULL, five));
    CHECK(hol_chains_add_block(other, 1, 1, 2, length));
    v[0] = INFINITY;
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_project_velocities(other, r, v, NULL, NULL));
    assert_message_names("molecule 0 (label 5): the velocity of atom 0 is");
    v[0] = 0, v[6] = NAN;
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_project_velocities(other, r, v, NULL, NULL));
    assert_message_names("molecule 1: the velocity of atom 2 is");
    hol_chains_destroy(other);
}

static void labels_change_no_result(void **state)
{
    (void)state;
    mixture m = mixture_of_all(1, MIXED, 2);
    const size_t size = mixture_size(&m);
    int64_t *atoms = calloc((size_t)m.n_atoms, 8);
    double *g = untouched(size), *h = untouched(size);
    const int64_t bytes = hol_chains_memory(m.chains);
    CHECK(hol_forces(m.chains, m.r, m.v, m.f, NULL, NULL, g, HOL_WRITE, NULL));
    CHECK(hol_chains_set_labels(m.chains, atoms, NULL));
    CHECK(hol_forces(m.chains, m.r, m.v, m.f, NULL, NULL, h, HOL_WRITE, NULL));
    assert_same_bits(g, h, size);
    assert_true(hol_chains_memory(m.chains) >= bytes + 8 * m.n_atoms);
    free(atoms), free(g), free(h);
    mixture_free(&m);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(messages_show_the_labels_of_atoms_and_molecules),
        cmocka_unit_test(a_bond_is_shown_by_the_labels_of_its_atoms),
        cmocka_unit_test(labels_change_no_result),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
