// SPDX-License-Identifier: GPL-2.0-only
// What differs between releases of LAMMPS: nothing else here depends on one.
#ifndef HOLONOMIC_LAMMPS_FIX_RELEASE_HPP
#define HOLONOMIC_LAMMPS_FIX_RELEASE_HPP

#include <type_traits>
#include <utility>

#include "atom.h"
#include "fix.h"
#include "input.h"

namespace holonomic_lammps {

/** What Fix::dof() returns: int until 2022, bigint later. */
using Dof = decltype(std::declval<LAMMPS_NS::Fix &>().dof(0));

/** Calls that ask for callbacks of Atom take a number, the same in all releases. */
enum { on_grow = 0 };

/** The name of the command that is being carried out, which LAMMPS keeps in a protected member. */
struct CommandName : LAMMPS_NS::Input {
    static const char *of(LAMMPS_NS::Input *input) {
        const char *name = input->*(&CommandName::command);
        return name ? name : "";
    }
};

}  // namespace holonomic_lammps

#endif
