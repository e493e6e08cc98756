/* Takes the place of the C library's allocation for the whole process; operator new of the C++ run-time calls malloc.
 */
#define _GNU_SOURCE
#include "failing_allocations.h"

#include <errno.h>
#include <limits.h>
#include <stdatomic.h>
#include <stddef.h>

extern void *__libc_malloc(size_t);
extern void *__libc_calloc(size_t, size_t);
extern void *__libc_realloc(void *, size_t);
extern void *__libc_memalign(size_t, size_t);
extern void __libc_free(void *);

static atomic_long left = LONG_MAX, refusals, in_use;
static atomic_int once;

static int refuse(void)
{
    if (atomic_load(&left) == LONG_MAX) return 0;
    const long before = atomic_fetch_sub(&left, 1);
    const int no = atomic_load(&once) ? before == 0 : before <= 0;
    if (no) {
        atomic_fetch_add(&refusals, 1);
        errno = ENOMEM;
    }
    return no;
}

static void *given(void *p)
{
    if (p) atomic_fetch_add(&in_use, 1);
    return p;
}

void fail_after(long good)
{
    atomic_store(&refusals, 0);
    atomic_store(&once, 0);
    atomic_store(&left, good);
}

void fail_once_after(long good)
{
    atomic_store(&refusals, 0);
    atomic_store(&once, 1);
    atomic_store(&left, good);
}

void fail_no_more(void)
{
    atomic_store(&left, LONG_MAX);
}
long refused(void)
{
    return atomic_load(&refusals);
}
long blocks_in_use(void)
{
    return atomic_load(&in_use);
}

void *malloc(size_t size)
{
    return refuse() ? NULL : given(__libc_malloc(size));
}
void *calloc(size_t count, size_t size)
{
    return refuse() ? NULL : given(__libc_calloc(count, size));
}
void *memalign(size_t alignment, size_t size)
{
    return refuse() ? NULL : given(__libc_memalign(alignment, size));
}
void *aligned_alloc(size_t alignment, size_t size)
{
    return memalign(alignment, size);
}

void *realloc(void *old, size_t size)
{
    if (refuse()) return NULL;
    return old ? __libc_realloc(old, size) : given(__libc_realloc(NULL, size));
}

int posix_memalign(void **out, size_t alignment, size_t size)
{
    void *const p = memalign(alignment, size);
    if (!p) return ENOMEM;
    *out = p;
    return 0;
}

void free(void *p)
{
    if (p) atomic_fetch_sub(&in_use, 1);
    __libc_free(p);
}
