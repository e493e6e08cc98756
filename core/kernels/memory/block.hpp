// A block: up to W chains, or W segments of one chain, one per lane. It is read from the caller's memory into
// interleaved arrays in cache, and written back. Packed coordinates are read in place and transposed, W x W elements at
// a time. Any other layout is first copied into packed staging buffers.
#pragma once

#include "core/kernels/arithmetic/vector3.hpp"
#include "core/kernels/call.hpp"
#include "core/kernels/isa/lanes.hpp"

namespace holonomic::HOL_ISA {

// Chains of so many bonds have kernels of their own (small.hpp), in a box or over atoms that are listed, too.
constexpr int largest_boxed_molecule = 3;

constexpr int group = W > 4 ? W : 4;  // bonds of a lane that are read and eliminated at a time

struct Block {
    long n, n_min;    // bonds of the longest and of the shortest lane
    long len[W];      // bonds of each lane
    int lanes;        // lanes in use; the others repeat the first one and are never stored
    bool padded;      // W atoms more can be read behind each lane
    long ahead;       // doubles from a lane's vectors to those of the next block, to be fetched early; or 0
    long list_ahead;  // the same for lists of atoms
    bool staged;      // some lanes lie in staging buffers, so all do
    // Each lane has its own unit of inverse masses: its inverse mass if that is the same for all atoms, else 1. So
    // equal masses cost nothing, and no lane's rounding depends on the others.
    bool uniform_w;       // they are 1 along every lane
    bool unit_masses;     // and so are the masses
    vec unit, mass;       // the unit, and 1 / unit
    mask movable;         // lanes in which an atom can move
    const vec *w;         // else [n+1], interleaved, in that unit
    const double *w3[W];  // and [len+1][3], each three times; or nullptr: not yet
    long first_bond[W];
    long chain[W];

    mask in_use() const { return first_lanes(lanes); }
    vec lengths() const {
        vec v = {};
        for (int i = 0; i < W; ++i) v[i] = static_cast<double>(len[i]);
        return v;
    }
};

// One vector per atom of each lane: [len+1][3], in the caller's memory or staged.
struct Packed {
    double *lane[W];
};

// Where the coordinates of a block are: in lanes, or anywhere in the array `base`.
struct Source {
    const Box *box;
    const Packed *r = nullptr;
    const double *base = nullptr;           // where lists or lanes say, else molecules of `apart` atoms in a row
    const int64_t *const *atoms = nullptr;  // lists
    const Lane *lanes = nullptr;            // of at most three bonds each
    long apart = 0;
    const long *len = nullptr;  // of lanes that may end before the joints that are asked for; or nullptr
    const double *atom(int lane, long k) const {
        if (r) return r->lane[lane] + 3 * k;
        if (lanes) return base + lanes[lane].element[k];
        return base + 3 * (atoms ? atoms[lane][k] : apart * lane + k);
    }
};

// Returns n bonds of a chain, from bond `from` on, as a chain.
HOL_INLINE Lane part_of(const Lane &chain, int64_t from, int64_t n) {
    Lane part = chain;
    part.n_bonds = n;
    part.first_atom += from;
    part.first_bond += from;
    if (chain.atoms) part.atoms += from;
    if (chain.w) part.w += from;
    if (chain.length) part.length += from;
    return part;
}

// The unit of a chain's inverse masses, and the inverse mass of atom k in it (see Block).
HOL_INLINE double unit_of(const Lane &lane) { return !lane.w && lane.w_uniform > 0 ? lane.w_uniform : 1.0; }
HOL_INLINE double relative_w(const Lane &lane, int64_t k) {
    return lane.w ? lane.w[k] : lane.w_uniform > 0 ? 1.0 : 0.0;
}

// Inverse mass of atom k in each lane's unit.
template <bool uniform>
HOL_INLINE vec w_at(const Block &block, long k) {
    return uniform ? splat(1.0) : block.w[k];
}

// The lanes that have both bonds k-1 and k.
HOL_INLINE mask joint(const Block &block, long k) { return less(splat(static_cast<double>(k)), block.lengths()); }

// Rows: W doubles of one lane as they stand in memory, and their transposition into lanes.

// Returns where W + 1 atoms can be read from atom k of a vector [len+1][3] on. If some lie past its end, that is
// buffer[3 W + 3], padded with zeros.
HOL_INLINE const double *window(const double *p, long k, long len, bool padded, double *buffer) {
    if (__builtin_expect(padded || k + W <= len, 1)) return p + 3 * k;
    const long left = len - k + 1 > 0 ? 3 * (len - k + 1) : 0;
    for (long i = 0; i < 3 * W + 3; ++i) buffer[i] = i < left ? p[3 * k + i] : 0.0;
    return buffer;
}

// Puts values along the lanes into out[n]. It reads rows[lane][k] while all lanes have one (k < count + more), and
// calls value(lane, k) from there on.
template <class Value>
HOL_INLINE void interleave(const double *const *rows, const long *count, long more, long n, vec *out,
                           const Value &value) {
    long full = n, k = 0;
    for (int i = 0; i < W; ++i) full = !rows[i] ? 0 : count[i] + more < full ? count[i] + more : full;
    for (; k + W <= full; k += W) {
        vec m[W];
        for (int i = 0; i < W; ++i) m[i] = load(rows[i] + k);
        transpose(m);
        for (int a = 0; a < W; ++a) out[k + a] = m[a];
    }
    for (; k < n; ++k)
        for (int i = 0; i < W; ++i) out[k][i] = value(i, k);
}

// The atoms k0 .. k0 + W - 1 of all lanes, from pointers to atom k0.
HOL_INLINE void load_atoms(const double *const *p, vec3 *atoms) {
    vec *const elements = &atoms->x;
    HOL_UNROLL
    for (int j = 0; j < 3; ++j) {
        vec e[W];
        HOL_UNROLL
        for (int i = 0; i < W; ++i) e[i] = load(p[i] + W * j);
        transpose(e);
        HOL_UNROLL
        for (int i = 0; i < W; ++i) elements[j * W + i] = e[i];
    }
}

HOL_INLINE vec3 load_atom(const Packed &p) {
    vec3 a = {};
    for (int i = 0; i < W; ++i) {
        a.x[i] = p.lane[i][0];
        a.y[i] = p.lane[i][1];
        a.z[i] = p.lane[i][2];
    }
    return a;
}

}  // namespace holonomic::HOL_ISA
