/**
 * @file text_reader.h
 * Reads tables of numbers from a text file line by line; `#` starts a comment line. Messages name the file and the
 * line. Every function returns 0, or -1 with the message written.
 */
#ifndef REFERENCE_TEXT_READER_H
#define REFERENCE_TEXT_READER_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

enum { READER_LINE = 4096 };

typedef struct text_reader {
    FILE *file;
    const char *path;
    long line_number;
    char line[READER_LINE];
    char *at; /**< the part of the line not read yet */
    char *message;
    size_t message_size;
} text_reader;

/** Opens the file; read_close in any case afterwards. */
int read_open(text_reader *in, const char *path, char *message, size_t message_size);
void read_close(text_reader *in);

/** Writes the message and returns -1. */
int read_fail(text_reader *in, const char *format, ...);

/** Goes to the next line that holds data. */
int read_line(text_reader *in);
int read_end_of_line(text_reader *in);

/** The next line begins with this word. */
int read_label(text_reader *in, const char *expected);

/** A word of at most size-1 characters from the present line. */
int read_word(text_reader *in, char *word, size_t size);
int read_whole(text_reader *in, int64_t low, int64_t high, int64_t *value);

/** A result, which carries more digits than a double has. */
int read_number(text_reader *in, long double *value);
int read_numbers(text_reader *in, int count, long double *values);

/** An input, which is an exact double and must not be rounded twice. */
int read_input(text_reader *in, double *value);
int read_inputs(text_reader *in, int count, double *values);

/** A whole line: label and numbers. */
int read_labelled(text_reader *in, const char *label, int count, long double *values);

/** A line that holds nothing but the label. */
int read_section(text_reader *in, const char *label);

/** Starts a row of a table: its number must be the next one. */
int read_row(text_reader *in, int64_t expected);

#endif
