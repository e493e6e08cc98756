/**
 * Results that must be the same to the last bit: wherever a chain stands among others, on any number of threads, in any
 * layout, in every repetition.
 */
#include "check.h"
#include "outputs.h"

static const double time_step = 0.004;

/** Chain i of one set of outputs against chain j of another. */
static void assert_same_chain(const assembly *a, int64_t i, const outputs *p, const assembly *b, int64_t j,
                              const outputs *q)
{
    const size_t n = (size_t)assembly_bonds(a, i), size = 3 * (n + 1);
    assert_int_equal(assembly_bonds(b, j), n);
    double *x = untouched(size), *y = untouched(size);
    for (int k = 0; k < VERBS + 1; ++k) {
        assembly_take(a, i, k < VERBS ? p->atoms[k] : p->moved, x);
        assembly_take(b, j, k < VERBS ? q->atoms[k] : q->moved, y);
        assert_same_bits(x, y, size);
        assert_same_bits((k < VERBS ? p->lambda[k] : p->tension) + a->first_bond[i],
                         (k < VERBS ? q->lambda[k] : q->tension) + b->first_bond[j], n);
    }
    free(x);
    free(y);
}

static const chain_kind kinds[] = {CHAIN_COIL, CHAIN_HETEROGENEOUS, CHAIN_LATTICE, CHAIN_MASSES_1E3};

static void repeated_calls_give_the_same_bits(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, 37, 1, 60, IN_ORDER, 1);
    outputs first = outputs_of(&a, time_step);
    for (int i = 0; i < 3; ++i) {
        outputs again = outputs_of(&a, time_step);
        assert_same_outputs(&a, &first, &again, 1);
        outputs_free(&again);
    }
    outputs_free(&first);
    assembly_free(&a);
}

static void a_chain_gives_the_same_bits_alone_and_among_others(void **state)
{
    (void)state;
    for (size_t kind = 0; kind < sizeof kinds / sizeof *kinds; ++kind) {
        assembly a = assembly_of_kind(kinds[kind], 41, 1, 70, SCATTERED, 2 + kind);
        outputs together = outputs_of(&a, time_step);
        for (int64_t c = 0; c < a.n_chains; ++c) {
            chain one = assembly_chain(&a, c);
            assembly b = assembly_make(&one, 1, IN_ORDER, 0);
            outputs alone = outputs_of(&b, time_step);
            assert_same_chain(&a, c, &together, &b, 0, &alone);
            outputs_free(&alone);
            assembly_free(&b);
            chain_free(&one);
        }
        outputs_free(&together);
        assembly_free(&a);
    }
}

static void a_chain_gives_the_same_bits_in_every_place_among_equals(void **state)
{
    (void)state;
    /* copies of one chain among 1 to 19 copies: it stands in every lane of full and of partly filled blocks */
    static const int64_t lengths[] = {1, 2, 3, 4, 5, 7, 8, 16, 31, 33, 100, 600};
    for (size_t l = 0; l < sizeof lengths / sizeof *lengths; ++l) {
        chain parts[19];
        for (int i = 0; i < 19; ++i) parts[i] = chain_make(CHAIN_HETEROGENEOUS, lengths[l], 5);
        assembly b = assembly_make(parts, 1, IN_ORDER, 0);
        outputs alone = outputs_of(&b, time_step);
        for (int n = 2; n <= 19; ++n) {
            assembly a = assembly_make(parts, n, n % 2 ? IN_ORDER : SCATTERED, (uint64_t)n);
            outputs many = outputs_of(&a, time_step);
            for (int c = 0; c < n; ++c) assert_same_chain(&a, c, &many, &b, 0, &alone);
            outputs_free(&many);
            assembly_free(&a);
        }
        outputs_free(&alone);
        assembly_free(&b);
        for (int i = 0; i < 19; ++i) chain_free(parts + i);
    }
}

static void a_chain_gives_the_same_bits_in_a_block_and_by_its_atoms(void **state)
{
    (void)state;
    for (int64_t bonds = 1; bonds <= 12; ++bonds) {
        chain parts[11];
        for (int i = 0; i < 11; ++i) parts[i] = chain_make(CHAIN_COIL, bonds, 70 + (uint64_t)i);
        assembly a = assembly_make(parts, 11, IN_ORDER, 0);
        /* lengths are for the position level only; the block takes one set for all */
        for (int64_t k = 0; k < a.n_bonds; ++k) a.length[k] = 1;
        hol_chains_destroy(a.chains);
        CHECK(hol_chains_create(a.n_atoms, a.mass, &a.chains));
        CHECK(hol_chains_add_block(a.chains, 11, bonds, 0, a.length));
        outputs block = outputs_of(&a, time_step);
        hol_chains_destroy(a.chains);
        CHECK(hol_chains_create(a.n_atoms, a.mass, &a.chains));
        for (int64_t c = 0; c < 11; ++c) CHECK(hol_chains_add(a.chains, bonds, a.atoms + a.first[c], a.length));
        outputs listed = outputs_of(&a, time_step);
        assert_same_outputs(&a, &block, &listed, 1);
        outputs_free(&block);
        outputs_free(&listed);
        assembly_free(&a);
        for (int i = 0; i < 11; ++i) chain_free(parts + i);
    }
}

static void a_long_chain_gives_the_same_bits_alone_and_among_others(void **state)
{
    (void)state;
    static const int64_t lengths[] = {5000, 3, 20000, 1, 700, 5000, 12};
    chain parts[7];
    for (int i = 0; i < 7; ++i) parts[i] = chain_make(CHAIN_HETEROGENEOUS, lengths[i], 31 + (uint64_t)i);
    assembly a = assembly_make(parts, 7, SCATTERED, 8);
    outputs together = outputs_of(&a, time_step);
    for (int c = 0; c < 7; ++c) {
        assembly b = assembly_make(parts + c, 1, IN_ORDER, 0);
        outputs alone = outputs_of(&b, time_step);
        assert_same_chain(&a, c, &together, &b, 0, &alone);
        outputs_free(&alone);
        assembly_free(&b);
        chain_free(parts + c);
    }
    outputs_free(&together);
    assembly_free(&a);
}

static void every_number_of_threads_gives_the_same_bits(void **state)
{
    (void)state;
    static const int64_t longest[3] = {5, 60, 3000};
    for (int i = 0; i < 3; ++i) {
        assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, i < 2 ? 700 : 9, 1, longest[i], SCATTERED, 3);
        outputs one = outputs_of(&a, time_step);
        for (int threads = 2; threads <= 5; ++threads) {
            CHECK(hol_chains_set_threads(a.chains, threads));
            outputs several = outputs_of(&a, time_step);
            assert_same_outputs(&a, &one, &several, 1);
            outputs_free(&several);
        }
        outputs_free(&one);
        assembly_free(&a);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(repeated_calls_give_the_same_bits),
        cmocka_unit_test(a_chain_gives_the_same_bits_alone_and_among_others),
        cmocka_unit_test(a_chain_gives_the_same_bits_in_every_place_among_equals),
        cmocka_unit_test(a_chain_gives_the_same_bits_in_a_block_and_by_its_atoms),
        cmocka_unit_test(a_long_chain_gives_the_same_bits_alone_and_among_others),
        cmocka_unit_test(every_number_of_threads_gives_the_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
