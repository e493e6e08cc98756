/** After a thread's first call nothing is allocated: every allocation of the process is counted. */
#define _GNU_SOURCE
#include "chain.h"
#include "check.h"

#include <errno.h>
#include <stdatomic.h>

static atomic_long allocations;

/* These take the place of the C library's functions, for the library under test and operator new as well. */
extern void *__libc_malloc(size_t);
extern void *__libc_calloc(size_t, size_t);
extern void *__libc_realloc(void *, size_t);
extern void *__libc_memalign(size_t, size_t);

void *malloc(size_t size)
{
    atomic_fetch_add(&allocations, 1);
    return __libc_malloc(size);
}

void *calloc(size_t count, size_t size)
{
    atomic_fetch_add(&allocations, 1);
    return __libc_calloc(count, size);
}

void *realloc(void *old, size_t size)
{
    atomic_fetch_add(&allocations, 1);
    return __libc_realloc(old, size);
}

void *aligned_alloc(size_t alignment, size_t size)
{
    atomic_fetch_add(&allocations, 1);
    return __libc_memalign(alignment, size);
}

int posix_memalign(void **out, size_t alignment, size_t size)
{
    atomic_fetch_add(&allocations, 1);
    *out = __libc_memalign(alignment, size);
    return *out ? 0 : ENOMEM;
}

static void calls(const hol_chains *chains, const chain *c, double *r, double *v, double *g, double *lambda)
{
    double virial[9];
    hol_report report;
    hol_worst worst;
    const size_t size = 3 * (size_t)(c->n_bonds + 1);
    memcpy(v, c->v, size * sizeof *v);
    for (size_t i = 0; i < size; ++i) r[i] = c->r[i] + 0.002 * v[i];
    CHECK(hol_forces(chains, c->r, v, c->f, lambda, NULL, g, HOL_WRITE, virial));
    CHECK(hol_project_velocities(chains, c->r, v, lambda, virial));
    CHECK(hol_project_positions(chains, c->r, r, v, 0.002, lambda, 0, virial, &report));
    CHECK(hol_violation(chains, r, v, &worst));
}

static void nothing_is_allocated_after_the_first_call(void **state)
{
    (void)state;
    static const int64_t shapes[][2] = {{400, 1}, {400, 3}, {50, 100}, {1, 900}, {1, 20000}};
    for (size_t s = 0; s < sizeof shapes / sizeof *shapes; ++s) {
        const int64_t atoms = shapes[s][0] * (shapes[s][1] + 1);
        const size_t size = 3 * (size_t)atoms;
        chain c = chain_make(CHAIN_COIL, atoms - 1, 5);
        hol_chains *chains;
        double *ones = malloc(sizeof *ones * (size_t)shapes[s][1]), *r = untouched(size), *v = untouched(size),
               *g = untouched(size), *lambda = untouched(size);
        for (int64_t k = 0; k < shapes[s][1]; ++k) ones[k] = 1;
        CHECK(hol_chains_create(atoms, c.mass, &chains));
        CHECK(hol_chains_add_block(chains, shapes[s][0], shapes[s][1], 0, ones));
        calls(chains, &c, r, v, g, lambda);
        const long before = atomic_load(&allocations);
        for (int round = 0; round < 3; ++round) calls(chains, &c, r, v, g, lambda);
        assert_int_equal(atomic_load(&allocations) - before, 0);
        free(ones), free(r), free(v), free(g), free(lambda);
        hol_chains_destroy(chains);
        chain_free(&c);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_is_allocated_after_the_first_call),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
