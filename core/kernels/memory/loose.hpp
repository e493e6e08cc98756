// Small molecules that stand anywhere, each of a kind of its own: what their lanes hold.
#ifndef HOLONOMIC_KERNELS_MEMORY_LOOSE_HPP
#define HOLONOMIC_KERNELS_MEMORY_LOOSE_HPP

#include "core/kernels/memory/fixed.hpp"

namespace holonomic {
namespace HOL_ISA {

// A place, as in fixed.hpp, of molecules of a unit that is not regular: the `used` ones from `first` on, of N bonds
// each. Lanes that are left over repeat the first one: what they write is the same.
template <int N>
struct ByLanes : ByNumber<N, ByLanes<N>> {
    static constexpr bool loose = true;
    const Lane *lane;

    ByLanes(const Unit &unit, int64_t first, int64_t used) : lane(unit.lanes + first) {
        if (__builtin_expect(used == W, 1)) return;
        for (int i = 0; i < W; ++i) last_[i] = lane[i < used ? i : 0];
        lane = last_;
    }
    ByLanes(const ByLanes &) = delete;
    ByLanes &operator=(const ByLanes &) = delete;

    HOL_INLINE int64_t end(const Unit &unit, int64_t first) {
        while (first < unit.count && unit.lanes[first].n_bonds == N) ++first;
        return first;
    }
    HOL_INLINE int64_t next(int64_t first, int64_t end) { return end - first >= W ? W : end - first; }
    HOL_FORCED int64_t element(int i, int k) const { return lane[i].element[k]; }
    HOL_FORCED int64_t chain_of(int i) const { return lane[i].chain; }
    HOL_FORCED void store_multipliers(const vec *t, vec factor, double *base) const {
        HOL_UNROLL
        for (int k = 0; k < N; ++k) {
            const vec value = mul_add(factor, t[k], vec{});
            HOL_UNROLL
            for (int i = 0; i < W; ++i) base[lane[i].first_bond + k] = value[i];
        }
    }
    HOL_FORCED const int64_t *const *lists() const { return nullptr; }
    HOL_FORCED const Lane *lanes() const { return lane; }
    HOL_FORCED void fetch_next(const double *) const {}

private:
    Lane last_[W];
};

// The masses of a block. Of a regular unit those that have been set; ..
template <int N, bool loose>
struct BlockMasses {
    const Block &block;
    explicit BlockMasses(const Block &b) : block(b) {}
    template <class Place>
    HOL_FORCED bool take(const Place &) const {
        return false;
    }
};

// .. else of the lanes of a place, with what else is asked of a block.
template <int N>
struct BlockMasses<N, true> {
    Block block;  // what is not set here is not asked for
    vec w[N + 1] = {};
    int64_t kind[W];
    explicit BlockMasses(const Block &) {
        block.n = block.n_min = N;
        for (int i = 0; i < W; ++i) {
            block.len[i] = N;
            kind[i] = -1;
        }
        block.lanes = W;
        block.unit = vec{};
        block.uniform_w = block.unit_masses = false;
        block.movable = first_lanes(W);
        block.w = w;
    }
    BlockMasses(const BlockMasses &) = delete;
    BlockMasses &operator=(const BlockMasses &) = delete;

    // Whether they are others than before.
    HOL_FORCED bool take(const ByLanes<N> &place) {
        bool same = true;
        for (int i = 0; i < W; ++i) same = same & (kind[i] == place.lane[i].kind);
        if (__builtin_expect(same, 1)) return false;
        for (int i = 0; i < W; ++i) {
            const Lane &lane = place.lane[i];
            kind[i] = lane.kind;
            block.unit[i] = unit_of(lane);
            for (int k = 0; k <= N; ++k) w[k][i] = relative_w(lane, k);
        }
        block.mass = splat(1.0) / block.unit;
        return true;
    }
};

}  // namespace HOL_ISA
}  // namespace holonomic
#endif
