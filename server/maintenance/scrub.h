/*
 * Checks and copies of stored data: scrubbing (scrub.c), backups (backup.c), missing files, and the
 * commands that run beside a daemon (maintenance_commands.c).
 */
#ifndef ORL_SERVER_MAINTENANCE_SCRUB_H
#define ORL_SERVER_MAINTENANCE_SCRUB_H

#include <stdint.h>

#include "cache/map_cache.h"
#include "process/log.h"
#include "store/database/db.h"
#include "store/files/folders.h"
#include "store/files/stored_files.h"

/*
 * Scrubbing: reads every stored file and checks it against its digest or checksum, to find damage
 * early. `orield scrub` does so at once. The daemon does so slowly and repeatedly, in a thread with
 * the lowest priority and its own database handle.
 *
 * A damaged map is removed, and made again when it is needed. A damaged blob stays: an equal upload
 * repairs it. Damaged results are lost; submitting the document again reproduces them. The log
 * names each.
 */

struct orl_scrub_totals {
    uint64_t files, bytes, damaged; /* damaged: including missing files */
};

struct orl_scrubber {
    /* found: called for each damaged file. should_continue: called after each file; false ends the
     * scrub. */
    void (*found)(void *ctx, const struct orl_stored_file *file, const struct orl_error *why);
    bool (*should_continue)(void *ctx, uint64_t bytes);
    void *ctx;
};

/* Scrubs all files once. Errors are those of the database. */
int orl_scrub(struct orl_db *db, const struct orl_folders *folders,
              const struct orl_scrubber *scrubber, struct orl_scrub_totals *totals,
              struct orl_error *err);

/* ---- In the daemon -------------------------------------------------------------------------- */

struct orl_scrub_thread;

/* Starts scrubbing, at most so many bytes a second; 0: never. Borrows log and maps. Loop thread,
 * like the others. */
struct orl_scrub_thread *orl_scrub_thread_start(const struct orl_folders *folders,
                                                const struct orl_log *log,
                                                struct orl_map_cache *maps, uint64_t bytes_per_s);
void orl_scrub_thread_stop(struct orl_scrub_thread *scrub_thread); /* NULL is allowed */
/* Logs the findings, and removes damaged maps. Called about every second. */
void orl_scrub_thread_poll(struct orl_scrub_thread *scrub_thread);
/* Returns the totals since the start. */
struct orl_scrub_totals orl_scrub_thread_totals(struct orl_scrub_thread *scrub_thread);

/*
 * Makes a consistent copy of a data folder, with or without a running daemon. It copies the
 * database at one moment, and the files that its rows name, each checked against its digest. Files
 * that were removed during the copy, or are damaged, are removed from the copy's database too.
 * Photon maps and loaded BSDFs are left out, since they can be made again.
 *
 * The copy is a data folder: a daemon started on it (better: on a copy of it) continues from there.
 */

struct orl_backup_totals {
    uint64_t files, bytes;
    uint64_t gone;    /* removed during the copy */
    uint64_t damaged; /* damaged in the store: left out and passed to found */
};

/* Copies the folder data to a new folder. Synced when it returns. */
int orl_backup(const char *data, const char *to,
               void (*found)(const struct orl_stored_file *file, const struct orl_error *why),
               struct orl_backup_totals *ret_totals, struct orl_error *err);

/* A check at the start for files that the database names but that do not exist. */

/* Logs how many uploads and results are missing, and the first few names. Their rows stay: sending
 * an upload again repairs it, and files may be restored. It checks only that files exist; the scrub
 * checks their bytes. */
void orl_missing_files_log(struct orl_db *db, const struct orl_folders *folders,
                           const struct orl_log *log);

/* ---- Commands -------------------------------------------------------------------------------- */

/* Runs `orield scrub` or `orield backup`; argv[0] is the verb. Returns the process's status. */
int orl_store_command(int argc, char **argv);
/* Runs `orield token ...`; argv[0] is "token". Prints; returns the process's status. */
int orl_token_command(int argc, char **argv);

#endif
