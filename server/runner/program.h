/*
 * Which program runs: by the build IDs (the notes that linkers leave, a digest of what they link)
 * of itself and its libraries; of one without such a note by its name, size and time of change.
 * A copy of the same files, elsewhere or later, is the same program.
 *
 * To be asked before there are threads: libraries load others when they are first used, which are
 * then found here, or not yet.
 */
#ifndef ORL_SERVER_RUNNER_PROGRAM_H
#define ORL_SERVER_RUNNER_PROGRAM_H

#include "store/folders.h"

void orl_program_digest(char ret_digest[ORL_SHA_HEX]);

#endif
