/*
 * Parts of a job's results that are done before the job is, kept so that a job started anew need
 * not do them again: views, its sensors, all under one sky.
 *
 * A job's work folder (partial/<job>) holds their files as they are made and, once these are
 * synced, a note "+<part>.done" beside them with their digests. What begins with '+' is not for
 * users, and goes before the folder becomes the job's results; the folder goes with a job that
 * fails or is cancelled, and stays with one that is queued again.
 *
 * A folder is believed when its "+key" is the job's: the digest of what is asked for, of which
 * scene, and of the program with all of its libraries (program.h), whose pictures another might not
 * make. So one job may go on with another's folder. A part is believed when its files are what its
 * note says.
 *
 * Threads: any, one per folder.
 */
#ifndef ORL_SERVER_RUNNER_CHECKPOINTS_H
#define ORL_SERVER_RUNNER_CHECKPOINTS_H

#include <jansson.h>
#include <stdbool.h>

#include <oriel/run.h>

#include "store/folders.h"

/* ---- The folder ------------------------------------------------------------------------------ */

/* asked: the digest of what is asked for, the same for identical jobs. */
void orl_checkpoint_key(const char *program, const char *asked, const char *scene,
                        char ret_key[ORL_SHA_HEX]);

/* Where the job works. */
void orl_checkpoint_folder(const struct orl_folders *folders, const char *job_id,
                           char ret_path[ORL_PATH_MAX]);
/* Makes the folder; what is in it stays if it was made with that key. */
int orl_checkpoint_open(const char *folder, const char *key, struct orl_error *err);
/* Removes what is not for users, photon maps of rounds and files half written included. */
void orl_checkpoint_forget(const char *folder);
/* Gives a job's work folder to one that goes on with it. False: that one has its own. */
bool orl_checkpoint_give(const struct orl_folders *folders, const char *from_id, const char *to_id);
/* Sweeps the work folders. heir names the job that continues one, maybe itself. Without one it is
 * removed, or set aside (orphans.h) when the job of that id is not known. */
void orl_checkpoint_sweep(const struct orl_folders *folders,
                          const char *(*heir)(void *ctx, const char *job_id, bool *ret_known),
                          void *ctx);

/* ---- Parts ----------------------------------------------------------------------------------- */

/*
 * Notes a part: its files, synced (entries as job_output.h makes them, borrowed), and what there is
 * to say of it, which is taken.
 */
int orl_checkpoint_add(const char *folder, const char *part, json_t *files, json_t *about,
                       struct orl_error *err);
/* Is it kept, and are its files whole? Then both are new references. */
bool orl_checkpoint_find(const char *folder, const char *part, json_t **ret_files,
                         json_t **ret_about);

/* A view's own strings, as JSON and back; the latter's are the caller's. NULL, false: no memory. */
json_t *orl_checkpoint_view_to_json(const struct orl_view_result *view);
bool orl_checkpoint_view_from_json(const json_t *json, struct orl_view_result *ret_view);

/* The sensors' numbers as a file, synced, and back into a result that has room for them. */
int orl_checkpoint_sensors_write(const char *folder, const char *name,
                                 const struct orl_result *result, struct orl_error *err);
bool orl_checkpoint_sensors_read(const char *folder, const char *name, struct orl_result *result);

#endif
