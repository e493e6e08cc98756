#include "library.hpp"

#include <dlfcn.h>

#include <cstring>
#include <stdexcept>

namespace rows {

Library::Library(const std::string &file) {
    // Local: neither library may find the functions of the other.
    void *const handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!handle) throw std::runtime_error(dlerror());
    auto find = [&](auto &function, const char *name) {
        void *const found = dlsym(handle, name);
        if (!found) throw std::runtime_error(file + " has no " + name);
        std::memcpy(&function, &found, sizeof function);
    };
#define ROWS_FIND(name) find(name, #name);
    ROWS_FUNCTIONS(ROWS_FIND)
#undef ROWS_FIND
}

void Library::check(int status) const {
    if (status != HOL_OK) throw std::runtime_error(hol_error_message());
}

}  // namespace rows
