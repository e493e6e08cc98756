// Bodies without bonds, which the kernels work on side by side (core/kernels/bodies).
#pragma once

#include "core/kernels/bodies/kind.hpp"
#include "core/kernels/call.hpp"
#include "core/rigid/molecule_kind.hpp"

namespace holonomic::rigid {

// As the kernels see a thick body, that of a molecule; both stay where they are as long as it is used.
BodyKind kind_of(const Body &body, const MoleculeKind &molecule);

// Scratch of the kernels for a molecule that is a body alone.
std::int64_t bytes_of_block(const MoleculeKind &molecule);

}  // namespace holonomic::rigid
