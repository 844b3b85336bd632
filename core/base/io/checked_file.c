#include "base/io/checked_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <oriel/base/files.h>
#include <sys/mman.h>
#include <sys/stat.h>

#include "base/memory/memory.h"

struct header {
    char magic[8];
    uint32_t version, byte_order;
    uint64_t shape;
    uint64_t size; /* file size, bytes */
    unsigned char content[ORL_CHECKED_FILE_CONTENT];
    unsigned char checksum[ORL_CHECKSUM_BYTES]; /* checksum of all data after the header */
    unsigned char reserved[32];                 /* 0 */
    unsigned char of_header[ORL_CHECKSUM_BYTES];
};
_Static_assert(sizeof(struct header) == ORL_CHECKED_FILE_HEADER, "a multiple of 64");

enum { STEP = 16 << 20 };
static const uint32_t byte_order = 0x01020304U;

/* ---- Writing --------------------------------------------------------------------------------- */

static void write_all(struct orl_checked_writer *writer, const char *data, size_t size)
{
    while (size > 0 && writer->error == 0) {
        const ssize_t n = write(writer->fd, data, size);
        if (n < 0 && errno != EINTR)
            writer->error = errno;
        data += n > 0 ? n : 0;
        size -= n > 0 ? (size_t)n : 0;
    }
}

static void flush_buffer(struct orl_checked_writer *writer)
{
    write_all(writer, writer->buffer, writer->filled);
    writer->filled = 0;
}

int orl_checked_writer_begin(struct orl_checked_writer *writer,
                             const struct orl_checked_file_kind *kind, const char *path,
                             struct orl_error *err)
{
    static const struct header none;
    *writer = (struct orl_checked_writer){.kind = kind, .path = path, .size = sizeof none};
    orl_checksum_init(&writer->sum);
    writer->fd = orl_open_regular(path, O_WRONLY | O_CREAT | O_TRUNC);
    if (writer->fd < 0)
        return orl_error_set(err, orl_err_of_errno(errno), "cannot write the %s '%s': %s",
                             kind->what, path, orl_open_reason(errno));
    write_all(writer, (const char *)&none, sizeof none);
    return 0;
}

void orl_checked_writer_put(struct orl_checked_writer *writer, const void *data, size_t bytes)
{
    orl_checksum_add(&writer->sum, data, bytes);
    writer->size += bytes;
    if (writer->filled + bytes > ORL_CHECKED_WRITER_BUFFER)
        flush_buffer(writer);
    if (bytes > ORL_CHECKED_WRITER_BUFFER / 2) {
        flush_buffer(writer);
        write_all(writer, data, bytes);
    } else if (data && bytes > 0) {
        memcpy(writer->buffer + writer->filled, data, bytes);
        writer->filled += bytes;
    }
}

void orl_checked_writer_align(struct orl_checked_writer *writer, size_t step)
{
    static const char zeros[ORL_CHECKED_FILE_BOUNDARY];
    orl_checked_writer_put(writer, zeros, (step - writer->size % step) % step);
}

int orl_checked_writer_end(struct orl_checked_writer *writer,
                           const unsigned char content[ORL_CHECKED_FILE_CONTENT],
                           uint64_t *ret_bytes, struct orl_error *err)
{
    const struct orl_checked_file_kind *const kind = writer->kind;
    struct header h = {.version = kind->version,
                       .byte_order = byte_order,
                       .shape = kind->shape,
                       .size = writer->size};
    memcpy(h.magic, kind->magic, sizeof h.magic);
    memcpy(h.content, content, sizeof h.content);
    orl_checksum_finish(&writer->sum, h.checksum);
    orl_checksum_of(&h, offsetof(struct header, of_header), h.of_header);
    flush_buffer(writer);
    if (writer->error == 0 && lseek(writer->fd, 0, SEEK_SET) != 0)
        writer->error = errno;
    write_all(writer, (const char *)&h, sizeof h);
    if (close(writer->fd) != 0 && writer->error == 0) /* may report a write error */
        writer->error = errno;
    *ret_bytes = h.size;
    if (writer->error == 0)
        return 0;
    unlink(writer->path);
    return orl_error_set(err, orl_err_of_errno(writer->error), "cannot write the %s '%s': %s",
                         kind->what, writer->path, strerror(writer->error));
}

/* ---- Opening --------------------------------------------------------------------------------- */

static int map_file(const struct orl_checked_file_kind *kind, const char *path,
                    struct orl_checked_file *ret_file, struct orl_error *err)
{
    const int fd = orl_open_regular(path, O_RDONLY);
    struct stat st;
    int code = 0;
    if (fd < 0)
        return orl_error_set(err, orl_open_err_of_stored(errno), "cannot open the %s '%s': %s",
                             kind->what, path, orl_open_reason(errno));
    if (fstat(fd, &st) != 0 || st.st_size < ORL_CHECKED_FILE_HEADER) {
        code = orl_error_set(err, ORL_ERR_CORRUPT, "the cached %s '%s' is truncated", kind->what,
                             path);
    } else {
        const size_t size = (size_t)st.st_size;
        void *const data = mmap(NULL, size, PROT_READ, MAP_SHARED, fd, 0);
        if (data == MAP_FAILED)
            code = orl_error_set(err, ORL_ERR_IO, "cannot map the %s '%s': %s", kind->what, path,
                                 strerror(errno));
        else
            *ret_file = (struct orl_checked_file){data, size};
    }
    close(fd);
    return code;
}

/* Computes the checksum of the body. Pages of a large file are released after reading; later
 * accesses load them again. */
static void sum_body(const struct orl_checked_file *file, unsigned char ret_sum[ORL_CHECKSUM_BYTES])
{
    struct orl_checksum sum;
    orl_checksum_init(&sum);
    for (size_t at = ORL_CHECKED_FILE_HEADER; at < file->size;) {
        const size_t end = file->size - at < STEP ? file->size : at + STEP;
        orl_checksum_add(&sum, file->data + at, end - at);
        if (file->size > STEP)
            madvise(file->data, end / STEP * STEP, MADV_DONTNEED);
        at = end;
    }
    orl_checksum_finish(&sum, ret_sum);
}

static int check_contents(const struct orl_checked_file_kind *kind,
                          const struct orl_checked_file *file, const unsigned char *content,
                          const char *path, struct orl_error *err)
{
    const struct header *const h = (const void *)file->data;
    unsigned char sum[ORL_CHECKSUM_BYTES];
    if (memcmp(h->magic, kind->magic, sizeof h->magic) != 0)
        return orl_error_set(err, ORL_ERR_CORRUPT, "'%s' is not a cached %s", path, kind->what);
    if (h->version != kind->version || h->byte_order != byte_order || h->shape != kind->shape)
        return orl_error_set(err, ORL_ERR_VERSION, "'%s' is a cached %s of another version", path,
                             kind->what);
    orl_checksum_of(h, offsetof(struct header, of_header), sum);
    if (memcmp(sum, h->of_header, sizeof sum) != 0 || h->size != file->size ||
        memcmp(h->content, content, ORL_CHECKED_FILE_CONTENT) != 0)
        return orl_error_set(err, ORL_ERR_CORRUPT,
                             "the cached %s '%s' is truncated, damaged or from another file",
                             kind->what, path);
    sum_body(file, sum);
    if (memcmp(sum, h->checksum, sizeof sum) != 0)
        return orl_error_set(err, ORL_ERR_CORRUPT, "the cached %s '%s' fails its checksum",
                             kind->what, path);
    return 0;
}

int orl_checked_file_open(const struct orl_checked_file_kind *kind, const char *path,
                          const unsigned char content[ORL_CHECKED_FILE_CONTENT],
                          struct orl_checked_file *ret_file, struct orl_error *err)
{
    struct orl_checked_file file = {0};
    int code = map_file(kind, path, &file, err);
    if (!file.data)
        return code;
    if (code == 0)
        code = check_contents(kind, &file, content, path, err);
    if (code == 0)
        *ret_file = file;
    else
        orl_checked_file_close(&file);
    return code;
}

void orl_checked_file_close(struct orl_checked_file *file)
{
    if (file->data)
        munmap(file->data, file->size);
    *file = (struct orl_checked_file){0};
}

enum { ALIGNMENT = 16 };

struct orl_serializer orl_serializer_to(struct orl_checked_writer *out)
{
    return (struct orl_serializer){.out = out};
}

struct orl_serializer orl_serializer_from(const struct orl_checked_file *file)
{
    return (struct orl_serializer){.begin = file->data,
                                   .at = file->data + ORL_CHECKED_FILE_HEADER,
                                   .end = file->data + file->size};
}

void orl_serializer_fail(struct orl_serializer *serializer, int code)
{
    if (serializer->code == 0)
        serializer->code = code;
}

/* Returns true if so many items can still be read. */
static bool has_left(struct orl_serializer *serializer, size_t count, size_t item)
{
    if (item > 0 && count > (size_t)(serializer->end - serializer->at) / item)
        orl_serializer_fail(serializer, ORL_ERR_CORRUPT);
    return serializer->code == 0;
}

void orl_serialize_bytes(struct orl_serializer *serializer, void *data, size_t bytes)
{
    if (serializer->out) {
        orl_checked_writer_put(serializer->out, data, bytes);
    } else if (!has_left(serializer, bytes, 1)) {
        memset(data, 0, bytes);
    } else if (bytes > 0) {
        memcpy(data, serializer->at, bytes);
        serializer->at += bytes;
    }
}

void orl_serializer_alloc(struct orl_serializer *serializer, void *slot, size_t count, size_t item)
{
    if (serializer->out || !has_left(serializer, count, 1))
        return;
    void *const made = calloc(count + 1, item);
    if (!made)
        orl_serializer_fail(serializer, ORL_ERR_NOMEM);
    memcpy(slot, &made, sizeof made);
}

static void pass_array(struct orl_serializer *serializer, struct orl_arena *arena, void *slot,
                       size_t bytes)
{
    void *data = NULL;
    if (serializer->out) {
        memcpy(&data, slot, sizeof data);
    } else if (has_left(serializer, bytes, 1)) {
        data = arena ? orl_arena_alloc(arena, bytes) : malloc(bytes);
        if (!data)
            orl_serializer_fail(serializer, ORL_ERR_NOMEM);
        memcpy(slot, &data, sizeof data);
    }
    if (data)
        orl_serialize_bytes(serializer, data, bytes);
}

void orl_serialize_array(struct orl_serializer *serializer, void *slot, size_t count, size_t item)
{
    if (serializer->out || has_left(serializer, count, item))
        pass_array(serializer, NULL, slot, count * item);
}

void orl_serialize_arena_array(struct orl_serializer *serializer, struct orl_arena *arena,
                               void *slot, size_t count, size_t item)
{
    static void *const none = NULL;
    if (count == 0 && orl_serializer_reads(serializer))
        memcpy(slot, &none, sizeof none);
    else if (count > 0 && (serializer->out || has_left(serializer, count, item)))
        pass_array(serializer, arena, slot, count * item);
}

void orl_serialize_text(struct orl_serializer *serializer, struct orl_arena *arena,
                        const char **text)
{
    uint32_t length = serializer->out && *text ? (uint32_t)strlen(*text) + 1 : 0;
    orl_serialize_value(serializer, &length);
    if (serializer->out) {
        orl_serialize_bytes(serializer, (void *)(uintptr_t)*text, length);
        return;
    }
    *text = NULL;
    if (length == 0 || !has_left(serializer, length, 1))
        return;
    *text = orl_arena_copy_text(arena, serializer->at, length - 1);
    if (!*text)
        orl_serializer_fail(serializer, ORL_ERR_NOMEM);
    serializer->at += length;
}

const void *orl_serialize_in_place(struct orl_serializer *serializer, const void *data,
                                   size_t bytes)
{
    if (serializer->out) {
        orl_checked_writer_align(serializer->out, ALIGNMENT);
        orl_checked_writer_put(serializer->out, data, bytes);
        return data;
    }
    const size_t at = (size_t)(serializer->at - serializer->begin);
    const size_t skipped = (ALIGNMENT - at % ALIGNMENT) % ALIGNMENT;
    if (!has_left(serializer, skipped, 1))
        return NULL;
    serializer->at += skipped;
    if (!has_left(serializer, bytes, 1))
        return NULL;
    const void *const here = serializer->at;
    serializer->at += bytes;
    return here;
}
