/* The commands beside a daemon: orield scrub, orield backup and orield token. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "http/access/tokens.h"
#include "maintenance/scrub.h"
#include "process/config.h"
#include "process/times.h"
#include "store/database/db.h"
#include "store/files/folders.h"

enum { STATUS_FAILED = 1, STATUS_USAGE = 2 };

static const char store_usage[] =
    "Usage: orield scrub [--data DIR]\n"
    "       orield backup TO [--data DIR]\n"
    "Both can run while a daemon uses the data folder.\n\n"
    "  scrub   reads the database and all stored files, and compares each file with its digest\n"
    "          or checksum. Prints damaged and missing files; the exit status is 1 if there\n"
    "          are any. Uploading a file again repairs it; a daemon removes damaged maps\n"
    "          by itself\n"
    "  backup  makes the folder TO: a consistent copy of the database, with scenes, BSDFs,\n"
    "          jobs and results. Photon maps, which are rebuilt, and the key of signed links\n"
    "          are left out. Damaged files are left out and printed, and the status is 1.\n"
    "          To restore: copy TO to the place of the data folder, and start the daemon\n\n"
    "  --data DIR  the daemon's data folder ($ORIEL_DATA, else ./oriel-data)\n";

/* ---- orield scrub, orield backup ------------------------------------------------------------- */

static int report_failure(const char *verb, const struct orl_error *err)
{
    char text[3 * ORL_ERROR_TEXT_MAX];
    orl_error_format(err, text, sizeof text);
    fprintf(stderr, "orield %s: %s\n", verb, text);
    return STATUS_FAILED;
}

static void print_finding(const struct orl_stored_file *file, const struct orl_error *why)
{
    printf("%s: %s\n", file->path, why->message);
}

static void report_damage(void *ctx, const struct orl_stored_file *file,
                          const struct orl_error *why)
{
    (void)ctx;
    print_finding(file, why);
}

static bool keep_going(void *ctx, uint64_t bytes)
{
    (void)ctx, (void)bytes;
    return true;
}

static int run_scrub(const char *data)
{
    const struct orl_scrubber scrubber = {report_damage, keep_going, NULL};
    struct orl_scrub_totals totals = {0};
    struct orl_folders folders = {.lock_fd = -1};
    struct orl_db db = {NULL};
    struct orl_error err;
    char path[ORL_PATH_MAX];
    snprintf(folders.root, sizeof folders.root, "%s", data);
    orl_folders_path(&folders, path, "oriel.db");
    int rc = orl_db_open_existing(&db, path, &err);
    if (rc == 0)
        rc = orl_db_check(&db, &err);
    if (rc == 0)
        rc = orl_scrub(&db, &folders, &scrubber, &totals, &err);
    orl_db_close(&db);
    if (rc)
        return report_failure("scrub", &err);
    printf("%llu files, %llu bytes, %llu damaged\n", (unsigned long long)totals.files,
           (unsigned long long)totals.bytes, (unsigned long long)totals.damaged);
    return totals.damaged ? STATUS_FAILED : 0;
}

static int run_backup(const char *data, const char *to)
{
    struct orl_backup_totals totals;
    struct orl_error err;
    if (orl_backup(data, to, print_finding, &totals, &err))
        return report_failure("backup", &err);
    printf("%llu files, %llu bytes; left out: %llu damaged, %llu removed meanwhile\n",
           (unsigned long long)totals.files, (unsigned long long)totals.bytes,
           (unsigned long long)totals.damaged, (unsigned long long)totals.gone);
    return totals.damaged ? STATUS_FAILED : 0;
}

int orl_store_command(int argc, char **argv)
{
    const char *data = getenv("ORIEL_DATA"), *to = NULL;
    const bool is_backup = strcmp(argv[0], "backup") == 0;
    if (!data || !*data)
        data = ORL_DEFAULT_DATA;
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) {
            fputs(store_usage, stdout);
            return 0;
        }
        if (strcmp(argv[i], "--data") == 0 && i + 1 < argc) {
            data = argv[++i];
        } else if (argv[i][0] != '-' && is_backup && !to) {
            to = argv[i];
        } else {
            fputs(store_usage, stderr);
            return STATUS_USAGE;
        }
    }
    if (is_backup && !to) {
        fputs(store_usage, stderr);
        return STATUS_USAGE;
    }
    return is_backup ? run_backup(data, to) : run_scrub(data);
}

/* ---- orield token ---------------------------------------------------------------------------- */

/* Creates and removes tokens on the daemon's machine, never over HTTP. */
static const char token_usage[] =
    "Usage: orield token add NAME [--scope read|submit|admin] [--data DIR]\n"
    "       orield token list [--data DIR]\n"
    "       orield token remove NAME [--data DIR]\n"
    "Manages the access tokens of a data folder. A running daemon applies changes at once.\n\n"
    "  add     makes a token and prints it; it is not shown again\n"
    "  list    prints name, scope, id and date of each token\n"
    "  remove  revokes a token\n\n"
    "  --scope read|submit|admin\n"
    "                 read: read everything; submit (default): also upload, submit, and cancel\n"
    "                 or remove own jobs; admin: also remove scenes, BSDFs, maps\n"
    "                 and jobs of other tokens\n"
    "  --data DIR     the daemon's data folder ($ORIEL_DATA, else ./oriel-data)\n";

/* Data folder and database. Only the process that holds the folder's lock migrates. */
struct storage {
    struct orl_folders folders;
    struct orl_db db;
};

static int open_storage(const char *data, struct storage *storage, struct orl_error *err)
{
    char path[ORL_PATH_MAX];
    struct orl_error locked;
    memset(storage, 0, sizeof *storage);
    const int mine = orl_folders_open(&storage->folders, data, &locked);
    if (mine != 0 && mine != ORL_ERR_INVALID) {
        *err = locked;
        return mine;
    }
    if (mine == 0)
        return orl_store_open(&storage->folders, ORL_LOST_DATABASE_REFUSE, &storage->db, err);
    orl_folders_path(&storage->folders, path, "oriel.db");
    return orl_db_open_existing(&storage->db, path, err);
}

static void close_storage(struct storage *storage)
{
    orl_db_close(&storage->db);
    orl_folders_close(&storage->folders);
}

static int add_token(struct orl_db *db, const char *name, enum orl_token_scope scope,
                     struct orl_error *err)
{
    char text[ORL_TOKEN_TEXT];
    struct orl_token_row row;
    int rc = orl_token_make(name, scope, &row, text, err);
    if (rc == 0)
        rc = orl_token_row_insert(db, &row, err);
    if (rc == 0)
        printf("%s\n", text);
    return rc;
}

static int print_row(void *ctx, const struct orl_token_row *row)
{
    char created[ORL_TIME_TEXT];
    (void)ctx;
    orl_time_format(row->created_ms, created);
    printf("%-24s %-7s %s %s\n", row->name, orl_scope_name(row->scope), row->id, created);
    return 0;
}

/* Reads the options after the verb. Returns 0, or -1 if they are invalid. */
static int parse_options(int argc, char **argv, const char **ret_name, const char **ret_scope,
                         const char **ret_data)
{
    const char *from_environment = getenv("ORIEL_DATA");
    *ret_name = NULL;
    *ret_scope = NULL;
    *ret_data = from_environment && *from_environment ? from_environment : ORL_DEFAULT_DATA;
    for (int i = 2; i < argc; i++) {
        const bool scope = strcmp(argv[i], "--scope") == 0;
        if ((scope || strcmp(argv[i], "--data") == 0) && i + 1 < argc)
            *(scope ? ret_scope : ret_data) = argv[++i];
        else if (argv[i][0] != '-' && !*ret_name)
            *ret_name = argv[i];
        else
            return -1;
    }
    return 0;
}

static int run_verb(const char *verb, const char *name, enum orl_token_scope scope,
                    const char *data)
{
    struct storage storage;
    struct orl_error err;
    char text[3 * ORL_ERROR_TEXT_MAX];
    int rc = open_storage(data, &storage, &err);
    if (rc == 0 && strcmp(verb, "add") == 0)
        rc = add_token(&storage.db, name, scope, &err);
    else if (rc == 0 && strcmp(verb, "remove") == 0)
        rc = orl_token_row_remove(&storage.db, name, &err);
    else if (rc == 0)
        rc = orl_token_rows(&storage.db, print_row, NULL, &err);
    close_storage(&storage);
    if (rc == 0)
        return 0;
    orl_error_format(&err, text, sizeof text);
    fprintf(stderr, "orield token: %s\n", text);
    return STATUS_FAILED;
}

int orl_token_command(int argc, char **argv)
{
    const char *verb = argc > 1 ? argv[1] : "", *name, *scope_name, *data;
    if (strcmp(verb, "--help") == 0 || strcmp(verb, "-h") == 0) {
        fputs(token_usage, stdout);
        return 0;
    }
    const bool is_add = strcmp(verb, "add") == 0, is_list = strcmp(verb, "list") == 0;
    if ((!is_add && !is_list && strcmp(verb, "remove") != 0) ||
        parse_options(argc, argv, &name, &scope_name, &data) != 0 || is_list != !name ||
        (scope_name && !is_add)) {
        fputs(token_usage, stderr);
        return STATUS_USAGE;
    }
    const enum orl_token_scope scope =
        scope_name ? orl_scope_from_name(scope_name) : ORL_SCOPE_SUBMIT;
    if (scope == ORL_SCOPE_COUNT) {
        fprintf(stderr, "orield token: there is no scope '%s'\n", scope_name);
        return STATUS_USAGE;
    }
    return run_verb(verb, name, scope, data);
}
