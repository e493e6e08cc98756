#pragma once

#include <cstddef>

namespace holonomic::device {

// The values are those of hol_device_precision, which capi/device.cpp asserts. mixed: coordinates and residuals are
// doubles; the matrix and its factors, to which iterations are indifferent, are floats.
enum class Precision { single = 0, mixed = 1, full = 2 };

// Bytes of what the kernels call mixed and real.
inline std::size_t bytes_of_mixed(Precision p) { return p == Precision::single ? sizeof(float) : sizeof(double); }
inline std::size_t bytes_of_real(Precision p) { return p == Precision::full ? sizeof(double) : sizeof(float); }

}  // namespace holonomic::device
