#include "core/error.hpp"

#include <cstdarg>
#include <cstdio>

namespace holonomic {

Error make_error(Status status, const char *format, ...) {
    Error error;
    error.status = status;
    va_list arguments;
    va_start(arguments, format);
    std::vsnprintf(error.message, sizeof error.message, format, arguments);
    va_end(arguments);
    return error;
}

}  // namespace holonomic
