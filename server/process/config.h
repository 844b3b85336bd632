/*
 * The daemon's settings: allowed web origins (origin.c), options for large jobs, and all others
 * (config.c). They come from its arguments and the environment (ORIEL_DATA).
 */
#ifndef ORL_SERVER_PROCESS_CONFIG_H
#define ORL_SERVER_PROCESS_CONFIG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <netinet/in.h>
#include <oriel/base/error.h>

#include "process/limits.h"
#include "process/log.h"

/*
 * Web origins as browsers write them in the Origin header (RFC 6454, 6.2): "https://tool.example",
 * "http://localhost:3000". Scheme and host are in lower case, the port is given only if it is not
 * the scheme's default, and nothing follows. Origins that differ in a byte are different; a dot at
 * the end of the name makes another. Threads: any.
 */

enum { ORL_ORIGIN_MAX = 300 }; /* bytes: the longest name that DNS has, and a port */

/* Checks an origin. ORL_ERR_INVALID, with a sentence, for text that no browser sends: "*", "null",
 * a path, ... */
int orl_origin_check(const char *text, struct orl_error *err);

/* Returns true if the origin equals one of the list, byte for byte. */
bool orl_origin_is_listed(const char *origin, const char *const *list, size_t count);

/* The daemon's options for large jobs: run here, or in parts by Slurm. */

enum { ORL_RUNNER_WORDS = 32, ORL_RUNNER_NAMED = 4 };

struct orl_runner_options {
    bool slurm;
    /* Borrowed from argv; NULL: not given. */
    const char *shared;                  /* folder that all nodes can access */
    const char *named[ORL_RUNNER_NAMED]; /* sbatch options: partition, account, qos, constraint */
    const char *words[ORL_RUNNER_WORDS]; /* further sbatch options, passed on unchanged */
    size_t n_words;
    uint32_t parts;        /* parts of a round, which is also the number of concurrent tasks */
    uint32_t part_threads; /* threads of each part */
    uint32_t least_s;      /* jobs with less work than these seconds of one core run here */
    bool any;              /* true if any of these options was given */
};

/* Names of the sbatch options in `named`: "partition", ... */
extern const char *const orl_runner_named[ORL_RUNNER_NAMED];

/* All settings. */

#define ORL_DEFAULT_DATA "oriel-data"

struct orl_config {
    union {
        struct sockaddr any;
        struct sockaddr_in v4;
        struct sockaddr_in6 v6;
    } address;
    const char *data;               /* borrowed from argv or the environment */
    const char *tls_cert, *tls_key; /* PEM files, borrowed; NULL: plain HTTP */
    bool needs_token;               /* tokens are required on all routes that are not open */
    const char *origins[ORL_SERVER_ORIGINS]; /* allowed web origins; borrowed from argv */
    size_t n_origins;
    uint32_t threads;              /* render threads, over all jobs */
    uint32_t jobs;                 /* maximum number of running jobs */
    uint32_t address_connections;  /* maximum of open connections from one address */
    uint32_t idle_timeout_s;       /* seconds of silence before a connection is closed */
    uint32_t check_timeout_s;      /* time limit of the check of an upload */
    uint64_t check_memory;         /* memory limit of a check, bytes */
    uint64_t memory_bytes;         /* capacity for daemon and checks; 0: what the system has */
    uint64_t storage_bytes;        /* storage budget; 0: half of the disk's free space */
    uint64_t scrub_bytes_per_s;    /* 0: stored files are not scrubbed */
    uint64_t memory_cache_bytes;   /* size of the memory cache that jobs share, bytes */
    uint32_t job_timeout_s;        /* time limit of a job */
    uint32_t keep_jobs, keep_days; /* limits for ended jobs; 0 days: forever */
    uint32_t keep_orphans_days;    /* days that orphans are kept */
    bool set_orphans_aside;        /* if the database is lost or another folder's: db.h */
    uint32_t drain_s;              /* seconds that running jobs have to finish at a stop */
    struct orl_runner_options runner;
    enum orl_log_level log_level;
    bool log_json;
};

enum orl_config_action { ORL_CONFIG_SERVE, ORL_CONFIG_HELP, ORL_CONFIG_VERSION };

/* Parses the arguments. ORL_ERR_INVALID with a sentence for the user. *ret_action is the action
 * requested. */
int orl_config_parse(int argc, char **argv, struct orl_config *ret_config,
                     enum orl_config_action *ret_action, struct orl_error *err);

void orl_config_help(FILE *stream);

/* Writes an address as text: "127.0.0.1:8423" or "[::1]:8423". */
void orl_address_format(const struct sockaddr *address, char *ret_text, size_t size);

#endif
