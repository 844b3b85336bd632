/*
 * Identity of this build of the program. Cache keys include it if the cached data may depend on all
 * of the program's code.
 */
#ifndef ORL_BASE_PROGRAM_ID_H
#define ORL_BASE_PROGRAM_ID_H

#include <stdbool.h>

#include <oriel/base/sha256.h>

/* Adds the linker's digest of the program (its note NT_GNU_BUILD_ID). Returns false if there is
 * none. */
bool orl_program_id_add(struct orl_sha256 *hash);

#endif
