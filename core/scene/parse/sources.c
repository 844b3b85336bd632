#include "scene/parse/parse.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include <oriel/base/limits.h>

#include "base/memory/memory.h"

void orl_sources_init(struct orl_sources *sources, const struct orl_files *files,
                      const struct orl_bsdf_loader *loader, struct orl_arena *arena)
{
    memset(sources, 0, sizeof *sources);
    sources->files = files;
    sources->loader = loader;
    sources->arena = arena;
    orl_sha256_init(&sources->digest);
}

bool orl_sources_is_resource(const char *name)
{
    const size_t length = strlen(name);
    return length >= 4 && strcasecmp(name + length - 4, ".xml") == 0;
}

static void close_item(struct orl_sources *sources, struct orl_source *item)
{
    if (item->open)
        sources->files->close(sources->files->ctx, &item->file);
    item->open = false;
}

void orl_sources_done(struct orl_sources *sources)
{
    for (size_t i = 0; i < sources->count; i++) {
        close_item(sources, sources->items + i);
        orl_bsdf_unref(sources->items[i].bsdf);
    }
    free(sources->items);
    free(sources->missing);
    memset(sources, 0, sizeof *sources);
}

/* Appends a path segment to path, and resolves "." and ".."; length: of path so far. */
static size_t add_segment(char *path, size_t length, const char *segment, size_t size)
{
    if (size == 0 || (size == 1 && segment[0] == '.'))
        return length;
    if (size == 2 && segment[0] == '.' && segment[1] == '.' && length > 0) {
        size_t cut = length;
        while (cut > 0 && path[cut - 1] != '/')
            cut--;
        if (length - cut != 2 || memcmp(path + cut, "..", 2) != 0)
            return cut > 1 ? cut - 1 : cut; /* a leading '/' stays */
    }
    if (length > 0 && path[length - 1] != '/')
        path[length++] = '/';
    memcpy(path + length, segment, size);
    return length + size;
}

enum { PATH_BYTES = 2 * ORL_LIMIT_WORD_BYTES };

/* Joins folder/name in its shortest form. Returns false if the result is empty or too long. */
static bool join_path(const char *folder, const char *name, char path[PATH_BYTES])
{
    const char *const parts[2] = {*name == '/' ? "" : folder, name};
    size_t length = 0;
    if (strlen(parts[0]) + strlen(name) + 3 > PATH_BYTES)
        return false;
    if (*name == '/' || *folder == '/')
        path[length++] = '/';
    for (int part = 0; part < 2; part++) {
        for (const char *at = parts[part]; *at;) {
            const size_t size = strcspn(at, "/");
            length = add_segment(path, length, at, size);
            at += size + (at[size] == '/');
        }
    }
    path[length] = '\0';
    return length > 0;
}

void orl_sources_count_again(struct orl_sources *sources, size_t index)
{
    const struct orl_source *item = sources->items + index;
    unsigned char length[8];
    for (int i = 0; i < 8; i++)
        length[i] = (unsigned char)((uint64_t)item->file.size >> (8 * i));
    orl_sha256_add(&sources->digest, length, sizeof length);
    orl_sha256_add(&sources->digest, item->content, sizeof item->content);
}

static int make_room(struct orl_sources *sources, struct orl_error *err)
{
    if (sources->count >= ORL_LIMIT_SCENE_FILES)
        return orl_error_set(err, ORL_ERR_LIMIT, "the scene has more than %u files",
                             ORL_LIMIT_SCENE_FILES);
    return orl_array_reserve(&sources->items, &sources->room, sources->count,
                             sizeof *sources->items)
               ? 0
               : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
}

static void find_digest(const struct orl_sources *sources, struct orl_source *item)
{
    const size_t step = 4 << 20, size = item->file.size;
    const struct orl_files *files = sources->files;
    struct orl_sha256 hash;
    if (files->digest && files->digest(files->ctx, item->name, item->content))
        return;
    orl_sha256_init(&hash);
    for (size_t at = 0; at < size; at += step) {
        orl_sha256_add(&hash, item->file.data + at, size - at < step ? size - at : step);
        if (files->passed && size - at > step)
            files->passed(files->ctx, &item->file, at, at + step);
    }
    orl_sha256_finish(&hash, item->content);
}

/* Records a name that was not found; out of memory counts as too many. */
static void add_missing(struct orl_sources *sources, const char *name, bool library)
{
    for (size_t i = 0; i < sources->n_missing && i < ORL_MISSING_FILES_MAX; i++)
        if (sources->missing[i].library == library && strcmp(sources->missing[i].name, name) == 0)
            return;
    if (sources->n_missing > ORL_MISSING_FILES_MAX)
        return;
    if (!orl_array_reserve(&sources->missing, &sources->missing_room, sources->n_missing,
                           sizeof *sources->missing)) {
        sources->n_missing = ORL_MISSING_FILES_MAX + 1;
        return;
    }
    const char *const kept = orl_arena_copy_text(sources->arena, name, strlen(name));
    sources->missing[sources->n_missing] = (struct orl_missing_file){kept, library};
    sources->n_missing = kept ? sources->n_missing + 1 : ORL_MISSING_FILES_MAX + 1;
}

/* Opens and hashes a file under its resolved name: the scene's own, or the user's library's. */
static int add_item(struct orl_sources *sources, const char *name, bool library,
                    struct orl_error *err)
{
    const struct orl_files *const files = sources->files;
    int code = make_room(sources, err);
    if (code < 0)
        return code;
    struct orl_source *item = sources->items + sources->count;
    memset(item, 0, sizeof *item);
    code = (library ? files->library : files->open)(files->ctx, name, &item->file, err);
    if (code == ORL_ERR_NOT_FOUND)
        add_missing(sources, name, library);
    if (code < 0)
        return code;
    item->open = true;
    item->library = library;
    const char *const slash = strrchr(name, '/');
    item->name = orl_arena_copy_text(sources->arena, name, strlen(name));
    item->folder = orl_arena_copy_text(sources->arena, name,
                                       !slash          ? 0
                                       : slash == name ? 1
                                                       : (size_t)(slash - name));
    sources->count++;
    if (!item->name || !item->folder)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    if (item->file.size > ORL_LIMIT_FILE_BYTES)
        return orl_error_set(err, ORL_ERR_LIMIT, "'%.200s' is larger than %lu MiB", name,
                             ORL_LIMIT_FILE_BYTES >> 20);
    find_digest(sources, item);
    orl_sources_count_again(sources, sources->count - 1);
    return 0;
}

static int find_as(struct orl_sources *sources, const char *name, bool library, size_t *ret_index,
                   struct orl_error *err)
{
    for (size_t i = 0; i < sources->count; i++) {
        if (strcmp(sources->items[i].name, name) == 0) {
            *ret_index = i;
            return 0;
        }
    }
    const int code = add_item(sources, name, library, err);
    if (code == 0)
        *ret_index = sources->count - 1;
    return code;
}

int orl_sources_open(struct orl_sources *sources, const char *name, bool library, size_t *ret_index,
                     struct orl_error *err)
{
    return library && !sources->files->library ? ORL_ERR_NOT_FOUND
                                               : find_as(sources, name, library, ret_index, err);
}

void orl_sources_hint(struct orl_error *err)
{
    orl_error_hint(err, "files are searched in the folder of the file that names them, then in the "
                        "scene's folder: put it there, or remove the reference");
}

static int find_from(struct orl_sources *sources, const char *folder, const char *name,
                     size_t *ret_index, struct orl_error *err)
{
    char path[PATH_BYTES], plain[PATH_BYTES];
    struct orl_error first = {0};
    if (!join_path(folder, name, path) || !join_path("", name, plain))
        return orl_error_set(err, ORL_ERR_SYNTAX, "'%.200s' is not a file name", name);
    int code = find_as(sources, path, false, ret_index, &first);
    if (code == ORL_ERR_NOT_FOUND && strcmp(path, plain) != 0) {
        code = find_as(sources, plain, false, ret_index, err);
        if (code == ORL_ERR_NOT_FOUND)
            orl_error_set(err, code, "no file named '%.200s', nor '%.200s'", path, plain);
    } else if (code < 0 && err) {
        *err = first;
    }
    if (code == ORL_ERR_NOT_FOUND && !orl_files_hint_case(sources->files, path, err) &&
        !orl_files_hint_case(sources->files, plain, err))
        orl_sources_hint(err);
    return code;
}

/* Files written on Windows have '\\' between folders: a name that is not found is tried again with
 * '/'. */
int orl_sources_find_own(struct orl_sources *sources, const char *folder, const char *name,
                         size_t *ret_index, struct orl_error *err)
{
    char turned[PATH_BYTES];
    struct orl_error first = {0}, second = {0};
    const size_t length = strlen(name);
    const struct orl_error *last = &first;
    int code = find_from(sources, folder, name, ret_index, &first);
    if (code == ORL_ERR_NOT_FOUND && strchr(name, '\\') && length < sizeof turned) {
        for (size_t i = 0; i <= length; i++)
            turned[i] = (char)(name[i] == '\\' ? '/' : name[i]);
        code = find_from(sources, folder, turned, ret_index, &second);
        last = code == ORL_ERR_NOT_FOUND ? &first : &second;
    }
    if (code < 0 && err) /* no error remains if the second name was found */
        *err = *last;
    return code;
}

int orl_sources_find(struct orl_sources *sources, const char *folder, const char *name,
                     size_t *ret_index, struct orl_error *err)
{
    const bool library = sources->files->library != NULL;
    struct orl_error first = {0}, second = {0};
    const struct orl_error *last = &first;
    int code = orl_sources_find_own(sources, folder, name, ret_index, &first);
    if (code == ORL_ERR_NOT_FOUND && library && *name != '/' && *name != '.') {
        code = find_as(sources, name, true, ret_index, &second);
        last = code == ORL_ERR_NOT_FOUND ? &first : &second;
    }
    if (code < 0 && err) /* the library's failure adds no information */
        *err = *last;
    return code;
}

/* A file that is being read, and its provider. */
struct reading {
    const struct orl_files *files;
    const struct orl_file *file;
};

static void report_passed(void *ctx, size_t begin, size_t end)
{
    const struct reading *reading = ctx;
    reading->files->passed(reading->files->ctx, reading->file, begin, end);
}

static int load_bsdf(const struct orl_sources *sources, struct orl_source *item,
                     struct orl_error *err)
{
    const struct orl_bsdf_loader *loader = sources->loader;
    struct reading reading = {sources->files, &item->file};
    const struct orl_bsdf_xml xml = {.name = item->name,
                                     .data = item->file.data,
                                     .size = item->file.size,
                                     .passed = sources->files->passed ? report_passed : NULL,
                                     .ctx = &reading,
                                     .cancel = loader ? loader->cancel : NULL};
    return loader && loader->load ? loader->load(loader->ctx, &xml, item->content, &item->bsdf, err)
                                  : orl_bsdf_load(&xml, &item->bsdf, err);
}

int orl_sources_bsdf(struct orl_sources *sources, size_t index, struct orl_bsdf **ret_bsdf,
                     struct orl_error *err)
{
    struct orl_source *item = sources->items + index;
    for (size_t i = 0; i < sources->count && !item->bsdf; i++) {
        const struct orl_source *other = sources->items + i;
        if (other->bsdf && memcmp(other->content, item->content, sizeof item->content) == 0)
            item->bsdf = orl_bsdf_ref(other->bsdf);
    }
    if (!item->bsdf) {
        const int code = load_bsdf(sources, item, err);
        if (code < 0)
            return code;
    }
    *ret_bsdf = item->bsdf;
    return 0;
}
