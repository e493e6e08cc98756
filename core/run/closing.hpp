// Whether the bonds of a molecule, each the nearest image in a periodic box, close its cycles.
#ifndef HOLONOMIC_CLOSING_HPP
#define HOLONOMIC_CLOSING_HPP

#include <cstdint>

#include "core/kernels/call.hpp"
#include "core/kernels/molecules/schedule.hpp"

namespace holonomic {

// Positions and their box.
struct Images {
    const AtomArray *r;
    const Box *box;
};

// Whether it may be that a molecule of this shape does not close, and its kernel does not see it.
inline bool may_stay_open(const Schedule &shape, const Images &images) {
    return images.box->shape != Box::none && (shape.type == Schedule::ring || shape.type == Schedule::graph);
}

// True also if a position is not finite, which the kernels find. `scratch` is that of a kernel.
bool closes(const Schedule &shape, const MoleculeLane &lane, const Images &images, double *scratch);

}  // namespace holonomic
#endif
