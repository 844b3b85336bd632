/*
 * Identity of this build of the program. Cache keys include it if the cached data may depend on all
 * of the program's code.
 */
#ifndef ORL_BASE_BUILD_H
#define ORL_BASE_BUILD_H

#include <stdbool.h>

#include <oriel/sha256.h>

/* Adds the linker's digest of the program (its note NT_GNU_BUILD_ID). Returns false if there is
 * none. */
bool orl_build_add(struct orl_sha256 *hash);

#endif
