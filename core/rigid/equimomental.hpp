// Mass points that have the mass, the centre and the moments of inertia of a rigid body (an equimomental system, Routh
// 1860): as far as its motion goes they are the body.
#pragma once

namespace holonomic::rigid {

struct MassPoints {
    int n;        // 2: on a line, 3: in a plane, 4
    double mass;  // of each
    double coordinates[4][3];
};

// inertia [3][3], about the centre. Throws Error where no distribution of mass has it.
MassPoints equimomental_points(double mass, const double *centre, const double *inertia);

}  // namespace holonomic::rigid
