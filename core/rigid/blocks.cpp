#include "core/rigid/blocks.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "core/kernel_choice.hpp"

namespace holonomic::rigid {

static_assert(std::is_standard_layout_v<NearestStep> && sizeof(NearestStep) == 2 * sizeof(std::int32_t),
              "BodyKind has them in pairs");

BodyKind kind_of(const Body &body, const MoleculeKind &molecule) {
    const std::ptrdiff_t n = std::ptrdiff_t{body.n_atoms} * (1 + body.rank);
    const double *const weights = body.weights.data();
    BodyKind kind{};
    kind.n_atoms = body.n_atoms;
    kind.rank = body.rank;
    kind.n_heavy = body.n_atoms;
    while (body.masses[static_cast<std::size_t>(kind.n_heavy - 1)] == 0) --kind.n_heavy;
    kind.has_sites = body.n_massive < body.n_atoms;
    kind.has_sites_between = body.n_massive < kind.n_heavy;
    kind.mass = body.mass;
    kind.extent = body.extent;
    kind.per_moment[0] = body.inverse_mass;
    for (int p = 0; p < body.rank; ++p) {
        kind.square[p] = body.square[p].hi;
        kind.per_moment[1 + p] = body.inverse_mass / kind.square[p];
    }
    for (int p = 0; p < 3; ++p)
        for (int q = 0; q < 3; ++q) {
            const double both = kind.square[p] + kind.square[q];
            kind.part[p][q] = p == q || both == 0 ? 0.5 : kind.square[p] / both;
        }
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        kind.skew[i] = kind.part[j][k] - kind.part[k][j];
    }
    kind.is_spherical = std::all_of(kind.skew, kind.skew + 3, [](double b) { return std::fabs(b) <= 1e-15; });
    std::copy_n(body.excess[0], 16, kind.excess[0]);
    kind.scale = 1 - kind.excess[0][0];
    kind.height = body.height.empty() ? nullptr : body.height.data();
    kind.masses = body.masses.data();
    kind.coordinates = weights;
    kind.share = weights + n;
    kind.steps = &molecule.steps.data()->atom;
    return kind;
}

std::int64_t bytes_of_block(const MoleculeKind &molecule) { return kernels().bodies.scratch_bytes(molecule.n_atoms); }

}  // namespace holonomic::rigid
