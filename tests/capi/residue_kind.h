/**
 * @file residue_kind.h
 * Kinds of residues, read from a line of text as in SMILES with all hydrogens: parentheses for branches, digits where a
 * ring opens and closes, H always an end. The last atom outside of parentheses is bonded to the residue that follows.
 */
#ifndef TESTS_RESIDUE_KIND_H
#define TESTS_RESIDUE_KIND_H

enum { RESIDUE_ATOMS = 96, RESIDUE_RINGS = 10 };

/** Atoms come after their parents; the parent of the first, -1, is in another residue. */
typedef struct residue_kind {
    int n_atoms, exit;
    char element[RESIDUE_ATOMS];
    int parent[RESIDUE_ATOMS];
    int backbone[RESIDUE_ATOMS]; /**< whether it is on the way through the residue */
    int ring[RESIDUE_ATOMS];     /**< the ring that the bond to its parent belongs to, or -1 */
    int sides[RESIDUE_ATOMS];    /**< how many bonds lead away from it that are of no ring, the link with them */
    int n_rings, size[RESIDUE_RINGS], closing[RESIDUE_RINGS][2]; /**< the first and the last atom of each ring */
} residue_kind;

residue_kind residue_kind_of(const char *text);

/** Twelve kinds: amino acids, a sugar, monomers, among them rings through the backbone and fused rings. */
extern const char *const residue_texts[];
enum { RESIDUE_TEXTS = 12 };

double residue_mass(char element);

#endif
