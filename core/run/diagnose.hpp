// What is wrong with a molecule that a kernel could not solve. Slow and rarely called: it reads the molecule again, so
// that the kernels need not keep account of causes.
#pragma once

#include "core/error.hpp"
#include "core/molecules/chains.hpp"

namespace holonomic {

struct NamedArray {
    const char *what;  // "position", "velocity", ...
    const AtomArray *array;
};

// The error of a call whose tally counts bad molecules; `otherwise` is the status if the data as such are in order. The
// first array has the positions of the bond vectors, and `box` is theirs.
Error diagnose(const Chains &chains, const Tally &tally, const Box &box, const NamedArray *arrays, int n_arrays,
               Status otherwise);

// Throws Error if one of the values per bond of the first bad molecule is not finite; `what` names them.
void check_values(const Chains &chains, const Tally &tally, const double *values, const char *what);

}  // namespace holonomic
