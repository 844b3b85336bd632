/* A temporary folder for a test's files: one at a time, created and removed by cmocka. */
#ifndef ORL_TESTS_SUPPORT_SCRATCH_H
#define ORL_TESTS_SUPPORT_SCRATCH_H

int scratch_set_up(void **state); /* does not use the state */
int scratch_tear_down(void **state);

/* Returns the path of a file in it; "" for the folder itself. Valid for the next three calls. */
const char *scratch_path(const char *name);

#endif
