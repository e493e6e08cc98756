/**
 * Every allocation made to fail in turn, in every function that allocates: HOL_ERR_MEMORY, outputs as they were,
 * nothing leaked, and the same call then succeeds with the same handle.
 *
 * Each attempt runs in a thread of its own, because a thread's scratch memory is kept from call to call.
 */
#define _GNU_SOURCE
#include "assembly.h"
#include "check.h"
#include "failing_allocations.h"
#include "operations.h"

#include <pthread.h>

typedef struct attempt {
    const operation *what;
    const assembly *a;
    const double *right; /* what must come out; NULL: not known yet */
    double *before, *out, *again;
    long good; /* allocations that succeed */
    int once;  /* one fails, or all from there on */
    int status, second;
    long refused;
} attempt;

static void *run(void *argument)
{
    attempt *t = argument;
    if (t->once)
        fail_once_after(t->good);
    else
        fail_after(t->good);
    t->status = t->what->call(t->a, t->out);
    t->refused = refused();
    fail_no_more();
    t->second = t->what->call(t->a, t->again);
    return NULL;
}

static void run_in_a_thread(attempt *t)
{
    pthread_t thread;
    prepare(t->a, t->before);
    prepare(t->a, t->out);
    prepare(t->a, t->again);
    assert_int_equal(pthread_create(&thread, NULL, run, t), 0);
    assert_int_equal(pthread_join(thread, NULL), 0);
}

/** Fails one allocation after the other until a call meets no failure any more. Returns how many were met. */
static long fail_each(const operation *what, const assembly *a, int once)
{
    const size_t size = out_size(a);
    double *right = untouched(size), *before = untouched(size), *out = untouched(size), *again = untouched(size);
    attempt t = {what, a, right, before, out, again, 1000000, once, 0, 0, 0};
    run_in_a_thread(&t); /* the first call may prepare the handle */
    if (t.status != HOL_OK) fail_msg("%s: %s", what->name, hol_status_name(t.status));
    memcpy(right, out, size * sizeof *out);
    const long in_use = blocks_in_use();
    for (t.good = 0;; ++t.good) {
        run_in_a_thread(&t);
        if (blocks_in_use() != in_use)
            fail_msg("%s: %ld blocks leak after failure %ld", what->name, blocks_in_use() - in_use, t.good);
        assert_int_equal(t.second, HOL_OK);
        assert_same_bits(again, right, size);
        if (t.refused == 0) break;
        if (t.status == HOL_OK && what->plans) {
            assert_same_bits(out, right, size);
            continue;
        }
        if (t.status != HOL_ERR_MEMORY)
            fail_msg("%s: %s after allocation %ld failed", what->name, hol_status_name(t.status), t.good);
        assert_same_bits(out, before, size);
    }
    assert_int_equal(t.status, HOL_OK);
    assert_same_bits(out, right, size);
    free(right), free(before), free(out), free(again);
    return t.good;
}

static void fail_each_of_all(const assembly *a, const char *name)
{
    CHECK(hol_inverse_create(a->chains, 0, a->r, &prepared));
    for (size_t i = 0; i < n_operations; ++i) {
        const long met = fail_each(operations + i, a, 0) + fail_each(operations + i, a, 1);
        print_message("%-28s %-12s %3ld allocations failed in turn\n", name, operations[i].name, met);
    }
    hol_inverse_destroy(prepared);
}

/** Its atoms with n other bonds, as long as these are there; `pairs` is kept for the operations. */
static void bond_anew(assembly *a, int64_t n, int64_t *pairs)
{
    static int64_t *kept;
    free(a->length);
    a->length = malloc((size_t)n * sizeof *a->length);
    for (int64_t k = 0; k < n; ++k) {
        double square = 0;
        for (int i = 0; i < 3; ++i) {
            const double d = a->r[3 * pairs[2 * k + 1] + i] - a->r[3 * pairs[2 * k] + i];
            square += d * d;
        }
        a->length[k] = sqrt(square);
    }
    hol_chains_destroy(a->chains);
    a->n_bonds = n;
    CHECK(hol_chains_create(a->n_atoms, a->mass, &a->chains));
    CHECK(hol_chains_add_bonds(a->chains, n, pairs, a->length));
    free(kept);
    pairs_of_bonds = kept = pairs;
}

/** Chains turned into molecules: some closed to rings, some with a triangle, two that share a fixed atom; no order. */
static assembly molecules(void)
{
    enum { CHAINS = 9, BONDS = 12, ATOMS = BONDS + 1 };
    assembly a = assembly_of_kind(CHAIN_COIL, CHAINS, BONDS, BONDS, IN_ORDER, 7);
    int64_t *pairs = malloc(sizeof *pairs * 2 * CHAINS * (BONDS + 1)), n = 0;
    a.mass[0] = 0;
    for (int64_t k = BONDS; k >= 0; --k)
        for (int64_t c = 0; c < CHAINS; ++c) {
            const int64_t first = c * ATOMS, last = c % 3 == 0 ? 0 : c % 3 == 1 ? first + 2 : first;
            if (k == BONDS && c == 0) continue;
            pairs[2 * n] = k == BONDS && c % 3 == 1 ? first : first + k;
            pairs[2 * n++ + 1] = k == BONDS ? last : first + k + 1;
        }
    bond_anew(&a, n, pairs);
    return a;
}

/** Strands between 40 nodes, four at each, large enough to be worked on as a network. */
static assembly network(void)
{
    enum { NODES = 40, STRANDS = 2 * NODES, BONDS = 5, ATOMS = NODES + STRANDS * (BONDS - 1) };
    assembly a = assembly_of_kind(CHAIN_COIL, 1, ATOMS - 1, ATOMS - 1, IN_ORDER, 8);
    int64_t *pairs = malloc(sizeof *pairs * 2 * STRANDS * BONDS), n = 0, next = NODES;
    for (int64_t s = 0; s < STRANDS; ++s)
        for (int64_t k = 0, last = s % NODES; k < BONDS; ++k, ++n) {
            pairs[2 * n] = last;
            pairs[2 * n + 1] = last = k + 1 < BONDS ? next++ : (s + (s < NODES ? 1 : 9)) % NODES;
        }
    bond_anew(&a, n, pairs);
    return a;
}

/** Bodies alone, of two kinds, one of them with a site; and copies of them with an atom at each, one of which is fixed.
 */
static assembly bodies(void)
{
    enum { COPIES = 9, ALONE = 3, EACH = 9, CHAIN = 40, ATOMS = COPIES * EACH + CHAIN + 1 };
    /* a tetrahedron with its centre, and a rod */
    static const double places[21] = {1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1, 0, 0, 0, 5, 0, 0, 6, 0, 0};
    static const double tails[6] = {0, 0, 2, 6, 1, 0};
    static const int64_t sizes[2] = {5, 2}, list[7] = {0, 1, 2, 3, 4, 5, 6}, pairs[4] = {3, 7, 6, 8};
    static const double lengths[2] = {1.7320508075688772, 1};
    assembly a = assembly_of_kind(CHAIN_COIL, 1, ATOMS - 1, ATOMS - 1, IN_ORDER, 7);
    hol_chains_destroy(a.chains);
    for (int64_t c = 0; c < COPIES; ++c) {
        const int64_t first = c * EACH;
        a.mass[first + 4] = a.mass[first + 8] = 0;
        memcpy(a.r + 3 * first, places, sizeof places);
        memcpy(a.r + 3 * (first + 7), tails, sizeof tails);
    }
    CHECK(hol_chains_create(a.n_atoms, a.mass, &a.chains));
    CHECK(hol_chains_add_rigid_molecules(a.chains, ALONE, EACH, 0, 2, sizes, list, places, 0, NULL, NULL));
    CHECK(hol_chains_add_rigid_molecules(a.chains, COPIES - ALONE, EACH, ALONE * EACH, 2, sizes, list, places, 2, pairs,
                                         lengths));
    CHECK(hol_chains_add_block(a.chains, 1, CHAIN, COPIES * EACH, a.length));
    a.n_bonds = hol_chains_n_bonds(a.chains);
    return a;
}

/** Of n operations. */
static void fail_each_of(const char *const *names, size_t n, assembly a, const char *name)
{
    long met = 0;
    for (size_t k = 0; k < n; ++k)
        for (size_t i = 0; i < n_operations; ++i)
            if (strcmp(names[k], operations[i].name) == 0)
                met += fail_each(operations + i, &a, 0) + fail_each(operations + i, &a, 1);
    print_message("%s: %ld allocations failed in turn\n", name, met);
    assert_true(met > 0);
    assembly_free(&a);
}

/** What takes bodies. */
static void every_allocation_of_a_calculation_with_bodies_can_fail(void **state)
{
    (void)state;
    static const char *const names[] = {
        "hol_forces",       "hol_project_velocities", "hol_project_positions",
        "hol_chains_check", "hol_violation",          "hol_solve",
        "hol_reactions",    "hol_forces with a rate", "hol_project_velocities with a rate"};
    fail_each_of(names, sizeof names / sizeof *names, bodies(), "bodies");
}

static void every_allocation_of_a_calculation_with_a_network_can_fail(void **state)
{
    (void)state;
    static const char *const names[] = {"hol_forces", "hol_factors_forces", "hol_factors_solve"};
    fail_each_of(names, sizeof names / sizeof *names, network(), "a network");
}

static void every_allocation_of_a_calculation_can_fail(void **state)
{
    (void)state;
    static const int64_t shapes[][3] = {{9, 3, 30}, {1, 2000, 2000}, {3, 2, 3000}};
    static const char *const names[] = {"short chains", "one long chain", "long and short"};
    for (int i = 0; i < 3; ++i) {
        pairs_of_bonds = NULL;
        assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, shapes[i][0], shapes[i][1], shapes[i][2], SCATTERED, 5);
        fail_each_of_all(&a, names[i]);
        assembly_free(&a);
    }
    assembly a = molecules();
    fail_each_of_all(&a, "molecules");
    assembly_free(&a);
}

/** The handle's own preparation happens in the first calculation after a change: that may fail too. */
static void the_first_calculation_with_a_handle_can_fail(void **state)
{
    (void)state;
    static const operation calls[] = {{"hol_forces", forces, 0}, {"hol_solve", given_right_hand_sides, 0}};
    for (int i = 0; i < 4; ++i) {
        assembly a = i < 2 ? assembly_of_kind(CHAIN_HETEROGENEOUS, 20, 1, 30, SCATTERED, 6) : molecules();
        const operation *what = calls + i % 2;
        const size_t size = out_size(&a);
        double *before = untouched(size), *out = untouched(size), *again = untouched(size), *right = untouched(size);
        prepare(&a, right);
        CHECK(what->call(&a, right));
        unsigned char *active = malloc((size_t)hol_chains_n_molecules(a.chains));
        memset(active, 1, (size_t)hol_chains_n_molecules(a.chains));
        attempt t = {what, &a, right, before, out, again, 0, 0, 0, 0, 0};
        for (t.good = 0;; ++t.good) {
            CHECK(hol_chains_set_active(a.chains, active)); /* makes the handle prepare itself again */
            run_in_a_thread(&t);
            assert_int_equal(t.second, HOL_OK);
            assert_same_bits(again, right, size);
            if (t.refused == 0) break;
            assert_int_equal(t.status, HOL_ERR_MEMORY);
            assert_same_bits(out, before, size);
        }
        assert_true(t.good > 0);
        free(before), free(out), free(again), free(right), free(active);
        assembly_free(&a);
    }
}

static void handles_are_not_made_without_memory(void **state)
{
    (void)state;
    const double mass[4] = {1, 2, 3, 4};
    const long in_use = blocks_in_use();
    long good = 0;
    for (;; ++good) {
        hol_chains *chains = (hol_chains *)&good;
        fail_after(good);
        const int status = hol_chains_create(4, mass, &chains);
        fail_no_more();
        if (status == HOL_OK) {
            hol_chains_destroy(chains);
            break;
        }
        assert_int_equal(status, HOL_ERR_MEMORY);
        assert_null(chains);
        assert_int_equal(blocks_in_use(), in_use);
    }
    assert_true(good > 0);
    assert_int_equal(blocks_in_use(), in_use);
}

enum {
    ADD = 0,
    ADD_BLOCK,
    ADD_BONDS,
    ADD_MOLECULES,
    ADD_RIGID,
    ADD_RIGID_MOLECULES,
    ADD_LINE,
    SET_LENGTHS,
    SET_MASSES,
    SET_ACTIVE,
    CHANGES
};

static int change(hol_chains *chains, int which)
{
    static const int64_t list[4] = {40, 7, 33, 12}; /* free atoms */
    static const double length[3] = {1, 1.5, 0.5};
    static const unsigned char active[40] = {1, 0, 1};
    /* a star, a ring, and a chain from its end on */
    static const int64_t bonds[20] = {20, 22, 20, 24, 20, 26, 12, 11, 11, 14, 14, 13, 13, 12, 41, 40, 40, 39, 39, 38};
    static const int64_t triangle[6] = {0, 1, 1, 2, 2, 0};
    static const double ones[10] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
    /* a tetrahedron with a tail, and a rod */
    static const int64_t sizes[2] = {4, 2}, held[6] = {20, 21, 22, 23, 30, 31}, tail[4] = {23, 24, 24, 25};
    static const double places[18] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    /* the same three times, of atoms one after the other */
    static const int64_t of_each[6] = {0, 1, 2, 3, 4, 5}, bonds_of_each[4] = {3, 4, 5, 6};
    /* three atoms on a line, which become a body, among others */
    static const int64_t line[10] = {43, 44, 44, 45, 43, 45, 46, 47, 45, 48};
    static const double twice[5] = {1, 1, 2, 1, 1};
    double mass[50];
    for (int i = 0; i < 50; ++i) mass[i] = 2 + i % 5;
    switch (which) {
        case ADD_BONDS:
            return hol_chains_add_bonds(chains, 10, bonds, ones);
        case ADD_MOLECULES:
            return hol_chains_add_molecules(chains, 9, 3, 20, 3, triangle, ones);
        case ADD_RIGID:
            return hol_chains_add_rigid(chains, 2, sizes, held, places, 2, tail, ones);
        case ADD_RIGID_MOLECULES:
            return hol_chains_add_rigid_molecules(chains, 3, 7, 15, 2, sizes, of_each, places, 2, bonds_of_each, ones);
        case ADD_LINE:
            return hol_chains_add_bonds(chains, 5, line, twice);
        case SET_LENGTHS:
            return hol_chains_set_lengths(chains, length);
        case SET_MASSES:
            return hol_chains_set_masses(chains, mass);
        case ADD:
            return hol_chains_add(chains, 3, list, length);
        case ADD_BLOCK:
            return hol_chains_add_block(chains, 3, 3, 14, length);
        default:
            return hol_chains_set_active(chains, active);
    }
}

static hol_chains *some_chains(void)
{
    hol_chains *chains = NULL;
    double mass[50];
    static const int64_t list[3] = {5, 3, 1};
    static const double length[2] = {1, 2};
    for (int i = 0; i < 50; ++i) mass[i] = 1 + i % 3;
    CHECK(hol_chains_create(50, mass, &chains));
    CHECK(hol_chains_add(chains, 2, list, length));
    return chains;
}

/** Masses, lengths and bonds show in what is calculated. */
static void assert_same_results(const hol_chains *one, const hol_chains *other)
{
    double r[150], f[150], lambda[2][40] = {{0}};
    hol_worst worst[2];
    const hol_chains *const both[2] = {one, other};
    for (int i = 0; i < 150; ++i) r[i] = sin(i * i), f[i] = cos(i);
    for (int i = 0; i < 2; ++i) {
        CHECK(hol_forces(both[i], r, NULL, f, lambda[i], NULL, NULL, HOL_WRITE, NULL));
        CHECK(hol_violation(both[i], r, NULL, worst + i));
    }
    assert_same_bits(lambda[0], lambda[1], 40);
    assert_true(worst[0].length == worst[1].length);
}

static void a_change_that_finds_no_memory_changes_nothing(void **state)
{
    (void)state;
    /* what the thread keeps for calls with bodies */
    hol_chains *first = some_chains();
    CHECK(change(first, ADD_RIGID));
    assert_same_results(first, first);
    hol_chains_destroy(first);
    for (int which = 0; which < CHANGES; ++which) {
        const long in_use = blocks_in_use();
        long good = 0;
        for (;; ++good) {
            hol_chains *chains = some_chains(), *twin = some_chains();
            fail_after(good);
            const int status = change(chains, which);
            const long no = refused();
            fail_no_more();
            if (status != HOL_OK) {
                assert_int_equal(status, HOL_ERR_MEMORY);
                assert_int_equal(hol_chains_n_molecules(chains), 1);
                assert_int_equal(hol_chains_n_bonds(chains), 2);
                assert_int_equal(hol_chains_n_kinds(chains), 1);
                CHECK(change(chains, which)); /* the atoms are still free */
            }
            CHECK(change(twin, which));
            const int64_t n = hol_chains_n_molecules(twin);
            assert_int_equal(hol_chains_n_molecules(chains), n);
            assert_int_equal(hol_chains_n_kinds(chains), hol_chains_n_kinds(twin));
            for (int64_t c = 0; c < n; ++c) {
                int64_t atoms[2][8] = {{0}}, bonds_of[2][8] = {{0}};
                CHECK(hol_chains_atoms(chains, c, atoms[0]));
                CHECK(hol_chains_atoms(twin, c, atoms[1]));
                assert_memory_equal(atoms[0], atoms[1], sizeof atoms[0]);
                CHECK(hol_chains_bonds(chains, c, bonds_of[0]));
                CHECK(hol_chains_bonds(twin, c, bonds_of[1]));
                assert_memory_equal(bonds_of[0], bonds_of[1], sizeof bonds_of[0]);
            }
            assert_same_results(chains, twin);
            assert_int_equal(hol_chains_degrees_of_freedom(chains, 3), hol_chains_degrees_of_freedom(twin, 3));
            hol_chains_destroy(chains);
            hol_chains_destroy(twin);
            assert_int_equal(blocks_in_use(), in_use);
            if (status == HOL_OK && no == 0) break;
        }
        assert_true(good > 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_allocation_of_a_calculation_can_fail),
        cmocka_unit_test(every_allocation_of_a_calculation_with_bodies_can_fail),
        cmocka_unit_test(every_allocation_of_a_calculation_with_a_network_can_fail),
        cmocka_unit_test(the_first_calculation_with_a_handle_can_fail),
        cmocka_unit_test(handles_are_not_made_without_memory),
        cmocka_unit_test(a_change_that_finds_no_memory_changes_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
