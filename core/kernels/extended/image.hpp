// The shortest image of a bond in a periodic box, in twice the precision.
#pragma once

#include "core/kernels/call.hpp"
#include "core/kernels/extended/wide.hpp"

namespace holonomic::HOL_ISA {

// Takes the minimum image of a bond vector, unrounded.
HOL_NOINLINE void wrap(const Box &box, Wide3 &d) {
    Wide *const component[3] = {&d.x, &d.y, &d.z};
    const double *const in = box.inverse;
    double n[3];
    for (int i = 0; i < 3; ++i) n[i] = round(d.x.hi * in[i] + d.y.hi * in[3 + i] + d.z.hi * in[6 + i]);
    for (int i = 0; i < 3; ++i)
        for (int c = 0; c < 3; ++c)
            if (box.h[3 * i + c] != 0) *component[c] -= n[i] * wide(box.h[3 * i + c]);
}

}  // namespace holonomic::HOL_ISA
