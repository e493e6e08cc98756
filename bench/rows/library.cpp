#include "library.hpp"

#include <dlfcn.h>

#include <cstring>
#include <stdexcept>

namespace rows {

Library::Library(const std::string &file) {
    // Local: neither library may find the functions of the other.
    void *const handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!handle) throw std::runtime_error(dlerror());
    auto find = [&](auto &function, const char *name, bool needed) {
        void *const found = dlsym(handle, name);
        if (!found && needed) throw std::runtime_error(file + " has no " + name);
        std::memcpy(&function, &found, sizeof function);
    };
#define ROWS_FIND(name) find(name, #name, true);
#define ROWS_LOOK_FOR(name) find(name, #name, false);
    ROWS_FUNCTIONS(ROWS_FIND)
    ROWS_LATER_FUNCTIONS(ROWS_LOOK_FOR)
#undef ROWS_LOOK_FOR
#undef ROWS_FIND
}

void Library::check(int status) const {
    if (status != HOL_OK) throw std::runtime_error(hol_error_message());
}

}  // namespace rows
