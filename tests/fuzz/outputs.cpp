#include "outputs.hpp"

#include <holonomic.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace fuzz
{

void check(bool right, const char *what)
{
    if (right) return;
    std::fprintf(stderr, "fuzz: %s (last message: %s)\n", what, hol_error_message());
    std::abort();
}

void check_status(int status)
{
    if (status == HOL_OK) return;
    check(hol_error_message()[0] != 0, "a failure without a message");
    check(std::strncmp(hol_status_name(status), "HOL_ERR_", 8) == 0, "a status without a name");
    check(status != HOL_ERR_INTERNAL && status != HOL_ERR_MEMORY, "an internal error");
}

bool is_wrong_argument(int status)
{
    return status == HOL_ERR_NULL || status == HOL_ERR_VALUE || status == HOL_ERR_INDEX ||
           status == HOL_ERR_SHARED_ATOM;
}

bool finite(const double *x, std::size_t n)
{
    for (std::size_t i = 0; i < n; ++i)
        if (!std::isfinite(x[i])) return false;
    return true;
}

void outputs::check_after(int status, std::int64_t n_active) const
{
    check_status(status);
    if (status == HOL_OK) return;
    std::int64_t n_bad = -1;
    hol_error_location(nullptr, nullptr, nullptr, &n_bad);
    const bool nothing = is_wrong_argument(status) || n_bad >= n_active;
    if (nothing)
        for (const auto &one : all_) check(one.first->holds(one.second), "an output was written on an error");
    for (const std::size_t s : sums_) check(all_[s].first->holds(all_[s].second), "a sum was written on an error");
}

}  // namespace fuzz
