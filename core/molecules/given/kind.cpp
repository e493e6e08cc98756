#include "core/molecules/given/kind.hpp"

#include <algorithm>
#include <iterator>

#include "core/molecules/given/hash.hpp"
#include "core/molecules/given/ordinary.hpp"

namespace holonomic {

namespace {

bool all_equal(const double *x, std::int64_t n) {
    return std::all_of(x, x + n, [x](double y) { return y == x[0]; });
}

bool all_are(const double *x, std::int64_t n, const double *table, double uniform) {
    if (table) return std::equal(x, x + n, table);
    return std::all_of(x, x + n, [uniform](double y) { return y == uniform; });
}

}  // namespace

bool Kinds::is(const Kind &kind, std::int32_t shape, std::int64_t n_atoms, std::int64_t n_bonds, const double *w,
               const double *length) const {
    return kind.shape == shape && kind.n_bonds == n_bonds && kind.n_atoms() == n_atoms &&
           all_are(length, n_bonds, this->length(kind), kind.length_uniform) &&
           all_are(w, n_atoms, this->w(kind), kind.w_uniform);
}

std::int64_t Kinds::find(std::int32_t shape, std::int64_t n_atoms, std::int64_t n_bonds, const double *w,
                         const double *length, std::int64_t likely) {
    if (likely >= 0 && is((*this)[likely], shape, n_atoms, n_bonds, w, length)) return likely;
    std::uint64_t hash = mix(static_cast<std::uint64_t>(n_bonds), static_cast<std::uint64_t>(shape));
    for (std::int64_t k = 0; k < n_bonds; ++k) hash = mix(hash, length[k]);
    for (std::int64_t i = 0; i < n_atoms; ++i) hash = mix(hash, w[i]);
    const auto candidates = by_hash_.equal_range(hash);
    for (auto it = candidates.first; it != candidates.second; ++it)
        if (is((*this)[it->second], shape, n_atoms, n_bonds, w, length)) return it->second;

    const std::size_t n_w = w_.size(), n_length = length_.size();
    Kind kind{n_bonds, shape, static_cast<std::int32_t>(n_bonds + 1 - n_atoms), -1, -1, w[0], length[0]};
    try {
        if (shape != linear || !all_equal(w, n_atoms)) {
            kind.w_offset = static_cast<std::int64_t>(n_w);
            w_.insert(w_.end(), w, w + n_atoms);
        }
        if (shape != linear || !all_equal(length, n_bonds)) {
            kind.length_offset = static_cast<std::int64_t>(n_length);
            length_.insert(length_.end(), length, length + n_bonds);
        }
        kinds_.push_back(kind);
        try {
            by_hash_.emplace(hash, size() - 1);
        } catch (...) {
            kinds_.pop_back();
            throw;
        }
    } catch (...) {
        w_.resize(n_w);
        length_.resize(n_length);
        throw;
    }
    return size() - 1;
}

void Kinds::roll_back(const Mark &mark) noexcept {
    if (kinds_.size() == mark.n_kinds) return;
    for (auto it = by_hash_.begin(); it != by_hash_.end();)
        it = it->second >= static_cast<std::int64_t>(mark.n_kinds) ? by_hash_.erase(it) : std::next(it);
    kinds_.resize(mark.n_kinds);
    w_.resize(mark.n_w);
    length_.resize(mark.n_lengths);
}

double Kinds::longest(std::int64_t first, double least) const {
    double longest = least;
    for (std::int64_t k = first; k < size(); ++k) {
        const Kind &kind = (*this)[k];
        const double *const table = length(kind);
        longest = std::max(longest, table ? *std::max_element(table, table + kind.n_bonds) : kind.length_uniform);
    }
    return longest;
}

bool Kinds::is_ordinary(const Kind &kind) const {
    const double *const masses = w(kind), *const lengths = length(kind);
    return are_ordinary(powers_of(lengths ? *std::max_element(lengths, lengths + kind.n_bonds) : kind.length_uniform,
                                  masses ? *std::max_element(masses, masses + kind.n_atoms()) : kind.w_uniform));
}

void Kinds::shrink() {
    kinds_.shrink_to_fit();
    w_.shrink_to_fit();
    length_.shrink_to_fit();
}

std::size_t Kinds::bytes() const {
    return kinds_.capacity() * sizeof(Kind) + (w_.capacity() + length_.capacity()) * sizeof(double) +
           by_hash_.size() * 40 + by_hash_.bucket_count() * sizeof(void *);
}

}  // namespace holonomic
