/*
 * The folder of a shared job (sharing.h), as it lies on disk:
 *
 *     job.json, files.json ({"NAME": "SHA-256"}), files/NAME   the job
 *     store/KIND-KEY.opm                                       what was made of it
 *     WAVE-NUMBER.json, and of each .done or .error            parts
 *     WAVE.wave                                                a wave that has not ended
 *     WAVE.slurm                                               what numbers Slurm gave it
 *
 * It is the owner's alone.
 */
#ifndef ORL_PARTS_SHARED_FOLDER_H
#define ORL_PARTS_SHARED_FOLDER_H

#include <jansson.h>
#include <stddef.h>

#include <oriel/error.h>
#include <oriel/pieces.h>

struct orl_shared_file {
    const char *name, *path; /* what the job calls it, and where it is */
};

/*
 * Lays the job out in path, and what lies there of another job goes; of the same job, by the same
 * version of this program, all stays. What no run has made is left alone: an error. *ret_job: a
 * digest of it all; *ret_earlier: how many pieces of an earlier run are there.
 */
int orl_shared_folder_make(const char *path, const json_t *doc, const struct orl_shared_file *files,
                           size_t n_files, char ret_job[ORL_PIECE_KEY], size_t *ret_earlier,
                           struct orl_error *err);

/* The digest of a document and its files, by what lies in such a folder; files are held against
 * their digests. */
int orl_shared_folder_verify(const char *folder, char ret_job[ORL_PIECE_KEY], json_t **ret_doc,
                             struct orl_error *err);

/* Network file systems look again for what was not there. */
void orl_shared_folder_look(const char *folder);

#endif
