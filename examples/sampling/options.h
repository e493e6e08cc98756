/** Arguments of the form name=value. */
#ifndef SAMPLING_OPTIONS_H
#define SAMPLING_OPTIONS_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct option {
    const char *name;
    double value, least; /* the default, replaced by what is given; the smallest that makes sense */
} option;

/** Reads the arguments into options [n]; output gets the value of output=. Ends the program with a message on an error.
 */
static inline void read_options(int argc, char **argv, option *options, int n, const char **output)
{
    for (int i = 1; i < argc; ++i) {
        const char *equals = strchr(argv[i], '=');
        const size_t length = equals ? (size_t)(equals - argv[i]) : 0;
        int known = 0;
        if (equals && strncmp(argv[i], "output=", 7) == 0) {
            *output = equals + 1;
            continue;
        }
        for (int k = 0; k < n && equals; ++k) {
            if (strlen(options[k].name) != length || strncmp(options[k].name, argv[i], length) != 0) continue;
            char *end;
            options[k].value = strtod(equals + 1, &end);
            known = 1;
            if (end != equals + 1 && *end == 0 && options[k].value >= options[k].least) continue;
            fprintf(stderr, "%s: %s must be a number of at least %g\n", argv[0], argv[i], options[k].least);
            exit(2);
        }
        if (known) continue;
        fprintf(stderr, "%s: there is no option '%s'; options and their defaults:\n", argv[0], argv[i]);
        for (int k = 0; k < n; ++k) fprintf(stderr, "  %s=%g\n", options[k].name, options[k].value);
        fprintf(stderr, "  output=%s\n", *output);
        exit(2);
    }
}

#endif
