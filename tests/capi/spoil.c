#include "spoil.h"

#include "check.h"

const char *const spoiler_words[SPOILERS] = {"nan position",   "infinite position", "nan velocity",    "nan force",
                                             "infinite force", "zero bond",         "overflowing bond"};

void spoil(assembly *a, int64_t c, int64_t at, spoiler how)
{
    const int64_t atom = a->atoms[a->first[c] + at], before = a->atoms[a->first[c] + at - 1];
    switch (how) {
        case NAN_POSITION:
            a->r[3 * atom + 1] = NAN;
            break;
        case INFINITE_POSITION:
            a->r[3 * atom + 2] = INFINITY;
            break;
        case NAN_VELOCITY:
            a->v[3 * atom] = NAN;
            break;
        case NAN_FORCE:
            a->f[3 * atom + 2] = NAN;
            break;
        case INFINITE_FORCE:
            a->f[3 * atom + 1] = -INFINITY;
            break;
        case ZERO_BOND:
            memcpy(a->r + 3 * atom, a->r + 3 * before, 3 * sizeof(double));
            break;
        case OVERFLOWING_BOND:
            a->r[3 * atom] = 1e300;
            break;
        default:
            break;
    }
}

int expected_status(spoiler how)
{
    return how == ZERO_BOND ? HOL_ERR_DEGENERATE : HOL_ERR_NOT_FINITE;
}

void assert_chain(const assembly *a, int64_t c, const double *got, const double *expected)
{
    const size_t size = 3 * ((size_t)assembly_bonds(a, c) + 1);
    double *x = untouched(size), *y = untouched(size);
    assembly_take(a, c, got, x);
    assembly_take(a, c, expected, y);
    assert_same_bits(x, y, size);
    free(x);
    free(y);
}

void assert_location(int64_t first, int64_t bad)
{
    int64_t where = -9, count = -9;
    char name[64];
    hol_error_location(&where, NULL, NULL, &count);
    assert_int_equal(where, first);
    assert_int_equal(count, bad);
    snprintf(name, sizeof name, "%lld", (long long)first);
    assert_message_names(name);
    snprintf(name, sizeof name, "%lld", (long long)bad);
    if (bad > 1) assert_message_names(name);
}
