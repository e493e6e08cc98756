#include <cstdio>

#include "boundary.hpp"
#include "core/kernel_choice.hpp"

namespace holonomic {

namespace {

thread_local Error last_error{};
thread_local char last_message[sizeof last_error.message + 48] = "";

constexpr bool same(Status status, hol_status code) { return static_cast<int>(status) == static_cast<int>(code); }
static_assert(same(Status::ok, HOL_OK) && same(Status::null, HOL_ERR_NULL) && same(Status::value, HOL_ERR_VALUE) &&
                  same(Status::index, HOL_ERR_INDEX) && same(Status::shared_atom, HOL_ERR_SHARED_ATOM) &&
                  same(Status::memory, HOL_ERR_MEMORY) && same(Status::not_finite, HOL_ERR_NOT_FINITE) &&
                  same(Status::degenerate, HOL_ERR_DEGENERATE) &&
                  same(Status::no_convergence, HOL_ERR_NO_CONVERGENCE) &&
                  same(Status::not_definite, HOL_ERR_NOT_DEFINITE) && same(Status::internal, HOL_ERR_INTERNAL) &&
                  same(Status::lengths, HOL_ERR_LENGTHS) && same(Status::unsupported, HOL_ERR_UNSUPPORTED) &&
                  same(Status::state, HOL_ERR_STATE) && same(Status::callback, HOL_ERR_CALLBACK),
              "core/status.hpp and the public header disagree");

}  // namespace

int remember(const char *function, const Error &error) noexcept {
    last_error = error;
    std::snprintf(last_message, sizeof last_message, "%s: %s", function, error.message);
    return static_cast<int>(error.status);
}

void throw_null(const char *name) { throw make_error(Status::null, "%s is NULL", name); }

}  // namespace holonomic

#define HOL_TEXT(x) #x
#define HOL_VERSION_TEXT(major, minor, patch) HOL_TEXT(major) "." HOL_TEXT(minor) "." HOL_TEXT(patch)

const char *hol_version(void) { return HOL_VERSION_TEXT(HOL_VERSION_MAJOR, HOL_VERSION_MINOR, HOL_VERSION_PATCH); }

int hol_version_number(void) { return HOL_VERSION; }

const char *hol_status_name(int status) {
    switch (status) {
        case HOL_OK:
            return "HOL_OK";
        case HOL_ERR_NULL:
            return "HOL_ERR_NULL";
        case HOL_ERR_VALUE:
            return "HOL_ERR_VALUE";
        case HOL_ERR_INDEX:
            return "HOL_ERR_INDEX";
        case HOL_ERR_SHARED_ATOM:
            return "HOL_ERR_SHARED_ATOM";
        case HOL_ERR_MEMORY:
            return "HOL_ERR_MEMORY";
        case HOL_ERR_NOT_FINITE:
            return "HOL_ERR_NOT_FINITE";
        case HOL_ERR_DEGENERATE:
            return "HOL_ERR_DEGENERATE";
        case HOL_ERR_NO_CONVERGENCE:
            return "HOL_ERR_NO_CONVERGENCE";
        case HOL_ERR_NOT_DEFINITE:
            return "HOL_ERR_NOT_DEFINITE";
        case HOL_ERR_INTERNAL:
            return "HOL_ERR_INTERNAL";
        case HOL_ERR_LENGTHS:
            return "HOL_ERR_LENGTHS";
        case HOL_ERR_UNSUPPORTED:
            return "HOL_ERR_UNSUPPORTED";
        case HOL_ERR_STATE:
            return "HOL_ERR_STATE";
        case HOL_ERR_CALLBACK:
            return "HOL_ERR_CALLBACK";
        default:
            return "unknown status";
    }
}

const char *hol_error_message(void) { return holonomic::last_message; }

int hol_error_remember(int status, const char *message) {
    holonomic::Error error{};
    error.status = static_cast<holonomic::Status>(status);
    std::snprintf(holonomic::last_message, sizeof holonomic::last_message, "%s", message ? message : "");
    holonomic::last_error = error;
    return status;
}

void hol_error_location(int64_t *molecule, int64_t *bond, int64_t *atom, int64_t *n_bad) {
    const holonomic::Error &error = holonomic::last_error;
    const bool any = error.status != holonomic::Status::ok;
    if (molecule) *molecule = any && error.chain >= 0 ? error.chain + error.base : -1;
    if (bond) *bond = any && error.bond >= 0 ? error.bond + error.base : -1;
    if (atom) *atom = any && error.atom >= 0 ? error.atom + error.base : -1;
    if (n_bad) *n_bad = any ? error.n_bad : 0;
}

const char *hol_instruction_set(void) { return holonomic::name_of_kernels(); }
