#include "found.hpp"

#include <dlfcn.h>
#include <link.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <vector>

#include "calls.hpp"
#include "gromacs.hpp"
#include "holonomic.h"

namespace holonomic {

namespace {

struct Name {
    const char *words;
    void *function;
};

template <typename Function>
void *address(Function *function) {
    return reinterpret_cast<void *>(function);
}

// A name of the dynamic linker contains the types of the arguments, so what has other arguments is not found.
const std::vector<Name> &taken_over() {
    static const std::vector<Name> names = {
        {"gmx::init_lincs", address(&gmx::init_lincs)},           {"gmx::set_lincs", address(&gmx::set_lincs)},
        {"gmx::constrain_lincs", address(&gmx::constrain_lincs)}, {"gmx::lincs_rmsd", address(&gmx::lincs_rmsd)},
        {"gmx::done_lincs", address(&gmx::done_lincs)},           {"dd_numHomeAtoms", address(&dd_numHomeAtoms)}};
    return names;
}

void add(std::string &list, const char *name) { list += (list.empty() ? "" : ", ") + std::string(name); }

std::string missing() {
    std::string list;
    for (const Name &name : taken_over())
        if (!next(name.function)) add(list, name.words);
    if (!address(&gmx_fatal)) add(list, "gmx_fatal");
    if (!address(&gmx_omp_nthreads_get)) add(list, "gmx_omp_nthreads_get");
    if (!address(&ddglatnr)) add(list, "ddglatnr");
    if (!address(&gmx::too_many_constraint_warnings)) add(list, "gmx::too_many_constraint_warnings");
    void (gmx::ObservablesReducerBuilder::*subscribe)(
        int, std::function<void(gmx::ObservablesReducerBuilder::Require &&, gmx::ArrayRef<double>)> &&,
        std::function<void(int64_t)> &&) = &gmx::ObservablesReducerBuilder::addSubscriber;
    if (!subscribe) add(list, "gmx::ObservablesReducerBuilder::addSubscriber");
    return list;
}

std::string &library() {
    static std::string path;
    return path;
}

// The functions among those taken over that this GROMACS calls directly, so that ours would never be called.
std::string &called_directly() {
    static std::string list;
    return list;
}

int is_gromacs(dl_phdr_info *info, size_t, void *) {
    const char *const name = std::strrchr(info->dlpi_name, '/');
    if (!name || std::strncmp(name, "/libgromacs", 11) != 0) return 0;
    library() = info->dlpi_name;
    const std::set<std::string> called = names_called_through_linker(*info);
    for (const Name &one : taken_over()) {
        Dl_info own;
        if (next(one.function) && dladdr(one.function, &own) && !called.count(own.dli_sname))
            add(called_directly(), one.words);
    }
    return 1;
}

// Before main(). In a program that GROMACS is no part of there is nothing to do.
__attribute__((constructor)) void check() {
    if (!dl_iterate_phdr(is_gromacs, nullptr)) return;
    const char *const version = address(&gmx_version) ? gmx_version() : "unknown";
    const int year = GMX_API_VERSION / 10000;
    const std::string list = missing();
    if (std::atoi(version) == year && list.empty() && called_directly().empty()) return;
    fprintf(stderr, "holonomic: this object was built for GROMACS %d in %s precision, and %s is version %s.\n", year,
            GMX_DOUBLE ? "double" : "mixed", library().c_str(), version);
    if (!list.empty()) fprintf(stderr, "These functions are not there as they are expected: %s.\n", list.c_str());
    if (!called_directly().empty())
        fprintf(stderr,
                "These functions are called directly there, and nothing can take their place: %s.\nThat is how Ubuntu "
                "links "
                "its libraries (-Bsymbolic-functions); a GROMACS of your own, built with its defaults, will do.\n",
                called_directly().c_str());
    fprintf(
        stderr,
        "Nothing was taken over, and nothing was run. Build hosts/gromacs for a GROMACS that fits, or run it without "
        "LD_PRELOAD.\n");
    _exit(1);
}

}  // namespace

void *next(void *function) {
    Dl_info info;
    return dladdr(function, &info) && info.dli_sname ? dlsym(RTLD_NEXT, info.dli_sname) : nullptr;
}

void tell_what_was_found(FILE *file) {
    std::string list;
    for (const Name &name : taken_over()) add(list, name.words);
    fprintf(file,
            "\nConstraints by holonomic %s (%s) in place of LINCS, in GROMACS %s\n(%s).\nTaken over: %s.\n"
            "lincs-order and lincs-iter do not matter: lengths are exact. Water with SETTLE is GROMACS's.\n\n",
            hol_version(), hol_instruction_set(), gmx_version(), library().c_str(), list.c_str());
}

}  // namespace holonomic
