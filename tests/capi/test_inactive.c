/** Inactive chains: not read, not written, counted in no sum. */
#define _DEFAULT_SOURCE
#include "assembly.h"
#include "check.h"

#include <sys/mman.h>
#include <unistd.h>

/** Every third chain is left out; its data are NaN. */
static unsigned char *leave_out(assembly *a)
{
    unsigned char *active = calloc((size_t)a->n_chains, 1);
    for (int64_t c = 0; c < a->n_chains; ++c) {
        active[c] = (unsigned char)(c % 3 == 1 ? 0 : 1 + c % 255);
        if (active[c]) continue;
        for (int64_t i = 0; i <= assembly_bonds(a, c); ++i)
            for (int x = 0; x < 3; ++x) {
                const int64_t at = 3 * a->atoms[a->first[c] + i] + x;
                a->r[at] = a->v[at] = a->f[at] = NAN;
            }
    }
    CHECK(hol_chains_set_active(a->chains, active));
    return active;
}

/** The active chains alone. */
static assembly only_active(const assembly *a, const unsigned char *active)
{
    chain *parts = calloc((size_t)a->n_chains, sizeof *parts);
    int64_t n = 0;
    for (int64_t c = 0; c < a->n_chains; ++c)
        if (active[c]) parts[n++] = assembly_chain(a, c);
    assembly b = assembly_make(parts, n, IN_ORDER, 1);
    for (int64_t c = 0; c < n; ++c) chain_free(parts + c);
    free(parts);
    return b;
}

static void assert_matches(const assembly *a, const unsigned char *active, const double *per_atom, const double *before,
                           const double *lambda, const assembly *b, const double *b_per_atom, const double *b_lambda)
{
    int64_t at = 0;
    for (int64_t c = 0; c < a->n_chains; ++c) {
        const size_t n = (size_t)assembly_bonds(a, c), size = 3 * (n + 1);
        double *x = untouched(size), *y = untouched(size);
        assembly_take(a, c, per_atom, x);
        if (active[c]) {
            assembly_take(b, at, b_per_atom, y);
            assert_same_bits(lambda + a->first_bond[c], b_lambda + b->first_bond[at], n);
            ++at;
        } else {
            assembly_take(a, c, before, y);
            assert_untouched(lambda + a->first_bond[c], n);
        }
        assert_same_bits(x, y, size);
        free(x);
        free(y);
    }
}

static void every_verb_leaves_inactive_chains_alone(void **state)
{
    (void)state;
    const double dt = 0.004;
    assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, 40, 1, 30, SCATTERED, 31);
    unsigned char *active = leave_out(&a);
    assembly b = only_active(&a, active);
    const size_t n = (size_t)a.n_bonds, size = assembly_size(&a), b_size = assembly_size(&b);
    double *g = untouched(size), *before = untouched(size), *lambda = untouched(n), *b_g = untouched(b_size),
           *b_lambda = untouched(n);
    double virial[9], b_virial[9];

    CHECK(hol_forces(a.chains, a.r, a.v, a.f, lambda, NULL, g, HOL_WRITE, virial));
    CHECK(hol_forces(b.chains, b.r, b.v, b.f, b_lambda, NULL, b_g, HOL_WRITE, b_virial));
    assert_matches(&a, active, g, before, lambda, &b, b_g, b_lambda);
    /* the chains stand in other blocks, so the sum over chains may be rounded elsewhere */
    for (int i = 0; i < 9; ++i)
        CHECK_AT_MOST(fabs(virial[i] - b_virial[i]),
                      64 * DBL_EPSILON * (fabs(b_virial[0]) + fabs(b_virial[4]) + fabs(b_virial[8])));

    double *v = copy_of(a.v, size), *b_v = copy_of(b.v, b_size), *fresh = untouched(n);
    CHECK(hol_project_velocities(a.chains, a.r, v, fresh, virial));
    CHECK(hol_project_velocities(b.chains, b.r, b_v, b_lambda, b_virial));
    assert_matches(&a, active, v, a.v, fresh, &b, b_v, b_lambda);

    double *r = copy_of(a.r, size), *b_r = copy_of(b.r, b_size), *of_positions = untouched(n);
    for (size_t i = 0; i < size; ++i) r[i] += dt * a.v[i];
    for (size_t i = 0; i < b_size; ++i) b_r[i] += dt * b.v[i];
    double *r_before = copy_of(r, size);
    hol_report report;
    CHECK(hol_project_positions(a.chains, a.r, r, NULL, dt, of_positions, 0, NULL, &report));
    CHECK(hol_project_positions(b.chains, b.r, b_r, NULL, dt, b_lambda, 0, NULL, NULL));
    assert_int_equal(report.n_corrected, b.n_chains);
    assert_int_equal(report.n_failed, 0);
    assert_matches(&a, active, r, r_before, of_positions, &b, b_r, b_lambda);

    hol_worst worst, b_worst;
    CHECK(hol_violation(a.chains, a.r, a.v, &worst));
    CHECK(hol_violation(b.chains, b.r, b.v, &b_worst));
    assert_true(worst.length == b_worst.length && worst.rate == b_worst.rate);
    assert_true(active[worst.length_molecule] && active[worst.rate_molecule]);

    free(g), free(before), free(lambda), free(b_g), free(b_lambda), free(v), free(b_v), free(fresh), free(r), free(b_r);
    free(of_positions), free(r_before), free(active);
    assembly_free(&a);
    assembly_free(&b);
}

static void memory_of_inactive_chains_is_never_touched(void **state)
{
    (void)state;
    /* three chains of 1000 atoms; the pages inside the middle one's part of every array can't be read or written */
    const int64_t bonds = 999, atoms = 3000;
    const size_t page = (size_t)sysconf(_SC_PAGESIZE), bytes = 3 * sizeof(double) * (size_t)atoms;
    chain parts[3];
    for (int c = 0; c < 3; ++c) parts[c] = chain_make(CHAIN_COIL, bonds, (uint64_t)c);
    assembly a = assembly_make(parts, 3, IN_ORDER, 0);
    double *area[4];
    for (int k = 0; k < 4; ++k) {
        area[k] = mmap(NULL, bytes + page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        assert_true(area[k] != MAP_FAILED);
        memcpy(area[k], k == 0 ? a.r : k == 1 ? a.v : a.f, bytes);
        const size_t low = (bytes / 3 + page - 1) / page * page, high = 2 * bytes / 3 / page * page;
        assert_true(high > low);
        assert_int_equal(mprotect((char *)area[k] + low, high - low, PROT_NONE), 0);
    }
    const unsigned char active[3] = {1, 0, 1};
    double *lambda = untouched((size_t)a.n_bonds), virial[9];
    hol_worst worst;
    CHECK(hol_chains_set_active(a.chains, active));
    CHECK(hol_forces(a.chains, area[0], area[1], area[2], lambda, NULL, area[3], HOL_ADD, virial));
    CHECK(hol_project_velocities(a.chains, area[0], area[1], NULL, virial));
    CHECK(hol_project_positions(a.chains, area[0], area[0], area[1], 0.01, NULL, 0, virial, NULL));
    CHECK(hol_violation(a.chains, area[0], area[1], &worst));
    assert_untouched(lambda + bonds, (size_t)bonds);
    for (int k = 0; k < 4; ++k) munmap(area[k], bytes + page);
    free(lambda);
    assembly_free(&a);
    for (int c = 0; c < 3; ++c) chain_free(parts + c);
}

static void the_list_is_copied_and_later_chains_are_active(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_COIL, 2, 3, 3, IN_ORDER, 32);
    hol_chains *c;
    CHECK(hol_chains_create(a.n_atoms, a.mass, &c));
    CHECK(hol_chains_add(c, 3, a.atoms, a.length));
    unsigned char active[1] = {0};
    CHECK(hol_chains_set_active(c, active));
    active[0] = 1;
    CHECK(hol_chains_add(c, 3, a.atoms + 4, a.length));
    double *lambda = untouched(6);
    CHECK(hol_forces(c, a.r, a.v, a.f, lambda, NULL, NULL, HOL_WRITE, NULL));
    assert_untouched(lambda, 3);
    assert_true(isfinite(lambda[3]) && isfinite(lambda[5]));
    CHECK(hol_chains_set_active(c, NULL));
    CHECK(hol_forces(c, a.r, a.v, a.f, lambda, NULL, NULL, HOL_WRITE, NULL));
    assert_true(isfinite(lambda[0]));
    free(lambda);
    hol_chains_destroy(c);
    assembly_free(&a);
}

static void bad_data_in_an_inactive_chain_are_no_error(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_COIL, 3, 5, 5, IN_ORDER, 33);
    const unsigned char none[3] = {0, 0, 0};
    double virial[9] = {1, 1, 1, 1, 1, 1, 1, 1, 1};
    CHECK(hol_chains_set_active(a.chains, none));
    for (int64_t i = 0; i < 3 * a.n_atoms; ++i) a.r[i] = NAN;
    CHECK(hol_forces(a.chains, a.r, a.v, a.f, NULL, NULL, NULL, HOL_WRITE, virial));
    for (int i = 0; i < 9; ++i) assert_true(virial[i] == 0);
    hol_worst worst;
    CHECK(hol_violation(a.chains, a.r, a.v, &worst));
    assert_int_equal(worst.length_molecule, -1);
    assert_true(worst.length == 0 && worst.rate == 0);
    assembly_free(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_verb_leaves_inactive_chains_alone),
        cmocka_unit_test(memory_of_inactive_chains_is_never_touched),
        cmocka_unit_test(the_list_is_copied_and_later_chains_are_active),
        cmocka_unit_test(bad_data_in_an_inactive_chain_are_no_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
