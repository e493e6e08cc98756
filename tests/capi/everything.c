#include "everything.h"

#include "check.h"
#include "random.h"

static void put(record *to, const double *values, size_t n)
{
    if (to->n + n > to->room) {
        to->room = 2 * (to->n + n);
        to->values = realloc(to->values, to->room * sizeof *to->values);
        if (!to->values) abort();
    }
    memcpy(to->values + to->n, values, n * sizeof *values);
    to->n += n;
}

static void put_status(record *to, int status)
{
    const double value = status;
    to->n_good += status == HOL_OK;
    put(to, &value, 1);
}

static void put_text(record *to, const char *text)
{
    double value[80] = {0};
    strncpy((char *)value, text, sizeof value - 1);
    put(to, value, 80);
}

typedef struct room {
    double *atoms, *also, *bonds, *more, *molecules, *others, virial[9];
} room;

static void put_outputs(record *to, const scene *s, const room *o)
{
    put(to, o->atoms, 3 * (size_t)s->n_atoms);
    put(to, o->also, 3 * (size_t)s->n_atoms);
    put(to, o->bonds, (size_t)s->n_bonds);
    put(to, o->more, (size_t)s->n_bonds);
    put(to, o->virial, 9);
}

static void call_verbs(record *to, const scene *s, const hol_chains *h, room *o)
{
    const size_t atoms = 3 * (size_t)s->n_atoms * sizeof(double);
    hol_report report = {0, 0, 0, 0, 0, 0};
    hol_worst worst;
    put_status(to, hol_forces(h, s->r, s->v, s->f, o->bonds, o->more, o->atoms, HOL_WRITE, o->virial));
    put_outputs(to, s, o);
    put_status(to, hol_solve(h, s->r, s->length, o->bonds, o->atoms, HOL_ADD, o->virial));
    put_outputs(to, s, o);
    put_status(to, hol_reactions(h, s->r, HOL_BOX, o->bonds, o->more, o->atoms, HOL_WRITE, NULL, o->virial));
    put_outputs(to, s, o);
    memcpy(o->atoms, s->v, atoms);
    put_status(to, hol_project_velocities(h, s->r, o->atoms, o->bonds, o->virial));
    put_outputs(to, s, o);
    memcpy(o->atoms, s->moved, atoms), memcpy(o->also, s->v, atoms);
    put_status(to, hol_project_positions(h, s->r, o->atoms, o->also, 0x1p-8, o->bonds, 0, o->virial, &report));
    put_outputs(to, s, o);
    put(to, &report.max_error, 1);
    put_status(to, hol_residuals(h, o->atoms, s->v, o->bonds, o->more));
    put_outputs(to, s, o);
    put_status(to, hol_violation(h, o->atoms, s->v, &worst));
    put(to, &worst.length, 1), put(to, &worst.rate, 1);
    memcpy(o->atoms, s->moved, atoms);
    put_status(to, hol_impose(h, o->atoms, &report));
    put_status(to, hol_chains_check(h, s->r, HOL_BOX));
    put_status(to, hol_metric(h, s->r, 1, o->molecules, o->others, &worst.rate, o->also, HOL_WRITE));
    put_outputs(to, s, o);
    put(to, &worst.rate, 1);
    put(to, o->molecules, (size_t)hol_chains_n_molecules(h)), put(to, o->others, (size_t)hol_chains_n_molecules(h));
}

static void call_inverse(record *to, const scene *s, const hol_chains *h, room *o)
{
    hol_inverse *inverse = NULL;
    double value = 0;
    put_status(to, hol_inverse_create(h, 0, s->r, &inverse));
    if (!inverse) return;
    put_status(to, hol_inverse_condition(inverse, &value));
    put(to, &value, 1);
    put_status(to, hol_inverse_row(inverse, HOL_PHYSICAL, 0, o->bonds));
    put(to, o->bonds, (size_t)hol_inverse_n_bonds(inverse));
    put_status(to, hol_inverse_error_bound(inverse, s->v, s->f, o->bonds, o->more, &value));
    put(to, &value, 1);
    hol_inverse_destroy(inverse);
}

/** All that is refused: not a number, out of range. */
static void call_badly(record *to, const scene *s, hol_chains *h, room *o)
{
    const size_t atoms = 3 * (size_t)s->n_atoms * sizeof(double);
    const double dt[] = {NAN, INFINITY, -1, 1e-200, 1e200, 0};
    const double bad[] = {NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN, NAN}, tiny[9] = {1e-310, 0, 0, 0, 1, 0, 0, 0, 1};
    const int64_t two[] = {0, 1};
    hol_chains *another = NULL;
    memcpy(o->atoms, s->moved, atoms);
    for (size_t i = 0; i < sizeof dt / sizeof *dt; ++i)
        put_status(to, hol_project_positions(h, s->r, o->atoms, NULL, dt[i], NULL, 0, NULL, NULL));
    put_text(to, hol_error_message());
    for (int64_t i = 0; i < 3 * s->n_atoms; ++i) memcpy(o->also + i, i % 4 ? bad : s->r + i, sizeof *bad);
    put_status(to, hol_forces(h, o->also, s->v, s->f, o->bonds, o->more, NULL, HOL_WRITE, o->virial));
    put_status(to, hol_forces(h, s->r, o->also, s->f, o->bonds, o->more, NULL, HOL_WRITE, o->virial));
    put_status(to, hol_project_positions(h, s->r, o->also, NULL, 1, NULL, 0, NULL, NULL));
    put_text(to, hol_error_message());
    put_status(to, hol_chains_set_box(h, bad));
    put_status(to, hol_chains_set_box(h, tiny));
    put_status(to, hol_chains_set_tolerance(h, NAN));
    for (int64_t k = 0; k < s->n_bonds; ++k) memcpy(o->more + k, bad, sizeof *bad);
    put_status(to, hol_chains_set_lengths(h, o->more));
    put_status(to, hol_chains_create(2, bad, &another));
    put_status(to, hol_chains_create(2, s->mass, &another));
    put_status(to, hol_chains_add(another, 1, two, bad));
    put_status(to, hol_chains_add_bonds(another, 1, two, bad));
    hol_chains_destroy(another);
}

static int add(const scene *s, hol_chains *h)
{
    if (s->n_copies == 0) return hol_chains_add_bonds(h, s->n_bonds, s->pairs, s->length);
    const int64_t atoms[] = {0, 1, 2, 3, 4, 5, 6, 7};
    return hol_chains_add_rigid_molecules(h, s->n_copies, s->size, 0, 1, &s->size, atoms, s->places, 0, NULL, NULL);
}

record everything_of(const scene *s)
{
    record all = {0, 0, NULL, 0};
    const size_t atoms = 3 * (size_t)s->n_atoms, bonds = (size_t)s->n_bonds;
    room o = {untouched(atoms),
              untouched(atoms),
              untouched(bonds),
              untouched(bonds),
              untouched(atoms),
              untouched(atoms),
              {0}};
    hol_chains *h = NULL;
    put_status(&all, hol_chains_create(s->n_atoms, s->mass, &h));
    put_status(&all, hol_chains_set_box(h, s->box));
    put_status(&all, add(s, h));
    put_status(&all, hol_chains_set_threads(h, s->n_threads));
    call_verbs(&all, s, h, &o);
    if (s->n_copies == 0) call_inverse(&all, s, h, &o);
    put_status(&all, hol_chains_set_masses(h, s->mass));
    call_badly(&all, s, h, &o);
    hol_chains_destroy(h);
    free(o.atoms), free(o.also), free(o.bonds), free(o.more), free(o.molecules), free(o.others);
    return all;
}

void assert_same_record(const record *a, const record *b, const char *what)
{
    if (a->n != b->n) fail_msg("%s: %zu and %zu numbers", what, a->n, b->n);
    for (size_t i = 0; i < a->n; ++i)
        if (memcmp(a->values + i, b->values + i, sizeof *a->values) != 0)
            fail_msg("%s: number %zu is %.17g and %.17g", what, i, a->values[i], b->values[i]);
}

static double *numbers(int64_t n)
{
    double *x = calloc((size_t)n + 1, sizeof *x);
    if (!x) abort();
    return x;
}

scene scene_of_atoms(int64_t n)
{
    scene s;
    memset(&s, 0, sizeof s);
    s.n_atoms = n;
    s.n_threads = 1;
    s.mass = numbers(n), s.length = numbers(0);
    s.r = numbers(3 * n), s.v = numbers(3 * n), s.f = numbers(3 * n), s.moved = numbers(3 * n);
    for (int64_t i = 0; i < n; ++i) s.mass[i] = 1;
    return s;
}

void scene_bond(scene *s, int64_t i, int64_t j)
{
    const size_t n = (size_t)++s->n_bonds;
    s->pairs = realloc(s->pairs, 2 * n * sizeof *s->pairs);
    s->length = realloc(s->length, n * sizeof *s->length);
    if (!s->pairs || !s->length) abort();
    s->pairs[2 * n - 2] = i, s->pairs[2 * n - 1] = j;
    double square = 0;
    for (int x = 0; x < 3; ++x) square += (s->r[3 * i + x] - s->r[3 * j + x]) * (s->r[3 * i + x] - s->r[3 * j + x]);
    s->length[n - 1] = sqrt(square);
}

void scene_finish(scene *s, uint64_t seed)
{
    random_stream stream = random_seed(seed);
    for (int64_t i = 0; i < 3 * s->n_atoms; ++i) {
        const int moves = s->mass[i / 3] > 0;
        s->v[i] = moves * random_normal(&stream);
        s->f[i] = random_normal(&stream);
        s->moved[i] = s->r[i] + 0x1p-8 * s->v[i];
    }
}

void scene_free(scene *s)
{
    free(s->mass), free(s->r), free(s->v), free(s->f), free(s->moved);
    free(s->pairs), free(s->length), free(s->places);
}
