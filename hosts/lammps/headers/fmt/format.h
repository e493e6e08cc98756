// SPDX-License-Identifier: GPL-2.0-only
// Packages of LAMMPS without its copy of the fmt library: declarations that are enough for its headers to be read.
// Nothing here is ever called; messages are made with std::string.
#ifndef HOLONOMIC_LAMMPS_FMT_FORMAT_H
#define HOLONOMIC_LAMMPS_FMT_FORMAT_H

#include <string>

namespace fmt {

class string_view;
class format_args;
template <typename... Args, typename S>
format_args make_args_checked(const S &, const Args &...);

}  // namespace fmt

#endif
