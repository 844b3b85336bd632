/*
 * An irradiance cache that does not depend on order: records are placed in rounds, each round
 * decided by the records of the rounds before and computed in parallel, so that an image is the
 * same for any number of threads and has no seams.
 *
 * A record holds the gathered irradiance at a place with its gradients and a radius: the harmonic
 * mean of the gather's ray lengths, or less near something close, on a steep gradient, and beside
 * such records (orl_icache_hold_back); at most what a number of pixels measure. It serves a place x
 * with error e = |x - x_i| / R + sqrt(1 - n . n_i) below a = ORL_ICACHE_ACCURACY, where R is the
 * radius or the least that pixels allow.
 *
 * Places are served sparsely, but read from more: from all records whose e is below a when R is
 * ORL_ICACHE_OVERLAP times the radius, or the least, and they turn by as much more. Weights are
 * 1 - e/a. A record is not read through what it has seen near it: a leg of a desk, lit on the other
 * side. Each place is so a mean of several records, whose rays err by chances of their own;
 * weights without a peak leave none of them alone with its noise.
 *
 * References: Ward, Rubinstein, Clear 1988; Ward and Heckbert 1992; Krivanek and Gautron 2009;
 * overlap and weights after Tabellion and Lamorlette 2004.
 */
#ifndef ORL_RENDER_GATHER_ICACHE_H
#define ORL_RENDER_GATHER_ICACHE_H

#include "render/gather/gather.h"

#define ORL_ICACHE_ACCURACY 0.25
#define ORL_ICACHE_OVERLAP 1.5

struct orl_record {
    struct orl_place place;
    struct orl_rgb irradiance;
    struct orl_vec3 by_rotation[3], by_translation[3];
    double error_by_photons, error_by_rays; /* standard ones, of the irradiance's luma */
    double rays;                            /* through strata of its hemisphere: one each */
    double radius, least;                   /* it serves as if the radius were at least that */
    double clear; /* nothing that it has seen is nearer: what is farther may stand behind things */
};

struct orl_icache {
    uint32_t channels;                   /* 3, or 1: all is gray */
    const struct orl_geometry *geometry; /* borrowed: what stands between places; NULL: nothing */
    struct orl_record *records;
    size_t count, capacity;
    /* An index by level (power of two of the record's reach) and cell; rebuilt between rounds. */
    struct orl_icache_entry *entries;
    uint32_t *heads; /* hash table: first entry of a bucket, and an end */
    size_t n_heads;  /* a power of two */
    int lowest_level, highest_level;
    int least_level; /* no cell is smaller */
    size_t looked;   /* parts of the tree and records that orl_icache_hold_back has looked at */
};

void orl_icache_init(struct orl_icache *cache, uint32_t channels);
void orl_icache_done(struct orl_icache *cache);

/* Adds records (copied); they are found after orl_icache_index. Returns 0 or ORL_ERR_NOMEM. */
int orl_icache_add(struct orl_icache *cache, const struct orl_record *records, size_t count);
int orl_icache_index(struct orl_icache *cache);

/*
 * Holds records back where a neighbour within their reach has seen something near: no radius is
 * larger than a neighbour's and the distance to it (Krivanek and Gautron 2009, neighbour clamping).
 * Places that are then no longer served want records of their own. Indexes anew. Takes time
 * n log n for n records of about one radius, however close they stand. Returns 0, ORL_ERR_NOMEM or
 * what orl_crew_try does, and then changes no radius.
 */
int orl_icache_hold_back(struct orl_icache *cache, struct orl_crew *crew);

/* Whether a place needs no record of its own. */
bool orl_icache_serves(const struct orl_icache *cache, const struct orl_place *place);

/* Whether a look-up finds anything there. */
bool orl_icache_reaches(const struct orl_icache *cache, const struct orl_place *place);

/* What records say of a place. */
struct orl_cached {
    struct orl_rgb irradiance;
    double standard_error; /* of its luma */
};

/*
 * Interpolates; false when no record reaches this place, even by overlap. Errors by photons are
 * averaged as values are, for records share photons; errors by rays are each record's own; that of
 * the interpolation is as much as records scatter beyond their rays' noise. What rays do to
 * gradients is not in it.
 */
bool orl_icache_lookup(const struct orl_icache *cache, const struct orl_place *place,
                       struct orl_cached *ret_cached);

/* The same from a few records that are not in the cache, but like its own. */
bool orl_records_lookup(const struct orl_record *records, size_t count,
                        const struct orl_icache *like, const struct orl_place *place,
                        struct orl_cached *ret_cached);

#endif
