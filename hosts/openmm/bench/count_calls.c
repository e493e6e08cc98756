/* Counts what a program asks of OpenCL: cc -shared -fPIC count_calls.c -o count_calls.so, and
 * LD_PRELOAD=./count_calls.so. */
#include <dlfcn.h>
#include <stddef.h>

long n_launches, n_waits; /* kernels; reads that block, and waits for events or for all */

/* The library is loaded late, by a plugin: it is not among those that come next. */
static void *found(const char *name) { return dlsym(dlopen("libOpenCL.so.1", RTLD_NOW), name); }

#define OWN(name, ...)              \
    static int (*own)(__VA_ARGS__); \
    if (!own) *(void **)&own = found(name)

int clEnqueueNDRangeKernel(void *queue, void *kernel, unsigned dimensions, const size_t *offset, const size_t *global,
                           const size_t *local, unsigned n, const void *waits, void *event) {
    OWN("clEnqueueNDRangeKernel", void *, void *, unsigned, const size_t *, const size_t *, const size_t *, unsigned,
        const void *, void *);
    ++n_launches;
    return own(queue, kernel, dimensions, offset, global, local, n, waits, event);
}

int clEnqueueReadBuffer(void *queue, void *buffer, unsigned blocking, size_t offset, size_t size, void *to, unsigned n,
                        const void *waits, void *event) {
    OWN("clEnqueueReadBuffer", void *, void *, unsigned, size_t, size_t, void *, unsigned, const void *, void *);
    n_waits += blocking != 0;
    return own(queue, buffer, blocking, offset, size, to, n, waits, event);
}

void *clEnqueueMapBuffer(void *queue, void *buffer, unsigned blocking, unsigned long flags, size_t offset, size_t size,
                         unsigned n, const void *waits, void *event, int *status) {
    static void *(*own)(void *, void *, unsigned, unsigned long, size_t, size_t, unsigned, const void *, void *, int *);
    if (!own) *(void **)&own = found("clEnqueueMapBuffer");
    n_waits += blocking != 0;
    return own(queue, buffer, blocking, flags, offset, size, n, waits, event, status);
}

int clWaitForEvents(unsigned n, const void *events) {
    OWN("clWaitForEvents", unsigned, const void *);
    ++n_waits;
    return own(n, events);
}

int clFinish(void *queue) {
    OWN("clFinish", void *);
    ++n_waits;
    return own(queue);
}
