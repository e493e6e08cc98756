/** One handle used by several threads at once; messages that belong to a thread; nothing printed, no rounding mode
 * changed. */
#define _DEFAULT_SOURCE
#include "assembly.h"
#include "check.h"

#include <fcntl.h>
#include <fenv.h>
#include <pthread.h>
#include <unistd.h>

enum { THREADS = 6, ROUNDS = 40 };

typedef struct job {
    const assembly *a;
    const double *g, *v, *r, *lambda; /* what must come out */
    int wrong;
} job;

static int differ(const double *a, const double *b, size_t n)
{
    return memcmp(a, b, n * sizeof *a) != 0;
}

static void *use_the_handle(void *argument)
{
    job *j = argument;
    const assembly *a = j->a;
    const size_t size = assembly_size(a), n = (size_t)a->n_bonds;
    double *g = copy_of(a->f, size), *v = copy_of(a->v, size), *r = copy_of(a->r, size), *lambda = untouched(n);
    for (int round = 0; round < (quick_run() ? 4 : ROUNDS); ++round) {
        memcpy(v, a->v, size * sizeof *v);
        for (size_t i = 0; i < size; ++i) r[i] = a->r[i] + 0.004 * a->v[i];
        j->wrong |= hol_forces(a->chains, a->r, a->v, a->f, lambda, NULL, g, HOL_WRITE, NULL) != HOL_OK;
        j->wrong |= differ(lambda, j->lambda, n) || differ(g, j->g, size);
        j->wrong |= hol_project_positions(a->chains, a->r, r, NULL, 0.004, NULL, 0, NULL, NULL) != HOL_OK;
        j->wrong |= differ(r, j->r, size);
        j->wrong |= hol_project_velocities(a->chains, a->r, v, NULL, NULL) != HOL_OK;
        j->wrong |= differ(v, j->v, size);
    }
    free(g), free(v), free(r), free(lambda);
    return NULL;
}

static void many_threads_may_compute_with_one_handle(void **state)
{
    (void)state;
    for (int inner = 1; inner <= 2; ++inner) {
        assembly a = assembly_of_kind(CHAIN_HETEROGENEOUS, 60, 1, 60, IN_ORDER, 111);
        CHECK(hol_chains_set_threads(a.chains, inner));
        const size_t size = assembly_size(&a);
        double *g = copy_of(a.f, size), *v = copy_of(a.v, size), *r = copy_of(a.r, size),
               *lambda = untouched((size_t)a.n_bonds);
        for (size_t i = 0; i < size; ++i) r[i] += 0.004 * a.v[i];
        CHECK(hol_forces(a.chains, a.r, a.v, a.f, lambda, NULL, g, HOL_WRITE, NULL));
        CHECK(hol_project_positions(a.chains, a.r, r, NULL, 0.004, NULL, 0, NULL, NULL));
        CHECK(hol_project_velocities(a.chains, a.r, v, NULL, NULL));
        pthread_t thread[THREADS];
        job jobs[THREADS];
        for (int t = 0; t < THREADS; ++t) {
            jobs[t] = (job){&a, g, v, r, lambda, 0};
            assert_int_equal(pthread_create(&thread[t], NULL, use_the_handle, &jobs[t]), 0);
        }
        for (int t = 0; t < THREADS; ++t) {
            pthread_join(thread[t], NULL);
            assert_int_equal(jobs[t].wrong, 0);
        }
        free(g), free(v), free(r), free(lambda);
        assembly_free(&a);
    }
}

static void *fail_in_another_thread(void *argument)
{
    const char **messages = argument;
    int64_t where = 7;
    messages[0] = hol_error_message()[0] == 0 ? "empty" : "not empty";
    hol_error_location(&where, NULL, NULL, NULL);
    if (where != -1) messages[0] = "place of another thread";
    hol_chains *c = NULL;
    messages[1] = hol_chains_create(-5, NULL, &c) == HOL_OK ? "no failure" : "failure";
    return NULL;
}

static void messages_belong_to_the_thread(void **state)
{
    (void)state;
    hol_chains *c = NULL;
    const double mass[3] = {1, -4, 1};
    CHECK_FAILS(HOL_ERR_VALUE, hol_chains_create(3, mass, &c));
    char *kept = malloc(strlen(hol_error_message()) + 1);
    strcpy(kept, hol_error_message());
    const char *messages[2] = {"", ""};
    pthread_t thread;
    assert_int_equal(pthread_create(&thread, NULL, fail_in_another_thread, messages), 0);
    pthread_join(thread, NULL);
    assert_string_equal(messages[0], "empty");
    assert_string_equal(messages[1], "failure");
    assert_string_equal(hol_error_message(), kept);
    free(kept);
}

static void success_leaves_the_last_message(void **state)
{
    (void)state;
    hol_chains *c = NULL;
    const double mass[2] = {1, 1};
    CHECK_FAILS(HOL_ERR_NULL, hol_chains_create(2, NULL, &c));
    char *kept = malloc(strlen(hol_error_message()) + 1);
    strcpy(kept, hol_error_message());
    CHECK(hol_chains_create(2, mass, &c));
    assert_string_equal(hol_error_message(), kept);
    int64_t place[4] = {5, 5, 5, 5};
    hol_error_location(NULL, NULL, NULL, NULL);
    hol_error_location(place, place + 1, place + 2, place + 3);
    for (int i = 0; i < 3; ++i) assert_int_equal(place[i], -1);
    assert_int_equal(place[3], 0);
    free(kept);
    hol_chains_destroy(c);
}

static void nothing_is_printed_on_errors(void **state)
{
    (void)state;
    char name[] = "/tmp/holonomic_output_XXXXXX";
    const int file = mkstemp(name), out = dup(1), err = dup(2);
    assert_true(file >= 0 && out >= 0 && err >= 0);
    assembly a = assembly_of_kind(CHAIN_COIL, 9, 3, 30, IN_ORDER, 112);
    a.r[5] = NAN;
    fflush(stdout), fflush(stderr);
    dup2(file, 1), dup2(file, 2);
    hol_chains *c = NULL;
    int sum = hol_chains_create(-1, NULL, &c) + hol_chains_add(a.chains, 1, NULL, NULL);
    sum += hol_forces(a.chains, a.r, a.v, a.f, NULL, NULL, NULL, HOL_WRITE, NULL);
    sum += hol_project_positions(a.chains, a.r, a.r, a.v, 1, NULL, 0, NULL, NULL);
    fflush(stdout), fflush(stderr);
    dup2(out, 1), dup2(err, 2);
    assert_true(sum > 0);
    assert_int_equal(lseek(file, 0, SEEK_END), 0);
    close(file), close(out), close(err), unlink(name);
    assembly_free(&a);
}

static void the_floating_point_environment_is_left_alone(void **state)
{
    (void)state;
    assembly a = assembly_of_kind(CHAIN_COIL, 9, 3, 30, IN_ORDER, 113);
    double *g = untouched(assembly_size(&a));
    const int mode = fegetround();
    CHECK(hol_forces(a.chains, a.r, a.v, a.f, NULL, NULL, g, HOL_WRITE, NULL));
    assert_int_equal(fegetround(), mode);
    volatile double tiny = DBL_MIN;
    assert_true(tiny / 2 > 0); /* denormal numbers are not flushed to zero */
    free(g);
    assembly_free(&a);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(many_threads_may_compute_with_one_handle),
        cmocka_unit_test(messages_belong_to_the_thread),
        cmocka_unit_test(success_leaves_the_last_message),
        cmocka_unit_test(nothing_is_printed_on_errors),
        cmocka_unit_test(the_floating_point_environment_is_left_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
