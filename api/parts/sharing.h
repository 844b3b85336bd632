/*
 * A job that is shared (oriel/pieces.h): a folder that all who work on it see (shared_folder.h), in
 * which lie the document, its files by their names and digests, the pieces that are made, and
 * parts, each a file that names the pieces it is to make. `oriel part` does one, on any machine.
 *
 * A wave is what a run asks for at a time: its pieces are shared out to parts of about equal work,
 * by their order, which is a function of the job and the number of parts alone. A part that is
 * lost, or fails, is tried three times; then the job ends with that part's own error. One that
 * comes up against Slurm's limit of time or memory is started with twice as much, five times at the
 * most, which are no tries (limits.h). A run that
 * was stopped leaves the folder: the next one of the same job, by the same version, takes up its
 * pieces, and waits for those of its parts that are still under way.
 */
#ifndef ORL_PARTS_SHARING_H
#define ORL_PARTS_SHARING_H

#include <jansson.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <time.h>

#include <oriel/run.h>

#include "parts/runner.h"
#include "parts/shared_folder.h"

enum { ORL_PARTS_MOST = 1000, ORL_PARTS_USUAL = 64 };

/* How the parts of a run stand. */
struct orl_parts_count {
    uint64_t waiting, running, done;
    uint64_t again; /* that were started once more, by us or by Slurm */
    double lost_s;  /* what these had run for */
    uint64_t held;  /* of those that wait: until the shared folder's disk has room */
    uint32_t waves;
};

/* What becomes of a part, for a log. All borrowed. */
struct orl_part_news {
    const char *what; /* "start", "end", "again", "failed" */
    const char *wave;
    uint32_t part, task; /* task: Slurm's number of its array job; 0: none, or not known */
    double ran_s;        /* as long as it was seen to run */
    struct orl_part_limits limits;
    const char *why; /* again, or failed; else NULL */
};

/* All borrowed, until the end of it. */
struct orl_sharing_spec {
    const char *folder; /* its own: made, or taken up */
    const json_t *doc;  /* names its scene's files by their names here */
    const struct orl_shared_file *files;
    size_t n_files;
    uint32_t threads;         /* of a part */
    uint32_t most;            /* parts of a wave, and at once */
    uint64_t memory_bytes;    /* that the job is thought to take; 0: not known (limits.h) */
    const char *program;      /* oriel */
    bool slurm;               /* else processes of this machine, */
    uint32_t abreast;         /* so many at once */
    const char *const *words; /* more of sbatch's options */
    size_t n_words;
    const atomic_bool *cancel;
    const atomic_bool *leaves;  /* NULL, or: when it is set what is under way outlives a cancel */
    double (*now_s)(void *ctx); /* a steady clock, of any ctx */
    /* Called by the lead when the count has changed. May be NULL. */
    void (*told)(void *ctx, const struct orl_parts_count *count);
    /* Likewise, of each part. May be NULL. */
    void (*part_told)(void *ctx, const struct orl_part_news *news);
    void *ctx;
};

struct orl_sharing {
    struct orl_pieces pieces;
    struct orl_map_store store;
    struct orl_shared_store in_folder;
    struct orl_runner runner;
    struct orl_sharing_spec spec;
    char folder[4096], job[ORL_PIECE_KEY];
    size_t earlier; /* pieces of an earlier run that serve again */
    time_t began;
    struct orl_parts_count count, told;
    const struct orl_pieces_watch *watch; /* of the wave under way; or NULL */
    uint64_t parts;                       /* that were started, each time counted */
    double opened_s, load_s;   /* when; and how long until the first wave; 0: there was none */
    double foreseen_s, took_s; /* of parts that have ended, and how long those did run */
};

/* Lays it all out. The caller ends it with orl_sharing_done, after an error, too. */
int orl_sharing_open(struct orl_sharing *sharing, const struct orl_sharing_spec *spec,
                     struct orl_error *err);
/* remove: the folder goes, with all pieces. */
void orl_sharing_done(struct orl_sharing *sharing, bool remove);

/* Of a job that nobody wants any more: ends what Slurm has of it, and removes its folder. May take
 * a minute. An error: some of it may be left. */
int orl_sharing_abandon(const char *folder, double (*now_s)(void *ctx), struct orl_error *err);

#endif
