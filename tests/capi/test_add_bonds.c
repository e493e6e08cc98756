/**
 * Molecules from lists of bonds: what is found in them, in whatever order they come; results bit for bit those of
 * chains that were given as chains; new lengths and masses.
 */
#include "assembly.h"
#include "check.h"
#include "random.h"

/* The bonds of an assembly in random order, either atom first. */
typedef struct bond_list {
    int64_t n, *pairs, *from; /* bond k of the list is bond from[k] of the assembly */
    double *lengths;
} bond_list;

static bond_list shuffled(const assembly *a, uint64_t seed)
{
    bond_list list = {a->n_bonds, malloc(16 * (size_t)a->n_bonds), malloc(8 * (size_t)a->n_bonds),
                      malloc(8 * (size_t)a->n_bonds)};
    random_stream stream = random_seed(seed);
    for (int64_t k = 0; k < list.n; ++k) list.from[k] = k;
    for (int64_t k = list.n - 1; k > 0; --k) {
        const int64_t other = random_integer(&stream, 0, k), kept = list.from[k];
        list.from[k] = list.from[other];
        list.from[other] = kept;
    }
    for (int64_t k = 0; k < list.n; ++k) {
        int64_t c = 0;
        while (a->first_bond[c + 1] <= list.from[k]) ++c;
        const int64_t *pair = a->atoms + a->first[c] + list.from[k] - a->first_bond[c];
        const int turned = random_uniform(&stream) < 0.5;
        list.pairs[2 * k] = pair[turned];
        list.pairs[2 * k + 1] = pair[!turned];
        list.lengths[k] = a->length[list.from[k]];
    }
    return list;
}

static void list_free(bond_list *list)
{
    free(list->pairs), free(list->from), free(list->lengths);
}

static hol_chains *of_bonds(const assembly *a, const bond_list *list)
{
    hol_chains *c = NULL;
    CHECK(hol_chains_create(a->n_atoms, a->mass, &c));
    CHECK(hol_chains_add_bonds(c, list->n, list->pairs, list->lengths));
    return c;
}

/* The chains of an assembly, each from its lower end on and in the order of their lowest atoms, as they are found. */
static assembly canonical(int64_t n, int64_t low, int64_t high, arrangement how, uint64_t seed)
{
    assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, n, low, high, how, seed);
    hol_chains *found = NULL;
    int64_t next = 0;
    int64_t *atoms = malloc(8 * (size_t)(a.n_bonds + n));
    bond_list list = shuffled(&a, seed);
    found = of_bonds(&a, &list);
    assert_int_equal(hol_chains_n_molecules(found), n);
    hol_chains_destroy(a.chains);
    CHECK(hol_chains_create(a.n_atoms, a.mass, &a.chains));
    double *length = malloc(8 * (size_t)a.n_bonds);
    for (int64_t c = 0; c < n; ++c) {
        int64_t n_bonds, *bonds = malloc(8 * (size_t)a.n_bonds);
        a.first[c] = next + c;
        a.first_bond[c] = next;
        CHECK(hol_chains_molecule(found, c, NULL, NULL, &n_bonds));
        CHECK(hol_chains_atoms(found, c, atoms + a.first[c]));
        CHECK(hol_chains_bonds(found, c, bonds));
        for (int64_t k = 0; k < n_bonds; ++k) length[next + k] = list.lengths[bonds[k]];
        CHECK(hol_chains_add(a.chains, n_bonds, atoms + a.first[c], length + next));
        next += n_bonds;
        free(bonds);
    }
    assert_int_equal(next, a.n_bonds);
    free(a.atoms), free(a.length);
    a.atoms = atoms;
    a.length = length;
    hol_chains_destroy(found);
    list_free(&list);
    return a;
}

static void assert_permuted(const double *list, const double *chains, const bond_list *bonds)
{
    for (int64_t k = 0; k < bonds->n; ++k) assert_same_bits(list + k, chains + bonds->from[k], 1);
}

static void check_every_level(const assembly *a, hol_chains *b, const bond_list *list)
{
    const size_t n = (size_t)a->n_bonds, size = assembly_size(a);
    double *l1 = untouched(n), *l2 = untouched(n), *t1 = untouched(n), *t2 = untouched(n);
    double *g1 = untouched(size), *g2 = untouched(size);
    CHECK(hol_forces(a->chains, a->r, a->v, a->f, l1, t1, g1, HOL_WRITE, NULL));
    CHECK(hol_forces(b, a->r, a->v, a->f, l2, t2, g2, HOL_WRITE, NULL));
    assert_permuted(l2, l1, list);
    assert_permuted(t2, t1, list);
    assert_same_bits(g2, g1, size);
    double *v1 = copy_of(a->v, size), *v2 = copy_of(a->v, size), *r1 = copy_of(a->r, size), *r2 = copy_of(a->r, size);
    CHECK(hol_project_velocities(a->chains, a->r, v1, l1, NULL));
    CHECK(hol_project_velocities(b, a->r, v2, l2, NULL));
    assert_permuted(l2, l1, list);
    assert_same_bits(v2, v1, size);
    const double dt = 1e-3;
    for (int step = 0; step < 2; ++step) { /* the second with the multipliers of the first */
        for (size_t i = 0; i < size; ++i) r1[i] = r2[i] = a->r[i] + dt * a->v[i];
        hol_report report1, report2;
        CHECK(hol_project_positions(a->chains, a->r, r1, v1, dt, l1, step, NULL, &report1));
        CHECK(hol_project_positions(b, a->r, r2, v2, dt, l2, step, NULL, &report2));
        assert_permuted(l2, l1, list);
        assert_same_bits(r2, r1, size);
        assert_same_bits(v2, v1, size);
        assert_int_equal(report1.iterations, report2.iterations);
        assert_true(report1.max_error == report2.max_error);
    }
    double *d1 = untouched((size_t)a->n_chains), *d2 = untouched((size_t)a->n_chains);
    CHECK(hol_metric(a->chains, a->r, 1, d1, NULL, NULL, g1, HOL_WRITE));
    CHECK(hol_metric(b, a->r, 1, d2, NULL, NULL, g2, HOL_WRITE));
    assert_same_bits(d2, d1, (size_t)a->n_chains);
    assert_same_bits(g2, g1, size);
    hol_worst w1, w2;
    CHECK(hol_violation(a->chains, r1, v1, &w1));
    CHECK(hol_violation(b, r2, v2, &w2));
    assert_true(w1.length == w2.length && w1.rate == w2.rate && w1.length_molecule == w2.length_molecule);
    assert_int_equal(w1.length_bond, w2.length_bond);
    free(l1), free(l2), free(t1), free(t2), free(g1), free(g2), free(v1), free(v2), free(r1), free(r2), free(d1),
        free(d2);
}

static void bonds_in_any_order_give_the_bits_of_chains(void **state)
{
    (void)state;
    static const int64_t sizes[][3] = {{1, 1, 1}, {40, 1, 6}, {17, 5, 60}, {3, 200, 700}, {30, 4, 4}};
    for (int i = 0; i < 5; ++i)
        for (int how = IN_ORDER; how <= SCATTERED; ++how) {
            assembly a = canonical(sizes[i][0], sizes[i][1], sizes[i][2], (arrangement)how, (uint64_t)(10 + i));
            bond_list list = shuffled(&a, (uint64_t)(77 + i));
            hol_chains *b = of_bonds(&a, &list);
            assert_int_equal(hol_chains_n_of_shape(b, HOL_SHAPE_CHAIN), a.n_chains);
            check_every_level(&a, b, &list);
            CHECK(hol_chains_set_threads(b, 3));
            check_every_level(&a, b, &list);
            hol_chains_destroy(b);
            list_free(&list);
            assembly_free(&a);
        }
}

static void a_list_may_come_in_several_calls(void **state)
{
    (void)state;
    /* chain by chain in reverse order: numbers of bonds run on, molecules are numbered as they were added */
    assembly a = canonical(9, 1, 7, SCATTERED, 5);
    hol_chains *b = NULL;
    CHECK(hol_chains_create(a.n_atoms, a.mass, &b));
    bond_list list = {0, malloc(16 * (size_t)a.n_bonds), malloc(8 * (size_t)a.n_bonds), malloc(8 * (size_t)a.n_bonds)};
    for (int64_t c = a.n_chains; c-- > 0;) {
        const int64_t n = assembly_bonds(&a, c), first = list.n;
        for (int64_t k = n; k-- > 0;) {
            list.pairs[2 * list.n] = a.atoms[a.first[c] + k];
            list.pairs[2 * list.n + 1] = a.atoms[a.first[c] + k + 1];
            list.lengths[list.n] = a.length[a.first_bond[c] + k];
            list.from[list.n++] = a.first_bond[c] + k;
        }
        CHECK(hol_chains_add_bonds(b, n, list.pairs + 2 * first, list.lengths + first));
    }
    assert_int_equal(hol_chains_n_molecules(b), a.n_chains);
    assert_int_equal(hol_chains_n_bonds(b), a.n_bonds);
    int64_t *molecule = malloc(8 * (size_t)a.n_bonds);
    CHECK(hol_chains_molecules_of_bonds(b, molecule));
    for (int64_t k = 0; k < a.n_bonds; ++k) {
        int64_t c = 0;
        while (a.first_bond[c + 1] <= list.from[k]) ++c;
        assert_int_equal(molecule[k], a.n_chains - 1 - c);
    }
    double *l1 = untouched((size_t)a.n_bonds), *l2 = untouched((size_t)a.n_bonds);
    CHECK(hol_forces(a.chains, a.r, a.v, a.f, l1, NULL, NULL, HOL_WRITE, NULL));
    CHECK(hol_forces(b, a.r, a.v, a.f, l2, NULL, NULL, HOL_WRITE, NULL));
    assert_permuted(l2, l1, &list);
    free(molecule), free(l1), free(l2);
    list_free(&list);
    hol_chains_destroy(b);
    assembly_free(&a);
}

static void bad_and_inactive_molecules_keep_their_multipliers(void **state)
{
    (void)state;
    assembly a = canonical(20, 1, 6, SCATTERED, 8);
    bond_list list = shuffled(&a, 3);
    hol_chains *b = of_bonds(&a, &list);
    int64_t *molecule = malloc(8 * (size_t)a.n_bonds);
    CHECK(hol_chains_molecules_of_bonds(b, molecule));
    unsigned char active[20];
    for (int c = 0; c < 20; ++c) active[c] = c != 4;
    CHECK(hol_chains_set_active(b, active));
    a.f[3 * a.atoms[a.first[7]] + 1] = NAN;
    double *lambda = untouched((size_t)a.n_bonds), *kept = untouched((size_t)a.n_bonds), *virial = untouched(9);
    CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_forces(b, a.r, a.v, a.f, lambda, NULL, NULL, HOL_WRITE, virial));
    assert_message_names("hol_forces: ");
    int64_t molecule_number, bond, atom, n_bad;
    hol_error_location(&molecule_number, &bond, &atom, &n_bad);
    assert_int_equal(molecule_number, 7);
    assert_int_equal(atom, a.atoms[a.first[7]]);
    assert_int_equal(n_bad, 1);
    assert_untouched(virial, 9);
    for (int64_t k = 0; k < a.n_bonds; ++k)
        if (molecule[k] == 4 || molecule[k] == 7)
            assert_same_bits(lambda + k, kept + k, 1);
        else
            assert_true(isfinite(lambda[k]) && memcmp(lambda + k, kept + k, 8) != 0);
    free(lambda), free(kept), free(virial), free(molecule);
    list_free(&list);
    hol_chains_destroy(b);
    assembly_free(&a);
}

static void new_lengths_and_masses_are_those_of_a_new_handle(void **state)
{
    (void)state;
    for (int how = IN_ORDER; how <= SCATTERED; ++how) {
        assembly a = canonical(25, 2, 6, (arrangement)how, 21);
        bond_list list = shuffled(&a, 22);
        hol_chains *b = of_bonds(&a, &list);
        assembly old = canonical(25, 2, 6, (arrangement)how, 21);
        const size_t n = (size_t)a.n_bonds, size = assembly_size(&a);
        double *l1 = untouched(n), *l2 = untouched(n);
        CHECK(hol_forces(b, a.r, a.v, a.f, l2, NULL, NULL, HOL_WRITE, NULL)); /* with a plan made before the change */
        random_stream stream = random_seed(23);
        for (int64_t i = 0; i < a.n_atoms; ++i) a.mass[i] = 1 + random_uniform(&stream);
        for (int64_t k = 0; k < a.n_bonds; ++k) a.length[k] *= 1 + 1e-3 * random_uniform(&stream);
        for (int64_t k = 0; k < a.n_bonds; ++k) list.lengths[k] = a.length[list.from[k]];
        CHECK(hol_chains_set_masses(b, a.mass));
        CHECK(hol_chains_set_lengths(b, list.lengths));
        CHECK(hol_chains_set_masses(old.chains, a.mass));
        CHECK(hol_chains_set_lengths(old.chains, a.length));
        hol_chains *fresh = of_bonds(&a, &list);
        assert_int_equal(hol_chains_n_kinds(fresh), hol_chains_n_kinds(b));
        hol_chains *const three[3] = {fresh, b, old.chains};
        double *r[3], *v[3];
        for (int i = 0; i < 3; ++i) {
            double *lambda = i == 0 ? l1 : l2;
            r[i] = copy_of(a.r, size);
            v[i] = copy_of(a.v, size);
            CHECK(hol_project_positions(three[i], a.r, r[i], v[i], 1, lambda, 0, NULL, NULL));
            if (i == 1) assert_same_bits(l2, l1, n);
            if (i == 2) assert_permuted(l1, l2, &list);
            assert_same_bits(r[i], r[0], size);
            assert_same_bits(v[i], v[0], size);
        }
        for (int i = 0; i < 3; ++i) free(r[i]), free(v[i]);
        hol_chains_destroy(b), hol_chains_destroy(fresh);
        free(l1), free(l2);
        list_free(&list);
        assembly_free(&a), assembly_free(&old);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bonds_in_any_order_give_the_bits_of_chains),
        cmocka_unit_test(a_list_may_come_in_several_calls),
        cmocka_unit_test(bad_and_inactive_molecules_keep_their_multipliers),
        cmocka_unit_test(new_lengths_and_masses_are_those_of_a_new_handle),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
