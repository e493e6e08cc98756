// Short numbers for the atoms that occur in a list of bonds.
#ifndef HOLONOMIC_NUMBERING_HPP
#define HOLONOMIC_NUMBERING_HPP

#include <cstdint>
#include <vector>

namespace holonomic {

class Numbering {
public:
    // The atoms that occur, each any number of times, all in 0 .. n_atoms - 1.
    Numbering(std::int64_t n_atoms, const std::vector<std::int64_t> &occurring);

    std::int32_t size() const { return static_cast<std::int32_t>(atoms_.size()); }
    std::int64_t atom(std::int32_t number) const { return atoms_[static_cast<std::size_t>(number)]; }  // ascending
    std::int32_t operator()(std::int64_t atom) const;

private:
    std::vector<std::int64_t> atoms_;
    std::vector<std::int32_t> number_;  // [n_atoms], or empty: looked up among the atoms
};

}  // namespace holonomic
#endif
