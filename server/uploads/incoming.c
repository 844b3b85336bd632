#include "uploads/uploads.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <unistd.h>

#include <oriel/base/sha256.h>

#include "process/limits.h"

void orl_incoming_init(struct orl_incoming *incoming, struct orl_bundle *bundle)
{
    *incoming = (struct orl_incoming){.bundle = bundle, .fd = -1};
}

static struct orl_bundle_file *current_file(const struct orl_incoming *incoming)
{
    return &incoming->bundle->files[incoming->bundle->count - 1];
}

int orl_incoming_begin(struct orl_incoming *incoming, const struct orl_folders *folders,
                       const char *name, bool resource, struct orl_error *err)
{
    char path[ORL_PATH_MAX] = "";
    if (!incoming->sink)
        orl_folders_temporary(folders, path);
    const int rc =
        orl_bundle_add(incoming->bundle, name, resource, path, 0, NULL, !incoming->sink, err);
    if (rc)
        return rc;
    if (incoming->sink)
        return incoming->sink->file(incoming->sink->ctx, name, err);
    incoming->fd = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (incoming->fd < 0)
        return orl_error_set(err, orl_err_of_errno(errno), "cannot store a file of the upload: %s",
                             strerror(errno));
    incoming->reservation = folders->reservation;
    orl_sha256_init(&incoming->hash);
    return 0;
}

int orl_incoming_append(struct orl_incoming *incoming, const char *data, size_t size,
                        struct orl_error *err)
{
    struct orl_bundle_file *file = current_file(incoming);
    file->bytes += size;
    if (file->bytes > ORL_LIMIT_FILE_BYTES) {
        orl_error_set(err, ORL_ERR_LIMIT, "the file is larger than %lu MiB",
                      ORL_LIMIT_FILE_BYTES >> 20);
        orl_error_at(err, file->name, 0, NULL);
        return ORL_ERR_LIMIT;
    }
    if (incoming->sink)
        return incoming->sink->data(incoming->sink->ctx, data, size, err);
    const int rc = orl_reservation_grow(incoming->reservation, size, err);
    if (rc)
        return rc;
    orl_sha256_add(&incoming->hash, data, size);
    return orl_write_all(incoming->fd, data, size)
               ? 0
               : orl_error_set(err, orl_err_of_errno(errno),
                               "cannot store a file of the upload: %s", strerror(errno));
}

void orl_incoming_end(struct orl_incoming *incoming)
{
    if (incoming->fd < 0)
        return;
    close(incoming->fd);
    incoming->fd = -1;
    orl_sha256_finish_hex(&incoming->hash, current_file(incoming)->sha);
}
