#include "rigid_file.h"

#include <stdlib.h>
#include <string.h>

#include "text_reader.h"

enum { MAX_ATOMS = 10000000 };

static int read_head(text_reader *in, rigid_file *m)
{
    char word[32];
    if (read_label(in, "rigid") || read_word(in, m->name, sizeof m->name) || read_end_of_line(in)) return -1;
    if (read_label(in, "natoms") || read_whole(in, 2, MAX_ATOMS, &m->n_atoms) || read_end_of_line(in)) return -1;
    if (read_label(in, "nbodies") || read_whole(in, 1, MAX_ATOMS, &m->n_bodies) || read_end_of_line(in)) return -1;
    if (read_label(in, "nbonds") || read_whole(in, 0, MAX_ATOMS, &m->n_bonds) || read_end_of_line(in)) return -1;
    if (read_label(in, "expect") || read_word(in, word, sizeof word) || read_end_of_line(in)) return -1;
    return strcmp(word, "ok") == 0 ? 0 : read_fail(in, "expected 'ok'");
}

static int allocate(text_reader *in, rigid_file *m)
{
    const size_t atoms = (size_t)m->n_atoms, n = (size_t)m->n_bonds;
    m->mass = calloc(16 * atoms + n, sizeof *m->mass);
    m->sizes = calloc((size_t)m->n_bodies + atoms + 2 * n, sizeof *m->sizes);
    m->lambda = calloc(6 * n + 16 * atoms, sizeof *m->lambda);
    if (!m->mass || !m->sizes || !m->lambda) return read_fail(in, "out of memory");
    m->place = m->mass + atoms;
    m->r = m->place + 3 * atoms;
    m->v = m->r + 3 * atoms;
    m->f = m->v + 3 * atoms;
    m->drifted = m->f + 3 * atoms;
    m->length = m->drifted + 3 * atoms;
    m->body_atoms = m->sizes + m->n_bodies;
    m->pairs = m->body_atoms + atoms;
    m->lambda_scale = m->lambda + n;
    m->mu = m->lambda_scale + n;
    m->mu_scale = m->mu + n;
    m->position_lambda = m->mu_scale + n;
    m->position_scale = m->position_lambda + n;
    m->g = m->position_scale + n;
    m->acceleration = m->g + 3 * atoms;
    m->velocity = m->acceleration + 3 * atoms;
    m->position = m->velocity + 3 * atoms;
    m->g_scale = m->position + 3 * atoms;
    m->a_scale = m->g_scale + atoms;
    m->v_scale = m->a_scale + atoms;
    m->r_scale = m->v_scale + atoms;
    return 0;
}

static int read_atoms(text_reader *in, rigid_file *m)
{
    if (read_section(in, "atoms_in")) return -1;
    for (int64_t i = 0; i < m->n_atoms; ++i)
        if (read_row(in, i) || read_input(in, m->mass + i) || read_inputs(in, 3, m->place + 3 * i) ||
            read_inputs(in, 3, m->r + 3 * i) || read_inputs(in, 3, m->v + 3 * i) || read_inputs(in, 3, m->f + 3 * i) ||
            read_end_of_line(in))
            return -1;
    return 0;
}

static int read_bodies(text_reader *in, rigid_file *m)
{
    if (read_section(in, "bodies_in")) return -1;
    for (int64_t b = 0; b < m->n_bodies; ++b) {
        if (read_row(in, b) || read_whole(in, 2, m->n_atoms - m->n_held, m->sizes + b)) return -1;
        for (int64_t a = 0; a < m->sizes[b]; ++a)
            if (read_whole(in, 0, m->n_atoms - 1, m->body_atoms + m->n_held++)) return -1;
        if (read_end_of_line(in)) return -1;
    }
    return 0;
}

static int read_bonds(text_reader *in, rigid_file *m)
{
    if (read_section(in, "bonds_in")) return -1;
    for (int64_t k = 0; k < m->n_bonds; ++k) {
        int64_t *pair = m->pairs + 2 * k;
        if (read_row(in, k) || read_whole(in, 0, m->n_atoms - 1, pair) || read_whole(in, 0, m->n_atoms - 1, pair + 1) ||
            read_input(in, m->length + k) || read_end_of_line(in))
            return -1;
    }
    return 0;
}

static int read_results(text_reader *in, rigid_file *m)
{
    static const int place[9] = {0, 1, 2, 1, 3, 4, 2, 4, 5};
    long double virial[6];
    if (read_labelled(in, "virial", 6, virial) || read_labelled(in, "virial_scale", 1, &m->virial_scale)) return -1;
    for (int i = 0; i < 9; ++i) m->virial[i] = virial[place[i]];
    if (read_section(in, "bonds_out")) return -1;
    for (int64_t k = 0; k < m->n_bonds; ++k)
        if (read_row(in, k) || read_number(in, m->lambda + k) || read_number(in, m->lambda_scale + k) ||
            read_number(in, m->mu + k) || read_number(in, m->mu_scale + k) || read_end_of_line(in))
            return -1;
    if (read_section(in, "atoms_out")) return -1;
    for (int64_t i = 0; i < m->n_atoms; ++i)
        if (read_row(in, i) || read_numbers(in, 3, m->g + 3 * i) || read_number(in, m->g_scale + i) ||
            read_numbers(in, 3, m->acceleration + 3 * i) || read_number(in, m->a_scale + i) ||
            read_numbers(in, 3, m->velocity + 3 * i) || read_number(in, m->v_scale + i) || read_end_of_line(in))
            return -1;
    return 0;
}

static int read_positions(text_reader *in, rigid_file *m)
{
    if (read_label(in, "positions") || read_input(in, &m->dt) || read_end_of_line(in)) return -1;
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

int rigid_file_read(const char *path, rigid_file *m, char *message, size_t message_size)
{
    text_reader in;
    memset(m, 0, sizeof *m);
    const int failed = read_open(&in, path, message, message_size) || read_head(&in, m) || allocate(&in, m) ||
                       read_atoms(&in, m) || read_bodies(&in, m) || read_bonds(&in, m) || read_results(&in, m) ||
                       read_positions(&in, m) || read_section(&in, "end");
    read_close(&in);
    if (failed) rigid_file_free(m);
    return failed ? -1 : 0;
}

void rigid_file_free(rigid_file *m)
{
    free(m->mass);
    free(m->sizes);
    free(m->lambda);
    memset(m, 0, sizeof *m);
}

int is_rigid_file(const char *path)
{
    text_reader in;
    char message[READER_LINE];
    const int yes = read_open(&in, path, message, sizeof message) == 0 && read_label(&in, "rigid") == 0;
    read_close(&in);
    return yes;
}
