#include "core/molecules/planned/shapes.hpp"

#include <algorithm>
#include <utility>

#include "core/molecules/given/hash.hpp"
#include "core/molecules/given/triangles.hpp"

namespace holonomic {

namespace {

bool is(const Shape &shape, std::int32_t n_atoms, std::int32_t n_bonds, const std::int32_t *pairs,
        const unsigned char *fixed) {
    if (shape.n_atoms != n_atoms || shape.n_bonds != n_bonds) return false;
    bool same = std::equal(fixed, fixed + n_atoms, shape.elimination->fixed);
    for (std::int32_t k = 0; same && k < n_bonds; ++k)
        same = pairs[2 * k] == shape.i(k) && pairs[2 * k + 1] == shape.j(k);
    return same;
}

std::vector<std::int32_t> spanning_walk(std::int32_t n_atoms, std::int32_t n_bonds, const std::int32_t *pairs) {
    std::vector<std::int32_t> start(at(n_atoms) + 1, 0), arms(2 * at(n_bonds)), walk, stack{0};
    for (std::size_t e = 0; e < 2 * at(n_bonds); ++e) ++start[at(pairs[e]) + 1];
    for (std::int32_t i = 0; i < n_atoms; ++i) start[at(i) + 1] += start[at(i)];
    std::vector<std::int32_t> next(start.begin(), start.end() - 1);
    for (std::int32_t k = 0; k < n_bonds; ++k) {
        arms[at(next[at(pairs[2 * at(k)])]++)] = k;
        arms[at(next[at(pairs[2 * at(k) + 1])]++)] = ~k;
    }
    std::vector<unsigned char> reached(at(n_atoms), 0);
    reached[0] = 1;
    walk.reserve(at(n_atoms) - 1);
    while (!stack.empty()) {
        const std::int32_t i = stack.back();
        stack.pop_back();
        for (std::int32_t a = start[at(i)]; a < start[at(i) + 1]; ++a) {
            const std::int32_t step = arms[at(a)];
            const std::int32_t j = pairs[step < 0 ? 2 * at(~step) : 2 * at(step) + 1];
            if (reached[at(j)]) continue;
            reached[at(j)] = 1;
            walk.push_back(step);
            stack.push_back(j);
        }
    }
    return walk;
}

}  // namespace

std::int32_t Shapes::find(Topology topology, std::int32_t n_atoms, std::int32_t n_bonds, const std::int32_t *pairs,
                          const unsigned char *fixed, std::int32_t likely, std::int64_t most_bytes,
                          EliminationWork *work) {
    if (likely >= 0 && is((*this)[likely], n_atoms, n_bonds, pairs, fixed)) return likely;
    std::uint64_t hash = mix(static_cast<std::uint64_t>(n_bonds), static_cast<std::uint64_t>(n_atoms));
    for (std::int64_t k = 0; k < n_bonds; ++k)
        hash = mix(hash, static_cast<std::uint64_t>(pairs[2 * k]) << 32 | static_cast<std::uint32_t>(pairs[2 * k + 1]));
    for (std::int32_t i = 0; i < n_atoms; ++i)
        if (fixed[i]) hash = mix(hash, static_cast<std::uint64_t>(i));
    const auto candidates = by_hash_.equal_range(hash);
    for (auto it = candidates.first; it != candidates.second; ++it)
        if (is((*this)[it->second], n_atoms, n_bonds, pairs, fixed)) return it->second;

    if (n_bonds > most_bytes / bytes_of_shape_bond) throw TooMuchMemory(n_bonds * bytes_of_shape_bond);
    Shape shape{topology, n_atoms, n_bonds, false, {}, {}};
    if (n_bonds >= n_atoms) {
        shape.has_triangles = any_triangle(
            n_atoms, n_bonds, [pairs](std::int32_t k, int end) { return pairs[2 * at(k) + at(end)]; },
            [](auto...) { return true; });
        shape.round_cycles = spanning_walk(n_atoms, n_bonds, pairs);
    }
    shape.elimination = make_elimination_plan(n_atoms, n_bonds, pairs, fixed, most_bytes, work);
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
        bytes += shape.round_cycles.capacity() * sizeof(std::int32_t) + bytes_of(*shape.elimination);
    return bytes;
}

}  // namespace holonomic
