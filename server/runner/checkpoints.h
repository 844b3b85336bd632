/*
 * Checkpoints: parts of a job's results that are finished before the job is. A restarted job need
 * not compute them again. Parts are views, their sensors, and everything under one sky.
 *
 * A job's work folder (partial/<job>) holds their files. Once these are synced, a note
 * "+<part>.done" with their digests is added. Names that begin with '+' are not for users, and are
 * removed before the folder becomes the job's results. The folder is removed with a job that fails
 * or is cancelled, and stays with one that is queued again.
 *
 * A folder is valid if its "+key" is the job's. The key is a digest of the request, of the scene,
 * and of the program with all of its libraries (build_id.c), since another program might render
 * other pictures. So one job may continue with another's folder. A part is valid if its files match
 * its note.
 *
 * Threads: any, one per folder.
 */
#ifndef ORL_SERVER_RUNNER_CHECKPOINTS_H
#define ORL_SERVER_RUNNER_CHECKPOINTS_H

#include <jansson.h>
#include <stdbool.h>

#include <oriel/job/run.h>

#include "store/files/folders.h"

/* ---- The folder ------------------------------------------------------------------------------ */

/* Computes the key of a job. asked: the digest of the request, equal for identical jobs. */
void orl_checkpoint_key(const char *program, const char *asked, const char *scene,
                        char ret_key[ORL_SHA_HEX]);

/* Writes the path of the job's work folder. */
void orl_checkpoint_folder(const struct orl_folders *folders, const char *job_id,
                           char ret_path[ORL_PATH_MAX]);
/* Makes the folder. Keeps its contents if they were made with that key. */
int orl_checkpoint_open(const char *folder, const char *key, struct orl_error *err);
/* Removes the files that are not for users, such as photon maps of rounds. */
void orl_checkpoint_remove_internal(const char *folder);
/* Moves a job's work folder to a job that continues its work. Returns false if that job has its own
 * folder. */
bool orl_checkpoint_transfer(const struct orl_folders *folders, const char *from_id,
                             const char *to_id);
/* Sweeps the work folders. successor returns the job that continues one, maybe that job itself. A
 * folder without a successor is removed, or set aside (removal.h) if the job of that id is not
 * known. */
void orl_checkpoint_sweep(const struct orl_folders *folders,
                          const char *(*successor)(void *ctx, const char *job_id, bool *ret_known),
                          void *ctx);

/* ---- Parts ----------------------------------------------------------------------------------- */

/*
 * Writes the note of a part. files: its synced files, as job_output.h lists them; borrowed. about:
 * further data of the part; owned by the call.
 */
int orl_checkpoint_add(const char *folder, const char *part, json_t *files, json_t *about,
                       struct orl_error *err);
/* Finds a part. Returns true if its note exists and its files are intact; both results, if
 * asked for, are then new references. */
bool orl_checkpoint_find(const char *folder, const char *part, json_t **ret_files,
                         json_t **ret_about);

/* Convert a view's own strings to JSON and back. The caller owns the strings. NULL or false: no
 * memory. */
json_t *orl_checkpoint_view_to_json(const struct orl_view_result *view);
bool orl_checkpoint_view_from_json(const json_t *json, struct orl_view_result *ret_view);

/* Write the sensors' numbers to a synced file, and read them into a result with room for them. */
int orl_checkpoint_sensors_write(const char *folder, const char *name,
                                 const struct orl_result *result, struct orl_error *err);
bool orl_checkpoint_sensors_read(const char *folder, const char *name, struct orl_result *result);

/* ---- The program ----------------------------------------------------------------------------- */

/*
 * Identity of the running program: a digest of the build IDs of itself and its libraries. A build
 * ID is a note by the linker with a digest of its output. A library without the note counts by its
 * name, size and modification time. A copy of the same files, elsewhere or later, is the same
 * program.
 *
 * Call it before there are threads. Libraries load others when they are first used, so a later call
 * may find more of them.
 */

void orl_program_digest(char ret_digest[ORL_SHA_HEX]);

#endif
