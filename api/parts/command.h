/* Other programs, run to their end within a time limit, with an argument vector. */
#ifndef ORL_PARTS_COMMAND_H
#define ORL_PARTS_COMMAND_H

#include <stdatomic.h>

#include <oriel/error.h>

enum { ORL_COMMAND_OUTPUT = 1 << 16 };

/*
 * Runs argv[0], found by PATH. ret_output: what it printed, errors included, the first of it where
 * there is more; "" after an error. Returns its exit status (128 and more: a signal's number above
 * 128), or a negative orl_err: ORL_ERR_NOT_FOUND: it cannot be started; ORL_ERR_IO: it did not end
 * in time and was killed; ORL_ERR_CANCELLED: likewise, because *cancel (NULL: never).
 */
int orl_command_run(char *const argv[], double limit_s, const atomic_bool *cancel,
                    char ret_output[ORL_COMMAND_OUTPUT], struct orl_error *err);

#endif
