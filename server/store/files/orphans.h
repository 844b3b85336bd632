/*
 * Orphans: files of the data folder that its database does not know. A crash leaves a few. If a
 * database was lost, or an older copy of it was restored, they may be all files there are. No start
 * deletes them. It moves them to
 *
 *     orphans/<time of the start>/blobs/... maps/... results/... partial/...
 *
 * under their original paths, so that moving them back undoes it. A later start, or a pass once an
 * hour, removes those folders when they are older than --keep-orphans days.
 *
 * Threads: the loop thread.
 */
#ifndef ORL_STORE_FILES_ORPHANS_H
#define ORL_STORE_FILES_ORPHANS_H

#include <stdint.h>
#include <uv.h>

#include "store/files/folders.h"

/* Moves a file or folder, such as "results/<job>", aside. below: its path in the data folder. A
 * missing one is no error. */
int orl_orphan_set_aside(const struct orl_folders *folders, const char *below,
                         struct orl_error *err);

/* Files set aside by this start so far. */
struct orl_orphans_found {
    uint64_t files, bytes;
};
struct orl_orphans_found orl_orphans_count(const struct orl_folders *folders);
/* Writes the path of this start's folder of orphans. */
void orl_orphans_path(const struct orl_folders *folders, char ret_path[ORL_PATH_MAX]);

/* Removes the folders of earlier starts that are more than keep_days older than now_ms. */
void orl_orphans_purge(uv_loop_t *loop, const struct orl_folders *folders, int64_t now_ms,
                       uint32_t keep_days);

#endif
