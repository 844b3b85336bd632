#include "support/zip.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>

#include <archive.h>
#include <archive_entry.h>
#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

struct writer {
    unsigned char *bytes;
    size_t size, room;
};

static void put_bytes(struct writer *w, const void *data, size_t size)
{
    if (size == 0)
        return;
    if (w->size + size > w->room) {
        w->room = 2 * (w->size + size);
        w->bytes = realloc(w->bytes, w->room);
        assert_non_null(w->bytes);
    }
    memcpy(w->bytes + w->size, data, size);
    w->size += size;
}

static void put_number(struct writer *w, uint64_t value, int bytes)
{
    for (int i = 0; i < bytes; i++) {
        const unsigned char byte = (unsigned char)(value >> (8 * i));
        put_bytes(w, &byte, 1);
    }
}

static uint32_t checksum(const char *data, size_t size)
{
    uint32_t crc = ~0U;
    for (size_t i = 0; i < size; i++) {
        crc ^= (unsigned char)data[i];
        for (int bit = 0; bit < 8; bit++)
            crc = crc & 1 ? crc >> 1 ^ 0xedb88320U : crc >> 1;
    }
    return ~crc;
}

/* Writes the fields that both headers of an entry share, from the flags to the length of the extra
 * field. */
static void put_common(struct writer *w, const struct zip_entry *entry)
{
    put_number(w, entry->flags, 2);
    put_number(w, entry->method, 2);
    put_number(w, 0x21 << 16, 4); /* the first of January 1980 */
    put_number(w, checksum(entry->data, entry->size) ^ entry->damage, 4);
    put_number(w, (uint32_t)entry->size, 4);
    put_number(w, (uint32_t)entry->size, 4);
    put_number(w, (uint32_t)strlen(entry->name), 2);
    put_number(w, 0, 2);
}

static void put_directory_entry(struct writer *w, const struct zip_entry *entry, uint32_t offset)
{
    const uint32_t mode = entry->mode ? entry->mode : 0100644;
    put_bytes(w, "PK\1\2", 4);
    put_number(w, 3 << 8 | 20, 2); /* made by Unix, version 2.0 */
    put_number(w, 20, 2);
    put_common(w, entry);
    put_number(w, 0, 6);
    put_number(w, mode << 16, 4);
    put_number(w, offset, 4);
    put_bytes(w, entry->name, strlen(entry->name));
}

char *zip_make(const struct zip_entry *entries, size_t count, size_t *ret_size)
{
    struct writer w = {0}, directory = {0};
    for (size_t i = 0; i < count; i++) {
        put_directory_entry(&directory, &entries[i], (uint32_t)w.size);
        put_bytes(&w, "PK\3\4", 4);
        put_number(&w, 20, 2);
        put_common(&w, &entries[i]);
        put_bytes(&w, entries[i].name, strlen(entries[i].name));
        put_bytes(&w, entries[i].data, entries[i].size);
    }
    const size_t start = w.size;
    put_bytes(&w, directory.bytes, directory.size);
    put_bytes(&w, "PK\5\6", 4);
    put_number(&w, 0, 4);
    put_number(&w, (uint32_t)count, 2);
    put_number(&w, (uint32_t)count, 2);
    put_number(&w, (uint32_t)directory.size, 4);
    put_number(&w, (uint32_t)start, 4);
    put_number(&w, 0, 2);
    free(directory.bytes);
    *ret_size = w.size;
    return (char *)w.bytes;
}

char *zip_make_bomb(const char *name, size_t zeros, size_t *ret_size)
{
    enum { CHUNK = 1 << 20 };
    const size_t room = CHUNK + zeros / 500;
    char *bytes = malloc(room), *chunk = calloc(1, CHUNK);
    struct archive *archive = archive_write_new();
    struct archive_entry *entry = archive_entry_new();
    assert_true(bytes && chunk && archive && entry);
    assert_int_equal(archive_write_set_format_zip(archive), ARCHIVE_OK);
    assert_int_equal(archive_write_open_memory(archive, bytes, room, ret_size), ARCHIVE_OK);
    archive_entry_set_pathname(entry, name);
    archive_entry_set_filetype(entry, AE_IFREG);
    archive_entry_set_size(entry, (la_int64_t)zeros);
    assert_int_equal(archive_write_header(archive, entry), ARCHIVE_OK);
    for (size_t left = zeros; left > 0;) {
        const size_t n = left < CHUNK ? left : CHUNK;
        assert_int_equal(archive_write_data(archive, chunk, n), (int)n);
        left -= n;
    }
    assert_int_equal(archive_write_close(archive), ARCHIVE_OK);
    archive_write_free(archive);
    archive_entry_free(entry);
    free(chunk);
    return bytes;
}
