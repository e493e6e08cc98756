/** The two LAPACK routines in use, under their Fortran names: Debian's liblapack-dev brings no C header. */
#ifndef BENCH_METHODS_LAPACK_ROUTINES_HPP
#define BENCH_METHODS_LAPACK_ROUTINES_HPP

extern "C" {
/// Symmetric positive definite tridiagonal system, by L D L^T.
void dptsv_(const int *n, const int *nrhs, double *d, double *e, double *b, const int *ldb, int *info);
/// General tridiagonal system, by Gaussian elimination with row exchanges.
void dgtsv_(const int *n, const int *nrhs, double *lower, double *d, double *upper, double *b, const int *ldb,
            int *info);
}

#endif
