// Blocks whose lanes are rows, in place or staged.
#include "core/kernels/memory/load.hpp"

#include "core/kernels/arithmetic/image.hpp"
#include "core/kernels/memory/load_one_lane.hpp"
#include "core/kernels/memory/padded_rows.hpp"
#include "core/kernels/memory/prefetch.hpp"

namespace holonomic::HOL_ISA {

// Whole chunks of W bonds. It subtracts numbers as they stand in memory, folds components into an orthorhombic box,
// multiplies, and transposes only what comes out: vectors that are transposed before that take 4 % more instructions
// per bond of forces, and all of them are shuffles, of which most processors do one at a time.
template <int terms, bool uniform, bool boxed>
static void load_chunks(const Reader &in, long k0, long end, vec3 *D, vec *B) {
    constexpr bool has_v = terms & (velocity_squared | rate), has_f = terms & force_difference;
    const Block &block = in.block;
    const Box &box = in.box;
    // All arrays are in place, or all are staged, so a lane has the same distance from the first one in each.
    const double *const first_r = in.r->lane[0], *const first_v = has_v ? in.v->lane[0] : nullptr,
                        *const first_f = has_f ? in.f->lane[0] : nullptr;
    const long done = load_in_fours<terms, uniform, boxed>(in, first_r, first_v, first_f, k0, end, D, B);
    k0 += done;
    D += done;
    if (B) B += done;
    long lane[W];
    for (int i = 0; i < W; ++i) lane[i] = in.r->lane[i] - first_r;
    for (; k0 < end; k0 += W, D += W) {
        if (__builtin_expect(in.ahead != 0, 0)) {
            fetch_ahead(first_r, k0, in.ahead);
            if (has_v) fetch_ahead(first_v, k0, in.ahead);
            if (has_f) fetch_ahead(first_f, k0, in.ahead);
        }
        vec *const d = &D->x;
        vec p[3 * W];
        HOL_UNROLL
        for (int j = 0; j < 3; ++j) {
            const long at = 3 * k0 + W * j;
            vec e[W];
            HOL_UNROLL
            for (int i = 0; i < W; ++i) {
                const double *const r = first_r + at + lane[i];
                e[i] = load(r + 3) - load(r);
                if (boxed) {
                    const int first = W * j % 3;
                    e[i] = mul_add(round(e[i] * load(box.per_side + first)), load(box.minus_side + first), e[i]);
                }
                vec dv = {}, df = {}, vv = {};
                if (has_v) dv = load(first_v + at + lane[i] + 3) - load(first_v + at + lane[i]);
                if (terms & velocity_squared) vv = square(terms, splat(block.mass[i]), dv);
                if (has_f) {
                    const vec f0 = load(first_f + at + lane[i]), f1 = load(first_f + at + lane[i] + 3);
                    const double *const w3 = uniform ? nullptr : block.w3[i] + at;
                    df = uniform ? f1 - f0 : load(w3 + 3) * f1 - load(w3) * f0;
                }
                if (terms & products) p[j * W + i] = product(terms, e[i], dv, df, vv);
            }
            transpose(e);
            HOL_UNROLL
            for (int i = 0; i < W; ++i) d[j * W + i] = e[i];
            if (terms & products) transpose(p + j * W);
        }
        if (!(terms & products)) {
            for (int b = 0; in.terms == none_ && B && b < W; ++b) *B++ = vec{};
            continue;
        }
        HOL_UNROLL
        for (int b = 0; b < W; ++b) B[b] = (p[3 * b] + p[3 * b + 1]) + p[3 * b + 2];
        B += W;
    }
}

// Those that whole chunks of a block have, or nullptr: bond by bond.
static Reader::LoadChunks *chunks_of(const Block &block, const Box &box, int terms, bool extended) {
    constexpr int forces = force_difference, both = velocity_squared | force_difference;
    if (extended || box.lattice == Box::triclinic) return nullptr;
    const bool boxed = box.lattice != Box::none;
    const bool uniform = (terms & force_difference) && block.uniform_w;  // else masses may not have been set
    switch (terms) {
        case none_:
        case kept_rate:
            return boxed ? load_chunks<none_, true, true> : load_chunks<none_, true, false>;
        case rate:
            return boxed ? load_chunks<rate, true, true> : load_chunks<rate, true, false>;
        case forces:
            if (uniform) return boxed ? load_chunks<forces, true, true> : load_chunks<forces, true, false>;
            return boxed ? load_chunks<forces, false, true> : load_chunks<forces, false, false>;
        case both:
            if (block.unit_masses && !boxed) return load_chunks<both | unit_mass, true, false>;
            if (uniform) return boxed ? load_chunks<both, true, true> : load_chunks<both, true, false>;
            return boxed ? load_chunks<both, false, true> : load_chunks<both, false, false>;
        default:
            return nullptr;
    }
}

// Differences of a vector per atom, of whole chunks, and what rounding leaves off them.
template <bool extended, bool weigh = false>
static void subtract_chunks(const Packed &rows, long k0, long end, vec3 *out, vec3 *low,
                            const double *const *w3 = nullptr) {
    const RowsOfLanes at(rows);
    if (!extended && !weigh) {
        const long done = subtract_in_fours(at.first + 3 * k0, end - k0, out);
        k0 += done;
        out += done;
    }
    for (; k0 < end; k0 += W, out += W) {
        subtract_chunk<extended, weigh>(at, k0, out, low, w3);
        if (extended) low += W;
    }
}

// Atom k of all lanes; of one that ends before, its last one.
HOL_INLINE vec3 read_atom(const Block &block, const Packed &rows, long k) {
    const double *p[W];
    for (int i = 0; i < W; ++i) p[i] = rows.lane[i] + 3 * (k < block.len[i] ? k : block.len[i]);
    vec3 a;
    read_rows(p, a);
    return a;
}

// The same of any bonds. low: of bond vectors, or nullptr. `weigh`: of vectors times inverse masses, which have no low.
HOL_NOINLINE void subtract(const Block &block, const Packed &rows, bool weigh, long k0, long end, vec3 *out,
                           vec3 *low) {
    const long full = ((block.n_min < end ? block.n_min : end) - k0) / W * W;
    if (full > 0) {
        if (weigh)
            subtract_chunks<false, true>(rows, k0, k0 + full, out, nullptr, block.w3);
        else
            low ? subtract_chunks<true>(rows, k0, k0 + full, out, low)
                : subtract_chunks<false>(rows, k0, k0 + full, out, low);
        k0 += full;
        out += full;
        if (low) low += full;
    }
    if (k0 >= end) return;
    vec3 x = read_atom(block, rows, k0);
    if (weigh) x = block.w[k0] * x;
    for (long k = k0 + 1; k <= end; ++k, ++out) {
        vec3 x1 = read_atom(block, rows, k);
        if (weigh) x1 = block.w[k] * x1;
        *out = x1 - x;
        if (low)
            *low++ = {two_difference<vec>(x1.x, x.x).lo, two_difference<vec>(x1.y, x.y).lo,
                      two_difference<vec>(x1.z, x.z).lo};
        x = x1;
    }
}

// The velocities of the atoms behind bonds, and rates of these.
HOL_NOINLINE void load_rates(const Reader &in, long from, long end, const vec3 *D, vec *B, vec3 *velocities) {
    const Block &block = in.block;
    if (from == 0) velocities[0] = load_atom(*in.v);
    vec3 v = velocities[from];
    long k = from;
    const long n = end <= block.n_min && block.padded ? end : (end < block.n_min ? end : block.n_min) - W + 1;
    vec3 *x = velocities + from;
    const long done = load_rates_in_fours(in.v->lane[0] + 3 * from, end - from, D, B, x + 1);
    k += done;
    x += done;
    D += done;
    B += done;
    v = *x;
    for (; k < n; k += W, x += W, D += W, B += W) {
        const double *p[W];
        for (int i = 0; i < W; ++i) p[i] = in.v->lane[i] + 3 * (k + 1);
        if (__builtin_expect(in.ahead != 0, 0)) fetch_ahead(in.v->lane[0], k, in.ahead);
        vec3 behind[W];
        load_atoms(p, behind);
        HOL_UNROLL
        for (int b = 0; b < W; ++b) {
            x[b + 1] = behind[b];
            B[b] = rate_of(D[b], v, behind[b]);
            v = behind[b];
        }
    }
    for (; k < end; ++k, ++x, ++D, ++B) {
        const vec3 behind = read_atom(block, *in.v, k + 1);
        x[1] = behind;
        *B = keep(joint(block, k), rate_of(*D, v, behind));
        v = behind;
    }
}

static void add_strain(const Reader &in, long k0, long end, const vec3 *D, vec *B) {
    for (long k = k0; k < end; ++k, ++D, ++B) *B = *B + keep(joint(in.block, k), stretching(in.strain, *D));
}

// Bonds past the end of a lane become inert: n of them from k0 on.
static void make_inert(const Block &block, long k0, long n, vec3 *D, vec3 *low, vec *B) {
    const vec lengths = block.lengths();
    for (long k = block.n_min > k0 ? block.n_min - k0 : 0; k < n; ++k) {
        const mask live = less(splat(static_cast<double>(k0 + k)), lengths);
        D[k] = {select(live, D[k].x, splat(1.0)), keep(live, D[k].y), keep(live, D[k].z)};
        if (low) low[k] = {keep(live, low[k].x), keep(live, low[k].y), keep(live, low[k].z)};
        if (B) B[k] = keep(live, B[k]);
    }
}

// Bonds of any block and in any box, and where lanes end, in steps: at most stage_bonds.
HOL_NOINLINE void load_bonds(const Reader &in, long k0, long end, vec3 *D, vec3 *low, vec *B) {
    const Block &block = in.block;
    const long n = end - k0;
    const int terms = in.terms;
    subtract(block, *in.r, false, k0, end, D, low);
    vec3 unused = {};
    if (low && in.box.lattice != Box::none) {
        for (long k = 0; k < n; ++k) wrap<true>(in.box, D[k], low[k]);
    } else if (in.box.lattice != Box::none) {
        const Box box = in.box;  // by value: stores don't change it
        for (long k = 0; k < n; ++k) wrap<false>(box, D[k], unused);
    }
    if (terms & products) {
        vec3 dv[stage_bonds + W], df[stage_bonds + W];
        if (terms & of_velocities) subtract(block, *in.v, false, k0, end, dv, nullptr);
        if (terms & force_difference) subtract(block, *in.f, !block.uniform_w, k0, end, df, nullptr);
        for (long k = 0; k < n; ++k) B[k] = right_hand_side(terms, block.mass, D[k], dv[k], df[k]);
    } else if (B) {
        for (long k = 0; k < n; ++k) B[k] = vec{};
    }
    make_inert(block, k0, n, D, low, B);
}

// A chunk in which lanes end. Those that have ended before it read what another one has there, and if there are no
// others, no row is copied.
HOL_NOINLINE void load_last_chunk(const Reader &in, long k0, long end, vec3 *D, vec *B) {
    const Block &block = in.block;
    const bool has_v = in.terms & (velocity_squared | rate), has_f = in.terms & force_difference;
    int whole = -1;  // a lane that has the chunk
    bool copies = false;
    for (int i = 0; i < W; ++i) {
        if (block.len[i] >= k0 + W) whole = i;
        copies = copies || (block.len[i] > k0 && block.len[i] < k0 + W);
    }
    copies = copies || whole < 0;
    PaddedRows padded_r, padded_v, padded_f;
    Packed rows[3];
    const auto rows_of = [&](const Packed &from, PaddedRows &padded, Packed &row) {
        if (copies) return padded.take(block, from, k0);
        for (int i = 0; i < W; ++i) row.lane[i] = from.lane[block.len[i] > k0 ? i : whole];
        return static_cast<const Packed *>(&row);
    };
    Reader last = in;
    last.ahead = 0;
    last.r = rows_of(*in.r, padded_r, rows[0]);
    if (has_v) last.v = rows_of(*in.v, padded_v, rows[1]);
    if (has_f) last.f = rows_of(*in.f, padded_f, rows[2]);
    in.load_chunks(last, k0, k0 + W, D, B);
    make_inert(block, k0, end - k0, D, nullptr, B);
}

void Reader::load_any(long from, long end, vec3 *D, vec3 *low, vec *B, vec3 *velocities) const {
    if (lists) return load_listed(*this, from, end, D, B, velocities);
    long k = 0;
    if (load_chunks) {
        // Where more can be read behind the lanes, so are chunks that end behind them.
        const long all = block.n_min < end ? block.n_min : end;
        k = block.padded && all == end ? (end - from + W - 1) / W * W : (all > from ? (all - from) / W * W : 0);
        if (k > 0) load_chunks(*this, from, from + k, D, B);
        for (; from + k < end; k += W)
            load_last_chunk(*this, from + k, end < from + k + W ? end : from + k + W, D + k, B ? B + k : nullptr);
    }
    for (; from + k < end; k += stage_bonds) {
        const long last = from + k + stage_bonds < end ? from + k + stage_bonds : end;
        load_bonds(*this, from + k, last, D + k, low ? low + k : nullptr, B ? B + k : nullptr);
    }
    if (terms == kept_rate) load_rates(*this, from, end, D, B, velocities);
    if (strain) add_strain(*this, from, end, D, B);
}

Reader::Reader(const Block &of, const Box &in, int wanted, const Packed &pr, const Packed &pv, const Packed &pf,
               bool with_low)
    : block(of), box(in), terms(wanted), extended(with_low), ahead(of.ahead), r(&pr), v(&pv), f(&pf),
      load_chunks(chunks_of(of, in, wanted, with_low)) {}

Reader::Reader(const Block &of, const Box &in, int wanted, const AtomLists &at, const AtomArray &ar,
               const AtomArray &av, const AtomArray &af)
    : block(of), box(in), terms(wanted), ahead(0), lists(&at), of_r(base_of(ar)), of_v(base_of(av)), of_f(base_of(af)) {
}

void load_bond_vectors(const Block &block, const Box &box, const Packed &r, vec3 *D) {
    if (box.lattice == Box::none && block.n == block.n_min && (block.n % W == 0 || block.padded))
        return subtract_chunks<false>(r, 0, block.n, D, nullptr);
    Reader reader(block, box, none_, r, r, r);
    reader.ahead = 0;  // it is fetched later, while these are worked on
    reader.load(0, block.n, D, nullptr, nullptr);
}

}  // namespace holonomic::HOL_ISA
