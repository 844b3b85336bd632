/* Runs other programs by an argument vector, to their end within a time limit. */
#ifndef ORL_API_DISTRIBUTED_RUN_PROGRAM_H
#define ORL_API_DISTRIBUTED_RUN_PROGRAM_H

#include <stdatomic.h>

#include <oriel/base/error.h>

enum { ORL_COMMAND_OUTPUT = 1 << 16 };

/*
 * Runs argv[0], found by PATH. ret_output: output and errors of the program, cut at the end if
 * too long; "" after an error. Returns the exit status (128 plus the number for a signal), or a
 * negative orl_err. ORL_ERR_NOT_FOUND: it cannot be started. ORL_ERR_IO: it exceeded the time
 * limit and was killed. ORL_ERR_CANCELLED: killed because *cancel was set (cancel NULL: never).
 */
int orl_command_run(char *const argv[], double limit_s, const atomic_bool *cancel,
                    char ret_output[ORL_COMMAND_OUTPUT], struct orl_error *err);

#endif
