/**
 * Many threads with one handle at once, from its very first use on, every function of calculation, failures included.
 * Built with -fsanitize=thread (tests/faults/thread_sanitizer.sh) this shows that nothing is shared that is written.
 * Each call uses one thread of its own: the OpenMP run-time synchronizes in ways that ThreadSanitizer does not see.
 */
#include "assembly.h"
#include "check.h"

#include <pthread.h>

enum { THREADS = 4, ROUNDS = 4 };

typedef struct shared {
    const assembly *good, *bad; /* bad: one chain has a coordinate that is not a number */
    const hol_inverse *inverse;
    pthread_barrier_t start;
} shared;

typedef struct job {
    shared *all;
    double *out;
    size_t size;
    int wrong;
} job;

static void calculate(const assembly *a, int expected, double *out, int *wrong)
{
    const size_t size = assembly_size(a), n = (size_t)a->n_bonds;
    double *lambda = out, *g = lambda + n, *v = g + size, *r = v + size, *force = r + size, *log_det = force + size;
    hol_worst worst;
    hol_report report;
    memcpy(v, a->v, sizeof *v * size);
    for (size_t i = 0; i < size; ++i) r[i] = a->r[i] + 0.003 * a->v[i];
    *wrong |= hol_forces(a->chains, a->r, a->v, a->f, lambda, NULL, g, HOL_WRITE, NULL) != expected;
    *wrong |= hol_project_velocities(a->chains, a->r, v, NULL, NULL) != expected;
    *wrong |= hol_project_positions(a->chains, a->r, r, NULL, 0.003, NULL, 0, NULL, &report) != expected;
    *wrong |= hol_metric(a->chains, a->r, 1, log_det, NULL, NULL, force, HOL_WRITE) != expected;
    *wrong |= hol_reactions(a->chains, a->r, HOL_BOX, a->length, NULL, force, HOL_ADD, NULL, NULL) != expected;
    *wrong |= hol_violation(a->chains, a->r, a->v, &worst) != expected;
    if (expected != HOL_OK) *wrong |= strstr(hol_error_message(), "not finite") == NULL;
}

static size_t room(const assembly *a)
{
    return 4 * assembly_size(a) + (size_t)(a->n_bonds + a->n_chains);
}

static void *work(void *argument)
{
    job *j = argument;
    const assembly *good = j->all->good;
    double *spoilt = untouched(room(j->all->bad)), value[2], gamma[3] = {0.5, 0.25, 0.5}, pivot[4];
    pthread_barrier_wait(&j->all->start);
    for (int round = 0; round < ROUNDS; ++round) {
        hol_inverse *own = NULL;
        calculate(good, HOL_OK, j->out, &j->wrong);
        calculate(j->all->bad, HOL_ERR_NOT_FINITE, spoilt, &j->wrong);
        j->wrong |= hol_inverse_entry(j->all->inverse, HOL_PHYSICAL, 0, 0, value) != HOL_OK;
        j->wrong |= hol_inverse_condition(j->all->inverse, value + 1) != HOL_OK;
        j->wrong |= hol_inverse_create(good->chains, 1, good->r, &own) != HOL_OK;
        j->wrong |= hol_tridiagonal_pivots(4, gamma, pivot) != HOL_OK;
        j->wrong |= hol_partition_function(3, NULL, value, NULL, NULL) != HOL_OK;
        j->wrong |= hol_chains_memory(good->chains) <= 0 || hol_chains_degrees_of_freedom(good->chains, 3) <= 0;
        hol_inverse_destroy(own);
    }
    free(spoilt);
    return NULL;
}

static void threads_share_a_handle_from_its_first_use_on(void **state)
{
    (void)state;
    assembly good = assembly_of_kind(CHAIN_HETEROGENEOUS, 40, 2, 60, SCATTERED, 7);
    assembly bad = assembly_of_kind(CHAIN_COIL, 9, 2, 400, IN_ORDER, 8),
             other = assembly_of_kind(CHAIN_COIL, 2, 3, 9, IN_ORDER, 9);
    bad.r[5] = NAN;
    hol_inverse *inverse = NULL;
    CHECK(hol_inverse_create(other.chains, 0, other.r, &inverse)); /* the two handles above stay unused until then */
    shared all = {.good = &good, .bad = &bad, .inverse = inverse};
    assert_int_equal(pthread_barrier_init(&all.start, NULL, THREADS), 0);
    pthread_t thread[THREADS];
    job jobs[THREADS];
    for (int t = 0; t < THREADS; ++t) {
        jobs[t] = (job){&all, untouched(room(&good)), room(&good), 0};
        assert_int_equal(pthread_create(&thread[t], NULL, work, &jobs[t]), 0);
    }
    for (int t = 0; t < THREADS; ++t) {
        assert_int_equal(pthread_join(thread[t], NULL), 0);
        assert_int_equal(jobs[t].wrong, 0);
        assert_same_bits(jobs[t].out, jobs[0].out, jobs[t].size);
    }
    for (int t = 0; t < THREADS; ++t) free(jobs[t].out);
    pthread_barrier_destroy(&all.start);
    hol_inverse_destroy(inverse);
    assembly_free(&good);
    assembly_free(&bad);
    assembly_free(&other);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(threads_share_a_handle_from_its_first_use_on),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
