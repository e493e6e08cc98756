/* The control of without_avx.sh: a machine without AVX must not run this. */
#include <immintrin.h>

int main(void)
{
    volatile double x[4] = {1, 2, 3, 4};
    const __m256d y = _mm256_set_pd(x[0], x[1], x[2], x[3]);
    double z[4];
    _mm256_storeu_pd(z, _mm256_add_pd(y, y));
    return z[0] == 8 ? 0 : 1;
}
