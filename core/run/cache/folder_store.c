/* A store in a folder, for one process, and the check of a stored file against its checksum. */
#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <oriel/job/run.h>
#include <sys/stat.h>

#include "photon/map/map.h"
#include "run/cache/word_file.h"

static bool is_word_file(const char *kind)
{
    return strcmp(kind, "annual") == 0 || strcmp(kind, "made") == 0 || strcmp(kind, "pilot") == 0;
}

int orl_map_verify(const char *kind, const char *path, struct orl_error *err)
{
    struct orl_photon_map *map = NULL;
    if (strcmp(kind, "bsdf") == 0 || strcmp(kind, "scene") == 0)
        return 0;
    if (is_word_file(kind)) {
        struct orl_word_file_info file_info;
        return orl_word_file_read(path, NULL, &file_info, NULL, NULL, err);
    }
    const int rc = orl_photon_map_open(path, true, &map, err);
    orl_photon_map_free(map);
    return rc < 0 ? rc : 0;
}

static int map_path(const struct orl_folder_store *state, const char *kind, const char *key,
                    const char *suffix, char ret_path[4096], struct orl_error *err)
{
    const int length = snprintf(ret_path, 4096, "%s/%s-%s.opm%s", state->folder, kind, key, suffix);
    if (length < 0 || length >= 4096)
        return orl_error_set(err, ORL_ERR_LIMIT, "the map folder's path is too long");
    return 0;
}

static int folder_acquire(void *ctx, const char *kind, const char *key, atomic_bool *cancel,
                          char ret_path[4096], bool *ret_hit, struct orl_map_info *ret_info,
                          struct orl_error *err)
{
    const struct orl_folder_store *state = ctx;
    struct stat st;
    int code = 0;
    (void)cancel; /* no other process builds in this folder, so that there is nothing to wait for */
    if (mkdir(state->folder, 0777) != 0 && errno != EEXIST)
        return orl_error_set(err, orl_err_of_errno(errno), "cannot create the map folder '%s': %s",
                             state->folder, strerror(errno));
    code = map_path(state, kind, key, "", ret_path, err);
    if (code < 0)
        return code;
    *ret_hit = stat(ret_path, &st) == 0;
    if (*ret_hit) {
        /* Fields not in the file stay zero; the run reads the rest from the map. */
        memset(ret_info, 0, sizeof *ret_info);
        snprintf(ret_info->kind, sizeof ret_info->kind, "%s", kind);
        snprintf(ret_info->key, sizeof ret_info->key, "%s", key);
        ret_info->bytes = (uint64_t)st.st_size;
        ret_info->cached = true;
        return 0;
    }
    return map_path(state, kind, key, ".part", ret_path, err);
}

static int folder_commit(void *ctx, const struct orl_map_info *info, struct orl_error *err)
{
    const struct orl_folder_store *state = ctx;
    char from[4096], to[4096];
    int code = map_path(state, info->kind, info->key, ".part", from, err);
    if (code == 0)
        code = map_path(state, info->kind, info->key, "", to, err);
    if (code == 0 && rename(from, to) != 0)
        code = orl_error_set(err, orl_err_of_errno(errno), "cannot store the map '%s': %s", to,
                             strerror(errno));
    return code;
}

static void folder_abandon(void *ctx, const char *kind, const char *key)
{
    char path[4096];
    if (map_path(ctx, kind, key, ".part", path, NULL) == 0)
        unlink(path);
    if (map_path(ctx, kind, key, "", path, NULL) == 0)
        unlink(path);
}

static void folder_release(void *ctx, const char *kind, const char *key)
{
    (void)ctx, (void)kind, (void)key;
}

static bool read_cached(const char *path, struct orl_map_info *info)
{
    struct orl_word_file_info file_info;
    if (orl_word_file_describe(path, &file_info, NULL) < 0)
        return false;
    memcpy(info->family, file_info.family, sizeof info->family);
    info->target = file_info.target;
    info->emitted = file_info.rays;
    info->bytes = file_info.bytes;
    return true;
}

/* Reads the info of a map file; returns false if it is no map, or of another version. */
static bool read_info(const struct orl_folder_store *state, const char *name,
                      struct orl_map_info *ret_info)
{
    struct orl_map_info info = {.cached = true};
    struct orl_photon_map *map = NULL;
    char path[4096], key[ORL_DIGEST_HEX + 1];
    int end = 0;
    if (sscanf(name, "%15[a-z]-%64[0-9a-f].opm%n", info.kind, key, &end) != 2 || end == 0 ||
        name[end] != '\0' || map_path(state, info.kind, key, "", path, NULL) < 0)
        return false;
    memcpy(info.key, key, sizeof key);
    if (is_word_file(info.kind)) {
        *ret_info = info;
        return read_cached(path, ret_info);
    }
    if (orl_photon_map_open(path, false, &map, NULL) < 0)
        return false;
    const struct orl_map_header *h = orl_photon_map_header(map);
    snprintf(info.family, sizeof info.family, "%.64s", h->family);
    info.target = h->target;
    info.emitted = h->emitted;
    info.stored = h->count;
    info.bytes = h->size;
    orl_photon_map_free(map);
    *ret_info = info;
    return true;
}

static int folder_find_smaller(void *ctx, const char *kind, const char *family, uint64_t target,
                               char ret_path[4096], bool *ret_found, struct orl_map_info *ret_info,
                               struct orl_error *err)
{
    const struct orl_folder_store *state = ctx;
    struct orl_map_info info, best = {.target = 0};
    bool found = false;
    DIR *folder = opendir(state->folder);
    if (!folder)
        return orl_error_set(err, ORL_ERR_IO, "cannot read the map folder '%s': %s", state->folder,
                             strerror(errno));
    for (const struct dirent *file; (file = readdir(folder)) != NULL;) {
        if (!read_info(state, file->d_name, &info) || strcmp(info.kind, kind) != 0 ||
            strcmp(info.family, family) != 0 || info.target >= target ||
            (found && info.target < best.target))
            continue;
        best = info;
        found = true;
    }
    closedir(folder);
    *ret_found = found;
    if (!found)
        return 0;
    *ret_info = best;
    return map_path(state, kind, best.key, "", ret_path, err);
}

struct orl_map_store orl_map_store_in_folder(struct orl_folder_store *state)
{
    return (struct orl_map_store){.ctx = state,
                                  .acquire = folder_acquire,
                                  .commit = folder_commit,
                                  .abandon = folder_abandon,
                                  .release = folder_release,
                                  .find_smaller = folder_find_smaller};
}
