// The options of a set of molecules, with what they are unless they are set (hol_chains_set_..).
#pragma once

#include <cstdint>

#include "core/caller/box.hpp"

namespace holonomic {

struct Settings {
    int base = 0;  // from which callers count; Chains::set_base
    int n_threads = 1;
    double tolerance = 0;            // of positions; 0: what coordinates carry
    double length_tolerance = 1e-3;  // by what part lengths of bodies are adjusted, at most (rigid/fit.hpp)
    int max_iterations = 50;         // of positions
    bool keeps_outcomes = false;     // core/run/outcomes.hpp
    bool finds_bodies = true;        // in lists of bonds whose lengths depend on each other; else they are refused
    std::int64_t memory_limit = 0;   // bytes; 0: the default (memory_limit.hpp)
    Cell box{};                      // Chains::set_box
};

}  // namespace holonomic
