// SPDX-License-Identifier: GPL-2.0-only
#ifndef HOLONOMIC_LAMMPS_FIX_TEMPLATE_HPP
#define HOLONOMIC_LAMMPS_FIX_TEMPLATE_HPP

#include <mpi.h>

#include <array>
#include <string>
#include <vector>

namespace holonomic_lammps {

/** What a rigid molecule looks like: its atoms in the order of their IDs. */
struct Template {
    std::string name; /**< in messages */
    std::vector<int> types;
    std::vector<std::array<double, 3>> at;
    bool listed = false; /**< of a body of a list of atoms, not of molecules */
};

/** A file's text on every rank. Collective: rank 0 reads. Throws ErrorEverywhere. @param what  the file is */
std::string text_of(MPI_Comm world, const std::string &file, const std::string &what);

/**
 * Reads sections Coords and Types of a file for LAMMPS's command molecule, whose class no package's headers declare.
 * Collective: rank 0 reads. Throws ErrorEverywhere.
 */
Template read_template(MPI_Comm world, const std::string &file);

}  // namespace holonomic_lammps

#endif
