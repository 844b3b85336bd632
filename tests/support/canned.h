/*
 * A daemon of canned answers, and `oriel` run against it: tests what the command sends, prints and
 * writes.
 */
#ifndef ORL_TESTS_SUPPORT_CANNED_H
#define ORL_TESTS_SUPPORT_CANNED_H

#include <pthread.h>
#include <stddef.h>

#include "support/cli.h"

enum { CANNED_BODY_MAX = 1 << 16 };

struct MHD_Daemon;

/* One canned answer. Answers to equal requests are given in turn, the last one for ever. */
struct canned {
    const char *request; /* "GET /v1/jobs/7" */
    unsigned status;
    const char *body;
};

struct canned_request {
    char line[256];
    char body[CANNED_BODY_MAX];
    size_t size;
};

struct canned_daemon {
    struct MHD_Daemon *daemon;
    pthread_mutex_t lock;        /* during a run the daemon's thread owns the following fields */
    const struct canned *canned; /* ends with a NULL request */
    struct canned_request *requests; /* in order of arrival */
    size_t n_requests;
    char url[64], folder[64];
    struct cli_result result;
};

/* cmocka's fixtures; *state is a struct canned_daemon. */
int canned_set_up(void **state);
int canned_tear_down(void **state);

/* Runs `oriel command operand [-o FOLDER] --server URL` (operand may be NULL). */
void canned_run(struct canned_daemon *f, const struct canned *canned, const char *command,
                const char *operand, const char *output);
/* Runs `oriel` with any arguments; args ends with NULL. */
void canned_run_args(struct canned_daemon *f, const struct canned *canned, const char *const *args);

/* Return how often a request line arrived, and the body of the first one (NULL: none). */
size_t canned_asked(const struct canned_daemon *f, const char *line);
const struct canned_request *canned_find(const struct canned_daemon *f, const char *line);

/* Fails the running test if text does not contain wanted. */
void canned_says(const char *text, const char *wanted);

#endif
