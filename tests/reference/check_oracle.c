/**
 * Checks the library against reference files: check_oracle DIR reads DIR/INDEX and the files that it lists, of chains
 * (tests/oracle/README.md), of molecules of any shape (tests/oracle/molecules/README.md) or with rigid bodies
 * (tests/oracle/rigid/README.md), mixed as they come.
 * A line per case and quantity: the worst error in units of eps times its scale, and its bound. Exit status 0: all are
 * within their bounds; 1: one is not; 2: the files cannot be read.
 */
#include <stdio.h>
#include <string.h>

#include "check_cases.h"

/** Reads the next file name from INDEX: 1, or 0 at its end. */
static int next_name(FILE *index, char *name, size_t size)
{
    char line[512];
    while (fgets(line, sizeof line, index)) {
        line[strcspn(line, "\r\n#")] = 0;
        if (sscanf(line, " %255s", name) == 1 && strlen(name) < size) return 1;
    }
    return 0;
}

/** Checks one file; ratio becomes the larger of itself and the file's. Returns 0, or -1 with a message. */
static int check_file(const char *path, long double *ratio, char *message, size_t message_size)
{
    long double of_case;
    if (is_molecule_file(path)) {
        molecule_file m;
        if (molecule_file_read(path, &m, message, message_size)) return -1;
        of_case = check_molecule_case(&m);
        molecule_file_free(&m);
    } else if (is_rigid_file(path)) {
        rigid_file m;
        if (rigid_file_read(path, &m, message, message_size)) return -1;
        of_case = check_rigid_case(&m);
        rigid_file_free(&m);
    } else {
        oracle_case c;
        if (oracle_read(path, &c, message, message_size)) return -1;
        of_case = check_chain_case(&c);
        oracle_free(&c);
    }
    if (of_case > *ratio) *ratio = of_case;
    return 0;
}

int main(int argc, char **argv)
{
    char path[4096], name[256], message[4400];
    if (argc != 2) {
        fprintf(stderr, "usage: check_oracle DIR\n");
        return 2;
    }
    snprintf(path, sizeof path, "%s/INDEX", argv[1]);
    FILE *index = fopen(path, "r");
    if (!index) {
        fprintf(stderr, "oracle: no readable file INDEX, which lists the cases, in %s\n", argv[1]);
        return 2;
    }
    long double ratio = 0;
    int count = 0;
    while (next_name(index, name, sizeof name)) {
        snprintf(path, sizeof path, "%s/%s", argv[1], name);
        if (check_file(path, &ratio, message, sizeof message)) {
            fprintf(stderr, "oracle: %s\n", message);
            fclose(index);
            return 2;
        }
        ++count;
    }
    fclose(index);
    if (count == 0) {
        fprintf(stderr, "oracle: %s/INDEX lists no case\n", argv[1]);
        return 2;
    }
    printf(
        "not checked: cond, least_pivot and the bond lengths of chains, which the files give for information only\n");
    printf("oracle: %d cases, worst ratio %.3Lg\n", count, ratio);
    return ratio <= 1 ? 0 : 1;
}
