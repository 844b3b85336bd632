#include "maintenance/store_command.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "maintenance/backup.h"
#include "maintenance/scrub.h"
#include "process/config.h"

enum { STATUS_FAILED = 1, STATUS_USAGE = 2 };

static const char usage[] =
    "Usage: orield scrub [--data DIR]\n"
    "       orield backup TO [--data DIR]\n"
    "Both may be used while a daemon runs on the data folder.\n\n"
    "  scrub   reads the database and all files kept, and holds each against its digest or\n"
    "          checksum; prints those that are damaged or missing, and ends with status 1\n"
    "          if there are any. An upload, sent again, mends its files; a daemon removes\n"
    "          damaged maps by itself\n"
    "  backup  makes the folder TO: the database as it is at one moment, with scenes, BSDFs,\n"
    "          jobs and results; not photon maps, which are made anew, nor the key of\n"
    "          signed links. What is damaged is left out and printed, and the status is 1.\n"
    "          To restore: copy TO to where the data folder is to be, and start the daemon\n\n"
    "  --data DIR  the daemon's data folder ($ORIEL_DATA, else ./oriel-data)\n";

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
            fputs(usage, stdout);
            return 0;
        }
        if (strcmp(argv[i], "--data") == 0 && i + 1 < argc) {
            data = argv[++i];
        } else if (argv[i][0] != '-' && is_backup && !to) {
            to = argv[i];
        } else {
            fputs(usage, stderr);
            return STATUS_USAGE;
        }
    }
    if (is_backup && !to) {
        fputs(usage, stderr);
        return STATUS_USAGE;
    }
    return is_backup ? run_backup(data, to) : run_scrub(data);
}
