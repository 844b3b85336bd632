#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include <sys/socket.h>
#include <sys/uio.h>

#include <oriel/base/array.h>

#include "checks/child/messages.h"
#include "store/files/folders.h"
#include "json/encode.h"

bool orl_frame_send(int fd, enum orl_frame_kind kind, const void *data, size_t size)
{
    char first = (char)kind;
    struct iovec parts[2] = {{&first, 1}, {(void *)(uintptr_t)data, size}};
    const struct msghdr message = {.msg_iov = parts, .msg_iovlen = size > 0 ? 2 : 1};
    ssize_t sent;
    do
        sent = sendmsg(fd, &message, MSG_NOSIGNAL);
    while (sent < 0 && errno == EINTR);
    return sent >= 0;
}

bool orl_frame_send_text(int fd, enum orl_frame_kind part, enum orl_frame_kind end,
                         const char *text, size_t size)
{
    for (; size > ORL_FRAME_BYTES; text += ORL_FRAME_BYTES, size -= ORL_FRAME_BYTES)
        if (!orl_frame_send(fd, part, text, ORL_FRAME_BYTES))
            return false;
    return orl_frame_send(fd, end, text, size);
}

bool orl_frame_text_add(struct orl_frame_text *text, const char *data, size_t size, size_t most)
{
    if (size > most - text->size ||
        !orl_array_reserve_more(&text->text, &text->capacity, text->size, size + 1, 1))
        return false;
    if (size > 0)
        memcpy(text->text + text->size, data, size);
    text->size += size;
    text->text[text->size] = '\0';
    return true;
}

json_t *orl_counts_to_json(uint64_t *const places[], size_t n)
{
    json_t *counts = json_array();
    for (size_t i = 0; i < n; i++)
        counts = orl_json_append(counts, json_integer((json_int_t)*places[i]));
    return counts;
}

bool orl_counts_from_json(const json_t *counts, uint64_t *const places[], size_t n)
{
    bool good = json_array_size(counts) == n;
    for (size_t i = 0; i < n && good; i++) {
        const json_int_t value = json_integer_value(json_array_get(counts, i));
        good = value >= 0;
        *places[i] = good ? (uint64_t)value : 0;
    }
    return good;
}

json_t *orl_mapped_inputs_to_json(const struct orl_bundle *bundle)
{
    json_t *files = json_array();
    for (size_t i = 0; files && i < bundle->count; i++) {
        const struct orl_bundle_file *file = &bundle->files[i];
        json_t *entry = json_pack("{s:s, s:s, s:s, s:I, s:b, s:b}", "name", file->name, "path",
                                  file->path, "sha", file->sha, "bytes", (json_int_t)file->bytes,
                                  "resource", (int)file->resource, "fresh", (int)file->temporary);
        files = orl_json_append(files, entry);
    }
    return files;
}

/* ---- Mapped files --------------------------------------------------------------------------- */

/* Maps one file. A file that was just written is not read again to verify its digest. */
static int open_file(struct orl_mapped_inputs *mapped, const json_t *entry, struct orl_error *err)
{
    const char *name = json_string_value(json_object_get(entry, "name"));
    const char *path = json_string_value(json_object_get(entry, "path"));
    const char *sha = json_string_value(json_object_get(entry, "sha"));
    const bool fresh = json_is_true(json_object_get(entry, "fresh"));
    struct orl_file *data = &mapped->data[mapped->bundle.count];
    if (!name || !path || !sha)
        return orl_error_set(err, ORL_ERR_INTERNAL, "the request to the check process is invalid");
    int rc = orl_bundle_add(&mapped->bundle, name, json_is_true(json_object_get(entry, "resource")),
                            path, (uint64_t)json_integer_value(json_object_get(entry, "bytes")),
                            sha, false, err);
    if (rc == 0)
        rc = orl_map_file(path, data, err);
    const struct orl_bundle_file *file = &mapped->bundle.files[mapped->bundle.count - 1];
    if (rc == 0 && !fresh)
        rc = orl_bundle_verify_file(file, data, err);
    return rc;
}

int orl_mapped_inputs_open(const json_t *request, struct orl_mapped_inputs *ret_mapped,
                           struct orl_error *err)
{
    const json_t *files = json_object_get(request, "files");
    const char *path = json_string_value(json_object_get(request, "path"));
    int rc = 0;
    ret_mapped->data = calloc(json_array_size(files) + 1, sizeof *ret_mapped->data);
    if (!ret_mapped->data)
        return orl_error_no_memory(err);
    for (size_t i = 0; i < json_array_size(files) && rc == 0; i++)
        rc = open_file(ret_mapped, json_array_get(files, i), err);
    if (rc == 0 && path)
        rc = orl_map_file(path, &ret_mapped->single, err);
    return rc;
}

static int provider_open(void *ctx, const char *name, struct orl_file *ret_file,
                         struct orl_error *err)
{
    const struct orl_mapped_inputs *mapped = ctx;
    const struct orl_bundle_file *file = orl_bundle_find(&mapped->bundle, name);
    if (!file)
        return orl_bundle_refuse_missing(&mapped->bundle, name, err);
    *ret_file = mapped->data[file - mapped->bundle.files];
    return 0;
}

static bool provider_other_case(void *ctx, const char *name, char *ret_name, size_t size)
{
    const struct orl_mapped_inputs *mapped = ctx;
    return orl_bundle_other_case(&mapped->bundle, name, ret_name, size);
}

static void provider_close(void *ctx, struct orl_file *file)
{
    (void)ctx, (void)file;
}

struct orl_files orl_mapped_inputs_provider(struct orl_mapped_inputs *mapped)
{
    return (struct orl_files){.ctx = mapped,
                              .open = provider_open,
                              .close = provider_close,
                              .passed = orl_files_release_pages,
                              .other_case = provider_other_case};
}
