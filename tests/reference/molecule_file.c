#include "molecule_file.h"

#include <stdlib.h>
#include <string.h>

#include "text_reader.h"

enum { MAX_ATOMS = 10000000 };

/** One of two words: 0 or 1. */
static int read_choice(text_reader *in, const char *label, const char *zero, const char *one, int *value)
{
    char word[32];
    if (read_label(in, label) || read_word(in, word, sizeof word) || read_end_of_line(in)) return -1;
    *value = strcmp(word, one) == 0;
    return *value || strcmp(word, zero) == 0 ? 0 : read_fail(in, "expected '%s' or '%s'", zero, one);
}

static int read_head(text_reader *in, molecule_file *m)
{
    if (read_label(in, "molecule") || read_word(in, m->name, sizeof m->name) || read_end_of_line(in)) return -1;
    if (read_label(in, "natoms") || read_whole(in, 2, MAX_ATOMS, &m->n_atoms) || read_end_of_line(in)) return -1;
    if (read_label(in, "nbonds") || read_whole(in, 1, MAX_ATOMS, &m->n_bonds) || read_end_of_line(in)) return -1;
    return read_choice(in, "class", "tree", "cyclic", &m->cyclic) ||
                   read_choice(in, "expect", "ok", "degenerate", &m->degenerate)
               ? -1
               : 0;
}

static int allocate(text_reader *in, molecule_file *m)
{
    const size_t atoms = (size_t)m->n_atoms, n = (size_t)m->n_bonds;
    m->w = calloc(14 * atoms + n, sizeof *m->w);
    m->pairs = calloc(2 * n, sizeof *m->pairs);
    m->lambda = calloc(6 * n + 16 * atoms, sizeof *m->lambda);
    if (!m->w || !m->pairs || !m->lambda) return read_fail(in, "out of memory");
    m->mass = m->w + atoms;
    m->r = m->mass + atoms;
    m->v = m->r + 3 * atoms;
    m->f = m->v + 3 * atoms;
    m->drifted = m->f + 3 * atoms;
    m->length = m->drifted + 3 * atoms;
    m->lambda_scale = m->lambda + n;
    m->mu = m->lambda_scale + n;
    m->mu_scale = m->mu + n;
    m->position_lambda = m->mu_scale + n;
    m->position_scale = m->position_lambda + n;
    m->g = m->position_scale + n;
    m->fixman_force = m->g + 3 * atoms;
    m->velocity = m->fixman_force + 3 * atoms;
    m->position = m->velocity + 3 * atoms;
    m->g_scale = m->position + 3 * atoms;
    m->fixman_scale = m->g_scale + atoms;
    m->v_scale = m->fixman_scale + atoms;
    m->r_scale = m->v_scale + atoms;
    return 0;
}

static int read_atoms(text_reader *in, molecule_file *m)
{
    if (read_section(in, "atoms_in")) return -1;
    for (int64_t i = 0; i < m->n_atoms; ++i)
        if (read_row(in, i) || read_input(in, m->w + i) || read_input(in, m->mass + i) ||
            read_inputs(in, 3, m->r + 3 * i) || read_inputs(in, 3, m->v + 3 * i) || read_inputs(in, 3, m->f + 3 * i) ||
            read_end_of_line(in))
            return -1;
    return 0;
}

static int read_bonds(text_reader *in, molecule_file *m)
{
    if (read_section(in, "bonds_in")) return -1;
    for (int64_t k = 0; k < m->n_bonds; ++k) {
        int64_t *pair = m->pairs + 2 * k;
        if (read_row(in, k) || read_whole(in, 0, m->n_atoms - 1, pair) || read_whole(in, 0, m->n_atoms - 1, pair + 1) ||
            read_input(in, m->length + k) || read_end_of_line(in))
            return -1;
        if (pair[0] == pair[1]) return read_fail(in, "a bond of an atom with itself");
    }
    return 0;
}

static int read_sums(text_reader *in, molecule_file *m)
{
    static const int place[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    long double virial[6], value[2];
    if (read_labelled(in, "lndet", 1, &m->lndet) || read_labelled(in, "lndetz", 1, &m->lndetz) ||
        read_labelled(in, "fixman_energy", 1, &m->fixman_energy) || read_labelled(in, "virial", 6, virial) ||
        read_labelled(in, "virial_scale", 1, &m->virial_scale) || read_labelled(in, "cond", 1, value) ||
        read_labelled(in, "least_pivot", 1, value + 1))
        return -1;
    for (int i = 0; i < 9; ++i) m->virial[i] = virial[place[i]];
    m->condition = (double)value[0];
    m->least_pivot = (double)value[1];
    return 0;
}

static int read_tables(text_reader *in, molecule_file *m)
{
    if (read_section(in, "bonds_out")) return -1;
    for (int64_t k = 0; k < m->n_bonds; ++k)
        if (read_row(in, k) || read_number(in, m->lambda + k) || read_number(in, m->lambda_scale + k) ||
            read_number(in, m->mu + k) || read_number(in, m->mu_scale + k) || read_end_of_line(in))
            return -1;
    if (read_section(in, "atoms_out")) return -1;
    for (int64_t i = 0; i < m->n_atoms; ++i)
        if (read_row(in, i) || read_numbers(in, 3, m->g + 3 * i) || read_number(in, m->g_scale + i) ||
            read_numbers(in, 3, m->fixman_force + 3 * i) || read_number(in, m->fixman_scale + i) ||
            read_numbers(in, 3, m->velocity + 3 * i) || read_number(in, m->v_scale + i) || read_end_of_line(in))
            return -1;
    return 0;
}

static int read_positions(text_reader *in, molecule_file *m)
{
    char word[64];
    if (read_label(in, "positions")) return -1;
    char *const after = in->at;
    if (read_word(in, word, sizeof word)) return -1;
    if (strcmp(word, "none") == 0) return read_end_of_line(in);
    in->at = after;
    m->has_positions = 1;
    if (read_input(in, &m->dt) || read_end_of_line(in)) return -1;
    if (!(m->dt > 0)) return read_fail(in, "the time step must be positive");
    for (int64_t i = 0; i < m->n_atoms; ++i)
        if (read_row(in, i) || read_inputs(in, 3, m->drifted + 3 * i) || read_numbers(in, 3, m->position + 3 * i) ||
            read_number(in, m->r_scale + i) || read_end_of_line(in))
            return -1;
    for (int64_t k = 0; k < m->n_bonds; ++k)
        if (read_row(in, k) || read_number(in, m->position_lambda + k) || read_number(in, m->position_scale + k) ||
            read_end_of_line(in))
            return -1;
    return 0;
}

static int read_all(text_reader *in, molecule_file *m)
{
    if (read_head(in, m) || allocate(in, m) || read_atoms(in, m) || read_bonds(in, m)) return -1;
    if (!m->degenerate && (read_sums(in, m) || read_tables(in, m) || read_positions(in, m))) return -1;
    return read_section(in, "end");
}

int molecule_file_read(const char *path, molecule_file *m, char *message, size_t message_size)
{
    text_reader in;
    memset(m, 0, sizeof *m);
    const int failed = read_open(&in, path, message, message_size) || read_all(&in, m);
    read_close(&in);
    if (failed) molecule_file_free(m);
    return failed ? -1 : 0;
}

void molecule_file_free(molecule_file *m)
{
    free(m->w);
    free(m->pairs);
    free(m->lambda);
    memset(m, 0, sizeof *m);
}

int is_molecule_file(const char *path)
{
    text_reader in;
    char message[READER_LINE];
    const int yes = read_open(&in, path, message, sizeof message) == 0 && read_label(&in, "molecule") == 0;
    read_close(&in);
    return yes;
}
