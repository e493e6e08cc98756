#include "text_reader.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

int read_open(text_reader *in, const char *path, char *message, size_t message_size)
{
    memset(in, 0, sizeof *in);
    in->path = path;
    in->message = message;
    in->message_size = message_size;
    in->file = fopen(path, "r");
    if (in->file) return 0;
    snprintf(message, message_size, "%s: %s", path, strerror(errno));
    return -1;
}

void read_close(text_reader *in)
{
    if (in->file) fclose(in->file);
    in->file = NULL;
}

int read_fail(text_reader *in, const char *format, ...)
{
    char what[256];
    va_list args;
    va_start(args, format);
    vsnprintf(what, sizeof what, format, args);
    va_end(args);
    snprintf(in->message, in->message_size, "%s, line %ld: %s", in->path, in->line_number, what);
    return -1;
}

int read_line(text_reader *in)
{
    while (fgets(in->line, READER_LINE, in->file)) {
        ++in->line_number;
        const size_t size = strlen(in->line);
        if (size + 1 == READER_LINE && in->line[size - 1] != '\n') return read_fail(in, "the line is too long");
        for (in->at = in->line; isspace((unsigned char)*in->at); ++in->at) {
        }
        if (*in->at && *in->at != '#') return 0;
    }
    return read_fail(in, "the file ends too early");
}

int read_end_of_line(text_reader *in)
{
    while (isspace((unsigned char)*in->at)) ++in->at;
    return *in->at ? read_fail(in, "unexpected text: %.40s", in->at) : 0;
}

int read_label(text_reader *in, const char *expected)
{
    const size_t size = strlen(expected);
    if (read_line(in)) return -1;
    if (strncmp(in->at, expected, size) != 0 || (in->at[size] && !isspace((unsigned char)in->at[size])))
        return read_fail(in, "expected '%s'", expected);
    in->at += size;
    return 0;
}

int read_whole(text_reader *in, int64_t low, int64_t high, int64_t *value)
{
    char *end;
    errno = 0;
    const long long n = strtoll(in->at, &end, 10);
    if (end == in->at || (*end && !isspace((unsigned char)*end))) return read_fail(in, "expected a whole number");
    if (errno || n < low || n > high)
        return read_fail(in, "number out of range %lld..%lld", (long long)low, (long long)high);
    in->at = end;
    *value = n;
    return 0;
}

int read_number(text_reader *in, long double *value)
{
    char *end;
    *value = strtold(in->at, &end);
    if (end == in->at || (*end && !isspace((unsigned char)*end))) return read_fail(in, "expected a number");
    if (!isfinite(*value)) return read_fail(in, "the number is not finite");
    in->at = end;
    return 0;
}

int read_input(text_reader *in, double *value)
{
    char *end;
    *value = strtod(in->at, &end);
    if (end == in->at || (*end && !isspace((unsigned char)*end))) return read_fail(in, "expected a number");
    if (!isfinite(*value)) return read_fail(in, "the number is not finite");
    in->at = end;
    return 0;
}

int read_numbers(text_reader *in, int count, long double *values)
{
    for (int i = 0; i < count; ++i)
        if (read_number(in, values + i)) return -1;
    return 0;
}

int read_inputs(text_reader *in, int count, double *values)
{
    for (int i = 0; i < count; ++i)
        if (read_input(in, values + i)) return -1;
    return 0;
}

int read_labelled(text_reader *in, const char *label, int count, long double *values)
{
    return read_label(in, label) || read_numbers(in, count, values) || read_end_of_line(in) ? -1 : 0;
}

int read_section(text_reader *in, const char *label)
{
    return read_label(in, label) || read_end_of_line(in) ? -1 : 0;
}

int read_row(text_reader *in, int64_t expected)
{
    int64_t n;
    return read_line(in) || read_whole(in, expected, expected, &n) ? -1 : 0;
}

int read_word(text_reader *in, char *word, size_t size)
{
    while (isspace((unsigned char)*in->at)) ++in->at;
    const size_t n = strcspn(in->at, " \t\r\n");
    if (n == 0 || n >= size) return read_fail(in, "expected a word of 1..%zu letters", size - 1);
    memcpy(word, in->at, n);
    word[n] = 0;
    in->at += n;
    return 0;
}
