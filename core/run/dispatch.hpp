// Which instruction set the calculations use.
#ifndef HOLONOMIC_DISPATCH_HPP
#define HOLONOMIC_DISPATCH_HPP

#include "core/kernels/call.hpp"

namespace holonomic {

// The best kernels that this machine can run, or those that HOLONOMIC_ISA names. Thread-safe.
const Kernels &kernels();

}  // namespace holonomic
#endif
