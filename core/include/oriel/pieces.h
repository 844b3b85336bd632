/*
 * A job in pieces, so that many processes, on many machines, can share it: photon maps, stretches
 * of sensors, views, skies, blocks of a year's sensors, runs of a study. Which pieces a job has is
 * a function of the job alone. Each goes by its kind and a key, a digest of all that it depends on,
 * and what is made of it lies in the run's store, as photon maps do.
 *
 * Every run of the job goes the same way through it. Where it comes to pieces that the store does
 * not have it asks which of them it is to make; the others are taken from the store. One that hands
 * all of them to others puts together what they made, in the job's own order: the same bytes as by
 * itself, for any number of others and any order of theirs. One that makes some of them ends when
 * these are made. Rounds of a job with a goal depend on those before them: their pieces are asked
 * for round by round.
 *
 * Jobs for a deadline are not shared: what they find depends on the machine.
 */
#ifndef ORIEL_PIECES_H
#define ORIEL_PIECES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/error.h>

enum { ORL_PIECE_KIND = 16, ORL_PIECE_KEY = 65 };

struct orl_piece {
    char kind[ORL_PIECE_KIND]; /* "sensors", "view", "sky", "global", "annual", ... */
    char key[ORL_PIECE_KEY];   /* lower-case hex */
    double work;               /* how much it is to do beside others of the same call, above 0 */
    double core_s;  /* that one core is thought to take for it, within a factor of several; 0: not
                       known */
    uint64_t bytes; /* of memory that making it takes beside the job itself; 0: little */
};

/* Who is told how much of what others make is made, 0..1, while a run waits for it. By the lead. */
struct orl_pieces_watch {
    void (*told)(void *ctx, double share);
    void *ctx;
};

struct orl_pieces {
    void *ctx;
    const char *job; /* a digest of the job and of all its files: goes into keys */
    /*
     * Pieces that the store has not; none of them needs another. Sets ret_here of those that this
     * run is to make, all false beforehand. When it returns 0 the others are in the store, or will
     * never be asked for. ORL_ERR_CANCELLED ends a run that has made what it was to make. Called by
     * the lead. watch: NULL: nobody wants to know.
     */
    int (*divide)(void *ctx, const struct orl_piece *pieces, size_t n, bool *ret_here,
                  const struct orl_pieces_watch *watch, struct orl_error *err);
    /* Asked when the run has made its pieces of a call: is nothing more wanted of it? Then it ends
     * with ORL_ERR_CANCELLED, and does not put together what others have made by then. NULL: it
     * goes on. By the lead. */
    bool (*over)(void *ctx);
};

static inline bool orl_pieces_are_over(const struct orl_pieces *pieces)
{
    return pieces->over && pieces->over(pieces->ctx);
}

/*
 * A store in a folder that many processes share, on many machines: pieces and maps as
 * <folder>/<kind>-<key>.opm, each written under a name of the process's own and then renamed, so
 * that it is whole or absent. Of two that make the same one the later is kept: they are equal.
 * Maps are never topped up there. All zero but for the folder beforehand; the lead's.
 */
struct orl_shared_store {
    char folder[4096];
    char mark[128];         /* of this process: host and number */
    struct orl_piece *owed; /* asked for, and not there: to be made or given up */
    size_t n_owed, room;
};
struct orl_map_store;
void orl_shared_store_init(struct orl_shared_store *state, struct orl_map_store *ret_store);
void orl_shared_store_done(struct orl_shared_store *state);

#endif
