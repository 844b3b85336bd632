/*
 * The body of one request: in memory while small, spilled to a file below tmp/ when larger.
 *
 * The loop thread appends. When append returns true, the caller suspends the connection and has a
 * pool thread flush. Afterwards a pool thread views the whole body. A body larger than its limit is
 * read and dropped (over is set), so that an answer can still be sent.
 * Threads: one at a time.
 */
#ifndef ORL_SERVER_HTTP_REQUEST_BODY_H
#define ORL_SERVER_HTTP_REQUEST_BODY_H

#include <stdbool.h>
#include <stdint.h>

#include <oriel/base/files.h>

#include "http/quota/quota.h"
#include "store/files/folders.h"

struct orl_body {
    uint64_t size, limit;
    bool over;   /* larger than limit */
    bool failed; /* a write failed; err has the reason */
    struct orl_error err;
    char *buffer;
    size_t used;
    int fd; /* the open file; -1 while all data is in the buffer */
    char path[ORL_PATH_MAX];
    struct orl_reservation *reservation; /* bounds the bytes on disk; borrowed; NULL: no bound */
    uint64_t written, reserved; /* bytes written to disk; bytes of them already reserved in hold */
    struct orl_file view;
};

void orl_body_init(struct orl_body *body, uint64_t limit, struct orl_reservation *reservation);
void orl_body_done(struct orl_body *body); /* removes the file, unless the caller took it */

/* Appends data. Returns true if the buffer must be flushed before more arrives. size is at most
 * half the buffer. */
bool orl_body_append(struct orl_body *body, const char *data, size_t size);
/* Pool: writes the buffer to the file. */
void orl_body_flush(struct orl_body *body, const struct orl_folders *folders);
/* Pool: returns the whole body, valid until done. */
int orl_body_view(struct orl_body *body, const struct orl_folders *folders,
                  struct orl_file *ret_view, struct orl_error *err);
/* Pool: returns the path of a file with the whole body. The body owns the file; *ret_path is valid
 * until done. */
int orl_body_file(struct orl_body *body, const struct orl_folders *folders, const char **ret_path,
                  struct orl_error *err);
/* Pool: puts the whole body into a file that the caller then owns, to move away or remove. */
int orl_body_take_file(struct orl_body *body, const struct orl_folders *folders,
                       char ret_path[ORL_PATH_MAX], struct orl_error *err);

#endif
