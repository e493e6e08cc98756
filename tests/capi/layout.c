#include "layout.h"

#include "check.h"

const layout layouts[] = {
    {"records of three", HOL_DOUBLE, 3, {0, 1, 2}, 0},
    {"separate arrays", HOL_DOUBLE, 0, {0, 0, 0}, 0},
    {"padded records", HOL_DOUBLE, 4, {0, 1, 2}, 0},
    {"wide records, components in another order", HOL_DOUBLE, 17, {9, 2, 5}, 0},
    {"records of three, backwards", HOL_DOUBLE, 3, {0, 1, 2}, 1},
    {"separate arrays, backwards", HOL_DOUBLE, 0, {0, 0, 0}, 1},
    {"float records of three", HOL_FLOAT, 3, {0, 1, 2}, 0},
    {"float separate arrays", HOL_FLOAT, 0, {0, 0, 0}, 0},
    {"float padded records", HOL_FLOAT, 4, {0, 1, 2}, 0},
    {"float wide records", HOL_FLOAT, 11, {7, 3, 10}, 0},
    {"float separate arrays, backwards", HOL_FLOAT, 0, {0, 0, 0}, 1},
};
const int n_layouts = sizeof layouts / sizeof *layouts, n_double_layouts = 6;

enum { PATTERN = 0x7b };

static char *element_at(const laid_out *a, int64_t i, int x)
{
    void *const parts[3] = {a->view.x, a->view.y, a->view.z};
    return (char *)parts[x] + i * a->view.stride;
}

static int dimensions_of(const laid_out *a)
{
    return a->view.z ? 3 : 2;
}

laid_out lay_out(const layout *how, int64_t n_atoms, const double *numbers, int dimensions)
{
    laid_out a;
    memset(&a, 0, sizeof a);
    const int64_t size = how->element == HOL_DOUBLE ? 8 : 4, step = how->step ? how->step * size : size;
    const int64_t array = n_atoms * step + size; /* one element of padding after each array */
    a.bytes = (size_t)(how->step ? array : 3 * array);
    a.memory = malloc(a.bytes + 1);
    if (!a.memory) abort();
    memset(a.memory, PATTERN, a.bytes);
    char *const start = (char *)a.memory + (how->backwards && n_atoms ? (n_atoms - 1) * step : 0);
    char *parts[3];
    for (int x = 0; x < 3; ++x) parts[x] = start + (how->step ? how->order[x] * size : x * array);
    a.view.x = parts[0];
    a.view.y = parts[1];
    a.view.z = dimensions == 3 ? parts[2] : NULL;
    a.view.stride = how->backwards ? -step : step;
    a.view.element = how->element;
    a.n_atoms = n_atoms;
    for (int64_t i = 0; i < n_atoms; ++i)
        for (int x = 0; x < dimensions; ++x) {
            const double number = numbers[3 * i + x];
            const float rounded = (float)number;
            if (how->element == HOL_DOUBLE)
                memcpy(element_at(&a, i, x), &number, sizeof number);
            else
                memcpy(element_at(&a, i, x), &rounded, sizeof rounded);
        }
    return a;
}

void collect(const laid_out *a, double *numbers)
{
    for (int64_t i = 0; i < a->n_atoms; ++i)
        for (int x = 0; x < dimensions_of(a); ++x) {
            float number;
            if (a->view.element == HOL_DOUBLE) {
                memcpy(numbers + 3 * i + x, element_at(a, i, x), sizeof *numbers);
                continue;
            }
            memcpy(&number, element_at(a, i, x), sizeof number);
            numbers[3 * i + x] = number;
        }
}

int gaps_untouched(const laid_out *a)
{
    const size_t size = a->view.element == HOL_DOUBLE ? 8 : 4;
    unsigned char *used = calloc(a->bytes + 1, 1);
    int same = 1;
    if (!used) abort();
    for (int64_t i = 0; i < a->n_atoms; ++i)
        for (int x = 0; x < dimensions_of(a); ++x) memset(used + (element_at(a, i, x) - (char *)a->memory), 1, size);
    for (size_t b = 0; b < a->bytes; ++b)
        if (!used[b] && ((unsigned char *)a->memory)[b] != PATTERN) same = 0;
    free(used);
    return same;
}

void laid_out_free(laid_out *a)
{
    free(a->memory);
    memset(a, 0, sizeof *a);
}

void assert_laid_out(const laid_out *got, const double *expected, const char *what)
{
    double *numbers = copy_of(expected, 3 * (size_t)got->n_atoms);
    collect(got, numbers);
    for (int64_t i = 0; i < 3 * got->n_atoms; ++i) {
        const double number = got->view.element == HOL_FLOAT ? (float)expected[i] : expected[i];
        if (memcmp(numbers + i, &number, sizeof number) != 0 && !(isnan(number) && isnan(numbers[i])))
            fail_msg("%s: number %lld is %.17g instead of %.17g", what, (long long)i, numbers[i], number);
    }
    free(numbers);
    assert_true(gaps_untouched(got));
}
