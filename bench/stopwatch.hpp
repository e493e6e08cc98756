/**
 * Time that a call takes: of the calling thread's own processor time where one thread works, so that other programs on
 * the machine don't count; elapsed time where several do.
 */
#ifndef BENCH_STOPWATCH_HPP
#define BENCH_STOPWATCH_HPP

#include <time.h>

namespace bench {

class Stopwatch {
public:
    explicit Stopwatch(int threads) : clock_(threads == 1 ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC), start_(now()) {}
    double seconds() const { return now() - start_; }

private:
    double now() const {
        timespec t;
        clock_gettime(clock_, &t);
        return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
    }
    clockid_t clock_;
    double start_;
};

}  // namespace bench

#endif
