/**
 * @file case_file.hpp
 * One chain as a file in the format of tests/oracle, and back. Comment lines keep what the format has no
 * place for: `# dt X` the time step, `# group FIRST SIZE LONGEST` the chains that it was computed together with.
 */
#ifndef STRESS_CASE_FILE_HPP
#define STRESS_CASE_FILE_HPP

#include <cstdint>
#include <string>

#include "hostile_chain.hpp"

namespace stress
{

/** The chains first .. first + size - 1 of at most `longest` bonds, in one call; size 0: none are known. */
struct chain_group {
    std::uint64_t first = 0, size = 0;
    std::int64_t longest = 0;
};

/** Writes DIRECTORY/NAME.txt and adds it to DIRECTORY/INDEX. False if that is not possible, or Z is singular. */
bool write_case(const std::string &directory, const std::string &name, const std::string &comment,
                const chain_group &group, const hostile_chain &c);

/** Reads the inputs of a case; the program ends with a message if it can't. */
hostile_chain read_case(const std::string &path, chain_group &group);

}  // namespace stress

#endif
