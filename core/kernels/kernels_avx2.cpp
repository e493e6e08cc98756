#define HOL_ISA avx2
#define HOL_LANES 4
#define HOL_NAME "avx2"
#include "kernels.inl"
