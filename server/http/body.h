/*
 * The body of one request: held in memory while small, spilled to a file below tmp/ when not.
 *
 * The loop thread appends; when append says so, the caller suspends the connection and has a pool
 * thread flush. Afterwards a pool thread views the whole. A body larger than its limit is swallowed
 * (over is set) so that an answer can still be sent.
 * Threads: one at a time.
 */
#ifndef ORL_SERVER_HTTP_BODY_H
#define ORL_SERVER_HTTP_BODY_H

#include <stdbool.h>
#include <stdint.h>

#include <oriel/files.h>

#include "http/hold.h"
#include "store/folders.h"

struct orl_body {
    uint64_t size, limit;
    bool over;   /* larger than limit */
    bool failed; /* a write failed; err says why */
    struct orl_error err;
    char *buffer;
    size_t used;
    int fd; /* of path; -1 while all is in the buffer */
    char path[ORL_PATH_MAX];
    struct orl_hold *hold;  /* of what goes to the disk: borrowed; NULL: no bound */
    uint64_t written, held; /* so much; and so much of it is held already */
    struct orl_file view;
};

void orl_body_init(struct orl_body *body, uint64_t limit, struct orl_hold *hold);
void orl_body_done(struct orl_body *body); /* removes the file, unless orl_body_take_file did */

/* Returns true when the buffer wants flushing before more comes. size is at most half of it. */
bool orl_body_append(struct orl_body *body, const char *data, size_t size);
/* Pool: writes the buffer to the file. */
void orl_body_flush(struct orl_body *body, const struct orl_folders *folders);
/* Pool: all of it, valid until done. */
int orl_body_view(struct orl_body *body, const struct orl_folders *folders,
                  struct orl_file *ret_view, struct orl_error *err);
/* Pool: all of it as a file, the body's until done; *ret_path is valid until then. */
int orl_body_file(struct orl_body *body, const struct orl_folders *folders, const char **ret_path,
                  struct orl_error *err);
/* Pool: puts all of it into a file of the caller's, who may move it away or must remove it. */
int orl_body_take_file(struct orl_body *body, const struct orl_folders *folders,
                       char ret_path[ORL_PATH_MAX], struct orl_error *err);

#endif
