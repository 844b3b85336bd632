/*
 * A daemon's storage as its clients see it. Everything here fails the running test on error.
 */
#ifndef ORL_TESTS_SUPPORT_STORAGE_H
#define ORL_TESTS_SUPPORT_STORAGE_H

#include "support/daemon.h"

/* Sends a request without a body; expects the status and, for a problem, its type (NULL: any). */
void storage_expect(struct daemon *daemon, const char *method, const char *path, long status,
                    const char *type);
enum { STORAGE_PHOTONS = 20000 };
/* Runs a job with that many photons until it has succeeded; returns its path. */
void storage_run_job(struct daemon *daemon, const char *scene, int seed, const char *view,
                     char ret_path[80]);
/* Requests the job's result, and expects that status. */
void storage_fetch(struct daemon *daemon, const char *job, long status);

/* Return the bytes of "maps", "bsdfs", "results" or "uploads", by the metrics; and the total. */
double storage_bytes_of(struct daemon *daemon, const char *kind);
double storage_bytes(struct daemon *daemon);
size_t storage_count_maps(struct daemon *daemon);
/* Runs SQL on the daemon's database, whether the daemon runs or not. */
void storage_run_sql(const struct daemon *daemon, const char *sql);

#endif
