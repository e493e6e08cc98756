// SPDX-License-Identifier: GPL-2.0-only
// Makes an unmodified LAMMPS know the fix: its Modify::create_factories, which fills the map of fixes, is called
// through this one, which stands before it in the order in which symbols are looked up (an executable, or LD_PRELOAD).
#include <dlfcn.h>

#include <cstdio>
#include <cstdlib>

#include "fix_holonomic.h"
#include "modify.h"

using namespace LAMMPS_NS;

namespace {

Fix *make(LAMMPS *lmp, int narg, char **arg) { return new FixHolonomic(lmp, narg, arg); }

}  // namespace

void Modify::create_factories() {
    using Original = void (*)(Modify *);
    const auto original = reinterpret_cast<Original>(dlsym(RTLD_NEXT, "_ZN9LAMMPS_NS6Modify16create_factoriesEv"));
    if (!original) {
        std::fputs("holonomic: this is no shared LAMMPS: its Modify::create_factories was not found\n", stderr);
        std::abort();
    }
    original(this);
    (*fix_map)["holonomic"] = make;
}
