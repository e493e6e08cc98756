// What is found in the process that this object is loaded into, and where it does not fit.
#pragma once
#include <cstdio>
#include <string>

namespace holonomic {

// The next function of the same name and arguments, GROMACS's own; null if there is none.
void *next(void *function);

template <typename Function>
Function *original(Function *function) {
    return reinterpret_cast<Function *>(next(reinterpret_cast<void *>(function)));
}

void tell_what_was_found(FILE *);

}  // namespace holonomic
