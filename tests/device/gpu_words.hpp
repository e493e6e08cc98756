// What the headers of CUDA and HIP bring, as far as the kernels use it.
#pragma once

#define __device__ __attribute__((device))
#define __global__ __attribute__((global))
#define __shared__ __attribute__((shared))

struct Index {
    unsigned x;
};
extern "C" __device__ unsigned index_of(int);
#define threadIdx   \
    Index           \
    {               \
        index_of(0) \
    }
#define blockIdx    \
    Index           \
    {               \
        index_of(1) \
    }
#define blockDim    \
    Index           \
    {               \
        index_of(2) \
    }
#define gridDim     \
    Index           \
    {               \
        index_of(3) \
    }
extern "C" __device__ void __syncthreads();
