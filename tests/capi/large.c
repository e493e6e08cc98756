#include "large.h"

#include "check.h"

/** The ends of the arms that have grown so far, and the stream that they come from. */
typedef struct crown {
    molecule m;
    int64_t n_ends, *end;
    int *neighbours; /* of each end */
    random_stream stream;
} crown;

static double some_mass(random_stream *s)
{
    return pow(10, random_uniform(s));
}

static crown sapling(int64_t most_ends, uint64_t seed)
{
    crown t = {molecule_empty(), 1, NULL, NULL, random_seed(seed)};
    t.end = calloc((size_t)most_ends, sizeof *t.end);
    t.neighbours = calloc((size_t)most_ends, sizeof *t.neighbours);
    molecule_add_atom(&t.m, some_mass(&t.stream), (const double[]){0, 0, 0});
    return t;
}

/** An arm of n bonds from any end; with the first number at its far end if `inwards`. */
static void grow(crown *t, int64_t n, int inwards, double bend)
{
    int64_t from;
    do from = random_integer(&t->stream, 0, t->n_ends - 1);
    while (t->neighbours[from] > 3);
    ++t->neighbours[from];
    const int64_t root = t->end[from], first = t->m.n_atoms;
    double u[3], at[3], *r = untouched(3 * (size_t)n);
    memcpy(at, t->m.r + 3 * root, sizeof at);
    random_direction(&t->stream, u);
    for (int64_t k = 0; k < n; ++k) {
        double turn[3], size = 0;
        random_direction(&t->stream, turn);
        for (int c = 0; c < 3; ++c) u[c] = bend > 1 ? turn[c] : u[c] + bend * turn[c], size += u[c] * u[c];
        for (int c = 0; c < 3; ++c) u[c] /= sqrt(size), at[c] += u[c];
        memcpy(r + 3 * (inwards ? n - 1 - k : k), at, sizeof at);
    }
    for (int64_t k = 0; k < n; ++k) molecule_add_atom(&t->m, some_mass(&t->stream), r + 3 * k);
    for (int64_t k = 0, last = root; k < n; ++k) {
        const int64_t i = first + (inwards ? n - 1 - k : k);
        molecule_add_bond(&t->m, last, i);
        last = i;
    }
    t->end[t->n_ends] = inwards ? first : first + n - 1, t->neighbours[t->n_ends++] = 1;
    free(r);
}

static molecule full_grown(crown *t)
{
    molecule_finish(&t->m, &t->stream);
    free(t->end), free(t->neighbours);
    return t->m;
}

molecule large_arms(int64_t first, int64_t last, double bend)
{
    crown t = sapling(2 * (last - first + 1) + 1, (uint64_t)first);
    for (int64_t n = first; n <= last; ++n)
        for (int inwards = 0; inwards < 2; ++inwards) grow(&t, n, inwards, bend);
    return full_grown(&t);
}

molecule large_coils(const int64_t *length, int64_t count, int fixed)
{
    crown t = sapling(count + 1, (uint64_t)count);
    for (int64_t a = 0; a < count; ++a) grow(&t, length[a], (int)(a % 2), 2);
    for (int64_t e = 0; fixed && e < t.n_ends; e += 3)
        if (t.neighbours[e] == 1) t.m.mass[t.end[e]] = t.m.inverse_mass[t.end[e]] = 0;
    return full_grown(&t);
}

molecule large_mixed_arms(int64_t n)
{
    crown t = sapling(n / 70 + 2, 7);
    for (int i = 0; t.m.n_atoms < n; ++i) {
        const double bend[] = {2, 1e-3, 2, 0.2, 1e-7};
        grow(&t, random_integer(&t.stream, 70, 700), i % 2, bend[i % 5]);
        if (i % 7 == 3) t.neighbours[t.n_ends - 1] = 4; /* nothing else grows there */
    }
    for (int64_t e = 4; e < t.n_ends; e += 7) t.m.mass[t.end[e]] = t.m.inverse_mass[t.end[e]] = 0;
    return full_grown(&t);
}

molecule large_segments(int64_t n_atoms, int64_t segment, int64_t ring, uint64_t seed)
{
    molecule m = molecule_empty();
    random_stream s = random_seed(seed);
    int *neighbours = calloc((size_t)n_atoms, sizeof *neighbours);
    int64_t *parent = calloc((size_t)n_atoms, sizeof *parent);
    molecule_add_atom(&m, some_mass(&s), (const double[]){0, 0, 0});
    for (int64_t i = 1; i < n_atoms; ++i) {
        double u[3];
        int64_t p = i - 1;
        if (i % segment == 0) do
                p = random_integer(&s, 0, i - 1);
            while (neighbours[p] > 3);
        random_direction(&s, u);
        ++neighbours[i], ++neighbours[p];
        parent[i] = p;
        molecule_grow(&m, p, some_mass(&s), 1, u);
    }
    for (int64_t i = 4; ring > 0 && i < n_atoms; i += ring)
        if (parent[i] == i - 1 && parent[i - 1] == i - 2 && parent[i - 2] == i - 3) molecule_add_bond(&m, i - 3, i);
    molecule_finish(&m, &s);
    free(neighbours), free(parent);
    return m;
}

molecule large_comb(int64_t n_atoms)
{
    molecule m = molecule_empty();
    random_stream s = random_seed(7);
    int64_t last = 0;
    molecule_add_atom(&m, some_mass(&s), (const double[]){0, 0, 0});
    while (m.n_atoms < n_atoms) {
        const int64_t sides = m.n_atoms % 4, from = last;
        for (int64_t k = 0; k <= sides; ++k) {
            double u[3];
            random_direction(&s, u);
            last = molecule_grow(&m, from, some_mass(&s), 1, u);
        }
    }
    molecule_finish(&m, &s);
    return m;
}

molecule large_hub(int64_t n_atoms, int64_t bonds)
{
    molecule m = molecule_empty();
    random_stream s = random_seed(9);
    molecule_add_atom(&m, some_mass(&s), (const double[]){0, 0, 0});
    while (m.n_atoms < n_atoms) {
        const int64_t i = m.n_atoms, behind = i - bonds - 2 < 8 ? i - bonds - 2 : 8;
        double u[3];
        random_direction(&s, u);
        molecule_grow(&m, i <= bonds ? 0 : i - 1 - random_integer(&s, 0, behind < 0 ? 0 : behind), some_mass(&s), 1, u);
    }
    molecule_finish(&m, &s);
    return m;
}

/** Every fourth atom hangs at the one before it; the others follow each other, and every 12 of them close a ring. */
molecule large_rings(int64_t n_atoms)
{
    molecule m = molecule_empty();
    random_stream s = random_seed(4);
    int64_t backbone[8] = {0}, last = 0, count = 1;
    molecule_add_atom(&m, some_mass(&s), (const double[]){0, 0, 0});
    while (m.n_atoms < n_atoms) {
        double u[3];
        random_direction(&s, u);
        const int64_t i = molecule_grow(&m, last, some_mass(&s), 1, u);
        if (i % 4 == 3) continue;
        backbone[count % 8] = last = i;
        if (++count % 12 == 0) molecule_add_bond(&m, backbone[(count - 6) % 8], i);
    }
    molecule_finish(&m, &s);
    return m;
}

molecule large_ladder(int64_t n_rungs)
{
    molecule m = molecule_empty();
    random_stream s = random_seed(6);
    double at[3] = {0};
    for (int64_t i = 0; i < n_rungs; ++i) {
        const double turn = 0.5 * (double)i;
        const double rung[3] = {cos(turn) + 0.3 * random_uniform(&s), sin(turn) + 0.3 * random_uniform(&s),
                                0.3 * random_uniform(&s)};
        double end[3];
        for (int c = 0; c < 3; ++c) end[c] = at[c] + rung[c];
        molecule_add_atom(&m, some_mass(&s), at);
        molecule_add_atom(&m, some_mass(&s), end);
        molecule_add_bond(&m, 2 * i, 2 * i + 1);
        for (int rail = 0; rail < 2 && i > 0; ++rail) molecule_add_bond(&m, 2 * i - 2 + rail, 2 * i + rail);
        for (int c = 0; c < 2; ++c) at[c] += 0.6 * (random_uniform(&s) - 0.5);
        at[2] += 0.8;
    }
    molecule_finish(&m, &s);
    return m;
}

void large_turn_bonds(molecule *m)
{
    for (int64_t k = 0, last = m->n_bonds - 1; k < last; ++k, --last) {
        const double length = m->length[k];
        m->length[k] = m->length[last], m->length[last] = length;
        for (int e = 0; e < 2; ++e) {
            const int64_t end = m->pairs[2 * last + 1 - e];
            m->pairs[2 * last + 1 - e] = m->pairs[2 * k + e];
            m->pairs[2 * k + e] = end;
        }
    }
}

hol_chains *large_chains(const molecule *m)
{
    hol_chains *chains = NULL;
    CHECK(hol_chains_create(m->n_atoms, m->mass, &chains));
    CHECK(hol_chains_add_bonds(chains, m->n_bonds, m->pairs, m->length));
    assert_int_equal(hol_chains_n_molecules(chains), 1);
    const hol_shape shape = m->n_bonds < m->n_atoms ? HOL_SHAPE_TREE : HOL_SHAPE_OTHER;
    assert_int_equal(hol_chains_n_of_shape(chains, shape), 1);
    return chains;
}

/** What a call had to leave alone. */
typedef struct kept {
    const molecule *m;
    const hol_chains *chains;
    double *bonds, *atoms;
} kept;

static void assert_kept(const kept *x, const double *was)
{
    const size_t size = 3 * (size_t)x->m->n_atoms;
    assert_untouched(x->bonds, (size_t)x->m->n_bonds);
    was ? assert_same_bits(x->atoms, was, size) : assert_untouched(x->atoms, size);
}

static void forces_fail(const kept *x, int status)
{
    const molecule *m = x->m;
    CHECK_FAILS(status, hol_forces(x->chains, m->r, m->v, m->f, x->bonds, NULL, x->atoms, HOL_WRITE, NULL));
    assert_kept(x, NULL);
}

static void velocities_fail(const kept *x, int status)
{
    const size_t bytes = 3 * (size_t)x->m->n_atoms * sizeof *x->atoms;
    double *const blank = copy_of(x->atoms, bytes / sizeof *x->atoms);
    memcpy(x->atoms, x->m->v, bytes);
    CHECK_FAILS(status, hol_project_velocities(x->chains, x->m->r, x->atoms, x->bonds, NULL));
    assert_kept(x, x->m->v);
    memcpy(x->atoms, blank, bytes);
    free(blank);
}

void check_bad_data_change_nothing(const molecule *m, const hol_chains *chains, size_t places)
{
    const size_t n = (size_t)m->n_bonds, size = 3 * (size_t)m->n_atoms;
    const kept x = {m, chains, untouched(n), untouched(size)};
    for (size_t i = 0; i < places; ++i) {
        const size_t at = i == 0 ? size / 2 : i == 1 ? 1 : size - 2;
        const double f = m->f[at], v = m->v[at], r = m->r[at], bad = i == 1 ? INFINITY : NAN;
        m->f[at] = bad;
        forces_fail(&x, HOL_ERR_NOT_FINITE);
        m->f[at] = f;
        m->v[at] = bad;
        forces_fail(&x, HOL_ERR_NOT_FINITE);
        velocities_fail(&x, HOL_ERR_NOT_FINITE);
        m->v[at] = v;
        double *const rhs = copy_of(m->length, n), *const moved = copy_of(m->r, size);
        rhs[at % n] = bad;
        CHECK_FAILS(HOL_ERR_NOT_FINITE, hol_solve(x.chains, m->r, rhs, x.bonds, x.atoms, HOL_WRITE, NULL));
        assert_kept(&x, NULL);
        moved[at] = bad;
        double *const was = copy_of(moved, size);
        CHECK_FAILS(HOL_ERR_NOT_FINITE,
                    hol_project_positions(x.chains, m->r, moved, NULL, 0.1, x.bonds, 0, NULL, NULL));
        assert_same_bits(moved, was, size);
        assert_kept(&x, NULL);
        m->r[at] = bad;
        forces_fail(&x, HOL_ERR_NOT_FINITE);
        velocities_fail(&x, HOL_ERR_NOT_FINITE);
        m->r[at] = r;
        free(rhs), free(moved), free(was);
    }
    const int64_t *const ends = m->pairs + m->n_bonds / 2 * 2;
    memcpy(m->r + 3 * ends[1], m->r + 3 * ends[0], 3 * sizeof *m->r);
    forces_fail(&x, HOL_ERR_DEGENERATE);
    free(x.bonds), free(x.atoms);
}
