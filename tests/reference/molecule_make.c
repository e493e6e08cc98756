#include "molecule_shapes.h"

const char *molecule_kind_name(molecule_kind kind)
{
    static const char *const names[MOLECULE_KINDS] = {
        "chain",
        "water",
        "xh2",
        "xh3",
        "methane",
        "neopentane",
        "alkane",
        "comb",
        "comb near straight 1e-6",
        "dendrimer",
        "star",
        "tree",
        "fixed atoms",
        "light joints 1e-9",
        "taut 1e-6",
        "coplanar star 1e-8",
        "ring",
        "ring collapsed 1e-3",
        "benzene",
        "benzene angles puckered",
        "triangles",
        "triangles zigzag",
        "triangles 179.9",
        "bent 179.9",
        "fused rings",
        "cube",
        "lariat light tail",
        "peptide",
        "refused ten distances",
        "refused linear",
        "refused planar square",
        "refused taut exactly",
        "cubane",
        "naphthalene",
    };
    return names[kind];
}

/** A comb with fixed atoms: an end, two neighbours in the middle, a side atom. */
static void make_fixed_atoms(molecule *m, random_stream *s, int64_t size)
{
    molecule all = molecule_empty();
    make_comb(&all, s, size, -1, 0);
    const int64_t middle = size / 2 * 2, fixed[4] = {0, middle, middle + 2, all.n_atoms - 1};
    for (int64_t i = 0; i < all.n_atoms; ++i) {
        int is_fixed = 0;
        for (int x = 0; x < 4; ++x) is_fixed = is_fixed || i == fixed[x];
        molecule_add_atom(m, is_fixed ? 0 : all.mass[i], all.r + 3 * i);
    }
    for (int64_t k = 0; k < all.n_bonds; ++k) molecule_add_bond(m, all.pairs[2 * k], all.pairs[2 * k + 1]);
    molecule_free(&all);
}

static void make_tree_kind(molecule *m, random_stream *s, molecule_kind kind, int64_t size)
{
    switch (kind) {
        case MOLECULE_CHAIN:
            make_tree(m, s, size, 2);
            return;
        case MOLECULE_XH2:
            make_xhn(m, s, 2);
            return;
        case MOLECULE_XH3:
            make_xhn(m, s, 3);
            return;
        case MOLECULE_XH4:
            make_xhn(m, s, 4);
            return;
        case MOLECULE_NEOPENTANE:
            make_neopentane(m, s);
            return;
        case MOLECULE_ALKANE:
            make_alkane(m, s, size);
            return;
        case MOLECULE_COMB:
            make_comb(m, s, size, -1, 0);
            return;
        case MOLECULE_NEARLY_STRAIGHT_COMB:
            make_comb(m, s, size, 1e-6, 0);
            return;
        case MOLECULE_DENDRIMER:
            make_dendrimer(m, s, size);
            return;
        case MOLECULE_STAR:
            make_star(m, s, size);
            return;
        case MOLECULE_TREE:
            make_tree(m, s, size, 6);
            return;
        case MOLECULE_FIXED_ATOMS:
            make_fixed_atoms(m, s, size);
            return;
        case MOLECULE_LIGHT_JOINTS:
            make_comb(m, s, size, -1, 1e-9);
            return;
        case MOLECULE_TAUT:
            make_taut(m, s, size, 1e-6);
            return;
        default:
            make_coplanar_star(m, s);
    }
}

static void make_cyclic_kind(molecule *m, random_stream *s, molecule_kind kind, int64_t size)
{
    switch (kind) {
        case MOLECULE_WATER:
            make_triangle(m, s, 0.9572, 104.52, 15.999, 1.008);
            return;
        case MOLECULE_RING:
            make_ring(m, s, size, 1);
            return;
        case MOLECULE_COLLAPSED_RING:
            make_ring(m, s, size, 1e-3);
            return;
        case MOLECULE_BENZENE:
            make_benzene(m, s, 0, 0);
            return;
        case MOLECULE_PUCKERED_BENZENE:
            make_benzene(m, s, 0.02, 1);
            return;
        case MOLECULE_TRIANGLES:
            make_triangles(m, s, size, 70, 150, 0);
            return;
        case MOLECULE_ZIGZAG:
            make_triangles(m, s, size, 109.5, 109.5, 1);
            return;
        case MOLECULE_TRIANGLES_179:
            make_triangles(m, s, size, 179.9, 179.9, 0);
            return;
        case MOLECULE_BENT:
            make_triangle(m, s, 1.16, 179.9, 12.011, 15.999);
            return;
        case MOLECULE_FUSED_RINGS:
            make_fused_rings(m, s, size);
            return;
        case MOLECULE_CUBE:
            make_cube(m, s);
            return;
        case MOLECULE_LARIAT:
            make_lariat(m, s, size);
            return;
        case MOLECULE_PEPTIDE:
            make_peptide(m, s, size);
            return;
        case MOLECULE_CUBANE:
            make_cubane(m);
            return;
        case MOLECULE_NAPHTHALENE:
            make_naphthalene(m);
            return;
        case MOLECULE_TEN_DISTANCES:
            make_ten_distances(m, s);
            return;
        case MOLECULE_PLANAR_SQUARE:
            make_planar_square(m);
            return;
        default:
            make_taut(m, s, size, 0);
    }
}

/** Three atoms along x with all three distances. */
static molecule make_linear(void)
{
    molecule m = molecule_empty();
    for (int i = 0; i < 3; ++i) {
        const double r[3] = {1.16 * (i - 1), 0, 0};
        molecule_add_atom(&m, i == 1 ? 12.011 : 15.999, r);
    }
    molecule_add_bond(&m, 0, 1);
    molecule_add_bond(&m, 1, 2);
    molecule_add_bond(&m, 0, 2);
    return m;
}

molecule molecule_make(molecule_kind kind, int64_t size, uint64_t seed)
{
    random_stream s = random_seed(seed * 64 + (uint64_t)kind);
    molecule m = kind == MOLECULE_LINEAR ? make_linear() : molecule_empty();
    const int tree = kind != MOLECULE_WATER && kind < MOLECULE_RING;
    if (tree)
        make_tree_kind(&m, &s, kind, size);
    else if (kind != MOLECULE_LINEAR)
        make_cyclic_kind(&m, &s, kind, size);
    molecule_finish(&m, &s);
    return m;
}
