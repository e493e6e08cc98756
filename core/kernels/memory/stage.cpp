// Copies a chain's atoms between the caller's layout and packed scratch (stage.hpp): floats, two dimensions,
// separate arrays and lists. The kernels then see one layout, and the arithmetic is the same.
#include "core/kernels/memory/stage.hpp"

namespace holonomic::HOL_ISA {

// Calls each(element, i) for component i of the atoms from .. from + n of a chain, but not for an absent z. For the
// layouts that most callers have, the compiler vectorizes these loops.
template <class T, class Each>
HOL_INLINE void for_each_element(const AtomArray &array, const Lane &lane, long from, long n, Each each) {
    const int64_t size = sizeof(T), offset = (lane.first_atom + from) * array.stride;
    if (!lane.atoms && array.z && array.stride == size) {
        T *__restrict const x = reinterpret_cast<T *>(array.x + offset);
        T *__restrict const y = reinterpret_cast<T *>(array.y + offset);
        T *__restrict const z = reinterpret_cast<T *>(array.z + offset);
        for (long k = 0; k <= n; ++k) {
            each(x[k], 3 * k);
            each(y[k], 3 * k + 1);
            each(z[k], 3 * k + 2);
        }
    } else if (!lane.atoms && array.z == array.y + size && array.y == array.x + size && array.stride == 3 * size) {
        T *__restrict const elements = reinterpret_cast<T *>(array.x + offset);
        for (long i = 0; i < 3 * (n + 1); ++i) each(elements[i], i);
    } else {
        for (long k = 0; k <= n; ++k) {
            const int64_t at = (lane.atoms ? lane.atoms[from + k] : lane.first_atom + from + k) * array.stride;
            each(*reinterpret_cast<T *>(array.x + at), 3 * k);
            each(*reinterpret_cast<T *>(array.y + at), 3 * k + 1);
            if (array.z) each(*reinterpret_cast<T *>(array.z + at), 3 * k + 2);
        }
    }
}

// Separate arrays x, y and z in which a chain's atoms stand one behind the other. x == nullptr: another layout.
struct SeparateArrays {
    double *x = nullptr, *y = nullptr, *z = nullptr;
    SeparateArrays(const AtomArray &array, const Lane &lane, long from) {
        if (array.is_float || lane.atoms || !array.z || array.stride != sizeof(double)) return;
        x = reinterpret_cast<double *>(array.x) + lane.first_atom + from;
        y = reinterpret_cast<double *>(array.y) + lane.first_atom + from;
        z = reinterpret_cast<double *>(array.z) + lane.first_atom + from;
    }
};

// Copies the atoms 0 .. n between x, y, z and packed[n+1][3], four (on Arm two) at a time. Returns the first atom that
// is left. A plain loop takes twice as many instructions.
#if defined(__AVX2__)
HOL_INLINE long pack(const SeparateArrays &from, long n, double *packed) {
    long k = 0;
    for (; k + 3 <= n; k += 4) {
        const __m256d x = _mm256_loadu_pd(from.x + k), y = _mm256_loadu_pd(from.y + k), z = _mm256_loadu_pd(from.z + k);
        const __m256d xy = _mm256_unpacklo_pd(x, y), zx = _mm256_blend_pd(z, x, 10), yz = _mm256_unpackhi_pd(y, z);
        _mm256_storeu_pd(packed + 3 * k, _mm256_permute2f128_pd(xy, zx, 0x20));
        _mm256_storeu_pd(packed + 3 * k + 4, _mm256_blend_pd(yz, xy, 12));
        _mm256_storeu_pd(packed + 3 * k + 8, _mm256_permute2f128_pd(zx, yz, 0x31));
    }
    return k;
}

template <bool add>
HOL_INLINE long unpack(const double *packed, long n, const SeparateArrays &to) {
    const auto put = [](double *p, __m256d a)
                         HOL_FORCED { _mm256_storeu_pd(p, add ? _mm256_add_pd(_mm256_loadu_pd(p), a) : a); };
    long k = 0;
    for (; k + 3 <= n; k += 4) {
        const __m256d a = _mm256_loadu_pd(packed + 3 * k), b = _mm256_loadu_pd(packed + 3 * k + 4);
        const __m256d c = _mm256_loadu_pd(packed + 3 * k + 8);
        const __m256d xy = _mm256_blend_pd(a, b, 12), zx = _mm256_permute2f128_pd(a, c, 0x21),
                      yz = _mm256_blend_pd(b, c, 12);
        put(to.x + k, _mm256_blend_pd(xy, zx, 10));
        put(to.y + k, _mm256_shuffle_pd(xy, yz, 5));
        put(to.z + k, _mm256_blend_pd(zx, yz, 10));
    }
    return k;
}
#elif defined(__aarch64__)
HOL_INLINE long pack(const SeparateArrays &from, long n, double *packed) {
    long k = 0;
    for (; k + 1 <= n; k += 2) {
        const float64x2x3_t a = {{vld1q_f64(from.x + k), vld1q_f64(from.y + k), vld1q_f64(from.z + k)}};
        vst3q_f64(packed + 3 * k, a);
    }
    return k;
}

template <bool add>
HOL_INLINE long unpack(const double *packed, long n, const SeparateArrays &to) {
    const auto put = [](double *p, float64x2_t a) HOL_FORCED { vst1q_f64(p, add ? vld1q_f64(p) + a : a); };
    long k = 0;
    for (; k + 1 <= n; k += 2) {
        const float64x2x3_t a = vld3q_f64(packed + 3 * k);
        put(to.x + k, a.val[0]);
        put(to.y + k, a.val[1]);
        put(to.z + k, a.val[2]);
    }
    return k;
}
#else
HOL_INLINE long pack(const SeparateArrays &, long, double *) { return 0; }
template <bool add>
HOL_INLINE long unpack(const double *, long, const SeparateArrays &) {
    return 0;
}
#endif

enum CopyWay { copy_in, copy_back, copy_back_and_add };

template <CopyWay way, class T>
HOL_INLINE void copy_elements(const AtomArray &array, const Lane &lane, long from, long n, double *__restrict packed) {
    for_each_element<T>(array, lane, from, n, [=](T &element, long i) HOL_FORCED {
        if (way == copy_in)
            packed[i] = element;
        else
            element = static_cast<T>(way == copy_back ? packed[i] : static_cast<double>(element) + packed[i]);
    });
    for (long k = 0; way == copy_in && !array.z && k <= n; ++k) packed[3 * k + 2] = 0;
}

template <CopyWay way>
HOL_INLINE void copy_atoms(const AtomArray &array, const Lane &lane, long from, long n, double *packed) {
    const SeparateArrays arrays(array, lane, from);
    long done = 0;
    if (arrays.x) done = way == copy_in ? pack(arrays, n, packed) : unpack<way == copy_back_and_add>(packed, n, arrays);
    if (done > n) return;
    if (array.is_float)
        copy_elements<way, float>(array, lane, from, n, packed);
    else
        copy_elements<way, double>(array, lane, from + done, n - done, packed + 3 * done);
}

void stage(const AtomArray &array, const Lane &lane, long from, long n, double *packed) {
    copy_atoms<copy_in>(array, lane, from, n, packed);
}

void unstage(const AtomArray &array, const Lane &lane, long from, long n, const double *staged, bool add) {
    double *const packed = const_cast<double *>(staged);  // not written
    add ? copy_atoms<copy_back_and_add>(array, lane, from, n, packed)
        : copy_atoms<copy_back>(array, lane, from, n, packed);
}

}  // namespace holonomic::HOL_ISA
