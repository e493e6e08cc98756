// Blocks of W small molecules of N bonds each. The arithmetic is that of any block, but the compiler knows the number
// of bonds and keeps everything in registers. Here is where the molecules stand in the arrays of a call, how they are
// read and written, their masses, and which kernel gets them. The kernels are those of verbs/*.cpp that end in
// _of_molecules. They leave to the general path what needs more than plain arithmetic, and the last molecules of a
// unit, behind which nothing may be read.
#pragma once

#include "core/kernels/arithmetic/image.hpp"
#include "core/kernels/isa/choose.hpp"
#include "core/kernels/memory/atom_rows.hpp"
#include "core/kernels/memory/columns.hpp"
#include "core/kernels/memory/load.hpp"
#include "core/kernels/memory/outputs.hpp"

namespace holonomic::HOL_ISA {

// Over consecutive atoms, without a box; else largest_boxed_molecule.
constexpr int largest_molecule = 5;

// A view: the W molecules of a unit from molecule `first` on. What all have:
//   end(unit, first)   the end of those that may be done from `first` on
//   next(first, end)   how many of these are the next block; 0: none is left
//   atom(base, i, k)   atom k of lane i in a packed array
//   bond_of, chain_of  first bond and number of lane i's molecule
//   array(of_call)     what atoms are read from: the base of a packed array, or columns
//   source(array, box) where it is, for what is rare
// in_row: rows of molecules follow each other in packed arrays. alike: all have the masses of the unit's first one, and
// one's atoms stand behind the other's. irregular: each has its own.

// One behind the other in a regular unit.
template <int N>
struct Consecutive {
    static constexpr int bonds = N;
    int64_t bond, chain;  // of the first one
    Consecutive(const Unit &unit, int64_t first)
        : bond(unit.lanes[0].first_bond + N * first), chain(unit.lanes[0].chain + first) {}
    HOL_STATIC int64_t next(int64_t first, int64_t end) { return end - first >= W ? W : 0; }
    HOL_FORCED int64_t bond_of(int i) const { return bond + N * i; }
    HOL_FORCED int64_t chain_of(int i) const { return chain + i; }
};

// In packed arrays.
template <int N>
struct InRow : Consecutive<N> {
    static constexpr bool packed = true, in_row = true, alike = true, irregular = false;
    static constexpr int elements = 3 * (N + 1);
    typedef EvenLanes<elements> Lanes;
    int64_t at;  // the first one
    InRow(const Unit &unit, int64_t first, int64_t)
        : Consecutive<N>(unit, first), at(3 * (unit.lanes[0].first_atom + (N + 1) * first)) {}
    HOL_STATIC double *array(const AtomArray &a) { return base_of(a); }
    HOL_FORCED Lanes lanes_of(double *base) const { return {base + at}; }
    // W atoms behind them can be read.
    HOL_STATIC int64_t end(const Unit &unit, int64_t) {
        return unit.count - (W == 1 || unit.padded ? 0 : (W + N) / (N + 1));
    }
    HOL_FORCED const double *atom(const double *base, int i, long k) const { return base + at + 3 * ((N + 1) * i + k); }
    HOL_FORCED Source source(const double *base, const Box &box) const {
        return {&box, nullptr, base + at, nullptr, nullptr, N + 1};
    }
    HOL_FORCED void fetch_next(const double *) const {}  // the processor does that
};

// In a regular unit, with lists of atoms. Where those of single bonds stand is found once for all arrays; of more atoms
// it would take the registers.
template <int N>
struct ByList : InRow<N>, AtomLists {
    static constexpr bool in_row = false, alike = false;
    static constexpr bool finds_once = N == 1;
    const bool fetches;  // whether atoms behind these may be fetched, and are worth it
    int64_t element[W][2];
    ByList(const Unit &unit, int64_t first, int64_t used)
        : InRow<N>(unit, first, used), AtomLists(unit.lanes[0].atoms + (N + 1) * first, N + 1),
          fetches(unit.large && unit.count - first >= 2 * W) {
        HOL_UNROLL
        for (int i = 0; finds_once && i < W; ++i)
            for (int k = 0; k < 2; ++k) element[i][k] = 3 * atoms[i][k];
    }
    HOL_STATIC int64_t end(const Unit &unit, int64_t) { return unit.count; }
    HOL_FORCED const double *atom(const double *base, int i, long k) const {
        return finds_once ? base + element[i][k] : AtomLists::atom(base, i, k);
    }
    HOL_FORCED Source source(const double *base, const Box &box) const { return {&box, nullptr, base, atoms}; }
    HOL_FORCED void fetch_next(const double *base) const {
        for (int i = 0; fetches && base && i < W; ++i)
            for (int k = 0; k <= N; ++k) __builtin_prefetch(base + 3 * atoms[i][W * (N + 1) + k], 0, 2);
    }
};

// Anywhere, each of a kind of its own: the `used` molecules of a unit that is not regular. Lanes that are left over
// repeat the first molecule, and write the same as its lane.
template <int N>
struct ByLanes {
    static constexpr int bonds = N;
    static constexpr bool packed = true, in_row = false, alike = false, irregular = true;
    const Lane *lane;
    HOL_STATIC double *array(const AtomArray &a) { return base_of(a); }
    ByLanes(const Unit &unit, int64_t first, int64_t used) : lane(unit.lanes + first) {
        if (__builtin_expect(used == W, 1)) return;
        for (int i = 0; i < W; ++i) last_[i] = lane[i < used ? i : 0];
        lane = last_;
    }
    ByLanes &operator=(const ByLanes &) = delete;
    HOL_STATIC int64_t end(const Unit &unit, int64_t first) {
        while (first < unit.count && unit.lanes[first].n_bonds == N) ++first;
        return first;
    }
    HOL_STATIC int64_t next(int64_t first, int64_t end) { return end - first >= W ? W : end - first; }
    HOL_FORCED const double *atom(const double *base, int i, long k) const { return base + lane[i].element[k]; }
    HOL_FORCED int64_t bond_of(int i) const { return lane[i].first_bond; }
    HOL_FORCED int64_t chain_of(int i) const { return lane[i].chain; }
    HOL_FORCED Source source(const double *base, const Box &box) const { return {&box, nullptr, base, nullptr, lane}; }
    HOL_FORCED void fetch_next(const double *) const {}

private:
    Lane last_[W];
};

// In columns.
template <int N>
struct InColumns : Consecutive<N> {
    static constexpr bool packed = false, in_row = false, alike = true, irregular = false;
    int64_t at;  // the first one
    InColumns(const Unit &unit, int64_t first, int64_t)
        : Consecutive<N>(unit, first), at(unit.lanes[0].first_atom + (N + 1) * first) {}
    HOL_STATIC Columns array(const AtomArray &a) { return Columns(a); }
    HOL_STATIC int64_t end(const Unit &unit, int64_t) { return unit.count; }
    // As Source.
    struct At {
        const Box *box;
        Columns columns;
        int64_t at;
        static constexpr const long *len = nullptr;
        struct Atom {
            double x[3];
            operator const double *() const { return x; }
        };
        Atom atom(int lane, long k) const {
            const int64_t i = at + (N + 1) * lane + k;
            return {{columns.component[0][i], columns.component[1][i], columns.component[2][i]}};
        }
    };
    HOL_FORCED At source(const Columns &columns, const Box &box) const { return {&box, columns, at}; }
    HOL_FORCED void fetch_next(const Columns &) const {}
};

// Vectors of n values of each lane, rounded up to what is transposed at a time.
template <int n>
constexpr int whole = (n + W - 1) / W *W;
template <int N>
constexpr int vectors_of = whole<3 * (N + 1)>;  // of the atoms of W molecules

// The atoms of a view: element 3 k + c is component c of atom k. In a row, up to W - 1 doubles behind are read.
template <class View>
HOL_INLINE void load_molecules(const View &view, const double *base, vec *elements) {
    constexpr int N = View::bonds;
    if constexpr (View::in_row) {
        HOL_UNROLL
        for (int j = 0; j < vectors_of<N> / W; ++j) {
            HOL_UNROLL
            for (int i = 0; i < W; ++i) elements[j * W + i] = load(view.atom(base, i, 0) + j * W);
            transpose(elements + j * W);
        }
    } else {
        HOL_UNROLL
        for (int k = 0; k <= N; ++k) {
            const vec3 a = gather(base, view, k);
            elements[3 * k] = a.x;
            elements[3 * k + 1] = a.y;
            elements[3 * k + 2] = a.z;
        }
    }
}

template <class View>
HOL_INLINE void load_molecules(const View &view, const Columns &columns, vec *elements) {
    read_columns<View::bonds + 1>(columns, view.at, reinterpret_cast<vec3 *>(elements));
}

// Gives a sink n values of each lane, transposed in place.
template <int n, class Sink>
HOL_INLINE void store_rows(vec *value, const Sink &sink) {
    constexpr int full = n / W, rest = n % W;
    HOL_UNROLL
    for (int j = 0; j < whole<n> / W; ++j) transpose(value + j * W);
    HOL_UNROLL
    for (int i = 0; i < W; ++i) {  // in the order of the addresses: faster from memory
        HOL_UNROLL
        for (int j = 0; j < full; ++j) sink.put(i, j * W, value[j * W + i]);
        if constexpr (rest > 1) {
            const vec last = value[full * W + i];
            HOL_UNROLL
            for (int e = 0; e + 1 < rest; e += 2) sink.put(i, full * W + e, double2{last[e], last[e + 1]});
        }
        if constexpr (rest % 2 > 0) sink.put(i, n - 1, value[full * W + i][rest - 1]);
    }
}

// Writes the atoms of a view, or adds to them.
template <Update update, class View>
HOL_INLINE void store_molecules(const View &view, vec *value, double *base) {
    if constexpr (View::in_row) {
        store_rows<View::elements>(value, AtomSink<update, typename View::Lanes>{view.lanes_of(base)});
    } else {
        HOL_UNROLL
        for (int k = 0; k <= View::bonds; ++k)
            scatter<update>(base, view, k, vec3{value[3 * k], value[3 * k + 1], value[3 * k + 2]});
    }
}

template <Update update, class View>
HOL_INLINE void store_molecules(const View &view, vec *value, const Columns &columns) {
    constexpr int n = View::bonds + 1;
    if (update == add_) {
        vec before[3 * n];
        load_molecules(view, columns, before);
        HOL_UNROLL
        for (int e = 0; e < 3 * n; ++e) value[e] = before[e] + value[e];
    }
    write_columns<n>(columns, view.at, reinterpret_cast<vec3 *>(value));
}

// Writes factor times a value per bond; zeros as +0.
template <class View>
HOL_INLINE void store_multipliers(const View &view, const vec *t, vec factor, double *base) {
    constexpr int N = View::bonds;
    vec value[whole<N>] = {};
    HOL_UNROLL
    for (int k = 0; k < N; ++k) value[k] = mul_add(factor, t[k], vec{});
    if constexpr (View::irregular) {
        HOL_UNROLL
        for (int k = 0; k < N; ++k)
            for (int i = 0; i < W; ++i) base[view.bond_of(i) + k] = value[k][i];
    } else if constexpr (N == 1) {
        store(base + view.bond, value[0]);
    } else {
        store_rows<N>(value, AtomSink<write_, EvenLanes<N>>{base + view.bond});
    }
}

// Kernels of the shortest chains are compiled once for calls that ask for a virial, and once for those that don't: a
// look at the call would take 1.02 to 1.04 times as long where nobody asks. kernel(a constant) is called with true for
// the first of these.
constexpr int fewest_with_virial = 3;
template <class View, bool boxed, class Kernel>
HOL_INLINE int64_t with_virial_or_not(bool virial, const Kernel &kernel) {
    if constexpr (View::bonds < fewest_with_virial)
        if (__builtin_expect(virial, 0)) return kernel(Constant<bool, true>{}, Constant<bool, true>{});
    return kernel(Constant<bool, false>{}, Constant<bool, boxed>{});
}

// Counts factor times the virial of the bonds of `used` molecules, as add_virial() does. They are copied, so that they
// stay in registers where nobody asks for it.
template <int N>
HOL_NOINLINE void add_virial_of(const vec3 (&d)[N], const vec (&t)[N], int64_t used, vec factor, Tally &tally) {
    VirialSum sum;
    for (int k = 0; k < N; ++k) sum.add(d[k], t[k] * d[k]);
    sum.count(first_lanes(static_cast<int>(used)), factor, tally);
}
template <int N>
HOL_INLINE void count_virial(const vec3 *d, const vec *t, int64_t used, vec factor, Tally &tally) {
    vec3 bonds[N];
    vec values[N];
    HOL_UNROLL
    for (int k = 0; k < N; ++k) {
        bonds[k] = d[k];
        values[k] = t[k];
    }
    add_virial_of<N>(bonds, values, used, factor, tally);
}

// Minimum images of the bonds of a view. In a triclinic box that is compiled into the kernels of molecules in a row
// alone: in the others it would take the registers of what is common.
template <class View>
HOL_INLINE void take_images(const Box &box, vec3 *D) {
    constexpr int N = View::bonds;
    if (box.lattice == Box::none) return;
    if (__builtin_expect(box.lattice == Box::triclinic, 0)) {
        vec3 unused = {};
        HOL_UNROLL
        for (int k = 0; k < N; ++k) {
            if constexpr (View::in_row)
                wrap<false>(box, D[k], unused);
            else
                D[k] = triclinic_image(box, D[k]);
        }
        return;
    }
    vec *const d = &D[0].x;
    HOL_UNROLL
    for (int c = 0; c < 3 * N; ++c)
        d[c] = mul_add(round(d[c] * box.per_side[c % 3]), splat(box.minus_side[c % 3]), d[c]);
}

// The bonds of a view. `boxed`: there may be a box. In a row they are differences of numbers as they stand in memory,
// if that transposes fewer vectors and nobody needs the atoms; elsewhere the atoms are read first.
template <bool boxed, bool with_atoms, class View, class Array>
HOL_INLINE void load_bonds(const Box &box, const View &view, const Array &array, vec *atoms, vec3 *D) {
    constexpr int N = View::bonds;
    if constexpr (View::in_row && !with_atoms && whole<3 * N> < vectors_of<N>) {
        vec d[whole<3 * N>];
        HOL_UNROLL
        for (int j = 0; j < whole<3 * N> / W; ++j) {
            HOL_UNROLL
            for (int i = 0; i < W; ++i) {
                const double *const p = view.atom(array, i, 0) + j * W;
                d[j * W + i] = load(p + 3) - load(p);
            }
            transpose(d + j * W);
        }
        HOL_UNROLL
        for (int k = 0; k < N; ++k) D[k] = {d[3 * k], d[3 * k + 1], d[3 * k + 2]};
    } else {
        load_molecules(view, array, atoms);
        vec *const d = &D[0].x;
        HOL_UNROLL
        for (int c = 0; c < 3 * N; ++c) d[c] = atoms[c + 3] - atoms[c];
    }
    if (boxed) take_images<View>(box, D);
}

// The masses of blocks. Those in a row are the given ones; lists have them in any case as a table, so that there is one
// kernel for equal and unequal ones. Where each lane is of a kind of its own, `own` holds also the other members of a
// block that the kernels ask for.
template <class View>
struct BlockMasses {
    static constexpr int N = View::bonds;
    Block own;
    const Block &block;
    vec w[N + 1] = {};
    int64_t kind[W];
    explicit BlockMasses(const Block &given) : block(View::alike ? given : own) {
        if (View::alike) return;
        if (!View::irregular) {
            own = given;
            for (int k = 0; k <= N; ++k) w[k] = given.uniform_w ? splat(1.0) : given.w[k];
            own.w = w;
            own.uniform_w = false;
            return;
        }
        own.n = own.n_min = N;
        for (int i = 0; i < W; ++i) {
            own.len[i] = N;
            kind[i] = -1;
        }
        own.lanes = W;
        own.unit = vec{};
        own.uniform_w = own.unit_masses = false;
        own.movable = first_lanes(W);
        own.w = w;
    }
    BlockMasses(const BlockMasses &) = delete;
    BlockMasses &operator=(const BlockMasses &) = delete;

    // Returns whether the masses are others than before.
    HOL_FORCED bool take(const View &view) {
        if constexpr (View::irregular) {
            const Lane *const lane = view.lane;
            bool same = true;
            for (int i = 0; i < W; ++i) same = same & (kind[i] == lane[i].kind);
            if (__builtin_expect(same, 1)) return false;
            for (int i = 0; i < W; ++i) {
                kind[i] = lane[i].kind;
                own.unit[i] = unit_of(lane[i]);
                for (int k = 0; k <= N; ++k) w[k][i] = relative_w(lane[i], k);
            }
            own.mass = splat(1.0) / own.unit;
            return true;
        }
        return false;
    }
};

// Calls kernel(view, uniform, boxed) for the molecules from `first` on, where view.type is one of memory/small.hpp.
// The kernel returns the first molecule that is not done. `uniform`: not of irregular lanes, with equal masses, and
// `one_length`. `boxed`: there is a box, or, of molecules that are not in a row or come alone, there may be one. Units
// that are not regular need no block: molecules with as many bonds as the first one are done.
template <class Kernel>
static inline int64_t any_molecules(const Unit &unit, const Block &block, int64_t first, bool boxed, bool one_length,
                                    const Kernel &kernel) {
    if constexpr (small_set) return first;
    constexpr Constant<bool, true> yes{};
    constexpr Constant<bool, false> no{};
    const Lane &head = unit.lanes[unit.regular ? 0 : first];
    const bool in_row = unit.regular && !head.atoms;
    if (head.n_bonds > (boxed || !in_row ? largest_boxed_molecule : largest_molecule)) return first;
    if (!unit.regular) {
        if constexpr (W == 1)  // a chain that comes alone is regular
            return first;
        else
            return choose_number<1, largest_boxed_molecule>(
                head.n_bonds, [&](auto n) { return kernel(Type<ByLanes<n>>{}, no, yes); });
    }
    const bool uniform = block.uniform_w && one_length;
    if (!in_row)
        return choose_number<1, largest_boxed_molecule>(head.n_bonds, [&](auto n) {
            if constexpr (W > 1)
                if (uniform) return kernel(Type<ByList<n>>{}, yes, yes);
            return kernel(Type<ByList<n>>{}, no, yes);
        });
    return choose_number<1, largest_molecule>(head.n_bonds, [&](auto constant) {
        constexpr int n = decltype(constant)::value;  // gcc 9 does not take it from within the next function
        return choose(
            [&](auto equal) {
                if constexpr (n <= largest_boxed_molecule)
                    if (boxed || W == 1) return kernel(Type<InRow<n>>{}, equal, yes);
                return kernel(Type<InRow<n>>{}, equal, no);
            },
            uniform);
    });
}

// Whether chains of a unit may be read from columns. At most `most` bonds.
template <int most = largest_molecule>
HOL_INLINE bool fit_columns(const Unit &unit, bool boxed) {
    const Lane &head = unit.lanes[0];
    constexpr int most_boxed = most < largest_boxed_molecule ? most : largest_boxed_molecule;
    return !small_set && W > 1 && unit.regular && !head.atoms && head.n_bonds <= (boxed ? most_boxed : most);
}

// The same for arrays of columns. `boxed`: there may be a box.
template <int most = largest_molecule, class Kernel>
static inline int64_t molecules_in_columns(const Unit &unit, const Block &block, int64_t first, bool boxed,
                                           bool one_length, const Kernel &kernel) {
    if constexpr (small_set || W == 1) {
        return first;
    } else {
        if (!fit_columns<most>(unit, boxed)) return first;
        return choose_number<1, most>(unit.lanes[0].n_bonds, [&](auto constant) {
            constexpr int n = decltype(constant)::value;
            return choose(
                [&](auto equal) {
                    return kernel(Type<InColumns<n>>{}, equal, Constant<bool, n <= largest_boxed_molecule>{});
                },
                block.uniform_w && one_length);
        });
    }
}

}  // namespace holonomic::HOL_ISA
