/*
 * What a run does with pieces of its work that others may make (oriel/pieces.h): finds them in the
 * store, makes its own, and puts them there.
 */
#ifndef ORL_RUN_PIECES_H
#define ORL_RUN_PIECES_H

#include <oriel/pieces.h>
#include <oriel/sha256.h>

#include "run/stages.h"

/* Of memory: a photon while its map is built; a pixel with its error, and what its files are made
 * of. */
enum { ORL_PHOTON_BYTES = 60, ORL_PIXEL_BYTES = 64 };

/* Pieces of one stage, none of which needs another. */
struct orl_piece_work {
    struct orl_piece *pieces;
    size_t n;
    void *ctx;
    /* Makes one, which is then the run's own, and packs it: *ret_data is the caller's, its size a
     * multiple of 4. */
    int (*make)(void *ctx, size_t index, void **ret_data, size_t *ret_size, struct orl_error *err);
    /* Takes one that was found. *ret_taken: it is what it should be. */
    int (*take)(void *ctx, size_t index, const void *data, size_t size, bool *ret_taken,
                struct orl_error *err);
    /* How much of those that others make is made. May be NULL. */
    void (*told)(void *ctx, double share);
};

/* Makes or takes all of them. Of a run that is shared. */
int orl_run_pieces(const struct orl_run_env *env, const struct orl_piece_work *work,
                   struct orl_error *err);

/* Of pieces that come to that share of what the stage under way is foreseen to take: the seconds of
 * each, by its work. */
void orl_pieces_foresee(const struct orl_run_state *state, struct orl_piece_work *work,
                        double share);

/* Whether the run is shared; a pilot never is. */
bool orl_run_is_shared(const struct orl_run_state *state);

/* A key begun with the job, its sky, and its round. */
void orl_piece_key_begin(const struct orl_run_state *state, struct orl_sha256 *hash);
void orl_piece_key_end(struct orl_sha256 *hash, char ret_key[ORL_PIECE_KEY]);

/* What was counted beside something of that key, for others to count as theirs. Where it cannot be
 * kept, or is not there, it is not counted: false. */
void orl_run_keep_counts(const struct orl_run_state *state, const char *key,
                         const struct orl_health *health);
bool orl_run_add_counts(struct orl_run_state *state, const char *key);

/* The same of what was warned of: those of the result's warnings from first on; and of them what
 * the run has not said yet. */
void orl_run_keep_warnings(const struct orl_run_state *state, const char *key, size_t first);
void orl_run_add_warnings(struct orl_run_state *state, const char *key);

/* What members of the crew have counted, taken from them: *ret_health. */
void orl_run_take_health(const struct orl_run_state *state, struct orl_health *ret_health);

#endif
