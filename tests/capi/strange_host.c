/**
 * What turns a program into one that calls the library from a strange floating-point environment: preloaded, it stands
 * between the two. Invalid operations, divisions by zero and overflows trap, or results are rounded upward and denormal
 * numbers flushed as well, or nothing is strange but what there has been; in turns. The program ends if a call leaves
 * anything else than it found: masks, rounding, sticky flags, of x87 as well. The program's own arithmetic has what it
 * had. x86-64 with the GNU C library.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <holonomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct environment {
    unsigned mxcsr;
    unsigned short control, status; /* of x87 */
} environment;

enum {
    TRAPS = 1 | 4 | 8,     /* invalid, zero, overflow: their bits among the flags, and as masks */
    FLAGS = 0x3f,          /* all six of them */
    INEXACT = 0x20,        /* which a program has always seen, soon after its start */
    UPWARD = 2,            /* the rounding */
    FLUSHED = 0x8040,      /* denormal results and operands, of MXCSR */
    FULL_LENGTH = 0x300,   /* of x87's results */
    NOTHING_TRAPS = 0x37f, /* its control word from the beginning */
    MASKS_AT = 7,          /* in MXCSR */
    ROUNDING_AT = 13,
    X87_ROUNDING_AT = 10
};

static environment read_environment(void)
{
    environment e;
    __asm__ volatile("stmxcsr %0\n\tfnstcw %1\n\tfnstsw %2" : "=m"(e.mxcsr), "=m"(e.control), "=m"(e.status));
    e.status &= FLAGS;
    return e;
}

static void write_environment(environment e)
{
    const double one = 1, three = 3;
    const unsigned short quiet = NOTHING_TRAPS;
    __asm__ volatile("fnclex\n\tfldcw %0" : : "m"(quiet));
    if (e.status & INEXACT) __asm__ volatile("fldl %0\n\tfdivl %1\n\tfstp %%st(0)" : : "m"(one), "m"(three));
    __asm__ volatile("fldcw %0\n\tldmxcsr %1" : : "m"(e.control), "m"(e.mxcsr));
}

static environment strange_environment(unsigned turn)
{
    environment e = {FLAGS << MASKS_AT, NOTHING_TRAPS, 0};
    const unsigned kind = turn % 3;
    if (kind < 2) {
        e.mxcsr &= ~((unsigned)TRAPS << MASKS_AT);
        e.control &= (unsigned short)~TRAPS;
    }
    if (kind == 1) {
        e.mxcsr |= UPWARD << ROUNDING_AT | FLUSHED;
        e.control = (unsigned short)((e.control & ~FULL_LENGTH) | UPWARD << X87_ROUNDING_AT);
    }
    if (turn / 3 % 2) {
        e.mxcsr |= INEXACT;
        e.status = INEXACT;
    }
    return e;
}

static unsigned n_calls;

__attribute__((destructor)) static void must_have_been_called(void)
{
    if (n_calls > 0) return;
    fputs("no call passed here\n", stderr);
    _Exit(1);
}

static void *find(const char *name)
{
    void *function = dlsym(RTLD_NEXT, name);
    if (!function) fprintf(stderr, "no %s behind this one\n", name), abort();
    return function;
}

typedef struct passage {
    const char *name;
    environment outside, strange;
} passage;

static passage enter(const char *name)
{
    const unsigned turn = __atomic_fetch_add(&n_calls, 1, __ATOMIC_RELAXED);
    const passage p = {name, read_environment(), strange_environment(turn)};
    write_environment(p.strange);
    return p;
}

static void leave(passage p)
{
    const environment found = read_environment();
    write_environment(p.outside);
    if (found.mxcsr == p.strange.mxcsr && found.control == p.strange.control && found.status == p.strange.status)
        return;
    fprintf(stderr, "%s: MXCSR %x, x87 %x %x; before the call %x, %x %x\n", p.name, found.mxcsr, found.control,
            found.status, p.strange.mxcsr, p.strange.control, p.strange.status);
    abort();
}

#define FUNCTION(type, name, parameters, arguments)                                                              \
    type name parameters                                                                                         \
    {                                                                                                            \
        static void *found;                                                                                      \
        type(*next) parameters;                                                                                  \
        if (!__atomic_load_n(&found, __ATOMIC_RELAXED)) __atomic_store_n(&found, find(#name), __ATOMIC_RELAXED); \
        memcpy(&next, &found, sizeof next);                                                                      \
        const passage p = enter(#name);                                                                          \
        type const result = next arguments;                                                                      \
        leave(p);                                                                                                \
        return result;                                                                                           \
    }
#define PROCEDURE(name, parameters, arguments)                                                                   \
    void name parameters                                                                                         \
    {                                                                                                            \
        static void *found;                                                                                      \
        void(*next) parameters;                                                                                  \
        if (!__atomic_load_n(&found, __ATOMIC_RELAXED)) __atomic_store_n(&found, find(#name), __ATOMIC_RELAXED); \
        memcpy(&next, &found, sizeof next);                                                                      \
        const passage p = enter(#name);                                                                          \
        next arguments;                                                                                          \
        leave(p);                                                                                                \
    }

#include "interposed_functions.h"
