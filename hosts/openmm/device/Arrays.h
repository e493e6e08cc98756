// A device's arrays of four numbers for each atom, floats or doubles.
#ifndef OPENMM_HOLONOMIC_ARRAYS_H_
#define OPENMM_HOLONOMIC_ARRAYS_H_

#include <vector>

#include "openmm/common/ArrayInterface.h"

namespace OpenMM {

std::vector<double> read(const ArrayInterface &array);
void write(ArrayInterface &array, const std::vector<double> &values);

}  // namespace OpenMM

#endif
