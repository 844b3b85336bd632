/*
 * What of a year others can use again: kept in a store (oriel/run.h) as kind "annual", each by a
 * key of all that it depends on, and nothing else:
 *
 *   suns   scene, site, seed             the sun of each hour as a sum over nodes and beams
 *   map    the same                      sunlight on surfaces inside (sun_map.h)
 *   paths  the same, sensors, samples    coefficients of a block of sensors, batch by batch
 *   sun    the same, sensors             the sun straight to them, of every time of the file
 *   rows   the same, samples, the job    all hours of them: of use to the runs that share the job
 *
 * The site is its place, north, and the times of the weather file's rows; not what was measured
 * then. Samples go on where fewer ended: paths of less accuracy are not made again.
 *
 * The result is the same either way, to the bit. What is damaged or cannot be kept costs time, and
 * is told once. Threads: the lead's.
 */
#ifndef ORL_ANNUAL_KEEP_H
#define ORL_ANNUAL_KEEP_H

#include <oriel/annual.h>

struct orl_year;

enum { ORL_YEARS_ROWS = ORL_YEARS_KINDS }; /* one more, of which nobody is told */

struct orl_keep {
    struct orl_year *year;
    const struct orl_map_store *store; /* NULL: nothing is kept */
    bool off;                          /* no more is asked of it, or put there */
    struct orl_error why;              /* that is so, if something failed */
    bool damaged;                      /* something was */
    struct orl_annual_reused rows;     /* what is told of no one */
    char site[ORL_DIGEST_HEX + 1];     /* a digest of what all depend on */
};

/* Of a year whose scene is loaded and whose hours are read. scene: its digest. */
void orl_keep_begin(struct orl_keep *keep, struct orl_year *year, const unsigned char *scene);

/* One that is asked for. Sensors: count of them from first on; of suns and map 0. */
struct orl_keeping {
    unsigned what; /* an orl_annual_kept, or ORL_YEARS_ROWS */
    size_t first, count;
    uint32_t samples; /* of paths and rows */
    double core_s;    /* of suns and map: that one core is thought to take (oriel/pieces.h) */
    char key[ORL_DIGEST_HEX + 1], family[ORL_DIGEST_HEX + 1], path[4096];
    bool owed;                 /* it is to be put or dropped */
    double began_s, earlier_s; /* by the run's clock; what samples that were there took */
    uint64_t rays;             /* that it took, and samples before it */
    uint32_t had;              /* samples of paths that were there: data has them */
    void *data;                /* owned; NULL: it is to be made */
    size_t size;
};

/* Fills the rest of one that says what, sensors and samples; orl_keep_done in the end. Paths of
 * fewer samples may come: had is less then, and owed true. ORL_ERR_CANCELLED. */
int orl_keep_ask(struct orl_keep *keep, struct orl_keeping *it, struct orl_error *err);
/* What was made, where it is owed; data: a multiple of 4 bytes. */
void orl_keep_put(struct orl_keep *keep, struct orl_keeping *it, const void *data, size_t size);
void orl_keep_done(struct orl_keep *keep, struct orl_keeping *it);

/* Whether the store has it, without reading it. */
bool orl_keep_has(struct orl_keep *keep, struct orl_keeping *it);

/* Of a run that ends well: warns of what went wrong. */
void orl_keep_end(struct orl_keep *keep);

#endif
