#define HOL_ISA avx512
#define HOL_LANES 8
#define HOL_NAME "avx512"
#include "kernels.inl"
