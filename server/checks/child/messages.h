/* Messages between daemon and child: packets over a socket, and the files that a request names. */
#ifndef ORL_SERVER_CHECKS_CHILD_MESSAGES_H
#define ORL_SERVER_CHECKS_CHILD_MESSAGES_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "store/files/scene_bundle.h"

/*
 * Packets over the socket, each a byte with its kind followed by data. A packet arrives whole or
 * not at all, even when a process dies.
 *
 *     daemon -> child         REQUEST ..., REQUEST_END: a JSON text, in parts
 *     child -> daemon         FILE (its name), DATA ..., FILE, ...: files unpacked
 *                             VERDICT ..., VERDICT_END: a JSON text, in parts
 *     fork server -> daemon   END: struct orl_child_end, after the child has ended
 *
 * Threads: any; one at a time for each socket. Errors: false, with errno set.
 */

enum orl_frame_kind {
    ORL_FRAME_REQUEST = 'r',
    ORL_FRAME_REQUEST_END = 'R',
    ORL_FRAME_FILE = 'f',
    ORL_FRAME_DATA = 'd',
    ORL_FRAME_VERDICT = 'v',
    ORL_FRAME_VERDICT_END = 'V',
    ORL_FRAME_END = 'E',
};

enum { ORL_FRAME_BYTES = 64 << 10 }; /* maximum of a packet, without the byte of its kind */

struct orl_child_end {
    int32_t status; /* status of waitpid */
    int32_t pid;
    uint64_t peak_bytes; /* peak resident set size */
    uint64_t cpu_ms;     /* user and system time */
};

/* Sends one packet. Blocks until the socket has space. */
bool orl_frame_send(int fd, enum orl_frame_kind kind, const void *data, size_t size);
/* Sends a text in as many packets as it takes; the last one has the kind `end`. Blocks like
 * orl_frame_send. */
bool orl_frame_send_text(int fd, enum orl_frame_kind part, enum orl_frame_kind end,
                         const char *text, size_t size);

/* A text that arrives in parts. */
struct orl_frame_text {
    char *text; /* owned; free() */
    size_t size, capacity;
};
/* Appends data and a terminating NUL. Returns false if the text exceeds `most` bytes or memory runs
 * out. */
bool orl_frame_text_add(struct orl_frame_text *text, const char *data, size_t size, size_t most);

/* Convert counts to a JSON array and back. Places: the addresses of n counts, in their order. NULL:
 * out of memory; false: it is no array of n counts, and the counts are partly set. */
json_t *orl_counts_to_json(uint64_t *const places[], size_t n);
bool orl_counts_from_json(const json_t *counts, uint64_t *const places[], size_t n);

/*
 * The files of a check, all mapped before the sandbox forbids open().
 *
 * Ownership: nothing is freed: the process ends with the check.
 */

struct orl_mapped_inputs {
    struct orl_bundle bundle; /* the request's "files", in their order */
    struct orl_file *data;    /* contents of the bundle's files */
    struct orl_file single;   /* the request's "path" */
};

/* Maps the files that the request names. */
int orl_mapped_inputs_open(const json_t *request, struct orl_mapped_inputs *ret_mapped,
                           struct orl_error *err);

/* Returns a file provider that borrows mapped. */
struct orl_files orl_mapped_inputs_provider(struct orl_mapped_inputs *mapped);

/* Converts a bundle to the request's "files". Returns a new reference; NULL: out of memory. */
json_t *orl_mapped_inputs_to_json(const struct orl_bundle *bundle);

#endif
