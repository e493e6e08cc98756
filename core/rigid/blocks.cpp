#include "core/rigid/blocks.hpp"

#include <algorithm>
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
    for (int p = 0; p < body.rank; ++p) kind.square[p] = body.square[p].hi;
    for (int p = 0; p < 3; ++p)
        for (int q = 0; q < body.rank; ++q) {
            kind.per_sum[p][q] = kind.per_sum[q][p] = 1 / (kind.square[p] + kind.square[q]);
            if (p >= body.rank) continue;
            kind.per_size[p][q] = 1 / (body.length[p] * body.length[q]);
            kind.ratio[p][q] = body.length[q] / body.length[p];
        }
    for (int q = 0; q < 2 && body.rank == 2; ++q) kind.ratio[2][q] = body.length[q] / (body.length[0] * body.length[1]);
    std::copy_n(body.excess[0], 16, kind.excess[0]);
    kind.masses = body.masses.data();
    kind.has_sites = body.n_massive < body.n_atoms;
    kind.place = weights;
    kind.share = weights + n;
    kind.steps = &shape.steps.data()->atom;
    return kind;
}

std::int64_t bytes_of_block(const Shape &shape) { return kernels().bodies.scratch_bytes(shape.n_atoms); }

}  // namespace holonomic::rigid
