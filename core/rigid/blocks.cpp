#include "core/rigid/blocks.hpp"

#include <type_traits>

#include "core/run/kernel_choice.hpp"

namespace holonomic::rigid {

static_assert(std::is_standard_layout_v<Step> && sizeof(Step) == 2 * sizeof(std::int32_t),
              "BodyKind has them in pairs");

BodyKind kind_of(const Body &body, const Shape &shape) {
    const std::ptrdiff_t n = std::ptrdiff_t{body.n_atoms} * (1 + body.rank);
    const double *const weights = body.weights.data();
    BodyKind kind{};
    kind.n_atoms = body.n_atoms;
    kind.rank = body.rank;
    kind.mass = body.mass;
    kind.inverse_mass = body.inverse_mass;
    kind.extent = body.extent;
    for (int p = 0; p < body.rank; ++p) {
        kind.square[p] = body.square[p].hi;
        for (int q = 0; q < body.rank; ++q) {
            kind.per_size[p][q] = 1 / (body.length[p] * body.length[q]);
            kind.per_sum[p][q] = 1 / (body.square[p].hi + body.square[q].hi);
        }
    }
    kind.masses = body.masses.data();
    kind.has_sites = body.n_massive < body.n_atoms;
    kind.place = weights;
    kind.place_low = weights + n;
    kind.share = weights + 2 * n;
    kind.share_low = weights + 3 * n;
    kind.steps = &shape.steps.data()->atom;
    return kind;
}

std::int64_t bytes_of_block(const Shape &shape) { return kernels().bodies.scratch_bytes(shape.n_atoms); }

}  // namespace holonomic::rigid
