// Sorts of molecules: the same bonds, masses and lengths. Molecules of one kind share its tables.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

namespace holonomic {

struct Kind {
    std::int64_t n_bonds;
    std::int32_t shape;          // into the shapes, or linear: the bonds join each atom to the next
    std::int32_t n_cycles;       // that are independent
    std::int64_t w_offset;       // into the table of inverse masses, or -1: all w_uniform
    std::int64_t length_offset;  // likewise
    double w_uniform, length_uniform;
    std::int64_t n_atoms() const { return n_bonds + 1 - n_cycles; }
};

constexpr std::int32_t linear = -1;

class Kinds {
public:
    // The kind with these w [n_atoms] and lengths [n_bonds]; a new one if there is none yet. Looks at `likely` first.
    // Throws std::bad_alloc, changing nothing.
    std::int64_t find(std::int32_t shape, std::int64_t n_atoms, std::int64_t n_bonds, const double *w,
                      const double *length, std::int64_t likely);

    // Takes back all that was new since.
    struct Mark {
        std::size_t n_kinds, n_w, n_lengths;
    };
    Mark mark() const { return {kinds_.size(), w_.size(), length_.size()}; }
    void roll_back(const Mark &mark) noexcept;

    const Kind &operator[](std::int64_t kind) const { return kinds_[static_cast<std::size_t>(kind)]; }
    std::int64_t size() const { return static_cast<std::int64_t>(kinds_.size()); }
    // [n_atoms], [n_bonds], or null if all are alike; kinds that are not linear have both.
    const double *w(const Kind &kind) const { return kind.w_offset < 0 ? nullptr : w_.data() + kind.w_offset; }
    const double *length(const Kind &kind) const {
        return kind.length_offset < 0 ? nullptr : length_.data() + kind.length_offset;
    }
    // Whether its masses and lengths are in ordinary units (ordinary.hpp).
    bool is_ordinary(const Kind &kind) const;
    // The largest length of the kinds from `first` on, if that is more than `least`.
    double longest(std::int64_t first, double least) const;
    void shrink();
    std::size_t bytes() const;

private:
    bool is(const Kind &kind, std::int32_t shape, std::int64_t n_atoms, std::int64_t n_bonds, const double *w,
            const double *length) const;

    std::vector<Kind> kinds_;
    std::unordered_multimap<std::uint64_t, std::int64_t> by_hash_;
    std::vector<double> w_, length_;
};

}  // namespace holonomic
