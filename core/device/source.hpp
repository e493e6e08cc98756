// The text of the kernels, in the common subset of OpenCL C, CUDA and HIP.
#pragma once

#include <string>
#include <vector>

#include "core/device/kinds.hpp"
#include "core/device/precision.hpp"

namespace holonomic::device {

// What the text begins with: the precision, words for each language unless the program has its own, where a program's
// arrays stand unless it says so, and what all kernels need.
std::string prologue(Precision precision);

// So many molecules of one kind stand side by side in the arrays: the work-items of a group.
constexpr int batch_width = 64;

// Kernels of a launch by its number: hol_positions_N and hol_velocities_N. All read where their data begin in
// `integers`, and how many lanes or molecules there are, from its first numbers: two for each launch.

// Of molecules that a work-item solves each, of the kinds from number first to number last - 1. Data:
//     batches    of batch_width molecules of one kind: the kind, and where its columns begin
//     columns    [n_atoms + 2][batch_width]: where the molecule's numbers begin, or -1: there is none; its atoms; the
//                molecule
std::string item_kernels(int launch, const std::vector<Sorted::OfKind> &kinds, int first, int last);

// Of molecules that a work-group solves each, of any kind, by its table. room: numbers in local memory; 0: each has its
// room in `scratch`. Data:
//     molecules  of each, where its table, its row, and its room in `scratch` begin
//     row        [n_atoms + 2] as a column above
std::string group_kernels(int launch, int group_size, int room);

// The numbers of a molecule: inverse masses of its atoms, then inverse squares of the lengths of its bonds.

}  // namespace holonomic::device
