#include "scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void ok(int status)
{
    if (status == HOL_OK) return;
    printf("%s\n", hol_error_message());
    exit(1);
}

static double noise(void)
{
    static uint32_t state = 7;
    state = 1664525 * state + 1013904223;
    return state / 4294967296.0 - 0.5;
}

static int place(scene *s, double mass, double x, double y, double z)
{
    const int atom = s->n_atoms++;
    s->mass[atom] = mass;
    s->r[3 * atom] = x, s->r[3 * atom + 1] = y, s->r[3 * atom + 2] = z;
    for (int axis = 0; axis < 3; ++axis) s->v[3 * atom + axis] = mass > 0 ? noise() : 0;
    return atom;
}

static void join(scene *s, int i, int j)
{
    double square = 0;
    for (int axis = 0; axis < 3; ++axis) square += pow(s->r[3 * i + axis] - s->r[3 * j + axis], 2);
    s->pair[2 * s->n_bonds] = i, s->pair[2 * s->n_bonds + 1] = j;
    s->length[s->n_bonds++] = sqrt(square);
}

/* A new atom at one that is there. */
static int grow(scene *s, int from, double mass)
{
    const double d[3] = {noise(), noise(), noise()}, *r = s->r + 3 * from;
    const double size = (1 + 0.2 * noise()) / sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    const int atom = place(s, mass, r[0] + size * d[0], r[1] + size * d[1], r[2] + size * d[2]);
    join(s, from, atom);
    return atom;
}

static void line(scene *s, int n_bonds, double x)
{
    int last = place(s, 3, x, 0, 0);
    for (int k = 0; k < n_bonds; ++k) last = grow(s, last, 1 + k % 3);
}

/* A backbone whose atoms carry a side atom each, and close a triangle here and there. */
static void comb(scene *s, int n_backbone, double x)
{
    int last = place(s, 3, x, 0, 0);
    for (int k = 0; k < n_backbone; ++k) {
        const int side = grow(s, last, 1);
        const int next = grow(s, last, 3);
        if (k % 7 == 3) join(s, side, next);
        last = next;
    }
}

void scene_make(scene *s)
{
    memset(s, 0, sizeof *s);
    for (int k = 0; k < 70; ++k) { /* more than stand side by side */
        const int o = place(s, 16, k, 0, 3), a = grow(s, o, 1), b = grow(s, o, 1);
        join(s, a, b);
    }
    int star[2] = {place(s, 12, 0, 9, 0), 0}; /* with nothing but its first atom in its order */
    for (int k = 0; k < 4; ++k) star[1] = grow(s, star[0], 1);
    for (int k = 0; k < 9; ++k) star[1] = grow(s, star[1], 4);
    line(s, 30, 20);
    comb(s, 60, 30);  /* in local memory */
    comb(s, 350, 50); /* in scratch */
    const int wall = place(s, 0, 0, 0, -5);
    for (int k = 0; k < 2; ++k) grow(s, grow(s, grow(s, wall, 1), 2), 1); /* two molecules at one held atom */
    const int c = place(s, 12, 0, 0, -9), o = place(s, 16, 1, 0, -9), p = place(s, 16, -1, 0, -9);
    join(s, c, o), join(s, c, p), join(s, o, p);
    const int hub = place(s, 12, 0, -9, -9);
    for (int k = 0; k < 80; ++k) grow(s, hub, 1);
    if (s->n_atoms != SCENE_ATOMS) printf("%d atoms\n", s->n_atoms), exit(1);
    ok(hol_chains_create(s->n_atoms, s->mass, &s->chains));
    ok(hol_chains_add_bonds(s->chains, s->n_bonds, s->pair, s->length));
    ok(hol_project_velocities(s->chains, s->r, s->v, NULL, NULL));
}

hol_device_plan *scene_plan(const scene *s, hol_device_precision precision)
{
    hol_device_plan *plan;
    ok(hol_device_plan_create(s->chains, precision, 40, &plan));
    return plan;
}
