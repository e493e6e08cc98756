#include "core/molecules/memory_limit.hpp"

#include <algorithm>
#include <cstdio>

#include "core/molecules/chains.hpp"

#if defined(_WIN32)
#ifndef NOMINMAX
#define NOMINMAX
#endif
#include <windows.h>
#else
#include <unistd.h>
#endif

namespace holonomic {

namespace {

std::int64_t memory_of_machine() {
#if defined(_WIN32)
    MEMORYSTATUSEX status;
    status.dwLength = sizeof status;
    if (GlobalMemoryStatusEx(&status)) return static_cast<std::int64_t>(status.ullTotalPhys);
#elif defined(_SC_PHYS_PAGES) && defined(_SC_PAGESIZE)
    const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
    if (pages > 0 && size > 0) return static_cast<std::int64_t>(pages) * size;
#endif
    return no_limit;
}

std::int64_t limit_of(const Chains &chains) {
    return chains.memory_limit > 0 ? chains.memory_limit : default_memory_limit();
}

}  // namespace

std::int64_t default_memory_limit() {
    static const std::int64_t limit = memory_of_machine() / 4;
    return limit;
}

std::int64_t memory_left(const Chains &chains) { return std::max<std::int64_t>(limit_of(chains) - chains.memory(), 0); }

void check_memory(const Chains &chains, std::int64_t n_bonds, std::int64_t bytes_per_bond) {
    if (n_bonds <= memory_left(chains) / bytes_per_bond) return;
    char what[64];
    std::snprintf(what, sizeof what, "%lld bonds", static_cast<long long>(n_bonds));
    throw too_much_memory(chains, what, n_bonds * bytes_per_bond);
}

Error too_much_memory(const Chains &chains, const char *what, std::int64_t bytes) {
    return make_error(Status::memory,
                      "%s would take at least %lld bytes of memory, beside %lld that the set has; the limit is %lld "
                      "(hol_chains_set_memory_limit)",
                      what, static_cast<long long>(bytes), static_cast<long long>(chains.memory()),
                      static_cast<long long>(limit_of(chains)));
}

}  // namespace holonomic
