// What one call adds to a set of molecules: all of it, or on an error nothing.
#pragma once

#include <cstdint>
#include <vector>

#include "core/molecules/chains.hpp"

namespace holonomic {

// Throws Error if a length is out of range. may_be_zero: its two atoms are one point.
void check_lengths(std::int64_t n_bonds, const double *lengths, int base, bool may_be_zero = false);

class Batch {
public:
    explicit Batch(Chains &chains);
    ~Batch();
    Batch(const Batch &) = delete;
    Batch &operator=(const Batch &) = delete;

    // An atom of a chain, which must be free if it can move. Throws Error.
    void take(std::int64_t atom, std::int64_t chain, std::int64_t position);
    void append_chain(std::int64_t n_bonds, const std::int64_t *atoms, const double *lengths);
    void append_block(std::int64_t count, std::int64_t n_bonds, std::int64_t first_atom, const double *lengths);
    // Bond k of the list has the length lengths[k % n_lengths]. Throws Error if an atom is not free.
    void append_found(const FoundMolecules &found, const BondList &list, const double *lengths, std::int64_t n_lengths);
    // Whether a molecule has atoms on a line or in a plane that are all bonded to each other.
    bool is_flat() const { return flat_; }
    void commit();
    // What is said of an atom of a molecule that an earlier call has added.
    static Error in_use(const Chains &chains, std::int64_t atom);
    // A bond that is in no equation.
    void leave_out(std::int64_t bond, const std::int64_t *atoms, double length);

private:
    void append_part(std::int64_t n_bonds, const std::int64_t *atoms, const double *lengths, std::int64_t first_bond);
    std::int32_t shape_of(const FoundMolecules &found, std::size_t m, std::int32_t likely);
    void append_one(const FoundMolecules &found, std::size_t m, std::int32_t shape, const double *lengths);
    void note_direction(const FoundMolecules &found, const FoundMolecule &molecule, const BondList &list);
    void check_closable(const Shape &shape, const std::int64_t *atoms, const std::int64_t *bonds,
                        const double *lengths) const;

    Chains &chains_;
    const std::unique_ptr<EliminationWork> work_;
    const Groups::Mark before_;
    const Kinds::Mark kinds_before_;
    const std::size_t n_unconstrained_, n_active_;
    std::int64_t n_bonds_ = 0;
    std::int64_t room_ = -1;                 // memory that new shapes may take; -1: not asked for yet
    const FoundMolecules *found_ = nullptr;  // of which the movable atoms are to be taken
    std::vector<std::int64_t> taken_, fixed_;
    std::vector<double> w_;
    std::vector<std::int64_t> places_;
    std::vector<std::int64_t> backwards_;  // bonds of the list whose atoms were given the other way round
    bool flat_ = false;
    bool committed_ = false;
};

}  // namespace holonomic
