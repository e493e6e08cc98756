// Short numbers for the atoms that occur in a list of bonds.
#pragma once

#include <cstdint>
#include <vector>

namespace holonomic {

class Numbering {
public:
    // Of the atoms atoms[i] - base, all in 0 .. n_atoms - 1, each any number of times.
    Numbering(std::int64_t n_atoms, const std::int64_t *atoms, std::int64_t count, int base);

    std::int32_t size() const { return size_; }
    std::int64_t atom(std::int32_t number) const {  // ascending
        return all_ ? number : atoms_[static_cast<std::size_t>(number)];
    }
    std::int32_t operator()(std::int64_t atom) const {
        if (all_) return static_cast<std::int32_t>(atom);
        return number_.empty() ? looked_up(atom) : number_[static_cast<std::size_t>(atom)];
    }

private:
    std::int32_t looked_up(std::int64_t atom) const;

    std::int32_t size_ = 0;
    bool all_ = false;  // every atom occurs: it is its own number
    std::vector<std::int64_t> atoms_;
    std::vector<std::int32_t> number_;  // [n_atoms], or empty: looked up among the atoms
};

}  // namespace holonomic
