/**
 * @file residues.h
 * Large molecules of repeating units: residues of several kinds, each of consecutive atoms, with bonds from one to the
 * next (links) and between far ones (bridges).
 */
#ifndef TESTS_RESIDUES_H
#define TESTS_RESIDUES_H

#include <holonomic.h>
#include <stdint.h>

#include "molecule.h"

/** What each residue hangs at. */
typedef enum residue_order {
    RESIDUES_IN_LINE = 0,
    RESIDUES_AS_COMB, /**< every fourth residue goes on with the line, three hang at its side */
    RESIDUES_AS_STAR, /**< arms of ten at the first one */
    RESIDUES_AS_TREE  /**< at any earlier one */
} residue_order;

/** How atoms are numbered. */
typedef enum residue_numbers {
    NUMBERS_ALONG = 0,   /**< residue after residue, each after the one that it hangs at */
    NUMBERS_BACK,        /**< the last atom of the last residue first */
    NUMBERS_OF_RESIDUES, /**< residues in any order, each whole */
    NUMBERS_ANYHOW
} residue_numbers;

typedef enum residue_box { NO_BOX = 0, ORTHORHOMBIC_BOX, TRICLINIC_BOX } residue_box;

typedef struct residue_recipe {
    const char *name;
    int first_kind, n_kinds; /**< of residue_texts; 0: each residue is of a kind of its own */
    residue_order order;
    int bridges;        /**< bonds between far residues */
    int closed;         /**< one more from the last residue to the first */
    int caps;           /**< ends are kinds of their own */
    int fixed;          /**< atoms at ends that are held fixed, in as many residues */
    int fixed_backbone; /**< atoms of the backbone: they divide the molecule */
    double decades;     /**< masses go up and down by so many, the same in residues of a kind; < 0: in each atom */
    double bend;        /**< angles along the backbone; 0: those of a tetrahedron */
    double offset;      /**< how far from the origin it is */
    residue_box box;    /**< atoms are wrapped into it */
    int shuffled;       /**< bonds in any order, either atom first */
    residue_numbers numbers;
    int isotopes; /**< in one of so many residues the first atom has another mass than in others of the kind */
} residue_recipe;

enum {
    RANDOM_SEQUENCE,
    RINGED_HOMOPOLYMER,
    SHORT_HOMOPOLYMER,
    SUGARS,
    PROLINES,
    BRIDGES,
    CLOSED,
    COMB,
    STAR,
    TREE,
    OWN_KINDS,
    FIXED_ENDS,
    FIXED_BACKBONE,
    SHUFFLED,
    SCATTERED_ATOMS,
    BACKWARDS,
    ANY_ORDER,
    ISOTOPES,
    IN_BOX,
    IN_TRICLINIC_BOX,
    FAR_AWAY,
    HOSTILE_RESIDUES, /* from here on ill conditioned */
    UNEQUAL_KINDS = HOSTILE_RESIDUES,
    UNEQUAL_ATOMS,
    STRAIGHT,
    STRAIGHT_UNEQUAL,
    RESIDUE_RECIPES
};
extern const residue_recipe residue_recipes[RESIDUE_RECIPES];

typedef struct residues {
    molecule m;
    const residue_recipe *recipe;
    int64_t *residue; /**< [n_atoms] number of the residue of each atom */
    double box[9];
    hol_chains *chains;
    int64_t n_molecules; /**< 1, unless fixed atoms divide it */
} residues;

/** Of at least so many bonds. */
residues residues_make(const residue_recipe *recipe, int64_t n_bonds, uint64_t seed);
void residues_free(residues *s);

/** Its box, or NULL. */
const double *residues_box(const residues *s);

/** A handle with all of these bonds in one list; box: or NULL. */
hol_chains *residue_chains(const molecule *m, const double *box);

/** Bonds in another order, either atom first; `place` [n_bonds] gets where each was. */
void residues_shuffle(molecule *m, uint64_t seed, int64_t *place);

/** Whether a bond joins two residues. */
int residues_link(const residues *s, int64_t bond);

/** Velocities that obey the constraints. */
void residues_project(residues *s);

/** A step in which no bond's ends move by more than a part of its length. */
double residues_step(const residues *s, double part);

#endif
