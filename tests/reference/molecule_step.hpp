/**
 * @file molecule_step.hpp
 * A step of the position level.
 */
#ifndef REFERENCE_MOLECULE_STEP_HPP
#define REFERENCE_MOLECULE_STEP_HPP

namespace reference
{

/** What a step is made of, beside the problem, whose positions are the reference. */
struct molecule_step {
    const double *drifted;  // [n_atoms][3]
    const double *length;   // [n_bonds]
    double dt;
    const double *drifted_box;       // the box of the drifted positions, or nullptr
    const double *lambda = nullptr;  // [n_bonds] that Newton's method starts from; nullptr: zeros
};

}  // namespace reference

#endif
