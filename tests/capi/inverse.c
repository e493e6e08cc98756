#include "inverse.h"

#include "check.h"

hol_chains *handle_of(const chain *c)
{
    hol_chains *chains;
    CHECK(hol_chains_create(c->n_bonds + 1, c->mass, &chains));
    CHECK(hol_chains_add_block(chains, 1, c->n_bonds, 0, c->length));
    return chains;
}

hol_inverse *inverse_of(const chain *c)
{
    hol_chains *chains = handle_of(c);
    hol_inverse *inverse;
    CHECK(hol_inverse_create(chains, 0, c->r, &inverse));
    hol_chains_destroy(chains); /* the inverse has copied what it needs */
    return inverse;
}
