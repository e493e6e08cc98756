/** Bad data in large molecules of repeating units: the molecule is named and left as it was, the others are complete.
 */
#include "large.h"
#include "residue_checks.h"
#include "residue_flock.h"

enum { COPIES = 3, BAD = 1 };
static const double dt = 1e-3;

/** Where an atom stands in its molecule. */
typedef enum place { AT_A_LINK, AT_AN_END, IN_A_RING, FIRST, LAST, PLACES } place;
static const char *const place_words[PLACES] = {"at a link", "at an end", "in a ring", "first", "last"};

static int64_t atom_at(const residues *s, place where)
{
    const molecule *m = &s->m;
    int *bonds = calloc((size_t)m->n_atoms, sizeof *bonds), ring = 0;
    int64_t link = -1, end = -1, closing = -1;
    for (int64_t e = 0; e < 2 * m->n_bonds; ++e) ++bonds[m->pairs[e]];
    for (int64_t k = 0; k < m->n_bonds; ++k) {
        const int64_t i = m->pairs[2 * k], j = m->pairs[2 * k + 1];
        if (residues_link(s, k) && k < m->n_bonds / 2) link = i;
        if (bonds[j] == 1 && k < m->n_bonds / 3) end = j;
        if (j > i + 3 && !residues_link(s, k) && !ring) closing = j, ring = k > m->n_bonds / 4;
    }
    free(bonds);
    const int64_t atom[PLACES] = {link, end, closing, 0, m->n_atoms - 1};
    assert_true(atom[where] >= 0);
    return atom[where];
}

/** Three copies in one set, and their results while all is well. */
typedef struct flock {
    molecule all;
    hol_chains *chains;
    residue_results good;
    int64_t n_bonds, n_atoms; /* of one */
} flock;

static flock make_flock(const residues *s)
{
    flock x = {residue_copies(&s->m, COPIES), NULL, {{0}, {0}, {0}, 0, 0}, s->m.n_bonds, s->m.n_atoms};
    for (int64_t i = 0; i < 3 * x.all.n_atoms; ++i) x.all.f[i] /= i / 3 / x.n_atoms == BAD ? 1e9 : 1;
    x.chains = residue_chains(&x.all, NULL);
    x.good = residue_compute(x.chains, &x.all, dt);
    return x;
}

static void free_flock(flock *x)
{
    residue_results_free(&x->good);
    hol_chains_destroy(x->chains);
    molecule_free(&x->all);
}

/** The call just made failed for the bad one, and said so; at this atom, unless it is -1. */
static void assert_named(int64_t atom)
{
    int64_t which = -9, count = -9, where = -9;
    hol_error_location(&which, NULL, &where, &count);
    assert_int_equal(which, BAD);
    assert_int_equal(count, 1);
    assert_message_names("molecule 1");
    if (atom >= 0) assert_int_equal(where, atom);
}

/** The bad copy's part is as before, the others' as if all were well. */
static void assert_others(const flock *x, const double *got, const double *good, const double *before, int per_atom)
{
    const size_t n = (size_t)(per_atom ? 3 * x->n_atoms : x->n_bonds);
    for (size_t c = 0; c < COPIES; ++c) {
        const double *const expected = c != BAD ? good + c * n : before ? before + c * n : NULL;
        expected ? assert_same_bits(got + c * n, expected, n) : assert_untouched(got + c * n, n);
    }
}

static void forces_fail(const flock *x, int status, int64_t atom)
{
    const molecule *m = &x->all;
    const size_t n = (size_t)m->n_bonds, size = 3 * (size_t)m->n_atoms;
    double *lambda = untouched(n), *tension = untouched(n), *g = untouched(size), *virial = untouched(9);
    CHECK_FAILS(status, hol_forces(x->chains, m->r, m->v, m->f, lambda, tension, g, HOL_WRITE, virial));
    assert_named(atom);
    assert_others(x, lambda, x->good.bond[0], NULL, 0);
    assert_others(x, tension, x->good.bond[1], NULL, 0);
    assert_others(x, g, x->good.atom[0], NULL, 1);
    assert_untouched(virial, 9);
    free(lambda), free(tension), free(g), free(virial);
}

static void solve_fails(const flock *x, const double *rhs, int status, int64_t atom)
{
    double *lambda = untouched((size_t)x->all.n_bonds), *g = untouched(3 * (size_t)x->all.n_atoms);
    CHECK_FAILS(status, hol_solve(x->chains, x->all.r, rhs, lambda, g, HOL_WRITE, NULL));
    assert_named(atom);
    assert_others(x, lambda, x->good.bond[2], NULL, 0);
    assert_untouched(g + 3 * BAD * x->n_atoms, 3 * (size_t)x->n_atoms);
    free(lambda), free(g);
}

static void velocities_fail(const flock *x, int status, int64_t atom)
{
    const molecule *m = &x->all;
    double *lambda = untouched((size_t)m->n_bonds), *v = copy_of(m->v, 3 * (size_t)m->n_atoms);
    double *virial = untouched(9);
    CHECK_FAILS(status, hol_project_velocities(x->chains, m->r, v, lambda, virial));
    assert_named(atom);
    assert_others(x, lambda, x->good.bond[3], NULL, 0);
    assert_others(x, v, x->good.atom[1], m->v, 1);
    assert_untouched(virial, 9);
    free(lambda), free(v), free(virial);
}

static void positions_fail(const flock *x, const double *drifted, int status, int64_t atom)
{
    const molecule *m = &x->all;
    const size_t size = 3 * (size_t)m->n_atoms;
    double *lambda = untouched((size_t)m->n_bonds), *v = copy_of(m->v, size), *r = copy_of(drifted, size);
    double *virial = untouched(9);
    hol_report report;
    CHECK_FAILS(status, hol_project_positions(x->chains, m->r, r, v, dt, lambda, 0, virial, &report));
    assert_named(atom);
    assert_int_equal(report.n_failed, 1);
    assert_int_equal(report.n_corrected, COPIES - 1);
    assert_int_not_equal(report.molecule, BAD);
    assert_others(x, lambda, x->good.bond[4], NULL, 0);
    assert_others(x, r, x->good.atom[2], drifted, 1);
    assert_others(x, v, x->good.atom[3], m->v, 1);
    assert_untouched(virial, 9);
    free(lambda), free(v), free(r), free(virial);
}

static void spoil_at(const flock *x, int64_t atom, double bad)
{
    const size_t at = 3 * (size_t)atom + (size_t)(atom % 3);
    const double r = x->all.r[at], v = x->all.v[at], f = x->all.f[at];
    x->all.f[at] = bad;
    forces_fail(x, HOL_ERR_NOT_FINITE, atom);
    x->all.f[at] = f;
    double *drifted = molecule_drifted(&x->all, dt);
    x->all.v[at] = bad;
    forces_fail(x, HOL_ERR_NOT_FINITE, atom);
    velocities_fail(x, HOL_ERR_NOT_FINITE, atom);
    x->all.v[at] = v;
    drifted[at] = bad;
    positions_fail(x, drifted, HOL_ERR_NOT_FINITE, atom);
    free(drifted);
    drifted = molecule_drifted(&x->all, dt);
    x->all.r[at] = bad;
    forces_fail(x, HOL_ERR_NOT_FINITE, atom);
    solve_fails(x, x->all.length, HOL_ERR_NOT_FINITE, atom);
    velocities_fail(x, HOL_ERR_NOT_FINITE, atom);
    positions_fail(x, drifted, HOL_ERR_NOT_FINITE, atom);
    x->all.r[at] = r;
    free(drifted);
}

static void name_what_is_not_finite(residues *s)
{
    flock x = make_flock(s);
    double *rhs = copy_of(x.all.length, (size_t)x.all.n_bonds);
    for (int where = 0; where < (quick_run() ? 1 : PLACES); ++where) {
        const int64_t atom = BAD * x.n_atoms + atom_at(s, (place)where);
        if (x.all.mass[atom] == 0) continue; /* no force moves it, and none is read */
        spoil_at(&x, atom, where % 2 ? INFINITY : NAN);
        const int64_t bond = BAD * x.n_bonds + (where + 1) * x.n_bonds / (PLACES + 1);
        const double was = rhs[bond];
        rhs[bond] = NAN;
        solve_fails(&x, rhs, HOL_ERR_NOT_FINITE, -1);
        rhs[bond] = was;
    }
    free(rhs);
    free_flock(&x);
}

/** Bonds without length, at a link and in a residue; atoms far away, and one beside its bond by three times that. */
static void name_what_can_not_be(residues *s)
{
    flock x = make_flock(s);
    double *const r = x.all.r, *drifted = molecule_drifted(&x.all, dt);
    for (int where = 0; where < (quick_run() ? 1 : PLACES); ++where) {
        const int64_t atom = BAD * x.n_atoms + atom_at(s, (place)where);
        if (x.all.mass[atom] == 0) continue;
        print_message("    %s\n", place_words[where]);
        int64_t k = 0;
        while (x.all.pairs[2 * k] != atom && x.all.pairs[2 * k + 1] != atom) ++k;
        const int64_t other = x.all.pairs[2 * k + (x.all.pairs[2 * k] == atom)];
        double before[3], *there = drifted + 3 * atom;
        memcpy(before, r + 3 * atom, sizeof before);
        memcpy(r + 3 * atom, r + 3 * other, sizeof before);
        forces_fail(&x, HOL_ERR_DEGENERATE, -1);
        solve_fails(&x, x.all.length, HOL_ERR_DEGENERATE, -1);
        velocities_fail(&x, HOL_ERR_DEGENERATE, -1);
        memcpy(r + 3 * atom, before, sizeof before);
        memcpy(before, there, sizeof before);
        there[1] += 1e4;
        positions_fail(&x, drifted, HOL_ERR_NO_CONVERGENCE, -1);
        CHECK(hol_chains_set_checks(x.chains, HOL_NEVER));
        positions_fail(&x, drifted, HOL_ERR_NO_CONVERGENCE, -1);
        CHECK(hol_chains_set_checks(x.chains, HOL_AT_START));
        memcpy(there, before, sizeof before);
        if (where == AT_AN_END) {
            const double *const d = r + 3 * atom, *const e = r + 3 * other;
            const double side[3] = {d[1] - e[1], e[0] - d[0], 0}, size = hypot(side[0], side[1]);
            for (int c = 0; c < 3; ++c) there[c] += 4 * side[c] / size;
            positions_fail(&x, drifted, HOL_ERR_NO_CONVERGENCE, -1);
            memcpy(there, before, sizeof before);
        }
        double *end = copy_of(drifted, 3 * (size_t)x.all.n_atoms); /* and all is well again */
        CHECK(hol_project_positions(x.chains, r, end, NULL, dt, NULL, 0, NULL, NULL));
        assert_same_bits(end, x.good.atom[2], 3 * (size_t)x.all.n_atoms);
        free(end);
    }
    free(drifted);
    free_flock(&x);
}

/** To say what is wrong with a molecule takes as long as thousands of calls. */
static int64_t size_of_test(void)
{
    return quick_run() ? 300 : 500;
}

static void what_is_not_finite_is_named_and_changes_nothing_else(void **state)
{
    (void)state;
    static const int recipes[] = {RANDOM_SEQUENCE, FIXED_ENDS, SUGARS, BRIDGES, TREE, UNEQUAL_KINDS, -1};
    for_some_residues(recipes, size_of_test(), name_what_is_not_finite);
}

static void what_can_not_be_is_named_and_changes_nothing_else(void **state)
{
    (void)state;
    static const int recipes[] = {RANDOM_SEQUENCE, FIXED_ENDS, STAR, -1};
    for_some_residues(recipes, size_of_test(), name_what_can_not_be);
}

static void leave_everything(residues *s)
{
    check_bad_data_change_nothing(&s->m, s->chains, 1);
}
static void bad_data_of_one_alone_leave_everything_untouched(void **state)
{
    (void)state;
    static const int recipes[] = {RANDOM_SEQUENCE, SUGARS, CLOSED, COMB, OWN_KINDS, IN_BOX, UNEQUAL_ATOMS, -1};
    for_some_residues(recipes, size_of_test(), leave_everything);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_not_finite_is_named_and_changes_nothing_else),
        cmocka_unit_test(what_can_not_be_is_named_and_changes_nothing_else),
        cmocka_unit_test(bad_data_of_one_alone_leave_everything_untouched),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
