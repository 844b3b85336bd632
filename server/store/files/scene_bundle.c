#include "store/files/scene_bundle.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <oriel/base/array.h>
#include <oriel/base/limits.h>
#include <oriel/base/sha256.h>

#include "store/files/folders.h"

enum { NAME_MAX_BYTES = 255 };

static void file_done(struct orl_bundle_file *file)
{
    if (file->temporary)
        unlink(file->path);
    free(file->name);
    free(file->path);
}

void orl_bundle_done(struct orl_bundle *bundle)
{
    if (!bundle)
        return;
    for (size_t i = 0; i < bundle->count; i++)
        file_done(&bundle->files[i]);
    free(bundle->files);
    memset(bundle, 0, sizeof *bundle);
}

/* Returns true for well-formed UTF-8. Overlong forms and surrogates would give one name two
 * spellings. */
static bool is_utf8(const unsigned char *s)
{
    while (*s) {
        const int more = *s < 0x80 ? 0 : *s < 0xc2 ? -1 : *s < 0xe0 ? 1 : *s < 0xf0 ? 2 : 3;
        if (more < 0 || *s > 0xf4)
            return false;
        if ((*s == 0xe0 && s[1] < 0xa0) || (*s == 0xed && s[1] > 0x9f) ||
            (*s == 0xf0 && s[1] < 0x90) || (*s == 0xf4 && s[1] > 0x8f))
            return false;
        for (int i = 1; i <= more; i++)
            if ((s[i] & 0xc0) != 0x80)
                return false;
        s += more + 1;
    }
    return true;
}

static const char *name_fault(const char *name)
{
    const size_t length = strlen(name);
    if (length == 0)
        return "it is empty";
    if (length > NAME_MAX_BYTES)
        return "it is longer than 255 bytes";
    if (name[0] == '/')
        return "it must be relative";
    if (!is_utf8((const unsigned char *)name))
        return "it is not UTF-8";
    for (const char *c = name; *c; c++)
        if ((unsigned char)*c < 32 || *c == 127 || *c == '\\')
            return "it holds a control character or a backslash";
    for (const char *part = name; part;) {
        const size_t n = strcspn(part, "/");
        if (n == 0 || (n == 1 && part[0] == '.') || (n == 2 && part[0] == '.' && part[1] == '.'))
            return "a part of it is empty, '.' or '..'";
        part = part[n] ? part + n + 1 : NULL;
    }
    return NULL;
}

int orl_bundle_check_name(const char *name, struct orl_error *err)
{
    const char *fault = name_fault(name);
    if (!fault)
        return 0;
    /* The message repeats the name without characters that JSON or terminals cannot show. */
    char shown[81];
    snprintf(shown, sizeof shown, "%s", name);
    for (char *c = shown; *c; c++)
        if ((unsigned char)*c < 32 || (unsigned char)*c > 126)
            *c = '?';
    orl_error_set(err, ORL_ERR_INVALID, "the file name '%s' is refused: %s", shown, fault);
    orl_error_at(err, shown, 0, NULL);
    return ORL_ERR_INVALID;
}

int orl_bundle_add(struct orl_bundle *bundle, const char *name, bool resource, const char *path,
                   uint64_t bytes, const char *sha, bool temporary, struct orl_error *err)
{
    int rc = orl_bundle_check_name(name, err);
    if (rc)
        return rc;
    if (bundle->count >= ORL_LIMIT_SCENE_FILES)
        return orl_error_set(err, ORL_ERR_LIMIT, "more than %u files in one scene",
                             ORL_LIMIT_SCENE_FILES);
    for (size_t i = 0; i < bundle->count; i++)
        if (strcmp(bundle->files[i].name, name) == 0) {
            orl_error_set(err, ORL_ERR_INVALID, "two files are named '%s'", name);
            orl_error_at(err, name, 0, NULL);
            return ORL_ERR_INVALID;
        }
    struct orl_bundle_file file = {.bytes = bytes, .resource = resource, .temporary = temporary};
    file.name = strdup(name);
    file.path = strdup(path);
    if (!file.name || !file.path ||
        !orl_array_reserve(&bundle->files, &bundle->capacity, bundle->count, sizeof file)) {
        free(file.name);
        free(file.path);
        return orl_error_no_memory(err);
    }
    if (sha)
        snprintf(file.sha, sizeof file.sha, "%s", sha);
    bundle->files[bundle->count++] = file;
    return 0;
}

void orl_bundle_remove(struct orl_bundle *bundle, size_t index)
{
    file_done(&bundle->files[index]);
    bundle->count--;
    memmove(&bundle->files[index], &bundle->files[index + 1],
            (bundle->count - index) * sizeof *bundle->files);
}

int orl_bundle_move(struct orl_bundle *from, struct orl_bundle *bundle, struct orl_error *err)
{
    int rc = 0;
    for (size_t i = 0; i < from->count && rc == 0; i++) {
        struct orl_bundle_file *file = &from->files[i];
        rc = orl_bundle_add(bundle, file->name, file->resource, file->path, file->bytes, file->sha,
                            true, err);
        if (rc == 0)
            file->temporary = false;
    }
    return rc;
}

static bool comes_after(const struct orl_bundle_file *a, const struct orl_bundle_file *b)
{
    if (a->resource != b->resource)
        return a->resource;
    return a->resource && strcmp(a->name, b->name) > 0;
}

void orl_bundle_sort(struct orl_bundle *bundle)
{
    /* Insertion sort keeps the order of main files; there are at most 512 files. */
    for (size_t i = 1; i < bundle->count; i++) {
        const struct orl_bundle_file file = bundle->files[i];
        size_t k = i;
        for (; k > 0 && comes_after(&bundle->files[k - 1], &file); k--)
            bundle->files[k] = bundle->files[k - 1];
        bundle->files[k] = file;
    }
}

int orl_bundle_id(const struct orl_bundle *bundle, char ret_id[ORL_SHA_HEX], struct orl_error *err)
{
    struct orl_sha256 hash;
    char line[NAME_MAX_BYTES + ORL_SHA_HEX + 16];
    orl_sha256_init(&hash);
    orl_sha256_add(&hash, "oriel-scene 1\n", 14);
    for (size_t i = 0; i < bundle->count; i++) {
        const struct orl_bundle_file *file = &bundle->files[i];
        if (!orl_is_sha256(file->sha))
            return orl_error_set(err, ORL_ERR_INTERNAL, "file '%s' has no digest", file->name);
        const int n = snprintf(line, sizeof line, "%s %s %s\n",
                               file->resource ? "resource" : "main", file->sha, file->name);
        orl_sha256_add(&hash, line, (size_t)n);
    }
    orl_sha256_finish_hex(&hash, ret_id);
    return 0;
}

size_t orl_bundle_main_count(const struct orl_bundle *bundle)
{
    size_t count = 0;
    for (size_t i = 0; i < bundle->count; i++)
        count += !bundle->files[i].resource;
    return count;
}

uint64_t orl_bundle_bytes(const struct orl_bundle *bundle)
{
    uint64_t bytes = 0;
    for (size_t i = 0; i < bundle->count; i++)
        bytes += bundle->files[i].bytes;
    return bytes;
}

const struct orl_bundle_file *orl_bundle_find(const struct orl_bundle *bundle, const char *name)
{
    while (name[0] == '.' && name[1] == '/')
        name += 2;
    for (size_t i = 0; i < bundle->count; i++)
        if (strcmp(bundle->files[i].name, name) == 0)
            return &bundle->files[i];
    return NULL;
}

/*
 * Returns true if the file still has the uploaded bytes. Large BSDFs are not checked here: one that
 * was loaded before is not read again, and core/run/cache/parsed_scene_cache.c checks it when it is
 * read.
 */
static bool is_whole(const struct orl_bundle_file *file, const struct orl_file *data)
{
    enum { SMALL = 1 << 20 };
    const bool xml = orl_name_has_ending(file->name, ".xml");
    char sha[ORL_SHA_HEX];
    if (data->size != file->bytes)
        return false;
    if (!orl_is_sha256(file->sha) || (xml && data->size > SMALL))
        return true;
    orl_sha256_hex(data->data, data->size, sha);
    return strcmp(sha, file->sha) == 0;
}

int orl_bundle_verify_file(const struct orl_bundle_file *file, const struct orl_file *data,
                           struct orl_error *err)
{
    if (is_whole(file, data))
        return 0;
    orl_error_set(err, ORL_ERR_CORRUPT, "the file '%.200s' is damaged in the store", file->name);
    orl_error_hint(err, "Upload it again");
    return ORL_ERR_CORRUPT;
}

bool orl_bundle_other_case(const struct orl_bundle *bundle, const char *name, char *ret_name,
                           size_t size)
{
    if (strncmp(name, "./", 2) == 0)
        name += 2;
    for (size_t i = 0; i < bundle->count; i++)
        if (strcasecmp(bundle->files[i].name, name) == 0) {
            snprintf(ret_name, size, "%s", bundle->files[i].name);
            return true;
        }
    return false;
}

static bool provider_other_case(void *ctx, const char *name, char *ret_name, size_t size)
{
    return orl_bundle_other_case(ctx, name, ret_name, size);
}

int orl_bundle_refuse_missing(const struct orl_bundle *bundle, const char *name,
                              struct orl_error *err)
{
    const struct orl_files files = {.ctx = (void *)(uintptr_t)bundle,
                                    .other_case = provider_other_case};
    orl_error_set(err, ORL_ERR_NOT_FOUND, "no file named '%.200s' was uploaded", name);
    if (!orl_files_hint_case(&files, name, err))
        orl_error_hint(err, "Upload it with the scene, under the name that the scene uses");
    return ORL_ERR_NOT_FOUND;
}

static int provider_open(void *ctx, const char *name, struct orl_file *ret_file,
                         struct orl_error *err)
{
    const struct orl_bundle_file *file = orl_bundle_find(ctx, name);
    if (!file)
        return orl_bundle_refuse_missing(ctx, name, err);
    int rc = orl_map_file(file->path, ret_file, err);
    if (rc)
        return rc;
    rc = orl_bundle_verify_file(file, ret_file, err);
    if (rc)
        orl_unmap_file(ret_file);
    return rc;
}

/* Returns the digest that a blob is stored by. */
static bool provider_digest(void *ctx, const char *name, unsigned char ret_digest[32])
{
    const struct orl_bundle_file *file = orl_bundle_find(ctx, name);
    return file && orl_is_sha256(file->sha) &&
           sodium_hex2bin(ret_digest, 32, file->sha, 64, NULL, NULL, NULL) == 0;
}

static void provider_close(void *ctx, struct orl_file *file)
{
    (void)ctx;
    orl_unmap_file(file);
}

struct orl_files orl_bundle_provider(struct orl_bundle *bundle)
{
    return (struct orl_files){.ctx = bundle,
                              .open = provider_open,
                              .close = provider_close,
                              .digest = provider_digest,
                              .passed = orl_files_release_pages,
                              .other_case = provider_other_case};
}
