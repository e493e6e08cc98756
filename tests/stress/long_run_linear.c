/**
 * Long runs of what topology files mean: what must stay?
 *     long_run_linear STEPS
 * NVE of molecules held by all bonds and all angles with rounded lengths, of bodies that share an atom, of atoms that
 * are one point, centroids that coincide, sites out of a plane, bodies by their inertia, bonds whose images are told,
 * each atom tied to a place by a spring: lengths within the rounding of coordinates, and energy without a drift. Exit
 * status 1 if one of them fails.
 */
#include <holonomic.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 64, MOST_PAIRS = 200 };

typedef struct scene {
    const char *name;
    int n, freedoms;
    double mass[MOST], r[3 * MOST], length[MOST_PAIRS];
    int n_pairs;
    int64_t pairs[2 * MOST_PAIRS];
} scene;

static void must(int status)
{
    if (status == HOL_OK) return;
    printf("FAILED: %s: %s\n", hol_status_name(status), hol_error_message());
    exit(1);
}

/* An atom: the one it is bonded to, how it is surrounded (l: on a line, f: in a plane, t: by a tetrahedron, o: by an
 * octahedron, e: an end) and its element. What of its places no atom takes is hydrogen's. */
typedef struct atom {
    int parent;
    char round, element;
} atom;

static double mass_of(char element)
{
    return element == 'C'   ? 12
           : element == 'N' ? 14
           : element == 'O' ? 16
           : element == 'S' ? 32
           : element == 'F' ? 19
           : element == 'P' ? 31
                            : 1;
}

static int add_atom(scene *s, double mass, const double *at, double length, const double *way)
{
    s->mass[s->n] = mass;
    for (int x = 0; x < 3; ++x) s->r[3 * s->n + x] = at ? at[x] + length * way[x] : 0;
    return s->n++;
}

/* The directions around an atom, the first one given. */
static int directions(char round, const double *u, double to[][3])
{
    const double pick[3] = {fabs(u[0]) < 0.8, fabs(u[0]) >= 0.8, 0.3};
    double v[3], w[3], along = 0, size = 0;
    for (int x = 0; x < 3; ++x) along += u[x] * pick[x];
    for (int x = 0; x < 3; ++x) v[x] = pick[x] - along * u[x], size += v[x] * v[x];
    for (int x = 0; x < 3; ++x) v[x] /= sqrt(size);
    for (int x = 0; x < 3; ++x) w[x] = u[(x + 1) % 3] * v[(x + 2) % 3] - u[(x + 2) % 3] * v[(x + 1) % 3];
    const int n = round == 'l' ? 1 : round == 'f' ? 2 : round == 't' ? 3 : round == 'o' ? 5 : 0;
    for (int k = 0; k < n; ++k) {
        const double pi = acos(-1.0), turn = round == 't' ? 2 * pi / 3 * k : round == 'f' ? pi * k : pi / 2 * k;
        double c = round == 'l' ? -1 : round == 'f' ? -0.5 : round == 't' ? -1.0 / 3 : 0;
        if (round == 'o' && k == 4) c = -1;
        const double t = c == -1 ? 0 : sqrt(1 - c * c);
        for (int x = 0; x < 3; ++x) to[k][x] = c * u[x] + t * (cos(turn) * v[x] + sin(turn) * w[x]);
    }
    return n;
}

static void join(scene *s, int i, int j, double digits)
{
    double square = 0;
    for (int x = 0; x < 3; ++x) square += pow(s->r[3 * j + x] - s->r[3 * i + x], 2);
    for (int k = 0; k < s->n_pairs; ++k)
        if ((s->pairs[2 * k] == i && s->pairs[2 * k + 1] == j) || (s->pairs[2 * k] == j && s->pairs[2 * k + 1] == i))
            return;
    s->pairs[2 * s->n_pairs] = i, s->pairs[2 * s->n_pairs + 1] = j;
    s->length[s->n_pairs++] = round(sqrt(square) * digits) / digits;
}

/* All bonds and all angles, with some decimals. */
static scene grow(const char *name, int freedoms, const atom *atoms, int n, int decimals)
{
    scene s = {.name = name, .freedoms = freedoms};
    int near[MOST][8], count[MOST] = {0}, slot[MOST] = {0};
    double ways[MOST][8][3];
    int n_ways[MOST] = {0};
    const double axis[3] = {0.6, 0, 0.8};
    for (int i = 0; i < n; ++i) {
        const int p = atoms[i].parent;
        double u[3];
        memcpy(u, axis, sizeof u);
        if (p < 0) {
            add_atom(&s, mass_of(atoms[i].element), NULL, 0, NULL);
            memcpy(ways[i][0], axis, sizeof axis);
            n_ways[i] = 1 + directions(atoms[i].round, axis, ways[i] + 1);
            continue;
        }
        const double *way = ways[p][slot[p]++];
        add_atom(&s, mass_of(atoms[i].element), s.r + 3 * p, 1.3 + 0.07 * (i % 4), way);
        near[p][count[p]++] = i, near[i][count[i]++] = p;
        for (int x = 0; x < 3; ++x) u[x] = -way[x];
        n_ways[i] = directions(atoms[i].round, u, ways[i]);
    }
    for (int i = 0; i < n; ++i)
        while (slot[i] < n_ways[i]) {
            const int h = add_atom(&s, 1, s.r + 3 * i, 1.09, ways[i][slot[i]++]);
            near[i][count[i]++] = h;
        }
    const double digits = pow(10, decimals);
    for (int i = 0; i < n; ++i)
        for (int a = 0; a < count[i]; ++a) {
            join(&s, i, near[i][a], digits);
            for (int b = 0; b < a; ++b) join(&s, near[i][a], near[i][b], digits);
        }
    return s;
}

/* Springs of unlike strength to places beside where each atom began; returns the potential energy. */
static double springs(const scene *s, const double *r, double *f)
{
    double sum = 0;
    for (int i = 0; i < 3 * s->n; ++i) {
        const double k = 1 + 0.3 * (i % 5), d = r[i] - (0.9 * s->r[i] + 0.1 * (i % 3));
        f[i] = -k * d;
        sum += 0.5 * k * d * d;
    }
    return sum;
}

static int run(const scene *s, hol_chains *chains, int64_t n_steps)
{
    const double dt = 0.01;
    double r[3 * MOST], v[3 * MOST], f[3 * MOST], ref[3 * MOST], mean[2] = {0, 0}, largest = 0, start = 0, thermal = 0;
    int ok = hol_chains_degrees_of_freedom(chains, 3) == s->freedoms;
    memcpy(r, s->r, sizeof r);
    must(hol_impose(chains, r, NULL));
    for (int i = 0; i < 3 * s->n; ++i) v[i] = sin(1.0 + 2.3 * i) / sqrt(s->mass[i / 3] > 0 ? s->mass[i / 3] : 1);
    must(hol_project_velocities(chains, r, v, NULL, NULL));
    for (int64_t step = 0; step <= n_steps; ++step) {
        const double potential = springs(s, r, f);
        must(hol_forces(chains, r, NULL, f, NULL, NULL, f, HOL_ADD, NULL));
        double kinetic = 0;
        for (int half = 0; half < 2; ++half) {
            for (int i = 0; i < 3 * s->n && step + half > 0; ++i)
                v[i] += s->mass[i / 3] > 0 ? 0.5 * dt * f[i] / s->mass[i / 3] : 0;
            if (half == 1) break;
            if (step > 0) must(hol_project_velocities(chains, r, v, NULL, NULL));
            for (int i = 0; i < 3 * s->n; ++i) kinetic += 0.5 * s->mass[i / 3] * v[i] * v[i];
        }
        if (step == 0) start = potential + kinetic;
        const double off = potential + kinetic - start;
        thermal += kinetic / (double)(n_steps + 1);
        largest = fmax(largest, fabs(off));
        if (10 * step < n_steps) mean[0] += off / ((double)n_steps / 10);
        if (10 * step > 9 * n_steps) mean[1] += off / ((double)n_steps / 10);
        if (step == n_steps) break;
        memcpy(ref, r, sizeof r);
        for (int i = 0; i < 3 * s->n; ++i) r[i] += dt * v[i];
        must(hol_project_positions(chains, ref, r, v, dt, NULL, 0, NULL, NULL));
    }
    hol_worst worst;
    must(hol_violation(chains, r, NULL, &worst));
    /* Means of few steps wander. */
    const double drift = fabs(mean[1] - mean[0]) / fmax(1, sqrt(1e5 / (double)n_steps));
    ok = ok && worst.length < 1e-13 && drift < 0.1 * largest + 1e-11 * thermal && largest < 0.05 * thermal;
    printf(
        "%-24s %3d freedoms%s  energy within %.1e, from the first tenth to the last %+.1e of the kinetic; lengths "
        "%.1e%s\n",
        s->name, (int)hol_chains_degrees_of_freedom(chains, 3),
        hol_chains_degrees_of_freedom(chains, 3) == s->freedoms ? "" : " WRONG", largest / thermal,
        (mean[1] - mean[0]) / thermal, worst.length, ok ? "" : "  FAILED");
    hol_chains_destroy(chains);
    return !ok;
}

static hol_chains *of_list(const scene *s)
{
    hol_chains *chains;
    must(hol_chains_create(s->n, s->mass, &chains));
    must(hol_chains_add_bonds(chains, s->n_pairs, s->pairs, s->length));
    return chains;
}

#define GROW(name, freedoms, decimals, ...)                                                  \
    do {                                                                                     \
        const atom atoms[] = {__VA_ARGS__};                                                  \
        const scene s = grow(name, freedoms, atoms, sizeof atoms / sizeof *atoms, decimals); \
        failed += run(&s, of_list(&s), n_steps);                                             \
    } while (0)

/* Benzene by all bonds and angles. */
static scene benzene(void)
{
    scene s = {.name = "benzene", .n = 12, .freedoms = 6};
    const double pi = acos(-1.0);
    for (int i = 0; i < 12; ++i) {
        const double size = i < 6 ? 1.39 : 2.48;
        s.mass[i] = i < 6 ? 12 : 1;
        s.r[3 * i] = size * cos(pi / 3 * i), s.r[3 * i + 1] = size * sin(pi / 3 * i);
    }
    for (int i = 0; i < 6; ++i) {
        const int next = (i + 1) % 6, before = (i + 5) % 6;
        join(&s, i, next, 1e4), join(&s, i, i + 6, 1e4), join(&s, before, next, 1e4);
        join(&s, i + 6, next, 1e4), join(&s, i + 6, before, 1e4);
    }
    return s;
}

/* What is given otherwise: two tetrahedra with a common corner, two atoms at one point between bonds, two triangles
 * whose centroids coincide, water with lone pairs. */
static int run_others(int64_t n_steps)
{
    int failed = 0;
    const double corner[4][3] = {{0, 0, 0}, {1, 0.2, 0}, {0.1, 1.1, 0}, {0, 0.1, 0.9}};
    {
        scene s = {.name = "ball joint", .n = 7, .freedoms = 9};
        const int64_t sizes[2] = {4, 4}, atoms[8] = {0, 1, 2, 3, 0, 4, 5, 6};
        double places[24];
        for (int i = 0; i < 8; ++i) memcpy(places + 3 * i, corner[i % 4], sizeof *corner);
        for (int i = 0; i < 7; ++i)
            for (int x = 0; x < 3; ++x)
                s.mass[i] = 1 + i % 3, s.r[3 * i + x] = i < 4 ? corner[i][x] : -corner[i - 3][x];
        hol_chains *chains;
        /* one is the mirror image of the other where it began: its own places then */
        for (int i = 12; i < 24; ++i) places[i] = -places[i];
        must(hol_chains_create(s.n, s.mass, &chains));
        must(hol_chains_add_rigid(chains, 2, sizes, atoms, places, 0, NULL, NULL));
        failed += run(&s, chains, n_steps);
    }
    {
        scene s = {.name = "atoms at one point", .n = 4, .freedoms = 7, .mass = {1, 2, 3, 4}};
        const int64_t pairs[6] = {0, 1, 1, 2, 2, 3};
        const double lengths[3] = {1, 0, 1.2};
        s.r[0] = 1, s.r[10] = 1.2;
        hol_chains *chains;
        must(hol_chains_create(s.n, s.mass, &chains));
        must(hol_chains_add_bonds(chains, 3, pairs, lengths));
        failed += run(&s, chains, n_steps);
    }
    {
        scene s = {.name = "centroids that coincide", .n = 6, .freedoms = 9, .mass = {1, 2, 3, 4, 5, 6}};
        const int64_t six = 6, atoms[6] = {0, 1, 2, 3, 4, 5}, pairs[12] = {0, 1, 1, 2, 2, 0, 3, 4, 4, 5, 5, 3};
        const double c[6] = {1, 1, 1, -1, -1, -1}, length = sqrt(3),
                     lengths[6] = {length, length, length, length, length, length};
        for (int i = 0; i < 6; ++i) {
            const double turn = 2 * acos(-1.0) / 3 * i;
            s.r[3 * i + (i < 3 ? 0 : 1)] = cos(turn), s.r[3 * i + (i < 3 ? 1 : 2)] = sin(turn);
        }
        hol_chains *chains;
        must(hol_chains_create(s.n, s.mass, &chains));
        must(hol_chains_add_linear(chains, 1, &six, atoms, c, 6, pairs, lengths));
        failed += run(&s, chains, n_steps);
    }
    {
        scene s = {.name = "TIP5P", .n = 5, .freedoms = 6, .mass = {16, 1, 1, 0, 0}};
        const double places[15] = {0, 0,         0, 0.585882, 0.756950,  0, 0.585882, -0.756950,
                                   0, -0.404151, 0, 0.5715,   -0.404151, 0, -0.5715};
        const int64_t five = 5, atoms[5] = {0, 1, 2, 3, 4};
        memcpy(s.r, places, sizeof places);
        hol_chains *chains;
        must(hol_chains_create(s.n, s.mass, &chains));
        must(hol_chains_add_rigid(chains, 1, &five, atoms, places, 0, NULL, NULL));
        failed += run(&s, chains, n_steps);
    }
    {
        /* a body by mass, centre and inertia, that carries three massless sites, on which forces act, too */
        scene s = {.name = "body by its inertia", .freedoms = 6};
        const double centre[3] = {0.1, -0.2, 0.3}, inertia[9] = {2.0, 0.1, -0.2, 0.1, 2.5, 0.3, -0.2, 0.3, 3.1};
        const double sites[9] = {1, 0, 0, 0, 1.1, 0, 0.2, 0.3, -0.9};
        double places[21];
        int64_t n_points, sizes[1], atoms[7];
        must(hol_equimomental_points(5.0, centre, inertia, &n_points, s.mass, places));
        memcpy(places + 3 * n_points, sites, sizeof sites);
        s.n = (int)n_points + 3;
        sizes[0] = s.n;
        for (int i = 0; i < s.n; ++i) atoms[i] = i;
        memcpy(s.r, places, sizeof places);
        hol_chains *chains;
        must(hol_chains_create(s.n, s.mass, &chains));
        must(hol_chains_add_rigid(chains, 1, sizes, atoms, places, 0, NULL, NULL));
        failed += run(&s, chains, n_steps);
    }
    {
        /* a ring that goes round the box, and a bond longer than half of it: images as they are told */
        scene s = {.name = "bonds with images", .n = 5, .freedoms = 11, .mass = {1, 2, 3, 4, 5}};
        const int64_t pairs[8] = {0, 1, 1, 2, 2, 0, 3, 4}, images[12] = {0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0};
        const double box[9] = {7, 0, 0, 0, 7, 0, 0, 0, 7}, lengths[4] = {2.5, 2.5, 2.5, 4.4};
        for (int i = 0; i < 3; ++i) s.r[3 * i] = 2.333 * i, s.r[3 * i + 1] = 0.8 * (i == 1), s.r[3 * i + 2] = 0.3 * i;
        s.r[9] = 1, s.r[10] = 3, s.r[12] = 5, s.r[13] = 3.5, s.r[14] = 1;
        hol_chains *chains;
        must(hol_chains_create(s.n, s.mass, &chains));
        must(hol_chains_set_box(chains, box));
        must(hol_chains_add_bonds_with_images(chains, 4, pairs, lengths, images));
        failed += run(&s, chains, n_steps);
    }
    return failed;
}

int main(int argc, char **argv)
{
    const int64_t n_steps = argc > 1 ? atoll(argv[1]) : 2000;
    int failed = 0;
    GROW("ethane", 7, 4, {-1, 't', 'C'}, {0, 't', 'C'});
    GROW("propane", 8, 4, {-1, 't', 'C'}, {0, 't', 'C'}, {1, 't', 'C'});
    GROW("isobutane", 9, 4, {-1, 't', 'C'}, {0, 't', 'C'}, {0, 't', 'C'}, {0, 't', 'C'});
    GROW("neopentane", 10, 4, {-1, 't', 'C'}, {0, 't', 'C'}, {0, 't', 'C'}, {0, 't', 'C'}, {0, 't', 'C'});
    GROW("hexane", 11, 4, {-1, 't', 'C'}, {0, 't', 'C'}, {1, 't', 'C'}, {2, 't', 'C'}, {3, 't', 'C'}, {4, 't', 'C'});
    GROW("hexadecane", 21, 4, {-1, 't', 'C'}, {0, 't', 'C'}, {1, 't', 'C'}, {2, 't', 'C'}, {3, 't', 'C'}, {4, 't', 'C'},
         {5, 't', 'C'}, {6, 't', 'C'}, {7, 't', 'C'}, {8, 't', 'C'}, {9, 't', 'C'}, {10, 't', 'C'}, {11, 't', 'C'},
         {12, 't', 'C'}, {13, 't', 'C'}, {14, 't', 'C'});
    GROW("guanidinium", 9, 4, {-1, 'f', 'C'}, {0, 'f', 'N'}, {0, 'f', 'N'}, {0, 'f', 'N'});
    GROW("N-methylacetamide", 9, 4, {-1, 'f', 'C'}, {0, 'e', 'O'}, {0, 't', 'C'}, {0, 'f', 'N'}, {3, 't', 'C'});
    GROW("acetonitrile", 6, 4, {-1, 't', 'C'}, {0, 'l', 'C'}, {1, 'e', 'N'});
    GROW("ethylene", 7, 5, {-1, 'f', 'C'}, {0, 'f', 'C'});
    GROW("allene", 7, 5, {-1, 'f', 'C'}, {0, 'l', 'C'}, {1, 'f', 'C'});
    GROW("nitrate", 6, 4, {-1, 'f', 'N'}, {0, 'e', 'O'}, {0, 'e', 'O'}, {0, 'e', 'O'});
    GROW("formate", 6, 5, {-1, 'f', 'C'}, {0, 'e', 'O'}, {0, 'e', 'O'});
    GROW("sulfate", 6, 4, {-1, 't', 'S'}, {0, 'e', 'O'}, {0, 'e', 'O'}, {0, 'e', 'O'}, {0, 'e', 'O'});
    GROW("PF6", 6, 4, {-1, 'o', 'P'}, {0, 'e', 'F'}, {0, 'e', 'F'}, {0, 'e', 'F'}, {0, 'e', 'F'}, {0, 'e', 'F'},
         {0, 'e', 'F'});
    GROW("CO2", 5, 3, {-1, 'l', 'C'}, {0, 'e', 'O'}, {0, 'e', 'O'});
    const scene ring = benzene();
    failed += run(&ring, of_list(&ring), n_steps);
    failed += run_others(n_steps);
    return failed > 0;
}
