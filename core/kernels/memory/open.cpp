// Opens a block of W chains (open.hpp): their inverse masses, relative to a unit of each chain's own, where their
// atoms stand, and which are bad or staged. Compiled once, for all levels.
#include "core/kernels/memory/open.hpp"

namespace holonomic::HOL_ISA {

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic push  // gcc 14 takes a vector that is filled element by element for one that was never set
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
void set_masses(Block &block, const Lane *lane, Arena &arena) {
    const double *table[W];
    double constant[W];  // where there is no table
    block.uniform_w = true;
    for (int i = 0; i < W; ++i) {
        const Lane &of = lane[i < block.lanes ? i : 0];
        const bool has_unit = !of.w && of.w_uniform > 0;  // not in a chain of nothing but fixed atoms
        table[i] = of.w;
        constant[i] = has_unit ? 1.0 : of.w_uniform;
        block.movable[i] = has_unit || of.w ? -1 : 0;
        block.unit[i] = has_unit ? of.w_uniform : 1.0;
        block.uniform_w = block.uniform_w && has_unit;
    }
    block.mass = splat(1.0) / block.unit;
    block.unit_masses = block.uniform_w && !any(~equal(block.mass, splat(1.0)));
    block.w3[0] = nullptr;
    if (block.uniform_w) return;
    constexpr int behind = HOL_FOURS ? 3 : 0;  // fours may end behind the chain
    const long n_atoms = block.n + 1;
    vec *w = arena.vecs(n_atoms + behind);
    interleave(table, block.len, 1, n_atoms, w, [&](int i, long k) HOL_FORCED {
        return k > block.len[i] ? 1.0 : (table[i] ? table[i][k] : constant[i]);  // past the end: any positive mass
    });
    HOL_UNROLL
    for (int k = 0; k < behind; ++k) w[n_atoms + k] = splat(1.0);
    block.w = w;
}

void repeat_masses(Block &block, const Lane *lane, Arena &arena) {
    if (block.uniform_w || block.w3[0]) return;
    for (int i = 0; i < W; ++i) {
        const Lane &first = lane[0], &of = lane[i < block.lanes ? i : 0];
        if (i > 0 && of.w == first.w && of.w_uniform == first.w_uniform && block.len[i] == block.len[0]) {
            block.w3[i] = block.w3[0];
            continue;
        }
        double *const w3 = arena.doubles(3 * (block.n + 1 + W));
        const double *const table = of.w;  // what is stored might be taken for it
        const long full = table ? block.len[i] + 1 : 0;
        long k = 0;
        for (; k + W <= full; k += W) {
            const vec x = load(table + k);
            HOL_UNROLL
            for (int j = 0; j < 3; ++j) {
                vec three = {};
                HOL_UNROLL
                for (int e = 0; e < W; ++e) three[e] = x[(j * W + e) / 3];
                store(w3 + 3 * k + j * W, three);
            }
        }
        for (; k < block.n + 1 + W; ++k) w3[3 * k] = w3[3 * k + 1] = w3[3 * k + 2] = k > block.n ? 1.0 : block.w[k][i];
        block.w3[i] = w3;
    }
}
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif

void note_bad(const Block &block, mask bad, Tally &tally) {
    const unsigned which = bits(bad & block.in_use());
    for (int i = 0; i < block.lanes; ++i)
        if (which >> i & 1) note_bad(block.chain[i], tally);
}

void open_block(const Unit &unit, int64_t first, Block &block, Lane *lane) {
    const int64_t left = unit.count - first;
    block.lanes = left < W ? static_cast<int>(left) : W;
    block.padded = block.staged = false;
    block.ahead = block.list_ahead = 0;
    if (unit.regular) {
        const Lane &head = unit.lanes[0];
        const int64_t n = head.n_bonds;
        if (first == 0) {
            block.n = block.n_min = n;
            for (int i = 0; i < W; ++i) {
                lane[i] = head;
                block.len[i] = n;
            }
        }
        for (int i = 0; i < block.lanes; ++i) {
            const int64_t c = first + i;
            lane[i].first_atom = head.first_atom + c * (n + 1);
            if (head.atoms) lane[i].atoms = head.atoms + c * (n + 1);
            lane[i].first_bond = block.first_bond[i] = head.first_bond + c * n;
            lane[i].chain = block.chain[i] = head.chain + c;
        }
        block.staged = head.atoms != nullptr;
        block.padded = (unit.padded || (left - block.lanes) * (n + 1) >= W) && !block.staged;
        if (unit.large) block.ahead = 3 * W * (n + 1);  // the next unit often goes on where this one ends
        if (unit.large && left >= 2 * W) block.list_ahead = W * (n + 1);
        return;
    }
    block.n = 0;
    block.n_min = unit.lanes[first].n_bonds;
    if (block.n_min <=
        largest_boxed_molecule) {  // as their own kernels take them, so that sums over blocks are the same
        int alike = 1;
        while (alike < block.lanes && unit.lanes[first + alike].n_bonds == block.n_min) ++alike;
        block.lanes = alike;
    }
    for (int i = 0; i < block.lanes; ++i) {
        lane[i] = unit.lanes[first + i];
        block.staged = block.staged || lane[i].atoms;
        block.len[i] = lane[i].n_bonds;
        block.first_bond[i] = lane[i].first_bond;
        block.chain[i] = lane[i].chain;
        if (lane[i].n_bonds > block.n) block.n = lane[i].n_bonds;
        if (lane[i].n_bonds < block.n_min) block.n_min = lane[i].n_bonds;
    }
    for (int i = block.lanes; i < W; ++i) block.len[i] = block.len[0];
    // If chains of one length stand one behind the other, the next block often goes on where this one ends.
    bool consecutive = unit.large && !block.staged && block.lanes == W && block.n == block.n_min;
    for (int i = 1; i < block.lanes; ++i)
        consecutive = consecutive && lane[i].first_atom == lane[0].first_atom + i * (block.n + 1);
    if (consecutive) block.ahead = 3 * W * (block.n + 1);
}

Packed open_staged(const AtomArray &array, const Block &block, const Lane *lane, Arena &arena, bool read) {
    Packed packed = {};
    for (int i = 0; i < block.lanes; ++i) {
        packed.lane[i] = arena.doubles(staged_size(block.n));
        if (read) stage(array, lane[i], 0, block.len[i], packed.lane[i]);
    }
    repeat_first(packed, block.lanes);
    return packed;
}

void close_staged(const AtomArray &array, const Block &block, const Lane *lane, mask which, const Packed &packed,
                  bool add) {
    const unsigned chosen = bits(which & block.in_use());
    for (int i = 0; i < block.lanes; ++i)
        if (chosen >> i & 1) unstage(array, lane[i], 0, block.len[i], packed.lane[i], add);
}

}  // namespace holonomic::HOL_ISA
