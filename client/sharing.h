/*
 * A job that is shared (oriel/pieces.h): a folder that all who work on it see, in which lie the
 * document, its files by their names and digests, the pieces that are made, and parts, each a file
 * that names the pieces it is to make. `oriel part` does one, on any machine.
 *
 *     FOLDER/job.json, files.json ({"NAME": "SHA-256"}), files/NAME, store/KIND-KEY.opm,
 *     FOLDER/WAVE-NUMBER.json, and of each .done or .error (a problem document)
 *
 * A wave is what a run asks for at a time: its pieces are shared out to parts of about equal work,
 * by their order, which is a function of the job and the number of parts alone. A part that is
 * lost, or fails, is tried three times; then the job ends with that part's own error. A run that
 * was stopped leaves the folder: the next one of the same job, by the same version, takes up its
 * pieces.
 */
#ifndef ORL_CLIENT_SHARING_H
#define ORL_CLIENT_SHARING_H

#include <jansson.h>
#include <stdatomic.h>
#include <time.h>

#include <oriel/run.h>

#include "runner.h"
#include "task_json.h"

/* What the command line says of it. */
struct orl_sharing_line {
    const char *parts_text; /* --parts: of a wave, at the most */
    const char *sbatch;     /* --sbatch: options of it */
    bool slurm;             /* --slurm */
};
#define ORL_OPTIONS_SHARING(line)                                                                  \
    {.name = "parts",                                                                              \
     .metavar = "N",                                                                               \
     .help = "do it in up to N parts at a time, each a process of its own; same results",          \
     .value = &(line)->parts_text},                                                                \
        {.name = "slurm",                                                                          \
         .help = "parts are tasks of Slurm; DIR and this program are where all nodes see them",    \
         .flag = &(line)->slurm},                                                                  \
    {                                                                                              \
        .name = "sbatch", .metavar = "OPTIONS",                                                    \
        .help = "with --slurm: more options of sbatch, as \"--partition=long --time=60\"",         \
        .value = &(line)->sbatch                                                                   \
    }
enum { ORL_SHARING_OPTIONS = 3 };

struct orl_sharing {
    struct orl_pieces pieces;
    struct orl_map_store store;
    struct orl_shared_store in_folder;
    struct orl_runner runner;
    const atomic_bool *cancel; /* borrowed */
    char folder[4096], job[ORL_PIECE_KEY];
    char aside[4096], earlier_job[ORL_PIECE_KEY]; /* what an earlier run has left */
    size_t earlier;                               /* pieces of it that serve again */
    time_t began;
    uint32_t threads, most;
    uint32_t wave;         /* so many were asked for */
    uint64_t parts, again; /* that were run, and of these once more */
};

/* Whether the line asks for it; *ret_rc: ORL_EXIT_USAGE where it makes no sense. */
struct orl_subcommand;
bool orl_sharing_asked(const struct orl_subcommand *self, const struct orl_sharing_line *line,
                       int *ret_rc);

/* Lays it all out in output/parts, which is the owner's alone. doc: what names its
 * scene's files below folder. threads: of a part. The caller ends it with orl_sharing_done, after
 * an error, too. */
int orl_sharing_open(struct orl_sharing *sharing, const struct orl_sharing_line *line,
                     const json_t *doc, const char *folder, const char *output, uint32_t threads,
                     const atomic_bool *cancel, struct orl_error *err);
/* How many parts there were, on stderr. */
void orl_sharing_tell(const struct orl_sharing *sharing);
/* remove: the folder goes, with all pieces. */
void orl_sharing_done(struct orl_sharing *sharing, bool remove);

/* The digest of a document and its files, by what lies in such a folder; files are held against
 * their digests. */
int orl_sharing_verify(const char *folder, char ret_job[ORL_PIECE_KEY], json_t **ret_doc,
                       struct orl_error *err);

#endif
