/** The inverse of one chain. */
#ifndef TESTS_INVERSE_H
#define TESTS_INVERSE_H

#include "chain.h"
#include "holonomic.h"

hol_chains *handle_of(const chain *c);
hol_inverse *inverse_of(const chain *c);

#endif
