// The boundary between C callers and the core: no exception crosses it, every failure leaves a message, and the core
// calculates in the default floating-point environment, whatever the caller's is.
#ifndef HOLONOMIC_CAPI_BOUNDARY_HPP
#define HOLONOMIC_CAPI_BOUNDARY_HPP

#include <exception>
#include <new>

#include "core/caller/environment.hpp"
#include "core/error.hpp"
#include "core/molecules/chains.hpp"
#include "core/reference_error.hpp"
#include "holonomic.h"

struct hol_chains {
    holonomic::Chains chains;
    mutable holonomic::ReferenceError reference_error;
    hol_chains(std::int64_t n_atoms, const double *masses) : chains(n_atoms, masses) {}
    explicit hol_chains(const holonomic::Chains &original) : chains(original) {}
    std::int64_t n_atoms() const { return chains.n_atoms(); }
    std::int64_t n_bonds() const { return chains.n_bonds(); }
};

namespace holonomic {

// Keeps the error for hol_error_message() and hol_error_location() of this thread; returns its status.
int remember(const char *function, const Error &error) noexcept;

// Throws Status::null if p is a null pointer.
[[noreturn]] void throw_null(const char *name);
inline void need(const void *p, const char *name) {
    if (!p) throw_null(name);
}

// The same of an array of `count` elements: of none it is not needed.
inline void need(std::int64_t count, const void *p, const char *name) {
    if (count != 0) need(p, name);
}

// How many bonds a call may add that has no list of molecules.
inline void check_n_bonds(std::int64_t n_bonds) {
    if (n_bonds < 0 || n_bonds > std::int64_t{1} << 30)
        throw make_error(Status::value, "n_bonds is %lld; it must be in 0 .. 2^30", static_cast<long long>(n_bonds));
}

// `function` is the name of the caller's, with which messages begin.
// Inlined by force: a call on one short chain would spend a tenth of its time in handing down its arguments once more.
// Arithmetic: LongDoubleEnvironment for a body that calculates with long double. Functions that are not guarded
// calculate nothing. missing: the name of an argument that is null, or nullptr.
template <class Arithmetic = DefaultEnvironment, class Body>
__attribute__((always_inline)) inline int guarded(const char *function, const Body &body,
                                                  const char *missing = nullptr) noexcept {
    const Arithmetic arithmetic;
    try {
        if (missing) throw_null(missing);
        body();
        return HOL_OK;
    } catch (const Error &error) {
        return remember(function, error);
    } catch (const std::bad_alloc &) {
        return remember(function, make_error(Status::memory, "out of memory"));
    } catch (const std::exception &error) {
        return remember(function, make_error(Status::internal, "internal error: %s", error.what()));
    } catch (...) {
        return remember(function, make_error(Status::internal, "internal error"));
    }
}

// The same of a function of a set, which must be there.
template <class Arithmetic = DefaultEnvironment, class Body>
__attribute__((always_inline)) inline int guarded(const char *function, const hol_chains *chains,
                                                  const Body &body) noexcept {
    return guarded<Arithmetic>(function, body, chains ? nullptr : "chains");
}

}  // namespace holonomic
#endif
