#include "melt.h"

#include "check.h"
#include "random.h"

static const double cutoff2 = 1.2599210498948732; /* 2^(1/3): the WCA potential ends at 2^(1/6) */
static const double list_radius =
    1.45; /* pairs are listed to here, and again once an atom has moved half of what is beyond */

/** Position number `step` of a path that visits a cubic lattice, each site a neighbour of the one before. */
static void lattice_path(int64_t step, int64_t side, double r[3])
{
    const int64_t z = step / (side * side), y = step / side % side, x = step % side;
    const int64_t turned_y = z % 2 ? side - 1 - y : y, row = z * side + y;
    r[0] = (double)(row % 2 ? side - 1 - x : x);
    r[1] = (double)turned_y;
    r[2] = (double)z;
}

static double image(const melt *m, double d)
{
    return d - m->side * nearbyint(d / m->side);
}

static double distance2(const melt *m, int64_t i, int64_t j, double d[3])
{
    for (int x = 0; x < 3; ++x) d[x] = image(m, m->r[3 * i + x] - m->r[3 * j + x]);
    return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}

static int bonded(const melt *m, int64_t i, int64_t j)
{
    return i / m->n_beads == j / m->n_beads && (i - j == 1 || j - i == 1);
}

static int64_t cell_of(const melt *m, int64_t i, int64_t cells)
{
    int64_t place = 0;
    for (int x = 0; x < 3; ++x) {
        const double s = m->r[3 * i + x] / m->side;
        int64_t c = (int64_t)((s - floor(s)) * (double)cells);
        if (c >= cells) c = cells - 1;
        place = place * cells + c;
    }
    return place;
}

static void list_with_cell(melt *m, int64_t i, int64_t cell)
{
    double d[3];
    for (int64_t j = m->head[cell]; j >= 0; j = m->next[j]) {
        if (j >= i || bonded(m, i, j) || distance2(m, i, j, d) > list_radius * list_radius) continue;
        if (m->n_pairs == m->capacity) {
            m->capacity = 2 * m->capacity + 1024;
            m->pairs = realloc(m->pairs, 2 * sizeof *m->pairs * (size_t)m->capacity);
            if (!m->pairs) abort();
        }
        m->pairs[2 * m->n_pairs] = i;
        m->pairs[2 * m->n_pairs++ + 1] = j;
    }
}

static void list_pairs(melt *m)
{
    const int64_t cells = (int64_t)(m->side / list_radius);
    m->n_pairs = 0;
    for (int64_t c = 0; c < cells * cells * cells; ++c) m->head[c] = -1;
    for (int64_t i = 0; i < m->n_atoms; ++i) {
        const int64_t c = cell_of(m, i, cells);
        m->next[i] = m->head[c];
        m->head[c] = i;
    }
    for (int64_t i = 0; i < m->n_atoms; ++i) {
        const int64_t c = cell_of(m, i, cells), z = c % cells, y = c / cells % cells, x = c / cells / cells;
        for (int64_t n = 0; n < 27; ++n) {
            const int64_t nx = (x + n / 9 - 1 + cells) % cells, ny = (y + n / 3 % 3 - 1 + cells) % cells,
                          nz = (z + n % 3 - 1 + cells) % cells;
            list_with_cell(m, i, (nx * cells + ny) * cells + nz);
        }
    }
    memcpy(m->at_list, m->r, 3 * sizeof(double) * (size_t)m->n_atoms);
}

static int list_is_old(const melt *m)
{
    const double margin = (list_radius - sqrt(cutoff2)) / 2;
    for (int64_t i = 0; i < m->n_atoms; ++i) {
        double square = 0;
        for (int x = 0; x < 3; ++x)
            square += (m->r[3 * i + x] - m->at_list[3 * i + x]) * (m->r[3 * i + x] - m->at_list[3 * i + x]);
        if (square > margin * margin) return 1;
    }
    return 0;
}

static void pair_forces(melt *m)
{
    if (list_is_old(m)) list_pairs(m);
    memset(m->f, 0, 3 * sizeof(double) * (size_t)m->n_atoms);
    m->potential = 0;
    for (int64_t p = 0; p < m->n_pairs; ++p) {
        double d[3];
        const int64_t i = m->pairs[2 * p], j = m->pairs[2 * p + 1];
        const double square = distance2(m, i, j, d);
        if (square >= cutoff2) continue;
        const double s = 1 / square, s6 = s * s * s, push = 48 * s6 * (s6 - 0.5) * s;
        m->potential += 4 * s6 * (s6 - 1) + 1;
        for (int x = 0; x < 3; ++x) {
            m->f[3 * i + x] += push * d[x];
            m->f[3 * j + x] -= push * d[x];
        }
    }
}

static double *doubles(int64_t n)
{
    double *p = calloc((size_t)n, sizeof *p);
    if (!p) abort();
    return p;
}

static int64_t *integers(int64_t n)
{
    int64_t *p = calloc((size_t)n, sizeof *p);
    if (!p) abort();
    return p;
}

melt melt_make(int64_t n_chains, int64_t n_beads, double density, uint64_t seed)
{
    melt m;
    random_stream s = random_seed(seed);
    memset(&m, 0, sizeof m);
    m.n_chains = n_chains;
    m.n_beads = n_beads;
    m.n_atoms = n_chains * n_beads;
    m.side = cbrt((double)m.n_atoms / density);
    const int64_t sites = (int64_t)m.side, cells = (int64_t)(m.side / list_radius), n = 3 * m.n_atoms;
    assert_true(sites * sites * sites >= m.n_atoms && cells >= 3);
    m.r = doubles(n), m.v = doubles(n), m.f = doubles(n), m.w = doubles(m.n_atoms), m.before = doubles(n),
    m.at_list = doubles(n);
    m.lambda = doubles(m.n_atoms);
    m.head = integers(cells * cells * cells), m.next = integers(m.n_atoms);
    double mean[3] = {0, 0, 0}, *lengths = doubles(n_beads);
    for (int64_t i = 0; i < m.n_atoms; ++i) {
        lattice_path(i, sites, m.r + 3 * i);
        m.w[i] = 1;
        for (int x = 0; x < 3; ++x) {
            m.v[3 * i + x] = random_normal(&s);
            mean[x] += m.v[3 * i + x] / (double)m.n_atoms;
        }
    }
    for (int64_t i = 0; i < n; ++i) m.v[i] -= mean[i % 3];
    for (int64_t k = 0; k < n_beads; ++k) lengths[k] = 1;
    const double box[9] = {m.side, 0, 0, 0, m.side, 0, 0, 0, m.side};
    CHECK(hol_chains_create(m.n_atoms, m.w, &m.chains));
    CHECK(hol_chains_add_block(m.chains, n_chains, n_beads - 1, 0, lengths));
    CHECK(hol_chains_set_box(m.chains, box));
    CHECK(hol_project_velocities(m.chains, m.r, m.v, NULL, NULL));
    free(lengths);
    list_pairs(&m);
    pair_forces(&m);
    return m;
}

void melt_step(melt *m, double dt)
{
    const int64_t n = 3 * m->n_atoms;
    hol_report report;
    memcpy(m->before, m->r, sizeof(double) * (size_t)n);
    for (int64_t i = 0; i < n; ++i) {
        m->v[i] += dt / 2 * m->w[i / 3] * m->f[i];
        m->r[i] += dt * m->v[i];
    }
    CHECK(hol_project_positions(m->chains, m->before, m->r, m->v, dt, m->lambda, m->steps > 0, NULL, &report));
    pair_forces(m);
    for (int64_t i = 0; i < n; ++i) m->v[i] += dt / 2 * m->w[i / 3] * m->f[i];
    CHECK(hol_project_velocities(m->chains, m->r, m->v, NULL, NULL));
    ++m->steps;
    m->iterations += report.iterations;
    if (m->steps % 10 == 0) {
        hol_worst worst;
        CHECK(hol_violation(m->chains, m->r, NULL, &worst));
        m->worst_length = fmax(m->worst_length, worst.length);
    } else {
        m->worst_length = fmax(m->worst_length, report.max_error);
    }
}

double melt_kinetic(const melt *m)
{
    double sum = 0;
    for (int64_t i = 0; i < 3 * m->n_atoms; ++i) sum += m->v[i] * m->v[i] / m->w[i / 3] / 2;
    return sum;
}

void melt_rescale(melt *m)
{
    const double freedom = (double)hol_chains_degrees_of_freedom(m->chains, 3) - 3; /* total momentum is zero */
    const double factor = sqrt(freedom / 2 / melt_kinetic(m));
    for (int64_t i = 0; i < 3 * m->n_atoms; ++i) m->v[i] *= factor;
}

void melt_free(melt *m)
{
    hol_chains_destroy(m->chains);
    free(m->r), free(m->v), free(m->f), free(m->w), free(m->before), free(m->lambda), free(m->at_list);
    free(m->head), free(m->next), free(m->pairs);
}
