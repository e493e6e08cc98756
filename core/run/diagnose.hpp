// What is wrong with a molecule that a kernel could not solve. Slow and rarely called: it reads the molecule again, so
// that the kernels need not keep account of causes.
#pragma once

#include <initializer_list>

#include "core/error.hpp"
#include "core/molecules/chains.hpp"

namespace holonomic {

struct NamedArray {
    const char *what;  // "position", "velocity", ...
    const AtomArray *array;
};

// The error of a call whose tally counts bad molecules; `otherwise` is the status if the data as such are in order. The
// first array has the positions of the bond vectors, and `box` is theirs.
Error diagnose(const Chains &chains, const Tally &tally, const Box &box, std::initializer_list<NamedArray> arrays,
               Status otherwise);
// The same of a verb: throws it, in the box of the set, if the data are in order for numbers that are none; and notes
// what each bad molecule suffers from (outcomes.hpp).
[[noreturn]] void throw_diagnosis(const Chains &chains, const Tally &tally, std::initializer_list<NamedArray> arrays,
                                  Status otherwise = Status::not_finite);

// Throws Error if one of the values per bond of the first bad molecule is not finite; `what` names them.
void check_values(const Chains &chains, const Tally &tally, const double *values, const char *what);

}  // namespace holonomic
