#include "store/database/db.h"

#include <dirent.h>
#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "store/files/folders.h"
#include "store/files/removal.h"

enum { ID_TEXT = 33 };

static const char *const data_folders[] = {"blobs", "maps", "partial", "results"};

/* ---- Files without a database ---------------------------------------------------------------- */

static bool has_file(const char *path)
{
    bool found = false;
    DIR *folder = opendir(path);
    for (const struct dirent *entry; folder && !found && (entry = readdir(folder));) {
        char below[ORL_PATH_MAX];
        struct stat st;
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
            continue;
        snprintf(below, sizeof below, "%.*s/%s", ORL_PATH_MAX - 260, path, entry->d_name);
        if (lstat(below, &st) == 0)
            found = !S_ISDIR(st.st_mode) || has_file(below);
    }
    if (folder)
        closedir(folder);
    return found;
}

static bool has_stored_files(const struct orl_folders *folders)
{
    char path[ORL_PATH_MAX];
    bool found = false;
    for (size_t i = 0; i < sizeof data_folders / sizeof *data_folders && !found; i++) {
        orl_folders_path(folders, path, "%s", data_folders[i]);
        found = has_file(path);
    }
    return found;
}

static int refuse_lost(const struct orl_folders *folders, struct orl_error *err)
{
    orl_error_set(err, ORL_ERR_CORRUPT,
                  "%.200s has files of scenes, jobs or maps, but its database oriel.db is missing "
                  "or empty; without it they would all be lost",
                  folders->root);
    orl_error_hint(
        err,
        "Put oriel.db back, from a backup or from oriel.db.before-NNNN; or start with --orphans "
        "set-aside, which moves the files to %.200s/orphans and starts with an empty database",
        folders->root);
    return ORL_ERR_CORRUPT;
}

/* Moves all stored files to orphans/, and makes their folders again. */
static int set_all_aside(const struct orl_folders *folders, struct orl_error *err)
{
    char path[ORL_PATH_MAX];
    int rc = 0;
    for (size_t i = 0; i < sizeof data_folders / sizeof *data_folders && rc == 0; i++) {
        rc = orl_orphan_set_aside(folders, data_folders[i], err);
        orl_folders_path(folders, path, "%s", data_folders[i]);
        if (rc == 0 && mkdir(path, 0777) != 0)
            rc = orl_error_set(err, orl_err_of_errno(errno), "cannot make the folder %s: %s", path,
                               strerror(errno));
    }
    return rc;
}

/* Moves the database to orphans/, with its log, which SQLite would remove since it belongs to no
 * database. */
static int set_database_aside(const struct orl_folders *folders, struct orl_error *err)
{
    static const char *const parts[] = {"oriel.db", "oriel.db-wal", "oriel.db-shm", "oriel.id"};
    int rc = 0;
    for (size_t i = 0; i < sizeof parts / sizeof *parts && rc == 0; i++)
        rc = orl_orphan_set_aside(folders, parts[i], err);
    return rc;
}

/* Checks the folder before SQLite makes a new database in place of a missing or empty file. */
static int check_lost_database(const struct orl_folders *folders, const char *path,
                               enum orl_lost_database_policy opening, struct orl_error *err)
{
    struct stat st;
    if ((stat(path, &st) == 0 && st.st_size > 0) || !has_stored_files(folders))
        return 0;
    if (opening == ORL_LOST_DATABASE_REFUSE)
        return refuse_lost(folders, err);
    const int rc = set_database_aside(folders, err);
    return rc ? rc : set_all_aside(folders, err);
}

/* Checks for tables: a database without a table counts as empty, too. */
static int check_tables(const struct orl_folders *folders, struct orl_db *db,
                        enum orl_lost_database_policy opening, struct orl_error *err)
{
    sqlite3_stmt *stmt = orl_db_prepare(db, err, "SELECT 1 FROM sqlite_schema LIMIT 1", "");
    const bool found = orl_db_next_row(stmt);
    const int rc = orl_db_finish(db, stmt, 0, "its tables cannot be listed", err);
    if (rc || found || !has_stored_files(folders))
        return rc;
    return opening == ORL_LOST_DATABASE_REFUSE ? refuse_lost(folders, err)
                                               : set_all_aside(folders, err);
}

/* ---- Another folder's database --------------------------------------------------------------- */

static int read_id(struct orl_db *db, char ret_id[ID_TEXT], struct orl_error *err)
{
    sqlite3_stmt *stmt = orl_db_prepare(db, err, "SELECT id FROM data_folder", "");
    const bool found = orl_db_next_row(stmt);
    if (found)
        snprintf(ret_id, ID_TEXT, "%s", orl_db_text(stmt, 0));
    const int rc = orl_db_finish(db, stmt, 0, "its id cannot be read", err);
    if (rc || found)
        return rc;
    orl_error_set(err, ORL_ERR_CORRUPT,
                  "the database oriel.db has lost its id: table data_folder is empty");
    orl_error_hint(err, "Another program has changed it: put it back from a backup");
    return ORL_ERR_CORRUPT;
}

static bool is_in_file(const char *path, const char *id)
{
    struct orl_file file;
    if (orl_map_file(path, &file, NULL))
        return false;
    const bool same = file.size == strlen(id) && memcmp(file.data, id, file.size) == 0;
    orl_unmap_file(&file);
    return same;
}

/* Checks the folder's id. On a full disk a folder without an id gets one at a later start. */
static int check_id(const struct orl_folders *folders, struct orl_db *db,
                    enum orl_lost_database_policy opening, struct orl_error *err)
{
    char id[ID_TEXT] = "", path[ORL_PATH_MAX];
    struct stat st;
    int rc = read_id(db, id, err);
    orl_folders_path(folders, path, "oriel.id");
    if (rc || is_in_file(path, id))
        return rc;
    const bool other = stat(path, &st) == 0 && st.st_size > 0;
    if (other && opening == ORL_LOST_DATABASE_REFUSE) {
        orl_error_set(err, ORL_ERR_CORRUPT,
                      "the database oriel.db does not belong to the data folder %.200s",
                      folders->root);
        orl_error_hint(err,
                       "Put back the folder's own database from a backup; or start with --orphans "
                       "set-aside, which moves files that this one does not know to %.200s/orphans",
                       folders->root);
        return ORL_ERR_CORRUPT;
    }
    rc = orl_write_file(path, id, strlen(id), err);
    return rc == ORL_ERR_FULL ? 0 : rc;
}

/* ---- Damage ---------------------------------------------------------------------------------- */

/* Adds the file's name and a hint to SQLite's message about a truncated or overwritten file. */
static int explain_damage(const char *path, struct orl_error *err)
{
    char why[sizeof err->message];
    snprintf(why, sizeof why, "%s", err->message);
    orl_error_set(err, ORL_ERR_CORRUPT, "%.200s is damaged: %.120s", path, why);
    orl_error_hint(err,
                   "Put it back from a backup, or from oriel.db.before-NNNN, the copy made before "
                   "its latest migration");
    return ORL_ERR_CORRUPT;
}

/* ---- Opening -------------------------------------------------------------------------------- */

int orl_store_open(const struct orl_folders *folders, enum orl_lost_database_policy opening,
                   struct orl_db *ret_db, struct orl_error *err)
{
    char path[ORL_PATH_MAX];
    orl_folders_path(folders, path, "oriel.db");
    bool damaged = false;
    ret_db->handle = NULL;
    int rc = check_lost_database(folders, path, opening, err);
    if (rc == 0) {
        rc = orl_db_open(ret_db, path, err);
        damaged = rc == ORL_ERR_CORRUPT;
    }
    if (rc == 0)
        rc = check_tables(folders, ret_db, opening, err);
    if (rc == 0)
        rc = orl_db_migrate_embedded(ret_db, err);
    if (rc == 0)
        rc = check_id(folders, ret_db, opening, err);
    if (rc && (damaged || orl_db_is_damaged(ret_db)))
        rc = explain_damage(path, err);
    if (rc)
        orl_db_close(ret_db);
    return rc;
}
