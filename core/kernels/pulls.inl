// What the multipliers do: the virial, and the pulls G_i = t_{i+1} d_{i+1} - t_i d_i on the atoms.

namespace holonomic {
namespace HOL_ISA {

// - factor sum t d (x) d over the bonds of the lanes in `which`.
static inline void add_virial(long n, const vec3 *d, const vec *t, mask which, vec factor, Tally &tally) {
    vec s[6] = {};
    for (long k = 0; k < n; ++k) {
        const vec3 p = {t[k] * d[k].x, t[k] * d[k].y, t[k] * d[k].z};
        s[0] = mul_add(p.x, d[k].x, s[0]);
        s[1] = mul_add(p.x, d[k].y, s[1]);
        s[2] = mul_add(p.x, d[k].z, s[2]);
        s[3] = mul_add(p.y, d[k].y, s[3]);
        s[4] = mul_add(p.y, d[k].z, s[4]);
        s[5] = mul_add(p.z, d[k].z, s[5]);
    }
    for (int c = 0; c < 6; ++c) tally.virial[c] -= sum_lanes(keep(which, factor * s[c]));
}

// G_i = t_{i+1} d_{i+1} - t_i d_i of the atoms first .. n, where `before` is t d of the bond before atom `first`; times
// w_i where `weighted`.
template <bool weighted, bool uniform, Update update>
static inline void store_pulls_from(const Block &block, long first, vec3 before, const vec3 *d, const vec *t,
                                    mask which, const Packed &out) {
    const unsigned chosen = bits(which);
    const auto pull = [&](long k, const vec3 &after, vec *value) __attribute__((always_inline)) {
        vec3 g = {after.x - before.x, after.y - before.y, after.z - before.z};
        if (weighted) {
            const vec w = w_at<uniform>(block, k);
            g = {w * g.x, w * g.y, w * g.z};
        }
        value[0] = g.x;
        value[1] = g.y;
        value[2] = g.z;
        before = after;
    };
    long k0 = first;
    if (chosen == (1u << W) - 1)
        for (; k0 + W <= block.n_min; k0 += W) {
            vec value[3 * W];
            for (int a = 0; a < W; ++a) {
                const long k = k0 + a;
                pull(k, {t[k] * d[k].x, t[k] * d[k].y, t[k] * d[k].z}, value + 3 * a);
            }
            store_chunk<update>(k0, value, out);
        }
    for (; k0 <= block.n; k0 += W) {
        vec value[3 * W] = {};
        for (int a = 0; a < W; ++a) {
            const long k = k0 + a;
            if (k > block.n) break;
            vec3 after = {};
            if (k < block.n) after = {t[k] * d[k].x, t[k] * d[k].y, t[k] * d[k].z};
            pull(k, after, value + 3 * a);
        }
        store_ragged<update>(block, k0, value, chosen, out);
    }
}

static inline void store_pulls(const Block &block, const vec3 *d, const vec *t, mask which, Update update,
                               const Packed &out) {
    if (update == add_)
        store_pulls_from<false, true, add_>(block, 0, vec3{}, d, t, which, out);
    else
        store_pulls_from<false, true, write_>(block, 0, vec3{}, d, t, which, out);
}

HOL_INLINE vec3 difference(const vec3 &a, const vec3 &b) { return {b.x - a.x, b.y - a.y, b.z - a.z}; }
HOL_INLINE vec3 scaled_bond(const vec3 &d, vec t) { return {t * d.x, t * d.y, t * d.z}; }

// The backward sweep, and what it gives written at once: G (see store_pulls_from) to `out`, and factor t to
// value_out[bond]; either may be absent. For blocks in which all lanes are used and good, and can't overflow (calm()).
template <Update update>
static __attribute__((noinline)) void substitute_and_store(const Block &block, const System &s, const Packed &out,
                                                           double *value_out, vec factor) {
    const long full = block.n_min / W * W;
    vec t = {};
    vec3 after = {};  // t d of the bond behind
    if (full < block.n) {
        backward(full, block.n, s.t, s.L);
        t = s.t[full];
        after = scaled_bond(s.D[full], t);
    } else {
        s.L[block.n] = vec{};
    }
    // Bonds full .. n-1 and the atoms behind them.
    for (long k0 = full + 1; out.lane[0] && k0 <= block.n; k0 += W) {
        vec value[3 * W] = {};
        for (long a = 0; a < W && k0 + a <= block.n; ++a) {
            const long k = k0 + a;
            const vec3 left = scaled_bond(s.D[k - 1], s.t[k - 1]);
            const vec3 right = k < block.n ? scaled_bond(s.D[k], s.t[k]) : vec3{};
            value[3 * a] = right.x - left.x;
            value[3 * a + 1] = right.y - left.y;
            value[3 * a + 2] = right.z - left.z;
        }
        store_ragged<update>(block, k0, value, (1u << W) - 1, out);
    }
    if (value_out)
        for (int i = 0; i < W; ++i)
            for (long k = full; k < block.len[i]; ++k)
                value_out[block.first_bond[i] + k] = mul_add(factor[i], s.t[k][i], 0.0);
    for (long k0 = full - W; k0 >= 0; k0 -= W) {
        vec value[3 * W], bond_value[W];
        HOL_UNROLL
        for (long b = W - 1; b >= 0; --b) {
            const long k = k0 + b;
            t = mul_add(s.L[k + 1], t, s.t[k]);
            bond_value[b] = mul_add(factor, t, vec{});  // zeros as +0
            const vec3 p = scaled_bond(s.D[k], t);
            value[3 * b] = after.x - p.x;
            value[3 * b + 1] = after.y - p.y;
            value[3 * b + 2] = after.z - p.z;
            after = p;
        }
        if (out.lane[0]) {
            if (update == write_ && block.ahead) fetch_ahead(out.lane[0], k0, block.ahead);
            store_chunk<update>(k0 + 1, value, out);
        }
        if (value_out) {
            transpose(bond_value);
            for (int i = 0; i < W; ++i) store(value_out + block.first_bond[i] + k0, bond_value[i]);
        }
    }
    if (!out.lane[0]) return;
    for (int i = 0; i < W; ++i) {
        double *const p = out.lane[i];
        p[0] = update == add_ ? p[0] + after.x[i] : after.x[i];
        p[1] = update == add_ ? p[1] + after.y[i] : after.y[i];
        p[2] = update == add_ ? p[2] + after.z[i] : after.z[i];
    }
}

}  // namespace HOL_ISA
}  // namespace holonomic
