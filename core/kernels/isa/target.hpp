// What a translation unit of the kernels is compiled for: HOL_ISA, the namespace of its instruction set, and HOL_LANES,
// how many doubles are worked on at once. core/kernels/sets.cmake defines both; the defaults here let every header open
// alone.
//
// All code of a set is in its namespace, so that no function compiled for a newer processor can be linked into code
// that runs on an older one. So no standard headers with templates in the kernels.
#pragma once

#ifndef HOL_ISA
#define HOL_ISA baseline
#endif
#ifndef HOL_LANES
#if defined(__AVX2__)
#define HOL_LANES 4
#else
#define HOL_LANES 2
#endif
#endif

// 1: size counts more than speed. Such a set has no kernels of their own for what the general ones can do.
#ifndef HOL_SMALL
#define HOL_SMALL 0
#endif

// the extended-precision solver of this set is in the namespace of another (extended/verbs.hpp).
#ifndef HOL_EXTENDED
#define HOL_EXTENDED HOL_ISA
#endif

// So are its networks, where more registers bring them nothing (molecules/network/verbs.hpp).
#ifndef HOL_NETWORKS
#define HOL_NETWORKS HOL_ISA
#endif

#if defined(__FMA__) || defined(__aarch64__)
#define HOL_HAS_FMA 1
#else
#define HOL_HAS_FMA 0
#endif

// Forced inlining keeps what a loop works on in registers. Instrumented code would not fit there, nor would more lanes
// than a register has, in sets for tests alone: inlined, both take minutes to compile, and a gigabyte.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HOL_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define HOL_SANITIZED 1
#endif
#endif

#if defined(HOL_SANITIZED) || defined(HOL_TESTS_ONLY)
#define HOL_FORCED
#else
#define HOL_FORCED __attribute__((always_inline))  // for lambdas and members
#endif
#define HOL_INLINE static inline HOL_FORCED  // for functions
#define HOL_STATIC static inline HOL_FORCED  // for members that need no object
// For rare cases, which would only make the common one longer.
#define HOL_NOINLINE static __attribute__((noinline, unused))
// For what is long and stands in many places.
#if HOL_SMALL
#define HOL_INLINE_UNLESS_SMALL HOL_NOINLINE
#else
#define HOL_INLINE_UNLESS_SMALL HOL_INLINE
#endif

// All that takes or returns a vector wider than a register is inlined, so that how such a one is passed does not
// matter.
#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wpsabi"
#endif

// Stands before a short loop over vectors. Unless it is unrolled, the compiler keeps them in memory. HOL_UNROLL_FEW is
// for loops of up to four rounds where the compiler knows how many there are; where it does not, gcc repeats the body
// as often as the number says.
#if defined(HOL_SANITIZED) || defined(HOL_TESTS_ONLY)
#define HOL_UNROLL
#define HOL_UNROLL_FEW
#elif defined(__clang__)
#define HOL_UNROLL _Pragma("clang loop unroll(full)")
#define HOL_UNROLL_FEW HOL_UNROLL
#else
#define HOL_UNROLL _Pragma("GCC unroll 16")
#define HOL_UNROLL_FEW _Pragma("GCC unroll 4")
#endif
