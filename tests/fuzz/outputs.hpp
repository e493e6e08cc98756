/**
 * @file outputs.hpp
 * What must hold after every call, whatever its arguments were.
 */
#ifndef FUZZ_OUTPUTS_HPP
#define FUZZ_OUTPUTS_HPP

#include <cstdint>
#include <utility>
#include <vector>

#include "atom_array.hpp"

namespace fuzz
{

/** Ends the program, as a fuzzer expects it, unless what is said is right. */
void check(bool right, const char *what);

/** A failure has a message and a name, and is not one of the library's own. */
void check_status(int status);

/** Whether the arguments alone were wrong, so that nothing at all may have been written. */
bool is_wrong_argument(int status);

bool finite(const double *x, std::size_t n);

/** Outputs of one call: what they were before, and what an error may have done to them. */
class outputs
{
public:
    void add(block &b)
    {
        all_.emplace_back(&b, b.copy());
    }
    void add_sum(block &b)
    {
        add(b);
        sums_.push_back(all_.size() - 1);
    }
    void check_after(int status, std::int64_t n_active) const;

private:
    std::vector<std::pair<block *, std::vector<char>>> all_;
    std::vector<std::size_t> sums_;
};

}  // namespace fuzz

#endif
