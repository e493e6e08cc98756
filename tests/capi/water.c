#include "water.h"

#include <math.h>
#include <stdlib.h>

#include "random.h"

const int64_t water_pairs[6] = {0, 1, 0, 2, 1, 2};
const double water_lengths[3] = {WATER_OH, WATER_OH, WATER_HH};

/* Two directions at right angles to each other. */
static void random_frame(random_stream *generator, double *u, double *v)
{
    double size = 0, along = 0;
    for (int c = 0; c < 3; ++c) u[c] = random_normal(generator);
    for (int c = 0; c < 3; ++c) v[c] = random_normal(generator);
    for (int c = 0; c < 3; ++c) size += u[c] * u[c];
    for (int c = 0; c < 3; ++c) u[c] /= sqrt(size);
    for (int c = 0; c < 3; ++c) along += u[c] * v[c];
    for (int c = 0; c < 3; ++c) v[c] -= along * u[c];
    size = 0;
    for (int c = 0; c < 3; ++c) size += v[c] * v[c];
    for (int c = 0; c < 3; ++c) v[c] /= sqrt(size);
}

waters make_waters(int per_side, uint64_t seed)
{
    const double spacing = 3.1, half = 0.5 * WATER_HH, height = sqrt(WATER_OH * WATER_OH - half * half);
    waters w = {per_side * per_side * per_side, 0, per_side * spacing, {0}, NULL, NULL};
    random_stream generator = random_seed(seed);
    w.n_atoms = 3 * w.n_molecules;
    w.r = malloc(sizeof *w.r * 3 * (size_t)w.n_atoms);
    w.mass = malloc(sizeof *w.mass * (size_t)w.n_atoms);
    for (int i = 0; i < 3; ++i) w.box[4 * i] = w.side;
    for (int64_t m = 0; m < w.n_molecules; ++m) {
        double u[3], v[3];
        const int64_t place[3] = {m % per_side, m / per_side % per_side, m / per_side / per_side};
        random_frame(&generator, u, v);
        for (int c = 0; c < 3; ++c) {
            double *const x = w.r + 9 * m + c;
            x[0] = spacing * (double)place[c];
            x[3] = x[0] + height * u[c] + half * v[c];
            x[6] = x[0] + height * u[c] - half * v[c];
        }
        w.mass[3 * m] = 15.999;
        w.mass[3 * m + 1] = w.mass[3 * m + 2] = 1.008;
    }
    return w;
}

void cut_by_the_faces(waters *w)
{
    for (int64_t i = 0; i < 3 * w->n_atoms; ++i) w->r[i] -= w->side * floor(w->r[i] / w->side);
}

void free_waters(waters *w)
{
    free(w->r);
    free(w->mass);
}
