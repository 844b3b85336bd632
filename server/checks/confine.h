/*
 * A process that is about to read what a stranger has sent gives up whatever that does not take:
 * memory, processor time and files beyond bounds, other programs, the network, files that it has
 * not opened, privileges; and it is the first to go when the machine has no memory left.
 *
 * In builds with sanitizers there is neither the bound on memory (their shadow is far larger than
 * any) nor the filter of system calls (theirs are others).
 * Threads: the process must have one only.
 */
#ifndef ORL_SERVER_CHECKS_CONFINE_H
#define ORL_SERVER_CHECKS_CONFINE_H

#include <stdint.h>

#include <oriel/error.h>

struct orl_bounds {
    uint64_t memory; /* bytes, of data; stacks and mapped files do not count */
    uint32_t cpu_s;
};

/* For good. ORL_ERR_INTERNAL when the system refuses. */
int orl_confine(const struct orl_bounds *bounds, struct orl_error *err);

#endif
