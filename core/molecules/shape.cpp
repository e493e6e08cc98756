#include "core/molecules/shape.hpp"

#include <algorithm>
#include <utility>

#include "core/molecules/hash.hpp"

namespace holonomic {

namespace {

bool is(const Shape &shape, std::int32_t n_atoms, std::int32_t n_bonds, const std::int32_t *pairs,
        const unsigned char *fixed) {
    return shape.n_atoms == n_atoms && shape.n_bonds == n_bonds &&
           std::equal(shape.pairs.begin(), shape.pairs.end(), pairs) &&
           std::equal(shape.fixed.begin(), shape.fixed.end(), fixed);
}

}  // namespace

std::int32_t Shapes::find(Form form, std::int32_t n_atoms, std::int32_t n_bonds, const std::int32_t *pairs,
                          const unsigned char *fixed, std::int32_t likely) {
    if (likely >= 0 && is((*this)[likely], n_atoms, n_bonds, pairs, fixed)) return likely;
    std::uint64_t hash = mix(static_cast<std::uint64_t>(n_bonds), static_cast<std::uint64_t>(n_atoms));
    for (std::int64_t k = 0; k < 2 * std::int64_t{n_bonds}; ++k) hash = mix(hash, static_cast<std::uint64_t>(pairs[k]));
    for (std::int32_t i = 0; i < n_atoms; ++i) hash = mix(hash, static_cast<std::uint64_t>(fixed[i]));
    const auto candidates = by_hash_.equal_range(hash);
    for (auto it = candidates.first; it != candidates.second; ++it)
        if (is((*this)[it->second], n_atoms, n_bonds, pairs, fixed)) return it->second;

    Shape shape{form, n_atoms, n_bonds, {pairs, pairs + 2 * std::int64_t{n_bonds}}, {fixed, fixed + n_atoms}, {}};
    const std::unique_ptr<bool[]> flags(new bool[static_cast<std::size_t>(n_atoms)]);
    std::transform(fixed, fixed + n_atoms, flags.get(), [](unsigned char f) { return f != 0; });
    shape.schedule = make_schedule(n_atoms, n_bonds, pairs, flags.get());
    shapes_.push_back(std::move(shape));
    try {
        by_hash_.emplace(hash, size() - 1);
    } catch (...) {
        shapes_.pop_back();
        throw;
    }
    return size() - 1;
}

std::size_t Shapes::bytes() const {
    std::size_t bytes =
        shapes_.capacity() * sizeof(Shape) + by_hash_.size() * 40 + by_hash_.bucket_count() * sizeof(void *);
    for (const Shape &shape : shapes_)
        bytes += shape.pairs.capacity() * sizeof(std::int32_t) + shape.fixed.capacity() + bytes_of(*shape.schedule);
    return bytes;
}

}  // namespace holonomic
