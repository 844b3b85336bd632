/*
 * A copy of a data folder that is consistent, taken while a daemon runs on it or not: the database
 * as it stands at one moment, and the files that its rows name, each held against its digest on the
 * way. What was removed while the copy was made, or is damaged, is removed from the copy's database
 * too. Photon maps and loaded BSDFs are left out: they are made anew.
 *
 * The copy is a data folder: a daemon started on it (better: on a copy of that) goes on from there.
 */
#ifndef ORL_SERVER_UPKEEP_BACKUP_H
#define ORL_SERVER_UPKEEP_BACKUP_H

#include <stdint.h>

#include "store/kept_files.h"

struct orl_backup_totals {
    uint64_t files, bytes;
    uint64_t gone;    /* removed meanwhile */
    uint64_t damaged; /* in the store: left out, found is told */
};

/* Of the folder data, into one that is not there yet. Synced when it returns. */
int orl_backup(const char *data, const char *to,
               void (*found)(const struct orl_kept_file *file, const struct orl_error *why),
               struct orl_backup_totals *ret_totals, struct orl_error *err);

#endif
