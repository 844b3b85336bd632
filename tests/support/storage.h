/*
 * What a daemon keeps, as its clients see it. Everything here fails the running test when it does
 * not succeed.
 */
#ifndef ORL_TESTS_SUPPORT_STORAGE_H
#define ORL_TESTS_SUPPORT_STORAGE_H

#include "support/daemon.h"

/* A request without a body; expects the status and, of a problem, its type, or NULL. */
void storage_expect(struct daemon *daemon, const char *method, const char *path, long status,
                    const char *type);
enum { STORAGE_PHOTONS = 20000 };
/* A job of so many photons, waited for until it has succeeded; its path. */
void storage_run_job(struct daemon *daemon, const char *scene, int seed, const char *view,
                     char ret_path[80]);
/* Asks for its result. */
void storage_fetch(struct daemon *daemon, const char *job, long status);

/* Bytes of "maps", "bsdfs", "results" or "uploads", by the metrics; of all of them. */
double storage_bytes_of(struct daemon *daemon, const char *kind);
double storage_bytes(struct daemon *daemon);
size_t storage_count_maps(struct daemon *daemon);
/* Runs SQL on the daemon's database, whether the daemon runs or not. */
void storage_run_sql(const struct daemon *daemon, const char *sql);

#endif
