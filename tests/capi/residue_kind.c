#include "residue_kind.h"

#include <stdlib.h>
#include <string.h>

const char *const residue_texts[RESIDUE_TEXTS] = {
    "NHCHHC(O)",                               /* glycine */
    "NHCH(CHHH)C(O)",                          /* alanine */
    "NHCH(CHHC1CHCHCHCHCH1)C(O)",              /* phenylalanine */
    "N1CH(CHHCHHCHH1)C(O)",                    /* proline */
    "NHCH(CHHC1NHCHNCH1)C(O)",                 /* histidine */
    "NHCH(CHHC1CHNHC2C1CHCHCHCH2)C(O)",        /* tryptophan */
    "NHCH(CHHCHHCHHCHHNHHH)C(O)",              /* lysine */
    "NHCH(CHHCH(CHHH)CHHH)C(O)",               /* leucine */
    "C1HCH(CHHOH)OCH(CH(OH)CH1OH)",            /* a sugar */
    "CHHCH(C1CHCHCHCHCH1)",                    /* styrene */
    "CHHCHHO",                                 /* ethylene oxide */
    "CHHCH(C(O)OCHHC(CHHH)(CHHH)CHHH)C1CHCH1", /* a triangle that hangs at the backbone's end */
};

double residue_mass(char element)
{
    return element == 'H' ? 1.008 : element == 'C' ? 12.011 : element == 'N' ? 14.007 : 15.999;
}

static int add_atom(residue_kind *k, char element, int parent, int depth)
{
    const int i = k->n_atoms++;
    if (i >= RESIDUE_ATOMS) abort();
    k->element[i] = element;
    k->parent[i] = parent;
    k->ring[i] = -1;
    k->backbone[i] = depth == 0 && element != 'H';
    return i;
}

/** The bonds of a ring, from its last atom up to its first. */
static void close_ring(residue_kind *k, int first, int last)
{
    const int ring = k->n_rings++;
    if (ring >= RESIDUE_RINGS) abort();
    k->closing[ring][0] = first, k->closing[ring][1] = last;
    k->size[ring] = 1;
    for (int i = last; i != first; i = k->parent[i], ++k->size[ring])
        if (k->ring[i] < 0) k->ring[i] = ring;
}

residue_kind residue_kind_of(const char *text)
{
    residue_kind k;
    int at = -1, depth = 0, before[RESIDUE_ATOMS], opened[10];
    memset(&k, 0, sizeof k);
    for (int d = 0; d < 10; ++d) opened[d] = -1;
    for (const char *c = text; *c; ++c) {
        const int digit = *c - '0';
        if (*c == '(') {
            before[depth++] = at;
        } else if (*c == ')') {
            at = before[--depth];
        } else if (digit < 0 || digit > 9) {
            const int i = add_atom(&k, *c, at, depth);
            if (*c != 'H') at = i;
        } else if (opened[digit] < 0) {
            opened[digit] = at;
        } else {
            close_ring(&k, opened[digit], at);
            opened[digit] = -1;
        }
    }
    k.exit = at;
    for (int i = 1; i < k.n_atoms; ++i) k.sides[k.parent[i]] += k.ring[i] < 0;
    ++k.sides[k.exit];
    return k;
}
