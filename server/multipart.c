#include "multipart.h"

#include <errno.h>
#include <fcntl.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "limits.h"

enum { PROCESSOR_BUFFER = 64 << 10, FEED_BYTES = 1 << 20 };

struct splitter {
    const struct orl_folders *folders;
    struct orl_multipart parts;
    int fd; /* of the file under way; -1 */
    crypto_hash_sha256_state hash;
    size_t field_bytes;
    int rc;
    struct orl_error *err;
};

bool orl_is_xml_name(const char *name)
{
    const size_t length = strlen(name);
    return length > 4 && strcasecmp(name + length - 4, ".xml") == 0;
}

/* Closes the file under way and notes its digest. */
static void finish_file(struct splitter *s)
{
    unsigned char digest[crypto_hash_sha256_BYTES];
    if (s->fd < 0)
        return;
    close(s->fd);
    s->fd = -1;
    struct orl_bundle_file *file = &s->parts.files.files[s->parts.files.count - 1];
    crypto_hash_sha256_final(&s->hash, digest);
    sodium_bin2hex(file->sha, sizeof file->sha, digest, sizeof digest);
}

static int begin_file(struct splitter *s, const char *field, const char *name)
{
    char path[ORL_PATH_MAX];
    orl_folders_temporary(s->folders, path);
    const bool resource = (field && strcmp(field, "resource") == 0) || orl_is_xml_name(name);
    const int rc = orl_bundle_add(&s->parts.files, name, resource, path, 0, NULL, true, s->err);
    if (rc)
        return rc;
    s->fd = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (s->fd < 0)
        return orl_error_set(s->err, ORL_ERR_IO, "cannot store a part: %s", strerror(errno));
    crypto_hash_sha256_init(&s->hash);
    return 0;
}

static int append_to_file(struct splitter *s, const char *data, size_t size)
{
    struct orl_bundle_file *file = &s->parts.files.files[s->parts.files.count - 1];
    file->bytes += size;
    if (file->bytes > ORL_LIMIT_FILE_BYTES) {
        orl_error_set(s->err, ORL_ERR_LIMIT, "the file is larger than %lu MiB",
                      ORL_LIMIT_FILE_BYTES >> 20);
        orl_error_at(s->err, file->name, 0, NULL);
        return ORL_ERR_LIMIT;
    }
    crypto_hash_sha256_update(&s->hash, (const unsigned char *)data, size);
    while (size > 0) {
        const ssize_t n = write(s->fd, data, size);
        if (n < 0 && errno != EINTR)
            return orl_error_set(s->err, ORL_ERR_IO, "cannot store a part: %s", strerror(errno));
        if (n > 0) {
            data += n;
            size -= (size_t)n;
        }
    }
    return 0;
}

static int append_to_field(struct splitter *s, const char *field, const char *data, size_t size)
{
    if (!field || strcmp(field, "bsdfs") != 0) {
        orl_error_set(s->err, ORL_ERR_INVALID, "there is no form field '%.100s'",
                      field ? field : "");
        orl_error_hint(s->err, "Send files as parts with a file name; 'bsdfs' is the only field");
        return ORL_ERR_INVALID;
    }
    if (size > ORL_SERVER_FIELD_BYTES - s->field_bytes)
        return orl_error_set(s->err, ORL_ERR_LIMIT, "the form field 'bsdfs' is too long");
    char *text = realloc(s->parts.bsdfs, s->field_bytes + size + 1);
    if (!text)
        return orl_error_set(s->err, ORL_ERR_NOMEM, "out of memory");
    memcpy(text + s->field_bytes, data, size);
    s->field_bytes += size;
    text[s->field_bytes] = '\0';
    s->parts.bsdfs = text;
    return 0;
}

static enum MHD_Result on_data(void *ctx, enum MHD_ValueKind kind, const char *field,
                               const char *name, const char *type, const char *encoding,
                               const char *data, uint64_t offset, size_t size)
{
    (void)kind, (void)type, (void)encoding;
    struct splitter *s = ctx;
    if (offset == 0) {
        finish_file(s);
        if (name)
            s->rc = begin_file(s, field, name);
    }
    if (s->rc == 0)
        s->rc = name ? append_to_file(s, data, size) : append_to_field(s, field, data, size);
    return s->rc == 0 ? MHD_YES : MHD_NO;
}

static int feed(struct splitter *s, struct MHD_PostProcessor *processor,
                const struct orl_file *body)
{
    size_t at = 0;
    while (at < body->size && s->rc == 0) {
        const size_t n = body->size - at < FEED_BYTES ? body->size - at : FEED_BYTES;
        if (MHD_post_process(processor, body->data + at, n) != MHD_YES && s->rc == 0)
            s->rc = orl_error_set(s->err, ORL_ERR_SYNTAX,
                                  "the multipart/form-data body is malformed near byte %zu", at);
        at += n;
    }
    return s->rc;
}

int orl_multipart_split(struct MHD_Connection *connection, const struct orl_file *body,
                        const struct orl_folders *folders, struct orl_multipart *ret_parts,
                        struct orl_error *err)
{
    struct splitter s = {.folders = folders, .fd = -1, .err = err};
    struct MHD_PostProcessor *processor =
        MHD_create_post_processor(connection, PROCESSOR_BUFFER, on_data, &s);
    if (!processor)
        return orl_error_set(err, ORL_ERR_SYNTAX,
                             "the Content-Type of the multipart body names no boundary, or one of "
                             "a single character");
    feed(&s, processor, body);
    if (MHD_destroy_post_processor(processor) != MHD_YES && s.rc == 0)
        s.rc = orl_error_set(err, ORL_ERR_SYNTAX, "the multipart/form-data body ends too early");
    finish_file(&s);
    if (s.rc)
        orl_multipart_done(&s.parts);
    else
        *ret_parts = s.parts;
    return s.rc;
}

void orl_multipart_done(struct orl_multipart *parts)
{
    orl_bundle_done(&parts->files);
    free(parts->bsdfs);
    parts->bsdfs = NULL;
}
