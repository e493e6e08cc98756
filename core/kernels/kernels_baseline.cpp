#define HOL_ISA baseline
#define HOL_LANES 2
#define HOL_NAME "baseline"
#include "kernels.inl"
