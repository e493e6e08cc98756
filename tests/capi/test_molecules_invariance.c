/** Results of molecules do not depend on how they are told, to the last bit. */
#include "check.h"
#include "input.h"
#include "layout.h"
#include "mixture.h"
#include "molecule_solution.h"

enum { ARRAYS = 9 };

/** All results, per part and in its own order: numbers of all parts one after the other. */
typedef struct everything {
    double *part[ARRAYS];
    size_t size[ARRAYS];
} everything;

static void gather(const mixture *m, everything *e, int at, const double *values, int per_atom)
{
    e->size[at] = (size_t)(per_atom ? 3 * m->first_atom[m->n_parts] : m->n_bonds);
    e->part[at] = untouched(e->size[at]);
    for (int64_t p = 0; p < m->n_parts; ++p)
        if (per_atom)
            mixture_take(m, p, values, e->part[at] + 3 * m->first_atom[p]);
        else
            mixture_take_bonds(m, p, values, e->part[at] + m->first_bond[p]);
}

static everything compute(const mixture *m)
{
    everything e;
    const size_t n = (size_t)m->n_bonds, size = mixture_size(m);
    const double dt = 1e-4;
    double *lambda = untouched(n), *g = untouched(size), *mu = untouched(n), *v = copy_of(m->v, size);
    double *tau = untouched(n), *r = mixture_drifted(m, dt), *force = untouched(size), *solved = untouched(n);
    double *moved = copy_of(m->v, size);
    CHECK(hol_forces(m->chains, m->r, m->v, m->f, lambda, NULL, g, HOL_WRITE, NULL));
    CHECK(hol_solve(m->chains, m->r, m->length, solved, NULL, HOL_WRITE, NULL));
    CHECK(hol_project_velocities(m->chains, m->r, v, mu, NULL));
    CHECK(hol_project_positions(m->chains, m->r, r, moved, dt, tau, 0, NULL, NULL));
    CHECK(hol_metric(m->chains, m->r, 1, NULL, NULL, NULL, force, HOL_WRITE));
    const double *const all[ARRAYS] = {lambda, mu, tau, solved, g, v, r, force, moved};
    for (int k = 0; k < ARRAYS; ++k) gather(m, &e, k, all[k], k >= 4);
    free(lambda), free(g), free(mu), free(v), free(tau), free(r), free(force), free(solved), free(moved);
    return e;
}

static void release(everything *e)
{
    for (int k = 0; k < ARRAYS; ++k) free(e->part[k]);
}

static void assert_same(const everything *a, const everything *b)
{
    for (int k = 0; k < ARRAYS; ++k) assert_same_bits(a->part[k], b->part[k], a->size[k]);
}

/** All kinds whose steps converge from velocities at random. */
static int64_t make_parts(molecule *parts)
{
    int64_t n = 0;
    for (int kind = 0; kind < MOLECULE_GOOD_KINDS; ++kind) {
        if (kind == MOLECULE_LIGHT_JOINTS || kind == MOLECULE_LARIAT || kind == MOLECULE_TAUT) continue;
        if (kind == MOLECULE_COLLAPSED_RING || kind == MOLECULE_BENT || kind == MOLECULE_TRIANGLES_179) continue;
        if (kind == MOLECULE_COPLANAR_STAR || kind == MOLECULE_NEARLY_STRAIGHT_COMB) continue;
        for (int copy = 0; copy < 3; ++copy)
            parts[n++] = molecule_make((molecule_kind)kind, kind == MOLECULE_DENDRIMER ? 1 : 4 + copy, (uint64_t)copy);
    }
    return n;
}

static void order_and_direction_of_bonds_and_placement_change_no_bit(void **state)
{
    (void)state;
    molecule parts[3 * MOLECULE_GOOD_KINDS];
    const int64_t n = make_parts(parts);
    mixture plain = mixture_make(parts, n, ONE_AFTER_THE_OTHER, 0);
    everything expected = compute(&plain);
    for (uint64_t seed = 1; seed <= 4; ++seed) {
        mixture m = mixture_make(parts, n, MIXED, seed);
        everything got = compute(&m);
        assert_same(&got, &expected);
        release(&got);
        mixture_free(&m);
    }
    for (int64_t p = 0; p < n; ++p) { /* each alone */
        mixture m = mixture_make(parts + p, 1, ONE_AFTER_THE_OTHER, 0);
        everything got = compute(&m);
        for (int k = 0; k < ARRAYS; ++k) {
            const int64_t first = k >= 4 ? 3 * plain.first_atom[p] : plain.first_bond[p];
            assert_same_bits(got.part[k], expected.part[k] + first, got.size[k]);
        }
        release(&got);
        mixture_free(&m);
    }
    release(&expected);
    mixture_free(&plain);
    for (int64_t p = 0; p < n; ++p) molecule_free(parts + p);
}

static void number_of_threads_changes_no_bit(void **state)
{
    (void)state;
    static const molecule_kind kinds[] = {MOLECULE_WATER, MOLECULE_XH3, MOLECULE_PEPTIDE, MOLECULE_RING};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; ++k) {
        mixture m =
            mixture_of_kind(kinds[k], quick_run() ? 40 : 400, 3, kinds[k] == MOLECULE_PEPTIDE ? 3 : 6, MIXED, k);
        everything one = compute(&m);
        double virial[3][9];
        CHECK(hol_forces(m.chains, m.r, m.v, m.f, NULL, NULL, NULL, HOL_WRITE, virial[0]));
        for (int threads = 2; threads <= 5; threads += 3) {
            CHECK(hol_chains_set_threads(m.chains, threads));
            everything several = compute(&m);
            assert_same(&several, &one);
            CHECK(hol_forces(m.chains, m.r, m.v, m.f, NULL, NULL, NULL, HOL_WRITE, virial[1]));
            assert_same_bits(virial[0], virial[1], 9);
            release(&several);
        }
        release(&one);
        mixture_free(&m);
    }
}

static void one_call_for_copies_gives_the_bits_of_the_list(void **state)
{
    (void)state;
    enum { N = 37 };
    mixture m = mixture_of_kind(MOLECULE_NEOPENTANE, N, 17, 17, ONE_AFTER_THE_OTHER, 3);
    everything list = compute(&m);
    for (int64_t k = 0; k < m.n_bonds; ++k) m.length[k] = m.length[k % 16]; /* all copies have those of the first */
    CHECK(hol_chains_set_lengths(m.chains, m.length));
    everything same_lengths = compute(&m);
    hol_chains_destroy(m.chains);
    CHECK(hol_chains_create(m.n_atoms, m.mass, &m.chains));
    CHECK(hol_chains_add_molecules(m.chains, N, 17, 0, 16, m.pairs, m.length));
    assert_int_equal(hol_chains_n_bonds(m.chains), m.n_bonds);
    everything copies = compute(&m);
    assert_same(&copies, &same_lengths);
    assert_same_bits(copies.part[0], list.part[0], list.size[0]); /* forces know no lengths */
    release(&list), release(&copies), release(&same_lengths);
    mixture_free(&m);
}

/** n molecules of one kind: atom a of molecule p is number n a + p, so that each molecule has a list of its own. */
static mixture interleaved(const molecule *parts, int64_t n)
{
    mixture m = mixture_make(parts, n, ONE_AFTER_THE_OTHER, 0);
    double *const arrays[3] = {m.r, m.v, m.f};
    const int64_t each = parts[0].n_atoms, bonds = parts[0].n_bonds;
    for (int k = 0; k < 3; ++k) {
        double *old = copy_of(arrays[k], mixture_size(&m));
        for (int64_t i = 0; i < n * each; ++i)
            memcpy(arrays[k] + 3 * (n * (i % each) + i / each), old + 3 * i, 3 * sizeof *old);
        free(old);
    }
    for (int64_t i = 0; i < n * each; ++i) {
        m.atoms[i] = n * (i % each) + i / each;
        m.mass[m.atoms[i]] = parts[0].mass[i % each];
    }
    for (int64_t b = 0; b < m.n_bonds; ++b) m.length[b] = parts[0].length[b % bonds];
    for (int64_t e = 0; e < 2 * m.n_bonds; ++e) m.pairs[e] = m.atoms[m.pairs[e]];
    hol_chains_destroy(m.chains);
    CHECK(hol_chains_create(m.n_atoms, m.mass, &m.chains));
    CHECK(hol_chains_add_bonds(m.chains, m.n_bonds, m.pairs, m.length));
    assert_int_equal(hol_chains_n_kinds(m.chains), 1);
    return m;
}

/** Frees the mixture of these molecules. In a box, if it is not NULL. */
static void assert_bits_of_each_alone_in(const double *box, const molecule *parts, int64_t n, mixture *all)
{
    if (box) CHECK(hol_chains_set_box(all->chains, box));
    everything together = compute(all);
    for (int64_t p = 0; p < n; ++p) {
        mixture one = mixture_make(parts + p, 1, ONE_AFTER_THE_OTHER, 0);
        if (box) CHECK(hol_chains_set_box(one.chains, box));
        everything alone = compute(&one);
        for (int a = 0; a < ARRAYS; ++a) {
            const int64_t before = a < 4 ? all->first_bond[p] : 3 * all->first_atom[p];
            assert_same_bits(alone.part[a], together.part[a] + before, alone.size[a]);
        }
        release(&alone);
        mixture_free(&one);
    }
    release(&together);
    mixture_free(all);
}

static void assert_bits_of_each_alone(const molecule *parts, int64_t n, mixture *all)
{
    assert_bits_of_each_alone_in(NULL, parts, n, all);
}

/** Some of those that share lanes are refined, with images of more digits, and some are not. */
static void graphs_in_a_box_have_the_bits_of_each_alone(void **state)
{
    (void)state;
    enum { N = 19 };
    static const double box[9] = {40, 0, 0, 0, 50, 0, 0, 0, 45};
    static const struct {
        molecule_kind kind;
        int64_t size;
    } kinds[] = {
        {MOLECULE_FUSED_RINGS, 4}, {MOLECULE_TRIANGLES, 9}, {MOLECULE_CUBE, 1}, {MOLECULE_PUCKERED_BENZENE, 1}};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; ++k) {
        molecule parts[N];
        for (int p = 0; p < N; ++p) {
            random_stream stream = random_seed((uint64_t)p + 1);
            parts[p] = molecule_make(kinds[k].kind, kinds[k].size, 1);
            molecule_finish(parts + p, &stream);
            memcpy(parts[p].length, parts[0].length, (size_t)parts[0].n_bonds * sizeof(double));
            for (int64_t i = 0; i < parts[p].n_atoms; ++i)
                for (int x = 0; x < 3; ++x) {
                    parts[p].r[3 * i + x] += box[4 * x] * (double)random_integer(&stream, -2, 2);
                    parts[p].v[3 * i + x] *= p % 3 == 0 ? 0 : 1;
                    parts[p].f[3 * i + x] *= p % 4 == 1 ? 1e-9 * (double)(i + 1) : 1;
                }
        }
        mixture in_order = mixture_make(parts, N, ONE_AFTER_THE_OTHER, 0);
        assert_bits_of_each_alone_in(box, parts, N, &in_order);
        for (int p = 0; p < N; ++p) molecule_free(parts + p);
    }
}

/** A regular unit of molecules, with lists and without; positions without a report. */
static void equal_molecules_have_the_bits_of_each_alone(void **state)
{
    (void)state;
    enum { N = 27 }; /* some blocks of every number of lanes, and a rest */
    static const struct {
        molecule_kind kind;
        int64_t size;
    } kinds[] = {{MOLECULE_WATER, 3}, {MOLECULE_XH3, 3},  {MOLECULE_XH4, 4},      {MOLECULE_NEOPENTANE, 17},
                 {MOLECULE_COMB, 7},  {MOLECULE_RING, 8}, {MOLECULE_TRIANGLES, 6}};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; ++k) {
        molecule parts[N];
        for (int p = 0; p < N; ++p) {
            random_stream stream = random_seed((uint64_t)p + 1);
            parts[p] = molecule_make(kinds[k].kind, kinds[k].size, 1);
            for (int64_t i = 0; i < parts[p].n_atoms; ++i)
                for (int x = 0; x < 3; ++x) parts[p].r[3 * i + x] = parts[0].r[3 * i + (x + p) % 3];
            molecule_finish(parts + p, &stream);
            memcpy(parts[p].length, parts[0].length, (size_t)parts[0].n_bonds * sizeof(double));
        }
        mixture listed = interleaved(parts, N), in_order = mixture_make(parts, N, ONE_AFTER_THE_OTHER, 0);
        assert_int_equal(hol_chains_n_kinds(in_order.chains), 1);
        assert_bits_of_each_alone(parts, N, &listed);
        assert_bits_of_each_alone(parts, N, &in_order);
        for (int p = 0; p < N; ++p) molecule_free(parts + p);
    }
}

/** Trees of which no two are alike share the lanes of a vector: full blocks and a rest, in order and by lists. */
static void different_trees_have_the_bits_of_each_alone(void **state)
{
    (void)state;
    enum { N = 23 };
    static const molecule_kind kinds[] = {MOLECULE_TREE,        MOLECULE_STAR, MOLECULE_COMB,
                                          MOLECULE_ALKANE,      MOLECULE_TREE, MOLECULE_DENDRIMER,
                                          MOLECULE_FIXED_ATOMS, MOLECULE_TREE, MOLECULE_NEARLY_STRAIGHT_COMB,
                                          MOLECULE_LIGHT_JOINTS};
    const int64_t n_kinds = (int64_t)(sizeof kinds / sizeof *kinds);
    for (uint64_t seed = 1; seed <= 3; ++seed) {
        molecule parts[N];
        for (int64_t p = 0; p < N; ++p) {
            const molecule_kind kind = kinds[p % n_kinds];
            const int64_t size = kind == MOLECULE_DENDRIMER ? 2 + p / n_kinds : 5 + p;
            parts[p] = molecule_make(kind, size, seed + (uint64_t)p);
            for (int64_t i = 0; i < 3 * parts[p].n_atoms; ++i) /* light atoms are fast */
                parts[p].v[i] /= 1 + fabs(parts[p].v[i]);
        }
        mixture in_order = mixture_make(parts, N, ONE_AFTER_THE_OTHER, 0), listed = mixture_make(parts, N, MIXED, seed);
        assert_bits_of_each_alone(parts, N, &in_order);
        assert_bits_of_each_alone(parts, N, &listed);
        for (int p = 0; p < N; ++p) molecule_free(parts + p);
    }
}

static void layouts_of_doubles_change_no_bit(void **state)
{
    (void)state;
    mixture m = mixture_of_all(1, MIXED, 5);
    const size_t size = mixture_size(&m);
    double *lambda = untouched((size_t)m.n_bonds), *g = untouched(size), *v = copy_of(m.v, size);
    CHECK(hol_forces(m.chains, m.r, m.v, m.f, lambda, NULL, g, HOL_WRITE, NULL));
    CHECK(hol_project_velocities(m.chains, m.r, v, NULL, NULL));
    for (int k = 0; k < n_double_layouts; ++k) {
        laid_out r = lay_out(layouts + k, m.n_atoms, m.r, 3), u = lay_out(layouts + k, m.n_atoms, m.v, 3);
        laid_out f = lay_out(layouts + k, m.n_atoms, m.f, 3), out = lay_out(layouts + k, m.n_atoms, m.f, 3);
        double *got = untouched((size_t)m.n_bonds), *got_g = untouched(size), *got_v = untouched(size);
        CHECK(hol_forces_view(m.chains, INPUT(&r.view), INPUT(&u.view), INPUT(&f.view), got, NULL, &out.view, HOL_WRITE,
                              NULL));
        CHECK(hol_project_velocities_view(m.chains, INPUT(&r.view), &u.view, NULL, NULL));
        assert_same_bits(got, lambda, (size_t)m.n_bonds);
        collect(&out, got_g);
        collect(&u, got_v);
        for (int64_t p = 0; p < m.n_parts; ++p)
            for (int64_t a = m.first_atom[p]; a < m.first_atom[p + 1]; ++a) {
                const size_t i = 3 * (size_t)m.atoms[a];
                int has_bond = 0;
                for (int64_t b = 0; b < 2 * m.n_bonds; ++b) has_bond = has_bond || m.pairs[b] == m.atoms[a];
                if (has_bond && !isnan(g[i])) assert_same_bits(got_g + i, g + i, 3);
                assert_same_bits(got_v + i, v + i, 3);
            }
        assert_true(gaps_untouched(&out) && gaps_untouched(&u));
        laid_out_free(&r), laid_out_free(&u), laid_out_free(&f), laid_out_free(&out);
        free(got), free(got_g), free(got_v);
    }
    free(lambda), free(g), free(v);
    mixture_free(&m);
}

/** Copies of a molecule, one behind the other, with motions of their own. */
static mixture copies_in_motion(molecule_kind kind, int64_t size, int64_t n)
{
    enum { MOST = 61 };
    molecule parts[MOST];
    for (int64_t p = 0; p < n; ++p) {
        parts[p] = molecule_make(kind, size, 5);
        for (int64_t i = 0; i < 3 * parts[p].n_atoms; ++i) {
            parts[p].v[i] = (float)(parts[p].v[i] * (1 + 0.01 * (double)p));
            parts[p].f[i] = (float)(parts[p].f[i] * (1 - 0.01 * (double)p));
        }
    }
    mixture m = mixture_make(parts, n, ONE_AFTER_THE_OTHER, 0);
    for (size_t i = 0; i < mixture_size(&m); ++i) {
        m.r[i] = (float)m.r[i];
        m.v[i] = (float)m.v[i];
        m.f[i] = (float)m.f[i];
    }
    const int64_t atoms = parts[0].n_atoms, bonds = parts[0].n_bonds;
    for (int64_t k = 0; k < m.n_bonds; ++k) m.length[k] = parts[0].length[k % bonds];
    hol_chains_destroy(m.chains);
    CHECK(hol_chains_create(m.n_atoms, m.mass, &m.chains));
    CHECK(hol_chains_add_molecules(m.chains, n, atoms, 0, bonds, m.pairs, m.length));
    for (int64_t p = 0; p < n; ++p) molecule_free(parts + p);
    return m;
}

static void copies_are_the_same_through_every_layout(void **state)
{
    (void)state;
    static const struct {
        molecule_kind kind;
        int64_t size;
    } kinds[] = {{MOLECULE_WATER, 3},       {MOLECULE_XH2, 2},  {MOLECULE_XH3, 3},         {MOLECULE_XH4, 4},
                 {MOLECULE_ALKANE, 4},      {MOLECULE_RING, 6}, {MOLECULE_FIXED_ATOMS, 6}, {MOLECULE_TREE, 12},
                 {MOLECULE_FUSED_RINGS, 3}, {MOLECULE_COMB, 60}};
    const double dt = 1e-4;
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; ++k)
        for (int bad = 0; bad < 2; ++bad) {
            mixture m = copies_in_motion(kinds[k].kind, kinds[k].size, 61);
            const size_t size = mixture_size(&m), n = (size_t)m.n_bonds;
            double *start = copy_of(m.r, size), *reference = copy_of(m.r, size);
            for (size_t i = 0; i < size; ++i) start[i] += dt * m.v[i];
            if (bad) m.f[size / 2] = m.v[size / 2] = start[size / 2] = NAN;
            for (int l = quick_run() ? bad : 0; l < n_layouts; l += quick_run() ? 2 : 1) {
                double *lambda = untouched(n), *got = untouched(n), *g = copy_of(m.f, size), *v = copy_of(m.v, size),
                       *q = copy_of(start, size), *u = copy_of(m.f, size);
                laid_out r = lay_out(layouts + l, m.n_atoms, reference, 3), f = lay_out(layouts + l, m.n_atoms, m.f, 3),
                         w = lay_out(layouts + l, m.n_atoms, m.v, 3), out = lay_out(layouts + l, m.n_atoms, m.f, 3),
                         p = lay_out(layouts + l, m.n_atoms, start, 3), x = lay_out(layouts + l, m.n_atoms, m.f, 3);
                for (int mode = HOL_WRITE; mode <= HOL_ADD; ++mode) {
                    for (size_t i = 0; layouts[l].element == HOL_FLOAT && i < size; ++i) g[i] = (float)g[i];
                    const int status = hol_forces(m.chains, reference, m.v, m.f, lambda, NULL, g, mode, NULL);
                    assert_int_equal(status, hol_forces_view(m.chains, INPUT(&r.view), INPUT(&w.view), INPUT(&f.view),
                                                             got, NULL, &out.view, mode, NULL));
                    /* sums at fixed atoms are rounded to floats on the way */
                    if (l < n_double_layouts || kinds[k].kind != MOLECULE_FIXED_ATOMS)
                        assert_laid_out(&out, g, layouts[l].name);
                    assert_same_bits(got, lambda, n);
                }
                const int of_v = hol_project_velocities(m.chains, reference, v, lambda, NULL);
                assert_int_equal(of_v, hol_project_velocities_view(m.chains, INPUT(&r.view), &w.view, got, NULL));
                if (l < n_double_layouts) { /* velocities that become floats are not corrected twice */
                    const int of_r = hol_project_positions(m.chains, reference, q, u, dt, lambda, 0, NULL, NULL);
                    assert_laid_out(&w, v, layouts[l].name);
                    assert_int_equal(of_r, hol_project_positions_view(m.chains, INPUT(&r.view), &p.view, &x.view, dt,
                                                                      got, 0, NULL, NULL));
                    assert_laid_out(&p, q, layouts[l].name);
                    assert_laid_out(&x, u, layouts[l].name);
                    assert_same_bits(got, lambda, n);
                }
                assert_true(gaps_untouched(&w) && gaps_untouched(&p));
                laid_out_free(&r), laid_out_free(&f), laid_out_free(&w), laid_out_free(&out), laid_out_free(&p),
                    laid_out_free(&x);
                free(lambda), free(got), free(g), free(v), free(q), free(u);
            }
            free(start), free(reference);
            mixture_free(&m);
        }
}

/** Inputs rounded to floats are as exact as any: lambda is that of the rounded numbers. */
static void floats_and_two_dimensions_give_the_solution_of_the_rounded_numbers(void **state)
{
    (void)state;
    for (int k = 0; k < n_layouts; ++k)
        for (int dimensions = 2; dimensions <= 3; ++dimensions) {
            molecule part = molecule_make(MOLECULE_TREE, 12, 6);
            mixture m = mixture_make(&part, 1, ONE_AFTER_THE_OTHER, 0);
            laid_out r = lay_out(layouts + k, m.n_atoms, m.r, dimensions);
            laid_out v = lay_out(layouts + k, m.n_atoms, m.v, dimensions),
                     f = lay_out(layouts + k, m.n_atoms, m.f, dimensions);
            double *lambda = untouched((size_t)m.n_bonds);
            CHECK(hol_forces_view(m.chains, INPUT(&r.view), INPUT(&v.view), INPUT(&f.view), lambda, NULL, NULL,
                                  HOL_WRITE, NULL));
            double *const inputs[3] = {part.r, part.v, part.f};
            const laid_out *const views[3] = {&r, &v, &f};
            for (int n = 0; n < 3; ++n) {
                collect(views[n], inputs[n]);
                for (int64_t i = 0; dimensions == 2 && i < part.n_atoms; ++i) inputs[n][3 * i + 2] = 0;
            }
            const molecule_problem problem = molecule_problem_of(&part);
            molecule_solution exact;
            assert_int_equal(molecule_forces(&problem, &exact), 0);
            for (int64_t b = 0; b < m.n_bonds; ++b)
                CHECK_AT_MOST(fabsl(lambda[b] - exact.lambda[b]),
                              oracle_bound(m.n_bonds) * DBL_EPSILON * exact.lambda_scale[b]);
            molecule_solution_free(&exact);
            laid_out_free(&r), laid_out_free(&v), laid_out_free(&f);
            free(lambda);
            mixture_free(&m);
            molecule_free(&part);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(order_and_direction_of_bonds_and_placement_change_no_bit),
        cmocka_unit_test(number_of_threads_changes_no_bit),
        cmocka_unit_test(one_call_for_copies_gives_the_bits_of_the_list),
        cmocka_unit_test(equal_molecules_have_the_bits_of_each_alone),
        cmocka_unit_test(graphs_in_a_box_have_the_bits_of_each_alone),
        cmocka_unit_test(different_trees_have_the_bits_of_each_alone),
        cmocka_unit_test(layouts_of_doubles_change_no_bit),
        cmocka_unit_test(copies_are_the_same_through_every_layout),
        cmocka_unit_test(floats_and_two_dimensions_give_the_solution_of_the_rounded_numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
