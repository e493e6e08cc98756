#include "oracle_file.h"

#include <stdlib.h>
#include <string.h>

#include "text_reader.h"

enum { MAX_BONDS = 10000000 };

static int read_head(text_reader *in, oracle_case *c)
{
    if (read_label(in, "case") || read_word(in, c->name, sizeof c->name)) return read_fail(in, "expected 'case NAME'");
    return read_label(in, "nbonds") || read_whole(in, 1, MAX_BONDS, &c->n_bonds) || read_end_of_line(in) ? -1 : 0;
}

static int allocate(text_reader *in, oracle_case *c)
{
    const size_t n = (size_t)c->n_bonds, atoms = n + 1;
    c->w = calloc(2 * atoms + 9 * atoms + n, sizeof *c->w);
    c->lambda = calloc(2 * n + 6 * atoms + 2 * atoms, sizeof *c->lambda);
    if (!c->w || !c->lambda) return read_fail(in, "out of memory");
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

static int read_atoms_and_bonds(text_reader *in, oracle_case *c)
{
    if (read_section(in, "atoms_in")) return -1;
    for (int64_t i = 0; i <= c->n_bonds; ++i)
        if (read_row(in, i) || read_input(in, c->w + i) || read_input(in, c->mass + i) ||
            read_inputs(in, 3, c->r + 3 * i) || read_inputs(in, 3, c->v + 3 * i) || read_inputs(in, 3, c->f + 3 * i) ||
            read_end_of_line(in))
            return -1;
    if (read_section(in, "bonds_in")) return -1;
    for (int64_t k = 0; k < c->n_bonds; ++k)
        if (read_row(in, k + 1) || read_input(in, c->length + k) || read_end_of_line(in)) return -1;
    return 0;
}

static int read_results(text_reader *in, oracle_case *c)
{
    long double virial[6], condition;
    static const int place[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    if (read_labelled(in, "lndet", 1, &c->lndet) || read_labelled(in, "fixman_energy", 1, &c->fixman_energy) ||
        read_labelled(in, "virial", 6, virial) || read_labelled(in, "cond", 1, &condition))
        return -1;
    for (int i = 0; i < 9; ++i) c->virial[i] = virial[place[i]];
    c->condition = (double)condition;
    if (read_section(in, "bonds_out")) return -1;
    for (int64_t k = 0; k < c->n_bonds; ++k)
        if (read_row(in, k + 1) || read_number(in, c->lambda + k) || read_number(in, c->lambda_scale + k) ||
            read_end_of_line(in))
            return -1;
    if (read_section(in, "atoms_out")) return -1;
    for (int64_t i = 0; i <= c->n_bonds; ++i)
        if (read_row(in, i) || read_numbers(in, 3, c->g + 3 * i) || read_number(in, c->g_scale + i) ||
            read_numbers(in, 3, c->fixman_force + 3 * i) || read_number(in, c->fixman_scale + i) ||
            read_end_of_line(in))
            return -1;
    return 0;
}

static int read_entries(text_reader *in, oracle_case *c)
{
    if (read_label(in, "zinv") || read_whole(in, 0, MAX_BONDS, &c->n_zinv) || read_end_of_line(in)) return -1;
    c->zinv = calloc((size_t)c->n_zinv + 1, sizeof *c->zinv);
    if (!c->zinv) return read_fail(in, "out of memory");
    for (int64_t e = 0; e < c->n_zinv; ++e) {
        oracle_entry *z = c->zinv + e;
        if (read_line(in) || read_whole(in, 1, c->n_bonds, &z->i) || read_whole(in, 1, c->n_bonds, &z->j) ||
            read_number(in, &z->value) || read_end_of_line(in))
            return -1;
    }
    return read_section(in, "end");
}

int oracle_read(const char *path, oracle_case *c, char *message, size_t message_size)
{
    text_reader in;
    memset(c, 0, sizeof *c);
    const int failed = read_open(&in, path, message, message_size) || read_head(&in, c) || allocate(&in, c) ||
                       read_atoms_and_bonds(&in, c) || read_results(&in, c) || read_entries(&in, c);
    read_close(&in);
    if (failed) oracle_free(c);
    return failed ? -1 : 0;
}

void oracle_free(oracle_case *c)
{
    free(c->w);
    free(c->lambda);
    free(c->zinv);
    memset(c, 0, sizeof *c);
}
