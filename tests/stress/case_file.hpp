/**
 * @file case_file.hpp
 * One chain as a file in the format of tests/oracle, and back. A comment line `# dt X` keeps the time step.
 */
#ifndef STRESS_CASE_FILE_HPP
#define STRESS_CASE_FILE_HPP

#include <string>

#include "hostile_chain.hpp"

namespace stress
{

/** Writes DIRECTORY/NAME.txt and adds it to DIRECTORY/INDEX. False if that is not possible, or Z is singular. */
bool write_case(const std::string &directory, const std::string &name, const std::string &comment,
                const hostile_chain &c);

/** Reads the inputs of a case; the program ends with a message if it can't. */
hostile_chain read_case(const std::string &path);

}  // namespace stress

#endif
