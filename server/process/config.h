/*
 * The daemon's settings, from its arguments and the environment (ORIEL_DATA).
 */
#ifndef ORL_SERVER_PROCESS_CONFIG_H
#define ORL_SERVER_PROCESS_CONFIG_H

#include <netinet/in.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include <oriel/error.h>

#include "process/limits.h"
#include "process/log.h"
#include "process/runner_options.h"

#define ORL_DEFAULT_DATA "oriel-data"

struct orl_config {
    union {
        struct sockaddr any;
        struct sockaddr_in v4;
        struct sockaddr_in6 v6;
    } address;
    const char *data;                        /* borrowed from argv or the environment */
    const char *tls_cert, *tls_key;          /* PEM files, borrowed; NULL: plain HTTP */
    bool needs_token;                        /* on every route that is not open */
    const char *origins[ORL_SERVER_ORIGINS]; /* whose pages may ask: origin.h; borrowed from argv */
    size_t n_origins;
    uint32_t threads;              /* that render, over all jobs */
    uint32_t jobs;                 /* that render at once */
    uint32_t address_connections;  /* open from one address */
    uint32_t idle_timeout_s;       /* of silence, before a connection is closed */
    uint32_t check_timeout_s;      /* that the check of an upload may take */
    uint64_t check_memory;         /* bytes that it may take */
    uint64_t memory_bytes;         /* that daemon and checks may take; 0: what there is */
    uint64_t storage_bytes;        /* that what is kept may take; 0: half of the disk's room */
    uint64_t scrub_bytes_per_s;    /* 0: what is kept is not looked through */
    uint64_t shelf_bytes;          /* of memory, for what jobs leave to those after them */
    uint32_t job_timeout_s;        /* that a job may run */
    uint32_t keep_jobs, keep_days; /* of those that have ended; no days: for ever */
    uint32_t keep_orphans_days;    /* that files stay which a start has set aside */
    bool set_orphans_aside;        /* of a database that is lost or another's: opening.h */
    uint32_t drain_s;              /* that running jobs are given to finish at a stop */
    struct orl_runner_options runner;
    enum orl_log_level log_level;
    bool log_json;
};

enum orl_config_action { ORL_CONFIG_SERVE, ORL_CONFIG_HELP, ORL_CONFIG_VERSION };

/* ORL_ERR_INVALID with a sentence for the user; *ret_action says what was asked for. */
int orl_config_parse(int argc, char **argv, struct orl_config *ret_config,
                     enum orl_config_action *ret_action, struct orl_error *err);

void orl_config_help(FILE *stream);

/* "127.0.0.1:8423" or "[::1]:8423" as text. */
void orl_address_format(const struct sockaddr *address, char *ret_text, size_t size);

#endif
