/*
 * Bounds on what HTTP clients may cost the daemon; those on scenes and jobs are in oriel/limits.h.
 * GET /v1/limits reports both.
 */
#ifndef ORL_SERVER_PROCESS_LIMITS_H
#define ORL_SERVER_PROCESS_LIMITS_H

#include <oriel/limits.h>

#include "process/sanitized.h"

#define ORL_SERVER_SCENE_BYTES (4UL << 30) /* the body of one scene upload */
#define ORL_SERVER_ZIP_ENTRIES 4096U       /* of one zip, folders among them */
#define ORL_SERVER_ZIP_RATIO 200UL         /* bytes unpacked to a byte of the zip, beyond ... */
#define ORL_SERVER_ZIP_FREE (64UL << 20)   /* ... these */
#define ORL_SERVER_FIELD_BYTES (1UL << 20) /* a form field that is not a file */
#define ORL_SERVER_BODY_BUFFER                                                                     \
    (128UL << 10)                             /* of memory for a body, which spills at half of it  \
                                               */
#define ORL_SERVER_DROPPED_BODY (512UL << 20) /* of a refused request, read to answer it */
#define ORL_SERVER_CONNECTIONS 2048U          /* open at once, event streams among them */
#define ORL_SERVER_STREAMS 1024U              /* of events, open at once */
#define ORL_SERVER_ADDRESS_CONNECTIONS 128U   /* ... from one address, unless on loopback */
#define ORL_SERVER_CONNECTION_MEMORY (32U << 10) /* headers and read buffer of one */
#define ORL_SERVER_URI_BYTES (8U << 10)          /* target of a request, and 64 an argument */
#define ORL_SERVER_ORIGINS 16U                   /* of web pages that may be let in */
#define ORL_SERVER_HUB_EVENTS 512U               /* kept for all streams: the latest of a job ... */
#define ORL_SERVER_HUB_BYTES (1UL << 20)         /* ... and what they take */
#define ORL_SERVER_SESSION_S 43200U              /* that a browser stays signed in */
#define ORL_SERVER_SESSIONS 64U                  /* of browsers, of one token */
#define ORL_SERVER_LINK_S 3600U                  /* that a signed link may be good for */
#define ORL_SERVER_LINKS 100U                    /* of them in one answer */
#define ORL_SERVER_TIMEOUT_S 60U         /* of silence, before a connection is closed (default) */
#define ORL_SERVER_JOB_S 86400U          /* that a job may run (default) */
#define ORL_SERVER_KEPT_JOBS 10000U      /* that have ended (default) */
#define ORL_SERVER_KEEP_ORPHANS_DAYS 30U /* that files stay which a start set aside (default) */
#define ORL_SERVER_DRAIN_S 5U            /* that running jobs have to finish at a stop (default) */
/* The time of an orderly stop after the drain limit; then the stop is forced. Builds with
 * sanitizers get more: they take seconds to map gigabytes that are reserved and never touched. */
#define ORL_SERVER_STOP_S (ORL_SANITIZED ? 60U : 5U)
#define ORL_SERVER_HEADER_S 15.0    /* from a connection's start to the end of its first headers */
#define ORL_SERVER_BODY_RATE 1024.0 /* bytes/s that a body has to come at */
#define ORL_SERVER_QUEUE 1024U      /* jobs waiting */
#define ORL_SERVER_CLIENT_JOBS 256U /* waiting or running, of one client among several ... */
#define ORL_SERVER_CLIENT_STREAMS 256U /* ... and streams of events open */
#define ORL_SERVER_SHARING 64U       /* jobs that follow one computation; the next begins another */
#define ORL_SERVER_KEY_S 86400U      /* that an Idempotency-Key is remembered */
#define ORL_SERVER_UNFETCHED_S 600U  /* that results stay for somebody to ask for them */
#define ORL_SERVER_LIST 1000U        /* jobs that a listing may be asked for; */
#define ORL_SERVER_LIST_AT_ONCE 200U /* of these in one answer, which everybody waits for ... */
#define ORL_SERVER_LIST_BYTES (4UL << 20) /* ... and what it may take; that many jobs, or one */
#define ORL_SERVER_STUDY_RUNS 500U        /* runs of one study, the reference's included */
#define ORL_SERVER_THREADS 512U           /* render threads */
#define ORL_SERVER_IO_THREADS 4U          /* pool threads beside them, for uploads and files */
#define ORL_SERVER_POOL_S 2.0 /* that the pool may take to begin a work; longer is not ready */
#define ORL_SERVER_CHECKS 3U  /* of uploads at once: one of the threads above is for the others */
#define ORL_SERVER_CHECK_QUICK_MS 200 /* of a check; one lane is for those that take no longer */
#define ORL_SERVER_CHECK_S 120U       /* that the check of one upload may take (default) */
#define ORL_SERVER_SMALL_JSON (64UL << 10)   /* a job's document that needs no child to be read */
#define ORL_SERVER_CHECK_BYTES (2UL << 30)   /* of memory that one check may take (default) ... */
#define ORL_SERVER_CHECK_FIRST (256UL << 20) /* ... that it is granted at first */
#define ORL_SERVER_CHECK_LEAST (64UL << 20)  /* ... and has at least */
#define ORL_SERVER_SCRUB_RATE (4UL << 20)    /* bytes a second that are looked through (default) */
#define ORL_SERVER_SHELF_BYTES (256UL << 20) /* that jobs leave in memory (default) */
#define ORL_SERVER_ATTEMPTS 3                /* starts of one job before it counts as a killer */

#endif
