/*
 * Makes a consistent copy of a data folder, with or without a running daemon. It copies the
 * database at one moment, and the files that its rows name, each checked against its digest. Files
 * that were removed during the copy, or are damaged, are removed from the copy's database too.
 * Photon maps and loaded BSDFs are left out, since they can be made again.
 *
 * The copy is a data folder: a daemon started on it (better: on a copy of it) continues from there.
 */
#ifndef ORL_SERVER_MAINTENANCE_BACKUP_H
#define ORL_SERVER_MAINTENANCE_BACKUP_H

#include <stdint.h>

#include "store/files/stored_files.h"

struct orl_backup_totals {
    uint64_t files, bytes;
    uint64_t gone;    /* removed during the copy */
    uint64_t damaged; /* damaged in the store: left out and passed to found */
};

/* Copies the folder data to a new folder. Synced when it returns. */
int orl_backup(const char *data, const char *to,
               void (*found)(const struct orl_stored_file *file, const struct orl_error *why),
               struct orl_backup_totals *ret_totals, struct orl_error *err);

#endif
