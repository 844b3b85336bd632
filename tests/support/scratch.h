/* A temporary folder for what a test writes: one at a time, made and removed by cmocka. */
#ifndef ORL_TESTS_SUPPORT_SCRATCH_H
#define ORL_TESTS_SUPPORT_SCRATCH_H

int scratch_set_up(void **state); /* the state is left alone */
int scratch_tear_down(void **state);

/* Of a file in it; "" is the folder's own. Valid until the next but three. */
const char *scratch_path(const char *name);

#endif
