/*
 * Persistent cache of a year's intermediate results, in a store (oriel/job/run.h) as kind "annual".
 * Each entry's key digests exactly the data that it depends on:
 *
 *   suns   scene, site, seed             interpolation weights of each sun over nodes and beams
 *   map    as suns                       sunlight on surfaces inside (sun_map.h)
 *   paths  as suns, sensors, samples     coefficients of a chunk of sensors, batch by batch
 *   sun    as suns, sensors, disc points direct sunlight at them, for every time of the file
 *   rows   as paths, the job             all hours of them; shared by the runs of one job
 *
 * The site is the location, north, and the times of the weather file's rows, but not the measured
 * weather. Entries of paths with fewer samples are continued: their samples are not traced again.
 *
 * The result is bit-identical with or without the cache. Entries that are damaged or cannot be
 * stored cost time, and cause one warning. Threads: the lead thread.
 */
#ifndef ORL_ANNUAL_YEAR_ANNUAL_CACHE_H
#define ORL_ANNUAL_YEAR_ANNUAL_CACHE_H

#include <oriel/annual/annual.h>

struct orl_year;

enum {
    ORL_ANNUAL_CACHE_ROWS = ORL_ANNUAL_CACHE_KINDS
}; /* internal kind, not reported in the result */

struct orl_annual_cache {
    struct orl_year *year;
    const struct orl_map_store *store;        /* NULL: nothing is stored */
    bool disabled;                            /* true if the store is no longer used */
    struct orl_error why;                     /* reason for disabled, if something failed */
    bool damaged;                             /* true if an entry was damaged */
    struct orl_annual_cache_stats rows_stats; /* counters of ORL_ANNUAL_CACHE_ROWS, not reported */
    char site[ORL_DIGEST_HEX + 1];            /* digest of the data on which all entries depend */
};

/* Starts the cache of a year whose scene is loaded and whose hours are read. */
void orl_annual_cache_init(struct orl_annual_cache *cache, struct orl_year *year);

/* A requested entry. first and count select its sensors; both are 0 for suns and map. */
struct orl_annual_cache_entry {
    unsigned data_kind; /* an orl_annual_cache_kind, or ORL_ANNUAL_CACHE_ROWS */
    size_t first, count;
    uint32_t samples; /* for paths and rows */
    double core_s;    /* for suns and map: estimated time of one core (oriel/job/job_tasks.h) */
    char key[ORL_DIGEST_HEX + 1], family[ORL_DIGEST_HEX + 1], path[4096];
    bool must_commit; /* true if the entry must be stored or abandoned */
    /* Start by the run's clock; time that the samples found in the store took. */
    double start_s, stored_s;
    uint64_t rays;           /* rays that it took, including those of samples found in the store */
    uint32_t stored_samples; /* samples of paths that data contains */
    void *data;              /* owned; NULL: the entry must be computed */
    size_t size;
};

/* Looks up an entry; the caller has set data_kind, sensors, samples and core_s, and calls
 * orl_annual_cache_release in the end. Paths may come with fewer samples: then stored_samples is
 * smaller, and must_commit is true. Returns 0, ORL_ERR_CANCELLED, or an error of a distributed run.
 */
int orl_annual_cache_get(struct orl_annual_cache *cache, struct orl_annual_cache_entry *entry,
                         struct orl_error *err);
/* Stores a computed entry if must_commit is set, and frees data. size is a multiple of 4 bytes.
 * data may be NULL: there was no memory to pack it, and nothing is stored. */
void orl_annual_cache_put(struct orl_annual_cache *cache, struct orl_annual_cache_entry *entry,
                          void *data, size_t size);
void orl_annual_cache_release(struct orl_annual_cache *cache, struct orl_annual_cache_entry *entry);

/* Returns true if the store has the entry, without reading it. */
bool orl_annual_cache_has(struct orl_annual_cache *cache, struct orl_annual_cache_entry *entry);

/* Ends a successful run: warns of failures and of damaged entries. */
void orl_annual_cache_report(struct orl_annual_cache *cache);

#endif
