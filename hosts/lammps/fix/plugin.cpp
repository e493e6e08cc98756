// SPDX-License-Identifier: GPL-2.0-only
// The fix as a plugin, for releases of LAMMPS with the PLUGIN package: plugin load holonomicplugin.so
#include "fix_holonomic.h"
#include "lammpsplugin.h"
#include "version.h"

using namespace LAMMPS_NS;

namespace {

Fix *make(LAMMPS *lmp, int narg, char **arg) { return new FixHolonomic(lmp, narg, arg); }

}  // namespace

extern "C" void lammpsplugin_init(void *lmp, void *handle, void *regfunc) {
    lammpsplugin_t plugin;
    plugin.version = LAMMPS_VERSION;
    plugin.style = "fix";
    plugin.name = "holonomic";
    plugin.info = "rigid bonds in molecules of any shape";
    plugin.author = "the authors of holonomic";
    plugin.creator.v2 = reinterpret_cast<lammpsplugin_factory2 *>(&make);
    plugin.handle = handle;
    reinterpret_cast<lammpsplugin_regfunc>(regfunc)(&plugin, lmp);
}
