/**
 * @file failing_allocations.h
 * Every allocation of the process goes through here: counted, kept account of, and made to fail on demand.
 */
#ifndef FAULTS_FAILING_ALLOCATIONS_H
#define FAULTS_FAILING_ALLOCATIONS_H

/** Lets `good` more allocations of any thread succeed, and then none until fail_no_more. */
void fail_after(long good);

/** Lets the next `good` succeed, one fail, and all that follow succeed. */
void fail_once_after(long good);

void fail_no_more(void);

/** How many allocations were refused since the last fail_after or fail_once_after. */
long refused(void);

/** Blocks allocated and not freed. */
long blocks_in_use(void);

#endif
