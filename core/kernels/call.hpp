// What the core hands to a kernel: plain data, the same for every instruction set.
#pragma once

#include <stdint.h>

namespace holonomic {

// A vector per atom in the caller's memory; x == nullptr: absent, z == nullptr: two dimensions.
struct AtomArray {
    char *x, *y, *z;
    int64_t stride;  // bytes
    bool is_float;   // the caller's numbers are floats
    bool packed;     // doubles [n_atoms][3], the layout that the kernels read and write in place; of floats: a copy
};
// No member: each set of kernels must have its own.
static inline bool holds_floats(const AtomArray &array) { return array.is_float && !array.packed; }

// One chain as a kernel sees it.
struct Lane {
    int64_t n_bonds;
    int64_t first_atom;    // if atoms == nullptr: the chain's atoms are first_atom, first_atom + 1, ...
    const int64_t *atoms;  // [n_bonds+1] or nullptr
    const double *w;       // inverse masses along the chain [n_bonds+1], or nullptr: all w_uniform
    const double *length;  // bond lengths [n_bonds], or nullptr: all length_uniform
    double w_uniform;
    double length_uniform;
    int64_t first_bond;  // place of its first bond in arrays per bond
    int64_t chain;       // its number
    int64_t kind;        // chains of one kind have the same masses and lengths
    int64_t element[4];  // of chains of at most three bonds: where each atom's first component stands in packed arrays
};

// What core hands down at once: chains of at most longest_lane bonds, or a single longer one.
struct Unit {
    const Lane *lanes;
    int64_t count;
    bool regular;         // all `count` chains are like lanes[0], over consecutive atoms and bonds; else lanes[count],
                          // irregular
    bool large;           // the caller's arrays are unlikely to be in cache
    bool padded = false;  // as many atoms as there are lanes may be read behind the last chain
};

// One molecule that is no chain, as a kernel sees it. Its atoms and bonds are numbered as in its shape.
struct MoleculeLane {
    int64_t first_atom;              // if atoms == nullptr: its atoms are first_atom, first_atom + 1, ...
    const int64_t *atoms;            // [n_atoms] or nullptr
    const unsigned char *shared;     // [n_atoms] or nullptr: fixed atoms of other molecules too, whose G is not written
    const double *w, *length;        // [n_atoms], [n_bonds]
    int64_t first_bond;              // bond k stands at first_bond + k in arrays per bond
    int64_t molecule;                // its number
    const int64_t *bonds = nullptr;  // [n_bonds] where they stand instead: only of networks
};

struct TreeBatch;        // different trees side by side: core/molecules/planned/tree_batches.hpp
struct EliminationPlan;  // order of elimination of a shape: core/molecules/planned/elimination_plan.hpp

struct Tally;

// The threads that work on one long chain, or on one large molecule, as core lends them: run() calls body(context, j,
// scratch, part) for j = 0 .. n-1 on any of them, and adds the parts to the total in the order of j.
struct LongTeam {
    const void *threads;
    void (*run)(const void *threads, int64_t n, Tally &total,
                void (*body)(const void *context, int64_t j, double *scratch, Tally &part), const void *context);
};

// The same of other shapes: molecules of one shape; masses and lengths may differ among them. Or batches of trees,
// whose trees are the lanes, one after the other, none regular: for verbs that work on such, and `elimination` is that
// of the first.
struct MoleculeUnit {
    const EliminationPlan *elimination;
    const MoleculeLane *lanes;
    int64_t count;
    bool regular, large;             // as in Unit
    const LongTeam *team = nullptr;  // of a single large molecule
    const TreeBatch *tree_batches = nullptr;
    int64_t n_batches = 0;
    bool padded = false;  // as in Unit
};

// Chains of more bonds are cut into segments.
constexpr int64_t longest_lane = 256;

// More lanes than this no set has: vectors are read so far from tables, and need no larger alignment.
constexpr int most_lanes = 16;

struct Box {
    enum Lattice { none, orthorhombic, triclinic } lattice;
    double h[9];        // row i is box vector i
    double inverse[9];  // fractional coordinate i of d is sum_c d_c inverse[3 c + i]
    // orthorhombic: minus the sides and their inverses for components x y z x y z ..
    double minus_side[most_lanes + 2], per_side[most_lanes + 2];
};

// What a unit adds to the result of a call.
constexpr int64_t most_listed = 64;
struct Tally {
    double virial[6];  // xx xy xz yy yz zz of - sum t d (x) d
    int64_t n_bad;
    int64_t first_bad;  // smallest number of a bad chain
    int64_t *bad;       // numbers of the first most_listed of them, or nullptr
    // positions
    int64_t iterations, n_corrected, worst_chain, worst_bond;
    double worst;
    // metric: ln det Z~ and, of a long chain, ln det Z
    double log_det, log_det_z;
};

// Which units are ordinary: those in which no product of a kernel overflows or underflows, unless the numbers of one
// molecule differ by very much. Powers of two of the longest bond and of the lightest mass; metres and kilograms are
// -33 and -86.
constexpr int most_ordinary_length = 48, most_ordinary_mass = 92;
// Squares of bonds are no more than this then, and no less than one over it; kernels look whether they are.
constexpr double most_ordinary_square = 0x1p199;

// Calls are `rescaled` where their molecule has been put into ordinary units (core/run/rescale.hpp). Where it has not,
// a molecule whose units plain products can't do in is bad, and core puts it there.

struct ForcesCall {
    AtomArray r, v, f, g;
    double *lambda, *tension;
    bool add, virial;
    Box box;
    bool rescaled = false;
};

struct VelocitiesCall {
    AtomArray r, v;
    double *lambda;
    bool virial;
    const double *strain;  // of a box that changes, arithmetic/vector3.hpp; or nullptr
    Box box;
    bool rescaled = false;
};

struct PositionsCall {
    AtomArray r_ref, r, v;
    double *lambda;
    double dt;
    bool guess, virial, report;            // report: the errors left are wanted
    double tolerance;                      // 0: what the coordinates carry
    double worst_trial = __builtin_inf();  // a molecule that comes with a larger error |D.D - a^2| / a^2 is bad
    double far_trial = __builtin_inf();    // the same of one that is no linear chain, and no more
    int max_iterations;
    Box box, box_ref;  // of r; of r_ref
    bool rescaled = false;
    const double *flow = nullptr;  // L [9] of a box that changes
};

struct MetricCall {
    AtomArray r, force;
    double kT = 0;
    double *log_det = nullptr, *log_det_z = nullptr;  // per chain
    bool sum = false;                                 // the tally's log_det is needed
    bool add = false;
    Box box;
};

// Z lambda = rhs.
struct SolveCall {
    AtomArray r, g;
    const double *rhs;  // per bond
    double *lambda, *tension;
    bool add, virial;
    Box box;
    bool rescaled = false;
};

// Factors that are kept from one elimination for any number of solves, block by block of the molecules of a unit, known
// by its first molecule. Each solve goes through the same units, and so comes to the same blocks.
struct KeptFactors {
    void *owner;
    double *(*room)(void *owner, int64_t molecule, int64_t doubles);  // to be filled; nullptr: there is no memory
    const double *const *block;                                       // [n_molecules] or nullptr: that one is not kept
    AtomArray r;                                                      // what they were made of; packed
    const Box *box;
};

// Keeps them, and marks the molecules that it has not kept.
struct KeepCall {
    AtomArray r;  // packed
    KeptFactors *kept;
    unsigned char *left;  // [n_molecules]
    Box box;
};

// Solves with them: with given right-hand sides, or with those of velocities and forces. Marks the molecules of which
// nothing has been written: other ways are left to them. Those that are marked already are passed over.
struct KeptCall {
    AtomArray v, f, g;  // packed
    const double *rhs;
    double *lambda, *tension;
    bool add, virial;
    const KeptFactors *kept;
    unsigned char *left;
};

// extreme: flagged, and by the units in which the chain is.
enum JoinResult { join_good, join_flagged, join_extreme, join_bad };

// A chain of more than longest_lane bonds is worked on in blocks of segments, in phases; within a phase the blocks may
// be done in any order, by any thread. `store` keeps what passes from phase to phase.
template <class Call>
struct InSegments {
    int64_t (*blocks)(int64_t n_bonds);
    int64_t (*bytes)(int64_t n_bonds);  // of the store
    void (*eliminate)(const Call &, const Lane &, int64_t block, bool extended, double *store, double *scratch);
    JoinResult (*join)(const Lane &, int64_t blocks, bool extended, double *store);  // the first so many
    void (*finish)(const Call &, const Lane &, int64_t block, double *store, double *scratch, Tally &);
};

// Or in windows, which know nothing of each other. `solve` returns false, with nothing written, where these won't do:
// then the chain is a unit of one, as if it were short.
template <class Call>
struct InWindows {
    int64_t (*blocks)(int64_t n_bonds);  // as InSegments has: which chains are worth several threads
    int64_t (*bytes)(int64_t n_bonds);
    bool (*solve)(const Call &, const Lane &, const LongTeam &, double *store, Tally &);
};

// Molecules that are no linear chains. `scratch` has the largest scratch_bytes of the elimination plans and batches of
// trees, aligned to 64. A value that solve writes may stand where its right-hand side did.
struct MoleculeKernels {
    int64_t (*scratch_bytes)(const EliminationPlan &);
    int64_t (*batch_bytes)(const TreeBatch &);
    void (*forces)(const ForcesCall &, const MoleculeUnit &, double *scratch, Tally &);
    void (*velocities)(const VelocitiesCall &, const MoleculeUnit &, double *scratch, Tally &);
    void (*positions)(const PositionsCall &, const MoleculeUnit &, double *scratch, Tally &);
    void (*metric)(const MetricCall &, const MoleculeUnit &, double *scratch, Tally &);
    void (*solve)(const SolveCall &, const MoleculeUnit &, double *scratch, Tally &);
};

struct BodyKind;  // a kind of rigid body that stands alone: core/kernels/bodies/kind.hpp

// Bodies of a kind, most_in_unit at most. Behind the last one the first one stands again, up to a multiple of
// most_lanes.
constexpr int most_in_unit = 64;
struct BodyUnit {
    const BodyKind *kind;
    const int64_t *atoms[most_in_unit];
    int64_t first[most_in_unit];  // element of its first atom in packed arrays
    int count;
    bool consecutive;  // the atoms of each stand one behind the other
    bool large;        // they do, and the caller's arrays are unlikely to be in cache
};

// What a body adds to the result of a call.
struct BodyResult {
    double virial[6], error;
    int iterations;
};

// Each returns bit by bit which bodies it has done; nothing of the others has been written. `scratch` has
// bytes(n_atoms), aligned to 64.
struct BodyKernels {
    int64_t (*scratch_bytes)(int64_t n_atoms);
    uint64_t (*forces)(const ForcesCall &, const BodyUnit &, double *scratch, BodyResult *);
    uint64_t (*velocities)(const VelocitiesCall &, const BodyUnit &, double *scratch, BodyResult *);
    uint64_t (*positions)(const PositionsCall &, const BodyUnit &, double *scratch, BodyResult *);
};

// The tridiagonal matrix of n rows with ones on its diagonal and -gamma beside it, by plain products. Both return false
// where these cannot answer for the last digits, or an argument is not finite; then x is as it was, and what is in
// pivots means nothing.
struct TridiagonalKernels {
    bool (*solve)(int64_t n, const double *gamma, const double *b, double *x, double *scratch);  // scratch: [3 n]
    bool (*pivots)(int64_t n, const double *gamma, double *pivots);
};

// Chains that fit into lanes, and molecules in lanes: is_kept() says of which shapes. Others are not to be handed over.
struct KeptKernels {
    void (*keep_chains)(const KeepCall &, const Unit &, double *scratch, Tally &);
    void (*solve_chains)(const KeptCall &, const Unit &, double *scratch, Tally &);
    bool (*is_kept)(const EliminationPlan &);
    int64_t (*scratch_bytes)(const EliminationPlan &);  // beyond that of other verbs; or 0
    void (*keep_molecules)(const KeepCall &, const MoleculeUnit &, double *scratch, Tally &);
    void (*solve_molecules)(const KeptCall *, int n_calls, const MoleculeUnit &, double *scratch, Tally &);
};

// The kernels of one instruction set. `scratch` has scratch_bytes(bonds of the longest chain), aligned to 64; for long
// chains cut_bytes.
struct Kernels {
    const char *name;
    int lanes;
    bool fused;  // products and sums are rounded once
    int64_t (*scratch_bytes)(int64_t n_bonds);
    int64_t cut_bytes;
    void (*forces)(const ForcesCall &, const Unit &, double *scratch, Tally &);
    void (*velocities)(const VelocitiesCall &, const Unit &, double *scratch, Tally &);
    void (*positions)(const PositionsCall &, const Unit &, double *scratch, Tally &);
    void (*metric)(const MetricCall &, const Unit &, double *scratch, Tally &);
    InSegments<ForcesCall> long_forces;
    InSegments<VelocitiesCall> long_velocities;
    InWindows<PositionsCall> long_positions;
    InWindows<MetricCall> long_metric;
    MoleculeKernels molecules{};
    TridiagonalKernels tridiagonal{};
    BodyKernels bodies{};
    KeptKernels kept{};
};

}  // namespace holonomic
