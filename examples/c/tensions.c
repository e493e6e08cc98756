/*
 * Tensions of the bonds of one chain, read from a file: tensions FILE
 *
 * A line per atom, in order along the chain:  mass  x y z  vx vy vz  fx fy fz
 * mass 0: the atom is held fixed. Empty lines and what follows a # are left out. Any consistent set of units.
 */
#include <holonomic.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* One chain as the library wants it. */
typedef struct atoms {
    long count, room;
    double *mass, *r, *v, *f; /* [count], [count][3] */
} atoms;

static int fail(const char *file, long line, const char *what)
{
    if (line > 0)
        fprintf(stderr, "tensions: %s, line %ld: %s\n", file, line, what);
    else
        fprintf(stderr, "tensions: %s: %s\n", file, what);
    return -1;
}

static int make_room(atoms *a)
{
    if (a->count < a->room) return 0;
    const long room = 2 * a->room + 64;
    double *const mass = realloc(a->mass, sizeof *mass * (size_t)room);
    if (mass) a->mass = mass;
    double *const r = realloc(a->r, 3 * sizeof *r * (size_t)room);
    if (r) a->r = r;
    double *const v = realloc(a->v, 3 * sizeof *v * (size_t)room);
    if (v) a->v = v;
    double *const f = realloc(a->f, 3 * sizeof *f * (size_t)room);
    if (f) a->f = f;
    if (!mass || !r || !v || !f) return -1;
    a->room = room;
    return 0;
}

/* Takes an atom from a line of ten numbers; an empty line holds none. */
static int take_line(atoms *a, char *line, const char *file, long number)
{
    double x[10];
    int n = 0;
    line[strcspn(line, "#")] = 0;
    for (char *word = strtok(line, " \t\r\n"), *end; word; word = strtok(NULL, " \t\r\n"), ++n) {
        if (n == 10) return fail(file, number, "more than ten numbers");
        x[n] = strtod(word, &end);
        if (*end) return fail(file, number, "this is not a number");
    }
    if (n == 0) return 0;
    if (n < 10) return fail(file, number, "expected ten numbers: mass, position, velocity, force");
    if (make_room(a)) return fail(file, number, "out of memory");
    a->mass[a->count] = x[0];
    memcpy(a->r + 3 * a->count, x + 1, 3 * sizeof *x);
    memcpy(a->v + 3 * a->count, x + 4, 3 * sizeof *x);
    memcpy(a->f + 3 * a->count, x + 7, 3 * sizeof *x);
    ++a->count;
    return 0;
}

static int read_atoms(atoms *a, const char *file)
{
    char line[1024];
    long number = 0;
    int status = 0;
    FILE *in = fopen(file, "r");
    if (!in) return fail(file, 0, "cannot be opened");
    while (status == 0 && fgets(line, sizeof line, in)) status = take_line(a, line, file, ++number);
    if (status == 0 && ferror(in)) status = fail(file, 0, "cannot be read");
    if (status == 0 && a->count < 2) status = fail(file, 0, "a chain has at least two atoms");
    fclose(in);
    return status;
}

static double distance(const double *p, const double *q)
{
    return sqrt((q[0] - p[0]) * (q[0] - p[0]) + (q[1] - p[1]) * (q[1] - p[1]) + (q[2] - p[2]) * (q[2] - p[2]));
}

/* Lengths of the bonds as they are, and their tensions. Returns an hol_status. */
static int compute(const atoms *a, double *length, double *tension, double *virial)
{
    hol_chains *chains = NULL;
    for (long k = 0; k + 1 < a->count; ++k) length[k] = distance(a->r + 3 * k, a->r + 3 * k + 3);
    int status = hol_chains_create(a->count, a->mass, &chains);
    if (status == HOL_OK) status = hol_chains_add_block(chains, 1, a->count - 1, 0, length);
    if (status == HOL_OK) status = hol_forces(chains, a->r, a->v, a->f, NULL, tension, NULL, HOL_WRITE, virial);
    hol_chains_destroy(chains);
    return status;
}

int main(int argc, char **argv)
{
    atoms a = {0, 0, NULL, NULL, NULL, NULL};
    double virial[9], *length = NULL, *tension = NULL;
    int status = -1;
    if (argc != 2)
        fprintf(stderr, "usage: tensions FILE\n");
    else if (read_atoms(&a, argv[1]) == 0) {
        length = malloc(sizeof *length * (size_t)a.count);
        tension = malloc(sizeof *tension * (size_t)a.count);
        status = length && tension ? compute(&a, length, tension, virial) : fail(argv[1], 0, "out of memory");
        if (status > 0) fail(argv[1], 0, hol_error_message());
    }
    if (status == HOL_OK) {
        printf("# bond    length       tension\n");
        for (long k = 0; k + 1 < a.count; ++k) printf("%6ld  %12.8g  %12.8g\n", k, length[k], tension[k]);
        printf("constraint virial: %.8g\n", virial[0] + virial[4] + virial[8]);
    }
    free(a.mass);
    free(a.r);
    free(a.v);
    free(a.f);
    free(length);
    free(tension);
    return status == HOL_OK ? 0 : 1;
}
