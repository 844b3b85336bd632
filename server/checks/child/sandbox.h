/*
 * Confines a process that is about to read untrusted data to what that needs. It bounds memory,
 * processor time and files, forbids other programs, the network and opening files, and drops
 * privileges. The process also becomes the first that the kernel kills when memory runs out.
 *
 * Builds with sanitizers have neither the memory bound (the shadow memory is far larger) nor the
 * system-call filter (sanitizers need other calls).
 * Threads: the process must have one only.
 */
#ifndef ORL_SERVER_CHECKS_CHILD_SANDBOX_H
#define ORL_SERVER_CHECKS_CHILD_SANDBOX_H

#include <stdint.h>

#include <oriel/base/error.h>

struct orl_sandbox_limits {
    uint64_t memory; /* bytes of data; stacks and mapped files do not count */
    uint32_t cpu_s;
};

/* Confines the process for good. ORL_ERR_INTERNAL if the system refuses. */
int orl_sandbox_enter(const struct orl_sandbox_limits *bounds, struct orl_error *err);

#endif
