/*
 * Limits on the resources of HTTP clients; oriel/base/limits.h has those of scenes and jobs. GET
 * /v1/limits reports both. ORL_SANITIZED, below, is true in builds with a sanitizer.
 */
#ifndef ORL_SERVER_PROCESS_LIMITS_H
#define ORL_SERVER_PROCESS_LIMITS_H

#include <oriel/base/limits.h>

#define ORL_SERVER_SCENE_BYTES (4UL << 30)       /* body of one scene upload */
#define ORL_SERVER_ZIP_ENTRIES 4096U             /* entries of one zip, including folders */
#define ORL_SERVER_ZIP_RATIO 200UL               /* unpacked bytes per byte of a zip, beyond ... */
#define ORL_SERVER_ZIP_FREE (64UL << 20)         /* ... these unpacked bytes */
#define ORL_SERVER_FIELD_BYTES (1UL << 20)       /* a form field that is not a file */
#define ORL_SERVER_BODY_BUFFER (128UL << 10)     /* memory for a body; it spills to disk at half */
#define ORL_SERVER_DROPPED_BODY (512UL << 20)    /* body of a refused request, read to answer it */
#define ORL_SERVER_CONNECTIONS 2048U             /* open connections, including event streams */
#define ORL_SERVER_STREAMS 1024U                 /* open event streams */
#define ORL_SERVER_ADDRESS_CONNECTIONS 128U      /* connections from one address, if not loopback */
#define ORL_SERVER_CONNECTION_MEMORY (32U << 10) /* headers and read buffer of a connection */
#define ORL_SERVER_URI_BYTES (8U << 10)          /* request target, plus 64 for each argument */
#define ORL_SERVER_ORIGINS 16U                   /* allowed origins of web pages */
#define ORL_SERVER_BROKER_EVENTS 512U            /* latest events of jobs, kept for all streams */
#define ORL_SERVER_BROKER_BYTES (1UL << 20)      /* bytes of these events */
#define ORL_SERVER_SESSION_S 43200U              /* lifetime of a browser's session */
#define ORL_SERVER_SESSIONS 64U                  /* browser sessions of one token */
#define ORL_SERVER_LINK_S 3600U                  /* maximum lifetime of a signed link */
#define ORL_SERVER_LINKS 100U                    /* signed links in one answer */
#define ORL_SERVER_TIMEOUT_S 60U         /* silence before a connection is closed (default) */
#define ORL_SERVER_JOB_S 86400U          /* time limit of a job (default) */
#define ORL_SERVER_KEPT_JOBS 10000U      /* ended jobs that are kept (default) */
#define ORL_SERVER_KEEP_ORPHANS_DAYS 30U /* age limit of orphans (default) */
#define ORL_SERVER_DRAIN_S 5U            /* time for running jobs to finish at a stop (default) */
/* Time of an orderly stop after the drain limit; then the stop is forced. Builds with sanitizers
 * get more: they take seconds to map gigabytes that are reserved and never touched. */
#define ORL_SERVER_STOP_S (ORL_SANITIZED ? 60U : 5U)
#define ORL_SERVER_HEADER_S 15.0    /* from a connection's start to the end of its first headers */
#define ORL_SERVER_BODY_RATE 1024.0 /* minimum rate of a body, bytes/s */
#define ORL_SERVER_QUEUE 1024U      /* waiting jobs */
#define ORL_SERVER_CLIENT_JOBS 256U /* jobs of one client of several, waiting or running */
#define ORL_SERVER_CLIENT_STREAMS 256U /* open event streams of such a client */
#define ORL_SERVER_DEDUP_FOLLOWERS 64U /* followers of one computation; one more starts another */
#define ORL_SERVER_KEY_S 86400U        /* lifetime of an Idempotency-Key */
#define ORL_SERVER_UNFETCHED_S 600U    /* time that results are kept for a first fetch */
#define ORL_SERVER_LIST 1000U          /* jobs in a listing */
#define ORL_SERVER_LIST_AT_ONCE 200U   /* jobs in one answer of it, which blocks the loop */
#define ORL_SERVER_LIST_BYTES (4UL << 20) /* bytes of such an answer; at least one job */
#define ORL_SERVER_STUDY_RUNS 500U        /* runs of one study, including the reference's */
#define ORL_SERVER_THREADS 512U           /* render threads */
#define ORL_SERVER_IO_THREADS 4U          /* further pool threads, for uploads and files */
#define ORL_SERVER_POOL_S 2.0         /* delay of the pool beyond which the daemon is not ready */
#define ORL_SERVER_CHECKS 3U          /* checks at once; leaves one thread above for other work */
#define ORL_SERVER_CHECK_QUICK_MS 200 /* limit of a quick check; one slot is for these */
#define ORL_SERVER_CHECK_S 120U       /* time limit of a check (default) */
#define ORL_SERVER_SMALL_JSON (64UL << 10)          /* larger job documents are read in a child */
#define ORL_SERVER_CHECK_BYTES (2UL << 30)          /* memory limit of one check (default) */
#define ORL_SERVER_CHECK_FIRST (256UL << 20)        /* first memory grant of a check */
#define ORL_SERVER_CHECK_LEAST (64UL << 20)         /* least memory grant of a check */
#define ORL_SERVER_SCRUB_RATE (4UL << 20)           /* scrubbed bytes/s (default) */
#define ORL_SERVER_MEMORY_CACHE_BYTES (256UL << 20) /* memory cache shared by jobs (default) */
#define ORL_SERVER_ATTEMPTS 3 /* times that a job may end the daemon before it fails */

/* 1 in a build with AddressSanitizer or ThreadSanitizer, otherwise 0. */

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define ORL_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define ORL_SANITIZED 1
#endif
#endif
#ifndef ORL_SANITIZED
#define ORL_SANITIZED 0
#endif

#endif
