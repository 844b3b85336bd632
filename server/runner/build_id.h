/*
 * Identity of the running program: a digest of the build IDs of itself and its libraries. A build
 * ID is a note by the linker with a digest of its output. A library without the note counts by its
 * name, size and modification time. A copy of the same files, elsewhere or later, is the same
 * program.
 *
 * Call it before there are threads. Libraries load others when they are first used, so a later call
 * may find more of them.
 */
#ifndef ORL_SERVER_RUNNER_BUILD_ID_H
#define ORL_SERVER_RUNNER_BUILD_ID_H

#include "store/files/folders.h"

void orl_program_digest(char ret_digest[ORL_SHA_HEX]);

#endif
