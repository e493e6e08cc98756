/**
 * @file molecule_text.hpp
 * The text of a reference file for a molecule (tests/oracle/molecules/README.md), solved with 512 bits and again with
 * 1024, which must agree in all the digits that are written.
 */
#ifndef REFERENCE_MOLECULE_TEXT_HPP
#define REFERENCE_MOLECULE_TEXT_HPP

#include <string>

#include "molecule_problem.h"
#include "molecule_step.hpp"

namespace reference
{

/** What a file has beside the problem. */
struct molecule_text_extra {
    std::string name;
    bool degenerate;     // whether it must be refused
    molecule_step step;  // of the position level; its lengths are needed in any case
};

/** The whole text, or "" if the digits are not certain or the molecule is regular or singular against expectation. */
std::string molecule_text(const molecule_problem &p, const molecule_text_extra &extra);

}  // namespace reference

#endif
