/**
 * Molecules with bad data among good ones: a bad one's outputs keep every bit, the good ones are complete, sums are not
 * written, and the message names the first bad one and how many there are.
 */
#include "check.h"
#include "mixture.h"

enum { SPOILERS = 6 };

static const char *const spoiler_words[SPOILERS] = {"NaN position", "infinite position", "NaN velocity",
                                                    "NaN force",    "infinite force",    "bond of zero length"};

/** Spoils one part at the second end of its first bond. */
static void spoil(mixture *m, int64_t part, int how)
{
    const molecule *p = m->parts + part;
    const int64_t *atoms = m->atoms + m->first_atom[part];
    const int64_t i = 3 * atoms[p->pairs[0]], j = 3 * atoms[p->pairs[1]];
    if (how == 0) m->r[j + 1] = NAN;
    if (how == 1) m->r[j] = INFINITY;
    if (how == 2) m->v[j + 2] = NAN;
    if (how == 3) m->f[j] = NAN;
    if (how == 4) m->f[j + 1] = -INFINITY;
    if (how == 5) memcpy(m->r + j, m->r + i, 3 * sizeof *m->r);
}

/** The library's number of a part that is one molecule. */
static int64_t number_of(const mixture *m, int64_t part)
{
    int64_t *molecules = calloc((size_t)m->n_bonds, sizeof *molecules);
    CHECK(hol_chains_molecules_of_bonds(m->chains, molecules));
    const int64_t c = molecules[m->bonds[m->first_bond[part]]];
    free(molecules);
    return c;
}

typedef struct outputs {
    double *per_bond[3], *per_atom[3]; /* lambda, tension, mu; g, v, Fixman force */
    double *log_det, virial[9], energy;
    int status[3];
} outputs;

static outputs compute(const mixture *m)
{
    outputs o;
    const size_t n = (size_t)m->n_bonds, size = mixture_size(m);
    for (int k = 0; k < 3; ++k) o.per_bond[k] = untouched(n), o.per_atom[k] = untouched(size);
    memcpy(o.per_atom[1], m->v, size * sizeof(double));
    o.log_det = untouched((size_t)hol_chains_n_molecules(m->chains));
    double *blank = untouched(10);
    memcpy(o.virial, blank, sizeof o.virial);
    memcpy(&o.energy, blank, sizeof o.energy);
    free(blank);
    o.status[1] = hol_project_velocities(m->chains, m->r, o.per_atom[1], o.per_bond[2], NULL);
    o.status[2] = hol_metric(m->chains, m->r, 1, o.log_det, NULL, &o.energy, o.per_atom[2], HOL_WRITE);
    o.status[0] =
        hol_forces(m->chains, m->r, m->v, m->f, o.per_bond[0], o.per_bond[1], o.per_atom[0], HOL_WRITE, o.virial);
    return o;
}

static void release(outputs *o)
{
    for (int k = 0; k < 3; ++k) free(o->per_bond[k]), free(o->per_atom[k]);
    free(o->log_det);
}

/** The parts of two arrays are the same bits. */
static void assert_part(const mixture *m, int64_t part, const double *got, const double *expected, int per_atom)
{
    const size_t n = (size_t)(per_atom ? 3 * m->parts[part].n_atoms : m->parts[part].n_bonds);
    double *a = untouched(n), *b = untouched(n);
    if (per_atom) {
        mixture_take(m, part, got, a);
        mixture_take(m, part, expected, b);
    } else {
        mixture_take_bonds(m, part, got, a);
        mixture_take_bonds(m, part, expected, b);
    }
    assert_same_bits(a, b, n);
    free(a), free(b);
}

static int is_bad(const int64_t *bad, int n_bad, int64_t part)
{
    for (int i = 0; i < n_bad; ++i)
        if (bad[i] == part) return 1;
    return 0;
}

static void check_with(int how, molecule_kind kind, const int64_t *bad, int n_bad, int threads)
{
    mixture m = mixture_of_kind(kind, 23, 4, 6, MIXED, 21);
    const int expected_status = how == 5 ? HOL_ERR_DEGENERATE : HOL_ERR_NOT_FINITE;
    CHECK(hol_chains_set_threads(m.chains, threads));
    outputs good = compute(&m);
    double *nothing = untouched((size_t)m.n_bonds + mixture_size(&m));
    for (int i = 0; i < n_bad; ++i) spoil(&m, bad[i], how);
    outputs o = compute(&m);
    /* velocities are no input of the metric, forces only of the forces */
    const int affects[3] = {1, how != 3 && how != 4, how != 2 && how != 3 && how != 4};
    for (int level = 0; level < 3; ++level)
        assert_int_equal(o.status[level], affects[level] ? expected_status : HOL_OK);
    int64_t first = -1, chain, count;
    for (int i = 0; i < n_bad; ++i) {
        const int64_t c = number_of(&m, bad[i]);
        if (first < 0 || c < first) first = c;
    }
    hol_error_location(&chain, NULL, NULL, &count); /* of the last call that failed, hol_forces */
    assert_int_equal(chain, first);
    assert_int_equal(count, n_bad);
    assert_untouched(o.virial, 9);
    if (affects[2]) assert_untouched(&o.energy, 1);
    for (int64_t p = 0; p < m.n_parts; ++p) {
        const int wrong = is_bad(bad, n_bad, p);
        for (int k = 0; k < 3; ++k)
            assert_part(&m, p, o.per_bond[k], wrong && affects[k == 2] ? nothing : good.per_bond[k], 0);
        assert_part(&m, p, o.per_atom[0], wrong ? nothing : good.per_atom[0], 1);
        assert_part(&m, p, o.per_atom[1], wrong && affects[1] ? m.v : good.per_atom[1], 1);
        assert_part(&m, p, o.per_atom[2], wrong && affects[2] ? nothing : good.per_atom[2], 1);
    }
    free(nothing);
    release(&good), release(&o);
    mixture_free(&m);
}

static void bad_molecules_keep_their_outputs_and_the_others_are_complete(void **state)
{
    (void)state;
    static const molecule_kind kinds[] = {MOLECULE_WATER, MOLECULE_XH3,       MOLECULE_TREE,
                                          MOLECULE_RING,  MOLECULE_TRIANGLES, MOLECULE_FUSED_RINGS};
    static const int64_t one[] = {13}, several[] = {0, 4, 5, 6, 22};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; ++k)
        for (int how = 0; how < SPOILERS; ++how) {
            print_message("%s: %s\n", molecule_kind_name(kinds[k]), spoiler_words[how]);
            check_with(how, kinds[k], one, 1, 1);
            if (quick_run()) continue;
            check_with(how, kinds[k], several, 5, 1);
            check_with(how, kinds[k], several, 5, 3);
        }
}

/** Positions: a molecule with bad data, or one that cannot be reached, stays where it was. */
static void positions_of_bad_molecules_stay(void **state)
{
    (void)state;
    static const molecule_kind kinds[] = {MOLECULE_WATER, MOLECULE_TREE, MOLECULE_RING, MOLECULE_CUBE};
    const double dt = 1e-3;
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; ++k)
        for (int how = 0; how < 4; ++how) {
            mixture m = mixture_of_kind(kinds[k], 15, 4, 6, MIXED, 31);
            const size_t size = mixture_size(&m), n = (size_t)m.n_bonds;
            double *drifted = mixture_drifted(&m, dt), *nothing = untouched(n);
            double *good = copy_of(drifted, size), *good_lambda = untouched(n);
            CHECK(hol_project_positions(m.chains, m.r, good, NULL, dt, good_lambda, 0, NULL, NULL));
            const molecule *part = m.parts + 7;
            const int64_t *atoms = m.atoms + m.first_atom[7];
            if (how == 0) drifted[3 * atoms[part->pairs[1]]] = NAN;
            if (how == 3) CHECK(hol_chains_set_checks(m.chains, HOL_NEVER));
            if (how == 1 || how == 3) drifted[3 * atoms[part->pairs[1]]] += 1e4; /* nowhere near its bonds' lengths */
            if (how == 2) spoil(&m, 7, 5);
            double *r = copy_of(drifted, size), *v = copy_of(m.v, size), *lambda = untouched(n);
            double *virial = untouched(9);
            hol_report report;
            CHECK_FAILS(how == 0   ? HOL_ERR_NOT_FINITE
                        : how == 2 ? HOL_ERR_DEGENERATE
                                   : HOL_ERR_NO_CONVERGENCE,
                        hol_project_positions(m.chains, m.r, r, v, dt, lambda, 0, virial, &report));
            int64_t chain, count;
            hol_error_location(&chain, NULL, NULL, &count);
            assert_int_equal(chain, number_of(&m, 7));
            assert_int_equal(count, 1);
            assert_int_equal(report.n_failed, 1);
            assert_int_equal(report.n_corrected, 14);
            assert_untouched(virial, 9);
            for (int64_t p = 0; p < m.n_parts; ++p) {
                assert_part(&m, p, r, p == 7 ? drifted : good, 1);
                assert_part(&m, p, lambda, p == 7 ? nothing : good_lambda, 0);
                if (p == 7) assert_part(&m, p, v, m.v, 1);
            }
            free(drifted), free(nothing), free(good), free(good_lambda), free(r), free(v), free(lambda), free(virial);
            mixture_free(&m);
        }
}

/** The last bond a little shorter than it is: lengths that fit exactly would make three atoms on a line, or four in a
 * plane, a rigid body. */
static molecule not_quite(molecule_kind kind, int size, uint64_t seed)
{
    molecule part = molecule_make(kind, size, seed);
    if (kind == MOLECULE_LINEAR) part.length[part.n_bonds - 1] *= 0.98;
    if (kind == MOLECULE_PLANAR_SQUARE) part.length[part.n_bonds - 1] *= 1.02;
    return part;
}

/** Three distances on a line, a planar frame, a branched path taut between fixed atoms: among good molecules. */
static void degenerate_molecules_are_refused_and_the_others_are_complete(void **state)
{
    (void)state;
    static const molecule_kind kinds[] = {MOLECULE_LINEAR, MOLECULE_PLANAR_SQUARE, MOLECULE_TAUT_EXACTLY};
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; ++k) {
        molecule parts[5];
        for (uint64_t p = 0; p < 5; ++p) parts[p] = not_quite(p == 2 ? kinds[k] : MOLECULE_WATER, 4, p);
        mixture m = mixture_make(parts, 5, MIXED, 41 + k);
        const size_t n = (size_t)m.n_bonds, size = mixture_size(&m);
        outputs o = compute(&m);
        double *nothing = untouched(n + size), *r = mixture_drifted(&m, 1e-3), *drifted = copy_of(r, size);
        for (int level = 0; level < 3; ++level) assert_int_equal(o.status[level], HOL_ERR_DEGENERATE);
        int64_t chain, bond, count;
        hol_error_location(&chain, &bond, NULL, &count);
        assert_int_equal(chain, number_of(&m, 2));
        assert_in_range(bond, 0, parts[2].n_bonds - 1);
        assert_int_equal(count, 1);
        assert_part(&m, 2, o.per_bond[0], nothing, 0);
        assert_part(&m, 2, o.per_bond[2], nothing, 0);
        assert_part(&m, 2, o.per_atom[0], nothing, 1);
        assert_part(&m, 2, o.per_atom[1], m.v, 1);
        assert_part(&m, 2, o.per_atom[2], nothing, 1);
        const int status = hol_project_positions(m.chains, m.r, r, NULL, 1e-3, NULL, 0, NULL, NULL);
        assert_true(status == HOL_ERR_DEGENERATE || status == HOL_ERR_NO_CONVERGENCE);
        assert_part(&m, 2, r, drifted, 1);
        for (int64_t p = 0; p < 5; ++p) {
            if (p == 2) continue;
            mixture alone = mixture_make(parts + p, 1, ONE_AFTER_THE_OTHER, 0);
            outputs of_one = compute(&alone);
            double *lambda = untouched(3);
            mixture_take_bonds(&m, p, o.per_bond[0], lambda);
            assert_same_bits(lambda, of_one.per_bond[0], 3);
            free(lambda);
            release(&of_one);
            mixture_free(&alone);
        }
        free(nothing), free(r), free(drifted);
        release(&o);
        mixture_free(&m);
        for (int p = 0; p < 5; ++p) molecule_free(parts + p);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bad_molecules_keep_their_outputs_and_the_others_are_complete),
        cmocka_unit_test(positions_of_bad_molecules_stay),
        cmocka_unit_test(degenerate_molecules_are_refused_and_the_others_are_complete),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
