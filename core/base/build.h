/*
 * Which build of the program this is: what is kept from one run to the next may depend on all of
 * its code, and goes by that then.
 */
#ifndef ORL_BASE_BUILD_H
#define ORL_BASE_BUILD_H

#include <stdbool.h>

#include <oriel/sha256.h>

/* Adds the linker's digest of the program (its note NT_GNU_BUILD_ID). False: it has none. */
bool orl_build_add(struct orl_sha256 *hash);

#endif
