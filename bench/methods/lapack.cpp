// LAPACK's tridiagonal solvers, as a program calls them: one chain per call, since each chain has a matrix of its own.
#include <limits>
#include <memory>

#include "methods.hpp"
#ifdef BENCH_HAVE_LAPACK
#include "lapack_routines.hpp"
#endif

namespace bench {

#ifdef BENCH_HAVE_LAPACK

namespace {

/// A solver that gave up must not look as if it had an answer.
void mark_failure(System &s) {
    for (double &x : s.x) x = std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

bool have_lapack() { return true; }

Solver lapack_dptsv() {
    return [](System &s) {
        const int n = s.size(), one = 1;
        int info = 0;
        dptsv_(&n, &one, s.diagonal.data(), s.beside.data(), s.x.data(), &n, &info);
        if (info != 0) mark_failure(s);
    };
}

Solver lapack_dgtsv() {
    auto lower = std::make_shared<std::vector<double>>();
    return [lower](System &s) {
        const int n = s.size(), one = 1;
        int info = 0;
        lower->assign(s.beside.begin(), s.beside.end());
        dgtsv_(&n, &one, lower->data(), s.diagonal.data(), s.beside.data(), s.x.data(), &n, &info);
        if (info != 0) mark_failure(s);
    };
}

#else

bool have_lapack() { return false; }
Solver lapack_dptsv() {
    return [](System &) {};
}
Solver lapack_dgtsv() {
    return [](System &) {};
}

#endif

}  // namespace bench
