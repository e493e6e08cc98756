#include "scene.h"
#include "../capi/input.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "layout.h"
#include "random.h"

const char *const place_names[PLACES] = {"packed", "mixed lengths", "listed", "separate arrays"};
const double time_step = 0.01, temperature = 0.7;

static void *memory(int64_t n, size_t size)
{
    void *p = calloc((size_t)n + 1, size);
    if (!p) abort();
    return p;
}

static double *doubles(int64_t n)
{
    return memory(n, sizeof(double));
}

/** The numbers 0 .. n-1, in random order where the atoms are listed. */
static int64_t *numbers(int64_t n, int listed, random_stream *s)
{
    int64_t *all = memory(n, sizeof *all);
    for (int64_t i = 0; i < n; ++i) all[i] = i;
    for (int64_t i = n - 1; listed && i > 0; --i) {
        const int64_t j = random_integer(s, 0, i), t = all[i];
        all[i] = all[j];
        all[j] = t;
    }
    return all;
}

/** Gives the atoms of a chain their places and velocities, and the forces on them. */
static void fill_chain(scene *s, const int64_t *atoms, int64_t n, const double *length, random_stream *stream)
{
    for (int64_t k = 0; k <= n; ++k) {
        const int64_t i = atoms[k];
        double u[3];
        random_direction(stream, u);
        for (int x = 0; x < 3; ++x) {
            s->r[3 * i + x] = k > 0 ? s->r[3 * atoms[k - 1] + x] + length[k - 1] * u[x] : random_normal(stream);
            s->v[3 * i + x] = random_normal(stream) / sqrt(s->mass[i]);
            s->f[3 * i + x] = random_normal(stream) * sqrt(s->mass[i]);
        }
    }
}

static void add_chains(scene *s, int64_t n_bonds)
{
    int failed = hol_chains_create(s->n_atoms, s->mass, &s->chains) != HOL_OK;
    if (s->where == PACKED) {
        failed |= hol_chains_add_block(s->chains, s->n_chains, n_bonds, 0, s->length) != HOL_OK;
    } else {
        const int64_t *atoms = s->atoms;
        const double *length = s->length;
        for (int64_t c = 0; c < s->n_chains; ++c) {
            failed |= hol_chains_add(s->chains, s->bonds[c], atoms, length) != HOL_OK;
            atoms += s->bonds[c] + 1;
            length += s->bonds[c];
        }
    }
    if (failed) abort();
}

scene scene_make(int64_t n_chains, int64_t n_bonds, place where, int unequal)
{
    random_stream stream = random_seed((uint64_t)(8 * n_bonds + 2 * (int64_t)where + unequal));
    scene s;
    memset(&s, 0, sizeof s);
    s.where = where;
    s.n_chains = n_chains;
    s.bonds = memory(n_chains, sizeof *s.bonds);
    for (int64_t c = 0; c < n_chains; ++c) {
        const int64_t n = n_bonds - (where == MIXED ? c % 5 : 0);
        s.bonds[c] = n > 1 ? n : 1;
        s.n_bonds += s.bonds[c];
    }
    s.n_atoms = s.n_bonds + n_chains;
    s.atoms = numbers(s.n_atoms, where == LISTED, &stream);
    s.mass = doubles(s.n_atoms);
    s.length = doubles(s.n_bonds);
    s.r = doubles(3 * s.n_atoms);
    s.v = doubles(3 * s.n_atoms);
    s.f = doubles(3 * s.n_atoms);
    for (int64_t i = 0; i < s.n_atoms; ++i) s.mass[i] = unequal ? pow(10, 2 * random_uniform(&stream) - 1) : 1;
    for (int64_t k = 0; k < s.n_bonds; ++k) s.length[k] = unequal ? 0.7 + 0.8 * random_uniform(&stream) : 1;
    int64_t *atoms = s.atoms;
    double *length = s.length;
    for (int64_t c = 0; c < n_chains; ++c) {
        if (where == PACKED && c > 0) memcpy(length, s.length, sizeof *length * (size_t)n_bonds);
        fill_chain(&s, atoms, s.bonds[c], length, &stream);
        atoms += s.bonds[c] + 1;
        length += s.bonds[c];
    }
    add_chains(&s, n_bonds);
    return s;
}

void scene_free(scene *s)
{
    hol_chains_destroy(s->chains);
    free(s->bonds);
    free(s->atoms);
    free(s->mass);
    free(s->length);
    free(s->r);
    free(s->v);
    free(s->f);
    memset(s, 0, sizeof *s);
}

static answers allocate(const scene *s)
{
    answers x;
    memset(&x, 0, sizeof x);
    for (int verb = 0; verb < 3; ++verb) x.lambda[verb] = doubles(s->n_bonds);
    x.tension = doubles(s->n_bonds);
    double **const per_atom[] = {&x.g, &x.projected, &x.drifted, &x.moved, &x.pushed, &x.fixman};
    for (int i = 0; i < 6; ++i) *per_atom[i] = doubles(3 * s->n_atoms);
    x.log_det = doubles(s->n_chains);
    x.log_det_z = doubles(s->n_chains);
    for (int64_t i = 0; i < 3 * s->n_atoms; ++i) {
        x.projected[i] = x.pushed[i] = s->v[i];
        x.drifted[i] = x.moved[i] = s->r[i] + time_step * s->v[i];
    }
    return x;
}

static void note(answers *x, int status, const char *call)
{
    if (status != HOL_OK && !x->failed) x->failed = call;
}

static void call_packed(const scene *s, answers *x, int plain)
{
    double *const sum = plain ? NULL : x->virial[0];
    note(x, hol_forces(s->chains, s->r, s->v, s->f, x->lambda[0], plain ? NULL : x->tension, x->g, HOL_WRITE, sum),
         "forces");
    note(x, hol_project_velocities(s->chains, s->r, x->projected, x->lambda[1], plain ? NULL : x->virial[1]),
         "velocities");
    note(x,
         hol_project_positions(s->chains, s->r, x->moved, x->pushed, time_step, x->lambda[2], 0,
                               plain ? NULL : x->virial[2], plain ? NULL : &x->report),
         "positions");
    note(x,
         hol_metric(s->chains, s->r, temperature, x->log_det, plain ? NULL : x->log_det_z, plain ? NULL : &x->energy,
                    x->fixman, HOL_WRITE),
         "metric");
}

static void call_apart(const scene *s, answers *x, int plain)
{
    const layout *const apart = &layouts[1];
    double *const arrays[] = {s->r, s->v, s->f, x->g, x->projected, x->moved, x->pushed, x->fixman};
    enum { R, V, F, G, PROJECTED, MOVED, PUSHED, FIXMAN, ARRAYS };
    laid_out a[ARRAYS];
    for (int i = 0; i < ARRAYS; ++i) a[i] = lay_out(apart, s->n_atoms, arrays[i], 3);
    note(x,
         hol_forces_view(s->chains, INPUT(&a[R].view), INPUT(&a[V].view), INPUT(&a[F].view), x->lambda[0],
                         plain ? NULL : x->tension, &a[G].view, HOL_WRITE, plain ? NULL : x->virial[0]),
         "forces");
    note(x,
         hol_project_velocities_view(s->chains, INPUT(&a[R].view), &a[PROJECTED].view, x->lambda[1],
                                     plain ? NULL : x->virial[1]),
         "velocities");
    note(x,
         hol_project_positions_view(s->chains, INPUT(&a[R].view), &a[MOVED].view, &a[PUSHED].view, time_step,
                                    x->lambda[2], 0, plain ? NULL : x->virial[2], plain ? NULL : &x->report),
         "positions");
    note(x,
         hol_metric_view(s->chains, INPUT(&a[R].view), temperature, x->log_det, plain ? NULL : x->log_det_z,
                         plain ? NULL : &x->energy, &a[FIXMAN].view, HOL_WRITE),
         "metric");
    for (int i = G; i < ARRAYS; ++i) collect(&a[i], arrays[i]);
    for (int i = 0; i < ARRAYS; ++i) laid_out_free(&a[i]);
}

static answers call(const scene *s, int plain)
{
    answers x = allocate(s);
    if (s->where == APART)
        call_apart(s, &x, plain);
    else
        call_packed(s, &x, plain);
    return x;
}

answers scene_answers(const scene *s)
{
    return call(s, 0);
}

answers scene_plain_answers(const scene *s)
{
    return call(s, 1);
}

void answers_free(answers *x)
{
    for (int verb = 0; verb < 3; ++verb) free(x->lambda[verb]);
    double *const others[] = {x->tension, x->g,      x->projected, x->drifted,  x->moved,
                              x->pushed,  x->fixman, x->log_det,   x->log_det_z};
    for (size_t i = 0; i < sizeof others / sizeof *others; ++i) free(others[i]);
    memset(x, 0, sizeof *x);
}
