#include "http/request/request.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "process/limits.h"
#include "store/files/folders.h"
#include "store/files/scene_bundle.h"

void orl_body_init(struct orl_body *body, uint64_t limit, struct orl_reservation *reservation)
{
    memset(body, 0, sizeof *body);
    body->limit = limit;
    body->reservation = reservation;
    body->fd = -1;
}

void orl_body_done(struct orl_body *body)
{
    if (body->view.handle)
        orl_unmap_file(&body->view);
    if (body->fd >= 0)
        close(body->fd);
    if (body->path[0])
        unlink(body->path);
    free(body->buffer);
    orl_body_init(body, 0, NULL);
}

bool orl_body_append(struct orl_body *body, const char *data, size_t size)
{
    body->size += size;
    body->over |= body->size > body->limit;
    if (body->over || body->failed)
        return false;
    if (!body->buffer)
        body->buffer = malloc(ORL_SERVER_BODY_BUFFER);
    if (!body->buffer || size > ORL_SERVER_BODY_BUFFER - body->used) {
        body->failed = true;
        orl_error_set(&body->err, ORL_ERR_NOMEM, "out of memory for a request's body");
        return false;
    }
    memcpy(body->buffer + body->used, data, size);
    body->used += size;
    return body->used > ORL_SERVER_BODY_BUFFER / 2;
}

void orl_body_flush(struct orl_body *body, const struct orl_folders *folders)
{
    if (body->failed || body->over)
        return;
    body->written += body->used;
    if (body->written > body->reserved) {
        if (orl_reservation_grow(body->reservation, body->written - body->reserved, &body->err)) {
            body->failed = true;
            body->used = 0;
            return;
        }
        body->reserved = body->written;
    }
    if (body->fd < 0) {
        orl_folders_temporary(folders, body->path);
        body->fd = open(body->path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    }
    if (body->fd < 0 || !orl_write_all(body->fd, body->buffer, body->used)) {
        body->failed = true;
        orl_error_set(&body->err, orl_err_of_errno(errno), "cannot store a request's body: %s",
                      strerror(errno));
    }
    body->used = 0;
}

static int copy_error(const struct orl_body *body, struct orl_error *err)
{
    if (err)
        *err = body->err;
    return body->err.code;
}

int orl_body_view(struct orl_body *body, const struct orl_folders *folders,
                  struct orl_file *ret_view, struct orl_error *err)
{
    if (body->fd >= 0 && body->used > 0)
        orl_body_flush(body, folders);
    if (body->failed)
        return copy_error(body, err);
    if (body->fd < 0) {
        *ret_view = (struct orl_file){body->buffer ? body->buffer : "", body->used, NULL};
        return 0;
    }
    if (!body->view.data) {
        const int rc = orl_map_file(body->path, &body->view, err);
        if (rc)
            return rc;
    }
    *ret_view = body->view;
    return 0;
}

int orl_body_file(struct orl_body *body, const struct orl_folders *folders, const char **ret_path,
                  struct orl_error *err)
{
    if (body->fd < 0 || body->used > 0)
        orl_body_flush(body, folders);
    if (body->failed)
        return copy_error(body, err);
    *ret_path = body->path;
    return 0;
}

int orl_body_take_file(struct orl_body *body, const struct orl_folders *folders,
                       char ret_path[ORL_PATH_MAX], struct orl_error *err)
{
    const char *path;
    const int rc = orl_body_file(body, folders, &path, err);
    if (rc)
        return rc;
    memcpy(ret_path, body->path, ORL_PATH_MAX);
    body->path[0] = '\0';
    return 0;
}
