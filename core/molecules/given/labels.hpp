// Numbers by which the caller knows atoms and molecules: messages show them beside the library's own.
#pragma once

#include <cstdint>
#include <vector>

namespace holonomic {

// A number as it stands in a message: "17", or "17 (label 90210)".
struct Name {
    char text[112];
};

class Labels {
public:
    // Either may be null: no labels. Copied; on std::bad_alloc nothing is changed.
    void set(std::int64_t n_atoms, const std::int64_t *atoms, std::int64_t n_molecules, const std::int64_t *molecules);

    // Counted from 0, shown counted from base.
    Name of_atom(std::int64_t atom, int base) const;
    // Of a molecule that has no label, one of its atoms is shown, if these have labels.
    Name of_molecule(std::int64_t molecule, std::int64_t atom, int base) const;

    // The label, or the number where there is none.
    std::int64_t number_of_atom(std::int64_t atom, int base) const;
    std::int64_t number_of_molecule(std::int64_t molecule, int base) const;

    std::int64_t bytes() const;

private:
    std::vector<std::int64_t> atoms_, molecules_;  // empty: no labels; molecules added later have none
};

}  // namespace holonomic
