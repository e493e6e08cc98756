// A library that was linked with -Bsymbolic-functions calls its own functions directly, and is told apart.
#include "calls.hpp"

#include <dlfcn.h>

#include <cstdio>
#include <cstring>

namespace {

struct Search {
    const char *name;
    bool calls = false, found = false;
};

int look(dl_phdr_info *info, size_t, void *data) {
    Search &search = *static_cast<Search *>(data);
    if (!std::strstr(info->dlpi_name, search.name)) return 0;
    search.found = true;
    search.calls = holonomic::names_called_through_linker(*info).count("inner") > 0;
    return 1;
}

}  // namespace

int main(int argc, char **argv) {
    for (int k = 1; k < argc; k++)
        if (!dlopen(argv[k], RTLD_NOW)) return std::printf("%s\n", dlerror()), 1;
    Search usual{"libinner_usual"}, direct{"libinner_direct"};
    dl_iterate_phdr(look, &usual);
    dl_iterate_phdr(look, &direct);
    const bool right = usual.found && direct.found && usual.calls && !direct.calls;
    std::printf("found %d %d, through the linker %d %d\n", usual.found, direct.found, usual.calls, direct.calls);
    return right ? 0 : 1;
}
