#include "core/run/threads.hpp"

#include "core/caller/environment.hpp"

#ifdef _OPENMP
#include <omp.h>
#endif

namespace holonomic {

#ifdef _OPENMP

namespace {

// A thread whose processor another program uses comes late, by a turn of the scheduler: some milliseconds, where a
// call takes some microseconds. OpenMP's team ends when all its threads have come, also when nothing is left for them.
// A caller that waited longer than it worked goes on alone until its own work has taken so many times the wait: waits
// then make calls longer by a tenth of what one thread takes, at most.
constexpr double wait_allowance = 0.1;

// Seconds of work that this thread still does alone.
thread_local double alone = 0;

}  // namespace

void on_threads(int n, void (*body)(const void *, int), const void *context) {
    const double begin = omp_get_wtime();
    if (alone > 0) {
        body(context, 0);
        alone -= omp_get_wtime() - begin;
        return;
    }
    double worked = 0;  // by this thread
    {
        const CallersEnvironment outside;
#pragma omp parallel num_threads(n)
        {
            const DefaultEnvironment own_environment;
            const int i = omp_get_thread_num();
            const double from = omp_get_wtime();
            body(context, i);
            if (i == 0) worked = omp_get_wtime() - from;
        }
    }
    const double waited = omp_get_wtime() - begin - worked;
    if (waited > worked) alone = waited / wait_allowance;
}

#else

void on_threads(int, void (*body)(const void *, int), const void *context) { body(context, 0); }

#endif

}  // namespace holonomic
