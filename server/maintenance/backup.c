#include "maintenance/scrub.h"

#include <errno.h>
#include <fcntl.h>
#include <libgen.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <oriel/base/files.h>
#include <oriel/base/sha256.h>

#include "process/times.h"

struct copy {
    const char *from, *to;
    struct orl_db *db; /* the database of the copy */
    void (*found)(const struct orl_stored_file *file, const struct orl_error *why);
    struct orl_backup_totals *totals;
};

static int copy_rows(struct orl_db *db, const char *to, struct orl_error *err)
{
    return orl_db_run(db, err, NULL, "VACUUM INTO ?", "s", to);
}

/* ---- Files ---------------------------------------------------------------------------------- */

static int make_parents(const char *path, struct orl_error *err)
{
    char parent[ORL_PATH_MAX];
    snprintf(parent, sizeof parent, "%s", path);
    dirname(parent);
    if (mkdir(parent, 0777) == 0 || errno == EEXIST)
        return 0;
    if (errno == ENOENT && strchr(parent + 1, '/')) {
        const int rc = make_parents(parent, err);
        return rc ? rc : make_parents(path, err);
    }
    return orl_error_set(err, orl_err_of_errno(errno), "cannot make %s: %s", parent,
                         strerror(errno));
}

/* Copies the bytes, and computes their digest. */
static int copy_bytes(int from, int to, char ret_sha[ORL_SHA_HEX], uint64_t *ret_bytes,
                      struct orl_error *err)
{
    enum { CHUNK = 1 << 17 };
    static unsigned char chunk[CHUNK]; /* static: the command has one thread */
    struct orl_sha256 hash;
    ssize_t n;
    orl_sha256_init(&hash);
    while ((n = read(from, chunk, sizeof chunk)) != 0) {
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0)
            return orl_error_set(err, ORL_ERR_IO, "cannot be read: %s", strerror(errno));
        orl_sha256_add(&hash, chunk, (size_t)n);
        if (!orl_write_all(to, chunk, (size_t)n))
            return orl_error_set(err, orl_err_of_errno(errno), "cannot write the copy: %s",
                                 strerror(errno));
        *ret_bytes += (uint64_t)n;
    }
    orl_sha256_finish_hex(&hash, ret_sha);
    return 0;
}

enum copy_outcome { COPIED, GONE, DAMAGED };

/* Copies a file. Fails if the copy cannot be written. */
static int copy_file(const struct copy *copy, const struct orl_stored_file *file,
                     enum copy_outcome *ret_fate, struct orl_error *err)
{
    char from[ORL_PATH_MAX], to[ORL_PATH_MAX], sha[ORL_SHA_HEX];
    struct orl_error why;
    snprintf(from, sizeof from, "%.2000s/%s", copy->from, file->path);
    snprintf(to, sizeof to, "%.2000s/%s", copy->to, file->path);
    const int in = orl_open_regular(from, O_RDONLY);
    if (in < 0) {
        *ret_fate = GONE;
        return 0;
    }
    int rc = make_parents(to, err);
    const int out = rc ? -1 : orl_open_regular(to, O_WRONLY | O_CREAT | O_TRUNC);
    if (rc == 0 && out < 0)
        rc = orl_error_set(err, orl_err_of_errno(errno), "cannot make %s: %s", to,
                           orl_open_reason(errno));
    *ret_fate = COPIED;
    if (rc == 0) {
        rc = copy_bytes(in, out, sha, &copy->totals->bytes, &why);
        if (rc == 0 && strcmp(sha, file->sha) != 0)
            rc = orl_error_set(&why, ORL_ERR_CORRUPT, "it is damaged in the store");
        if (rc == ORL_ERR_CORRUPT || rc == ORL_ERR_IO) {
            *ret_fate = DAMAGED;
            copy->found(file, &why);
            unlink(to);
            rc = 0;
        } else if (rc) {
            *err = why;
        }
    }
    close(in);
    if (out >= 0)
        close(out);
    return rc;
}

/* ---- Rows of missing files ------------------------------------------------------------------ */

/* Deletes the rows of a blob. Cancels jobs that need it; ended jobs stay. */
static int forget_blob(struct orl_db *db, const char *sha, struct orl_error *err)
{
    static const char *const statements[] = {
        "DELETE FROM jobs WHERE document = ?",
        ("UPDATE jobs SET state = 'cancelled' WHERE state IN ('queued', 'running') AND scene IN "
         "(SELECT scene FROM scene_files WHERE blob = ?)"),
        "DELETE FROM scenes WHERE id IN (SELECT scene FROM scene_files WHERE blob = ?)",
        "DELETE FROM bsdfs WHERE id = ?",
    };
    int rc = 0;
    for (size_t i = 0; i < sizeof statements / sizeof *statements && rc == 0; i++)
        rc = orl_db_run(db, err, NULL, statements[i], "s", sha);
    return rc;
}

static int copy_listed_file(void *ctx, const struct orl_stored_file *file, struct orl_error *err)
{
    const struct copy *copy = ctx;
    enum copy_outcome copy_outcome = COPIED;
    if (file->kind == ORL_STORED_FILE_MAP)
        return 0;
    int rc = copy_file(copy, file, &copy_outcome, err);
    if (rc)
        return rc;
    copy->totals->files += copy_outcome == COPIED;
    copy->totals->gone += copy_outcome == GONE;
    copy->totals->damaged += copy_outcome == DAMAGED;
    if (copy_outcome != COPIED && file->kind == ORL_STORED_FILE_BLOB)
        rc = forget_blob(copy->db, file->sha, err);
    else if (copy_outcome != COPIED)
        rc = orl_db_run(copy->db, err, NULL, "UPDATE jobs SET evicted_ms = ? WHERE id = ?", "is",
                        orl_time_now_ms(), file->job);
    return rc;
}

/* ---- The copy ------------------------------------------------------------------------------- */

static int copy_db(const char *data, const char *to, struct orl_error *err)
{
    char from[ORL_PATH_MAX];
    struct orl_db db = {NULL};
    snprintf(from, sizeof from, "%.2000s/oriel.db", data);
    int rc = orl_db_open_existing(&db, from, err);
    if (rc == 0)
        rc = copy_rows(&db, to, err);
    orl_db_close(&db);
    return rc;
}

static int copy_all(struct copy *copy, const char *db_path, struct orl_error *err)
{
    struct orl_db db = {NULL};
    int rc = orl_db_open(&db, db_path, err);
    copy->db = &db;
    if (rc == 0)
        rc = orl_db_exec(&db, "DELETE FROM maps", err);
    if (rc == 0)
        rc = orl_stored_files_visit(&db, copy_listed_file, copy, err);
    copy->db = NULL;
    orl_db_close(&db);
    return rc;
}

int orl_backup(const char *data, const char *to,
               void (*found)(const struct orl_stored_file *file, const struct orl_error *why),
               struct orl_backup_totals *ret_totals, struct orl_error *err)
{
    struct copy copy = {.from = data, .to = to, .found = found, .totals = ret_totals};
    char db_path[ORL_PATH_MAX];
    *ret_totals = (struct orl_backup_totals){0};
    if (mkdir(to, 0777) != 0) {
        orl_error_set(err, orl_err_of_errno(errno), "cannot make %s: %s", to, strerror(errno));
        if (errno == EEXIST)
            orl_error_hint(err, "Name a folder that does not exist yet");
        return err->code;
    }
    snprintf(db_path, sizeof db_path, "%.2000s/oriel.db", to);
    int rc = copy_db(data, db_path, err);
    if (rc == 0)
        rc = copy_all(&copy, db_path, err);
    const int fd = rc ? -1 : open(to, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (rc == 0 && (fd < 0 || syncfs(fd) != 0))
        rc = orl_error_set(err, orl_err_of_errno(errno), "cannot sync %s: %s", to, strerror(errno));
    if (fd >= 0)
        close(fd);
    return rc;
}
