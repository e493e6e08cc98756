#include "oracle_file.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINE_SIZE = 4096, MAX_BONDS = 10000000 };

typedef struct reader {
    FILE *file;
    const char *path;
    long line_number;
    char line[LINE_SIZE];
    char *at; /* the part of the line not read yet */
    char *message;
    size_t message_size;
} reader;

static int fail(reader *in, const char *format, ...)
{
    char what[256];
    va_list args;
    va_start(args, format);
    vsnprintf(what, sizeof what, format, args);
    va_end(args);
    snprintf(in->message, in->message_size, "%s, line %ld: %s", in->path, in->line_number, what);
    return -1;
}

/** Goes to the next line that holds data. */
static int next_line(reader *in)
{
    while (fgets(in->line, LINE_SIZE, in->file)) {
        ++in->line_number;
        const size_t size = strlen(in->line);
        if (size + 1 == LINE_SIZE && in->line[size - 1] != '\n') return fail(in, "the line is too long");
        for (in->at = in->line; isspace((unsigned char)*in->at); ++in->at) {
        }
        if (*in->at && *in->at != '#') return 0;
    }
    return fail(in, "the file ends too early");
}

static int end_of_line(reader *in)
{
    while (isspace((unsigned char)*in->at)) ++in->at;
    return *in->at ? fail(in, "unexpected text: %.40s", in->at) : 0;
}

static int word(reader *in, const char *expected)
{
    const size_t size = strlen(expected);
    if (next_line(in)) return -1;
    if (strncmp(in->at, expected, size) != 0 || (in->at[size] && !isspace((unsigned char)in->at[size])))
        return fail(in, "expected '%s'", expected);
    in->at += size;
    return 0;
}

static int whole(reader *in, int64_t low, int64_t high, int64_t *value)
{
    char *end;
    errno = 0;
    const long long n = strtoll(in->at, &end, 10);
    if (end == in->at || (*end && !isspace((unsigned char)*end))) return fail(in, "expected a whole number");
    if (errno || n < low || n > high)
        return fail(in, "number out of range %lld..%lld", (long long)low, (long long)high);
    in->at = end;
    *value = n;
    return 0;
}

static int number(reader *in, long double *value)
{
    char *end;
    *value = strtold(in->at, &end);
    if (end == in->at || (*end && !isspace((unsigned char)*end))) return fail(in, "expected a number");
    if (!isfinite(*value)) return fail(in, "the number is not finite");
    in->at = end;
    return 0;
}

static int input(reader *in, double *value)
{
    /* an input is an exact double, so it must not be rounded twice */
    char *end;
    *value = strtod(in->at, &end);
    if (end == in->at || (*end && !isspace((unsigned char)*end))) return fail(in, "expected a number");
    if (!isfinite(*value)) return fail(in, "the number is not finite");
    in->at = end;
    return 0;
}

static int numbers(reader *in, int count, long double *values)
{
    for (int i = 0; i < count; ++i)
        if (number(in, values + i)) return -1;
    return 0;
}

static int inputs(reader *in, int count, double *values)
{
    for (int i = 0; i < count; ++i)
        if (input(in, values + i)) return -1;
    return 0;
}

static int labelled(reader *in, const char *label, int count, long double *values)
{
    return word(in, label) || numbers(in, count, values) || end_of_line(in) ? -1 : 0;
}

static int section(reader *in, const char *label)
{
    return word(in, label) || end_of_line(in) ? -1 : 0;
}

/** Starts a row of a table: its number must be the next one. */
static int row(reader *in, int64_t expected)
{
    int64_t n;
    return next_line(in) || whole(in, expected, expected, &n) ? -1 : 0;
}

static int read_head(reader *in, oracle_case *c)
{
    if (word(in, "case") || sscanf(in->at, " %127s", c->name) != 1) return fail(in, "expected 'case NAME'");
    return word(in, "nbonds") || whole(in, 1, MAX_BONDS, &c->n_bonds) || end_of_line(in) ? -1 : 0;
}

static int allocate(reader *in, oracle_case *c)
{
    const size_t n = (size_t)c->n_bonds, atoms = n + 1;
    c->w = calloc(2 * atoms + 9 * atoms + n, sizeof *c->w);
    c->lambda = calloc(2 * n + 6 * atoms + 2 * atoms, sizeof *c->lambda);
    if (!c->w || !c->lambda) return fail(in, "out of memory");
    c->mass = c->w + atoms;
    c->r = c->mass + atoms;
    c->v = c->r + 3 * atoms;
    c->f = c->v + 3 * atoms;
    c->length = c->f + 3 * atoms;
    c->lambda_scale = c->lambda + n;
    c->g = c->lambda_scale + n;
    c->fixman_force = c->g + 3 * atoms;
    c->g_scale = c->fixman_force + 3 * atoms;
    c->fixman_scale = c->g_scale + atoms;
    return 0;
}

static int read_inputs(reader *in, oracle_case *c)
{
    if (section(in, "atoms_in")) return -1;
    for (int64_t i = 0; i <= c->n_bonds; ++i)
        if (row(in, i) || input(in, c->w + i) || input(in, c->mass + i) || inputs(in, 3, c->r + 3 * i) ||
            inputs(in, 3, c->v + 3 * i) || inputs(in, 3, c->f + 3 * i) || end_of_line(in))
            return -1;
    if (section(in, "bonds_in")) return -1;
    for (int64_t k = 0; k < c->n_bonds; ++k)
        if (row(in, k + 1) || input(in, c->length + k) || end_of_line(in)) return -1;
    return 0;
}

static int read_results(reader *in, oracle_case *c)
{
    long double virial[6], condition;
    static const int place[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    if (labelled(in, "lndet", 1, &c->lndet) || labelled(in, "fixman_energy", 1, &c->fixman_energy) ||
        labelled(in, "virial", 6, virial) || labelled(in, "cond", 1, &condition))
        return -1;
    for (int i = 0; i < 9; ++i) c->virial[i] = virial[place[i]];
    c->condition = (double)condition;
    if (section(in, "bonds_out")) return -1;
    for (int64_t k = 0; k < c->n_bonds; ++k)
        if (row(in, k + 1) || number(in, c->lambda + k) || number(in, c->lambda_scale + k) || end_of_line(in))
            return -1;
    if (section(in, "atoms_out")) return -1;
    for (int64_t i = 0; i <= c->n_bonds; ++i)
        if (row(in, i) || numbers(in, 3, c->g + 3 * i) || number(in, c->g_scale + i) ||
            numbers(in, 3, c->fixman_force + 3 * i) || number(in, c->fixman_scale + i) || end_of_line(in))
            return -1;
    return 0;
}

static int read_entries(reader *in, oracle_case *c)
{
    if (word(in, "zinv") || whole(in, 0, MAX_BONDS, &c->n_zinv) || end_of_line(in)) return -1;
    c->zinv = calloc((size_t)c->n_zinv + 1, sizeof *c->zinv);
    if (!c->zinv) return fail(in, "out of memory");
    for (int64_t e = 0; e < c->n_zinv; ++e) {
        oracle_entry *z = c->zinv + e;
        if (next_line(in) || whole(in, 1, c->n_bonds, &z->i) || whole(in, 1, c->n_bonds, &z->j) ||
            number(in, &z->value) || end_of_line(in))
            return -1;
    }
    return section(in, "end");
}

int oracle_read(const char *path, oracle_case *c, char *message, size_t message_size)
{
    memset(c, 0, sizeof *c);
    reader *in = calloc(1, sizeof *in);
    if (!in) {
        snprintf(message, message_size, "%s: out of memory", path);
        return -1;
    }
    in->path = path;
    in->message = message;
    in->message_size = message_size;
    in->file = fopen(path, "r");
    int status = -1;
    if (!in->file)
        snprintf(message, message_size, "%s: %s", path, strerror(errno));
    else
        status = read_head(in, c) || allocate(in, c) || read_inputs(in, c) || read_results(in, c) || read_entries(in, c)
                     ? -1
                     : 0;
    if (in->file) fclose(in->file);
    free(in);
    if (status) oracle_free(c);
    return status;
}

void oracle_free(oracle_case *c)
{
    free(c->w);
    free(c->lambda);
    free(c->zinv);
    memset(c, 0, sizeof *c);
}
