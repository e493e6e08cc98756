/** An output in the place of an input, where the header allows it, gives the bits that arrays of their own give. */
#include "check.h"
#include "input.h"
#include "large.h"
#include "mixture.h"

/** A view with room between atoms, of the numbers of a packed array; or the packed array itself. */
typedef struct any_array {
    hol_view view;
    double *memory;
    size_t n;
} any_array;

static any_array array_of(const double *packed, size_t size, int apart)
{
    const size_t step = apart ? 5 : 3;
    any_array a = {.memory = untouched(step * size / 3), .n = size / 3};
    for (size_t i = 0; i < size; ++i) a.memory[i / 3 * step + i % 3] = packed[i];
    a.view = (hol_view){a.memory, a.memory + 1, a.memory + 2, (int64_t)(step * sizeof(double)), HOL_DOUBLE, 0};
    return a;
}

static void assert_same_arrays(const any_array *a, const any_array *b)
{
    for (size_t i = 0; i < a->n; ++i) {
        const size_t at = i * (size_t)a->view.stride / sizeof(double);
        assert_same_bits(a->memory + at, b->memory + at, 3);
    }
}

static void release(any_array *a, any_array *b)
{
    free(a->memory);
    if (b) free(b->memory);
}

static void forces_may_stand_where_forces_stood(const mixture *m, int apart, int mode)
{
    const size_t size = mixture_size(m), n = (size_t)m->n_bonds;
    any_array r = array_of(m->r, size, apart), v = array_of(m->v, size, apart), f = array_of(m->f, size, apart);
    any_array g = array_of(m->f, size, apart);
    double *lambda = untouched(n), *other = untouched(n), virial[9], sum[9];
    CHECK(hol_forces_view(m->chains, INPUT(&r.view), INPUT(&v.view), INPUT(&f.view), lambda, NULL, &g.view, mode,
                          virial));
    CHECK(hol_forces_view(m->chains, INPUT(&r.view), INPUT(&v.view), INPUT(&f.view), other, NULL, &f.view, mode, sum));
    assert_same_arrays(&g, &f);
    assert_same_bits(lambda, other, n);
    assert_same_bits(virial, sum, 9);
    release(&r, &v), release(&f, &g), free(lambda), free(other);
}

static void multipliers_may_stand_where_right_hand_sides_stood(const mixture *m)
{
    const size_t n = (size_t)m->n_bonds;
    double *lambda = untouched(n), *both = copy_of(m->length, n);
    CHECK(hol_solve(m->chains, m->r, m->length, lambda, NULL, HOL_WRITE, NULL));
    CHECK(hol_solve(m->chains, m->r, both, both, NULL, HOL_WRITE, NULL));
    assert_same_bits(lambda, both, n);
    free(lambda), free(both);
}

/** From positions that are off their lengths, along their own bonds. */
static void positions_may_be_their_own_reference(const mixture *m, int apart)
{
    const size_t size = mixture_size(m), n = (size_t)m->n_bonds;
    double *off = mixture_drifted(m, 1e-3);
    any_array r = array_of(off, size, apart), ref = array_of(off, size, apart), own = array_of(off, size, apart);
    any_array v = array_of(m->v, size, apart), u = array_of(m->v, size, apart);
    double *lambda = untouched(n), *other = untouched(n), virial[9], sum[9];
    hol_report report, own_report;
    const int status =
        hol_project_positions_view(m->chains, INPUT(&ref.view), &r.view, &v.view, 1e-3, lambda, 0, virial, &report);
    assert_int_equal(
        hol_project_positions_view(m->chains, INPUT(&own.view), &own.view, &u.view, 1e-3, other, 0, sum, &own_report),
        status);
    assert_same_arrays(&r, &own);
    assert_same_arrays(&v, &u);
    assert_same_bits(lambda, other, n);
    assert_int_equal(report.iterations, own_report.iterations);
    if (status == HOL_OK) assert_same_bits(virial, sum, 9);
    if (status == HOL_OK) {
        hol_worst worst;
        CHECK(hol_violation_view(m->chains, INPUT(&own.view), NULL, &worst));
        CHECK_AT_MOST(worst.length, 1e-9);
    }
    release(&r, &ref), release(&v, &u), release(&own, NULL), free(off), free(lambda), free(other);
}

static void check(const mixture *m)
{
    CHECK(hol_chains_set_checks(m->chains, HOL_NEVER));
    multipliers_may_stand_where_right_hand_sides_stood(m);
    for (int apart = 0; apart < 2; ++apart) {
        if (!quick_run() || !apart) forces_may_stand_where_forces_stood(m, apart, HOL_WRITE);
        if (!quick_run() || apart) forces_may_stand_where_forces_stood(m, apart, HOL_ADD);
        positions_may_be_their_own_reference(m, apart);
    }
}

/** Alone, with others like it, and among other atoms; of large molecules one other is enough. Under slow tools those
 * like it are left out, large molecules are among other atoms only, and there are none of thousands of bonds but trees.
 */
static void check_molecule(molecule m)
{
    molecule parts[5] = {m, m, m, m, m};
    for (int i = quick_run() && m.n_bonds > 256 ? 2 : 0; i < 3; i += quick_run() ? 2 : 1) {
        mixture x = mixture_make(parts, i == 0 ? 1 : m.n_bonds > 1000 ? 2 : 5, i == 2 ? MIXED : ONE_AFTER_THE_OTHER, 7);
        check(&x);
        mixture_free(&x);
    }
    molecule_free(&m);
}

static void small_molecules(void **state)
{
    (void)state;
    for (int kind = 0; kind < MOLECULE_KINDS; ++kind) /* the last ones are bodies */
        if (kind != MOLECULE_TAUT_EXACTLY)
            check_molecule(molecule_make((molecule_kind)kind, kind == MOLECULE_DENDRIMER ? 2 : 6, 3));
}

static void chains_and_rings_of_any_length(void **state)
{
    (void)state;
    static const int64_t chains[] = {1, 2, 3, 4, 5, 6, 40, 256, 257, 400, 1000, 2050, 4100};
    for (size_t i = 0; i < sizeof chains / sizeof *chains && !(quick_run() && chains[i] > 1000); ++i)
        check_molecule(molecule_make(MOLECULE_CHAIN, chains[i], 11 + i));
    static const int64_t rings[] = {4, 12, 100, 300, 600, 2600, 4100};
    for (size_t i = 0; i < sizeof rings / sizeof *rings && !(quick_run() && rings[i] > 1000); ++i)
        check_molecule(molecule_make(MOLECULE_RING, rings[i], 40 + i));
    check_molecule(molecule_make(MOLECULE_LARIAT, 300, 5));
}

static void large_molecules(void **state)
{
    (void)state;
    static const int64_t coils[] = {300, 700, 500, 900};
    molecule arms = large_arms(300, 306, 2);
    large_turn_bonds(&arms);
    check_molecule(arms);
    check_molecule(large_coils(coils, 4, 1));
    check_molecule(large_mixed_arms(3000));
    check_molecule(large_segments(3000, 150, 0, 3));
    check_molecule(large_segments(3000, 150, 40, 3));
    check_molecule(large_comb(3000));
    check_molecule(large_hub(3000, 40));
    check_molecule(large_rings(3000));
    check_molecule(large_ladder(500));
    check_molecule(molecule_make(MOLECULE_TREE, 5000, 2));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(small_molecules),
        cmocka_unit_test(chains_and_rings_of_any_length),
        cmocka_unit_test(large_molecules),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
