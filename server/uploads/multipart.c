#include "uploads/uploads.h"

#include <errno.h>
#include <microhttpd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/array.h>

#include "process/limits.h"

enum { PROCESSOR_BUFFER = 64 << 10, FEED_BYTES = 1 << 20 };

/* A text field and its length. */
struct field {
    char **text;
    size_t length, capacity;
};

struct splitter {
    const struct orl_folders *folders;
    struct orl_multipart parts;
    struct field bsdfs, mains;
    struct orl_incoming file; /* the current file */
    int rc;
    struct orl_error *err;
};

bool orl_is_xml_name(const char *name)
{
    return orl_name_has_ending(name, ".xml");
}

/* Starts a file. A zip is kept separate until all parts are read. */
static int begin_file(struct splitter *s, const char *field, const char *name, const char *type)
{
    const bool resource = (field && strcmp(field, "resource") == 0) || orl_is_xml_name(name);
    const bool zip = orl_is_zip_type(type) || orl_name_has_ending(name, ".zip");
    orl_incoming_init(&s->file, zip ? &s->parts.zips : &s->parts.files);
    return orl_incoming_begin(&s->file, s->folders, name, resource, s->err);
}

static struct field *find_field(struct splitter *s, const char *name)
{
    if (name && strcmp(name, "bsdfs") == 0)
        return &s->bsdfs;
    return name && strcmp(name, "main") == 0 ? &s->mains : NULL;
}

static int append_to_field(struct splitter *s, const char *name, const char *data, size_t size)
{
    struct field *field = find_field(s, name);
    if (!field && errno == ENOMEM) /* for example for the name of a file */
        return orl_error_no_memory(s->err);
    if (!field) {
        orl_error_set(s->err, ORL_ERR_INVALID, "there is no form field '%.100s'", name ? name : "");
        orl_error_hint(
            s->err, "Send files as parts with a file name; 'bsdfs' and 'main' are the only fields");
        return ORL_ERR_INVALID;
    }
    if (field->length + size > ORL_SERVER_FIELD_BYTES)
        return orl_error_set(s->err, ORL_ERR_LIMIT, "the form field '%s' is too long", name);
    if (!orl_array_reserve_more(field->text, &field->capacity, field->length, size + 1, 1))
        return orl_error_no_memory(s->err);
    if (size > 0)
        memcpy(*field->text + field->length, data, size);
    field->length += size;
    (*field->text)[field->length] = '\0';
    return 0;
}

/* Starts a field. Each field "main" has one line, or several. */
static int begin_field(struct splitter *s, const char *field)
{
    return field && strcmp(field, "main") == 0 && s->parts.mains
               ? append_to_field(s, field, "\n", 1)
               : 0;
}

static enum MHD_Result on_data(void *ctx, enum MHD_ValueKind kind, const char *field,
                               const char *name, const char *type, const char *encoding,
                               const char *data, uint64_t offset, size_t size)
{
    (void)kind, (void)encoding;
    struct splitter *s = ctx;
    if (offset == 0) {
        orl_incoming_end(&s->file);
        s->rc = name ? begin_file(s, field, name, type) : begin_field(s, field);
    }
    if (s->rc == 0)
        s->rc = name ? orl_incoming_append(&s->file, data, size, s->err)
                     : append_to_field(s, field, data, size);
    return s->rc == 0 ? MHD_YES : MHD_NO;
}

static int feed_body(struct splitter *s, struct MHD_PostProcessor *processor,
                     const struct orl_file *body)
{
    size_t at = 0;
    while (at < body->size && s->rc == 0) {
        const size_t n = body->size - at < FEED_BYTES ? body->size - at : FEED_BYTES;
        errno = 0; /* libmicrohttpd continues when memory runs out, so errno is checked */
        const bool fed = MHD_post_process(processor, body->data + at, n) == MHD_YES;
        if (!fed && s->rc == 0 && errno == ENOMEM)
            s->rc = orl_error_no_memory(s->err);
        else if (!fed && s->rc == 0)
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
    struct splitter s = {.folders = folders, .file = {.fd = -1}, .err = err};
    s.bsdfs.text = &s.parts.bsdfs;
    s.mains.text = &s.parts.mains;
    errno = 0;
    struct MHD_PostProcessor *processor =
        MHD_create_post_processor(connection, PROCESSOR_BUFFER, on_data, &s);
    if (!processor && errno == ENOMEM)
        return orl_error_no_memory(err);
    if (!processor)
        return orl_error_set(err, ORL_ERR_SYNTAX,
                             "the Content-Type of the multipart body names no boundary, or one of "
                             "a single character");
    feed_body(&s, processor, body);
    if (MHD_destroy_post_processor(processor) != MHD_YES && s.rc == 0)
        s.rc = orl_error_set(err, ORL_ERR_SYNTAX, "the multipart/form-data body ends too early");
    orl_incoming_end(&s.file);
    if (s.rc)
        orl_multipart_done(&s.parts);
    else
        *ret_parts = s.parts;
    return s.rc;
}

void orl_multipart_done(struct orl_multipart *parts)
{
    orl_bundle_done(&parts->files);
    orl_bundle_done(&parts->zips);
    free(parts->bsdfs);
    free(parts->mains);
    parts->bsdfs = parts->mains = NULL;
}
