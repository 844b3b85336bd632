/*
 * Files of the data folder that its database does not know. A crash leaves a few; where a database
 * was lost, or an older copy of it was put back, they may be all there is. No start deletes them.
 * It moves them to
 *
 *     orphans/<time of the start>/blobs/... maps/... results/... partial/...
 *
 * under the paths that they had, so that moving them back undoes it. A later start, or a pass once
 * an hour, removes those folders when they are older than --keep-orphans days.
 *
 * Threads: the loop thread.
 */
#ifndef ORL_STORE_ORPHANS_H
#define ORL_STORE_ORPHANS_H

#include <stdint.h>
#include <uv.h>

#include "store/folders.h"

/* Moves the file or folder "results/<job>", or whatever below names, aside. Missing is fine. */
int orl_orphan_set_aside(const struct orl_folders *folders, const char *below,
                         struct orl_error *err);

/* Files set aside by this start so far. */
struct orl_orphans_found {
    uint64_t files, bytes;
};
struct orl_orphans_found orl_orphans_count(const struct orl_folders *folders);
/* The folder that this start sets aside to. */
void orl_orphans_path(const struct orl_folders *folders, char ret_path[ORL_PATH_MAX]);

/* Removes what earlier starts have set aside, more than keep_days before now_ms. */
void orl_orphans_purge(uv_loop_t *loop, const struct orl_folders *folders, int64_t now_ms,
                       uint32_t keep_days);

#endif
