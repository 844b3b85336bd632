/*
 * Scrubbing: everything kept is read, and held against its digest or checksum, before somebody
 * needs it. `orield scrub` does so at once; the daemon slowly, over and over, in a thread of its
 * own with the lowest priority and a database handle of its own.
 *
 * A damaged map goes, and is made anew when it is asked for. A damaged blob stays: the same upload
 * mends it. Damaged results are lost; the same document gives them anew. The log names each.
 */
#ifndef ORL_SERVER_UPKEEP_SCRUB_H
#define ORL_SERVER_UPKEEP_SCRUB_H

#include <stdint.h>

#include "cache/map_cache.h"
#include "process/log.h"
#include "store/kept_files.h"

struct orl_scrub_totals {
    uint64_t files, bytes, damaged; /* damaged: or not there */
};

struct orl_scrubber {
    /* Of each that is not what was written; and after each, false ends it. */
    void (*found)(void *ctx, const struct orl_kept_file *file, const struct orl_error *why);
    bool (*go_on)(void *ctx, uint64_t bytes);
    void *ctx;
};

/* Goes through all once. Errors are those of the database. */
int orl_scrub(struct orl_db *db, const struct orl_folders *folders,
              const struct orl_scrubber *scrubber, struct orl_scrub_totals *totals,
              struct orl_error *err);

/* ---- In the daemon -------------------------------------------------------------------------- */

struct orl_scrubbing;

/* Begins, at most so many bytes a second; 0: never. Borrows log and maps. Loop thread, as are the
 * others. */
struct orl_scrubbing *orl_scrubbing_start(const struct orl_folders *folders,
                                          const struct orl_log *log, struct orl_map_cache *maps,
                                          uint64_t bytes_per_s);
void orl_scrubbing_stop(struct orl_scrubbing *scrubbing); /* NULL is fine */
/* To be called every second or so: what has been found is told, and maps removed. */
void orl_scrubbing_look(struct orl_scrubbing *scrubbing);
/* Since the start. */
struct orl_scrub_totals orl_scrubbing_totals(struct orl_scrubbing *scrubbing);

#endif
