#include "store/files/blobs.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "store/files/removal.h"
#include "store/rows/scenes.h"

enum { BUCKETS = 1024 };

struct claim {
    char sha[ORL_SHA_HEX];
    unsigned holders;
    bool counted; /* true if bytes includes it: the blob existed before */
    struct claim *next;
};

struct orl_blobs {
    uv_loop_t *loop;
    const struct orl_folders *folders;
    struct orl_db *db;
    struct orl_wal_sync *wal_sync;
    uint64_t bytes;
    struct claim *claims[BUCKETS];
};

/* Returns the slot of the digest's claim, or the slot where it would be. */
static struct claim **find_claim(struct orl_blobs *blobs, const char *sha)
{
    char head[5];
    snprintf(head, sizeof head, "%.4s", sha);
    struct claim **at = &blobs->claims[strtoul(head, NULL, 16) % BUCKETS];
    while (*at && strcmp((*at)->sha, sha) != 0)
        at = &(*at)->next;
    return at;
}

/* Returns the bytes of the blob; -1 if it does not exist. */
static int64_t blob_size(const struct orl_blobs *blobs, const char *sha)
{
    char path[ORL_PATH_MAX];
    struct stat st;
    orl_blob_path(blobs->folders, sha, path);
    return stat(path, &st) == 0 ? (int64_t)st.st_size : -1;
}

/* A blob whose row was deleted. Once that is safe on disk, the blob is removed unless it was
 * claimed meanwhile. */
struct deferred_removal {
    struct orl_wal_sync_wait wait; /* first member, whose address is the struct's */
    struct orl_blobs *blobs;
    char sha[ORL_SHA_HEX];
};

static void count_or_remove(struct orl_blobs *blobs, const char *sha, bool counted);

static void on_row_deletion_durable(struct orl_wal_sync_wait *wait, int rc,
                                    const struct orl_error *err)
{
    struct deferred_removal *deferred_removal = (struct deferred_removal *)wait;
    (void)err;
    if (rc == 0 && !*find_claim(deferred_removal->blobs, deferred_removal->sha))
        count_or_remove(deferred_removal->blobs, deferred_removal->sha, true);
    free(deferred_removal);
}

/* Waits for the row's deletion. Without memory, or if the disk fails, the blob stays until the next
 * start. */
static void remove_when_durable(struct orl_blobs *blobs, const char *sha)
{
    struct deferred_removal *deferred_removal = calloc(1, sizeof *deferred_removal);
    if (!deferred_removal)
        return;
    deferred_removal->wait.synced = on_row_deletion_durable;
    deferred_removal->blobs = blobs;
    snprintf(deferred_removal->sha, sizeof deferred_removal->sha, "%s", sha);
    orl_wal_sync_request(blobs->wal_sync, &deferred_removal->wait);
}

/* Counts or removes a blob without claims: counts it if a row names it, otherwise removes it. If
 * the database cannot be read, the blob stays for the next start to check. A blob that is not
 * counted never had a row. */
static void count_or_remove(struct orl_blobs *blobs, const char *sha, bool counted)
{
    char path[ORL_PATH_MAX];
    const int64_t bytes = blob_size(blobs, sha);
    bool named = true;
    if (bytes < 0)
        return;
    orl_blob_is_referenced(blobs->db, sha, &named, NULL);
    if (named && !counted)
        blobs->bytes += (uint64_t)bytes;
    if (named)
        return;
    if (counted &&
        !orl_wal_sync_is_durable(blobs->wal_sync, orl_wal_sync_last_commit(blobs->wal_sync))) {
        remove_when_durable(blobs, sha);
        return;
    }
    if (counted)
        blobs->bytes -= (uint64_t)bytes;
    orl_blob_path(blobs->folders, sha, path);
    orl_remove_async(blobs->loop, blobs->folders, path);
}

int orl_blobs_claim(struct orl_blobs *blobs, const char *sha, struct orl_error *err)
{
    struct claim **at = find_claim(blobs, sha);
    if (*at) {
        (*at)->holders++;
        return 0;
    }
    struct claim *claim = calloc(1, sizeof *claim);
    if (!claim)
        return orl_error_no_memory(err);
    snprintf(claim->sha, sizeof claim->sha, "%s", sha);
    claim->holders = 1;
    claim->counted = blob_size(blobs, sha) >= 0;
    *at = claim;
    return 0;
}

void orl_blobs_release(struct orl_blobs *blobs, const char *sha)
{
    struct claim **at = find_claim(blobs, sha), *claim = *at;
    if (!claim || --claim->holders > 0)
        return;
    *at = claim->next;
    count_or_remove(blobs, sha, claim->counted);
    free(claim);
}

int orl_blobs_claim_files(struct orl_blobs *blobs, const struct orl_bundle *files,
                          struct orl_blob_claims *claims, struct orl_error *err)
{
    int rc = 0;
    *claims = (struct orl_blob_claims){
        .blobs = blobs, .shas = calloc(files->count ? files->count : 1, sizeof *claims->shas)};
    if (!claims->shas)
        return orl_error_no_memory(err);
    for (size_t i = 0; i < files->count && rc == 0; i++) {
        memcpy(claims->shas[i], files->files[i].sha, ORL_SHA_HEX);
        rc = orl_blobs_claim(blobs, claims->shas[i], err);
        claims->count += rc == 0;
    }
    if (rc)
        orl_blobs_release_files(claims);
    return rc;
}

void orl_blobs_release_files(struct orl_blob_claims *claims)
{
    for (size_t i = 0; i < claims->count; i++)
        orl_blobs_release(claims->blobs, claims->shas[i]);
    free(claims->shas);
    *claims = (struct orl_blob_claims){0};
}

void orl_blobs_remove_unused(struct orl_blobs *blobs, const char *sha)
{
    if (!*find_claim(blobs, sha))
        count_or_remove(blobs, sha, true);
}

uint64_t orl_blobs_bytes(const struct orl_blobs *blobs)
{
    return blobs->bytes;
}

/* ---- Start and end -------------------------------------------------------------------------- */

static int sweep_file(struct orl_blobs *blobs, const char *sha, struct orl_error *err)
{
    char path[ORL_PATH_MAX];
    const int64_t bytes = orl_is_sha256(sha) ? blob_size(blobs, sha) : -1;
    bool named = true;
    if (bytes < 0)
        return 0;
    const int rc = orl_blob_is_referenced(blobs->db, sha, &named, err);
    if (rc)
        return rc;
    if (named) {
        blobs->bytes += (uint64_t)bytes;
        return 0;
    }
    /* If this fails, as on a full disk, the blob stays until the next start. */
    snprintf(path, sizeof path, "blobs/%.2s/%s", sha, sha);
    orl_orphan_set_aside(blobs->folders, path, NULL);
    return 0;
}

static int sweep_folder(struct orl_blobs *blobs, const char *name, struct orl_error *err)
{
    char path[ORL_PATH_MAX];
    int rc = 0;
    orl_folders_path(blobs->folders, path, "blobs/%s", name);
    DIR *folder = opendir(path);
    if (!folder)
        return errno == ENOTDIR
                   ? 0
                   : orl_error_set(err, ORL_ERR_IO, "cannot read %s: %s", path, strerror(errno));
    for (const struct dirent *file; rc == 0 && (file = readdir(folder));)
        if (file->d_name[0] != '.')
            rc = sweep_file(blobs, file->d_name, err);
    closedir(folder);
    return rc;
}

static int sweep_blobs(struct orl_blobs *blobs, struct orl_error *err)
{
    char path[ORL_PATH_MAX];
    int rc = 0;
    orl_folders_path(blobs->folders, path, "blobs");
    DIR *folder = opendir(path);
    if (!folder)
        return orl_error_set(err, ORL_ERR_IO, "cannot read %s: %s", path, strerror(errno));
    for (const struct dirent *below; rc == 0 && (below = readdir(folder));)
        if (below->d_name[0] != '.')
            rc = sweep_folder(blobs, below->d_name, err);
    closedir(folder);
    return rc;
}

int orl_blobs_open(uv_loop_t *loop, const struct orl_folders *folders, struct orl_db *db,
                   struct orl_wal_sync *wal_sync, struct orl_blobs **ret_blobs,
                   struct orl_error *err)
{
    struct orl_blobs *blobs = calloc(1, sizeof *blobs);
    if (!blobs)
        return orl_error_no_memory(err);
    blobs->loop = loop;
    blobs->folders = folders;
    blobs->db = db;
    blobs->wal_sync = wal_sync;
    const int rc = sweep_blobs(blobs, err);
    if (rc)
        orl_blobs_close(blobs);
    else
        *ret_blobs = blobs;
    return rc;
}

void orl_blobs_close(struct orl_blobs *blobs)
{
    if (!blobs)
        return;
    for (size_t i = 0; i < BUCKETS; i++)
        while (blobs->claims[i]) {
            struct claim *claim = blobs->claims[i];
            blobs->claims[i] = claim->next;
            free(claim);
        }
    free(blobs);
}
