/*
 * BSDFs made from a panel or from measurements, with a run's store (oriel/job/run.h): results are
 * cached there as kind "made", and the work is distributed over processes. Cached and new results
 * are bitwise the same.
 */
#ifndef ORIEL_BSDF_BSDF_STORE_H
#define ORIEL_BSDF_BSDF_STORE_H

#include <oriel/bsdf/bsdf_fit.h>
#include <oriel/bsdf/bsdf_make.h>
#include <oriel/job/job_tasks.h>
#include <oriel/job/run.h>

#define ORL_BSDF_CACHE_KIND "made"

struct orl_bsdf_cache_key {
    const struct orl_map_store *store;
    /* ORL_DIGEST_HEX digits that identify all inputs of the BSDF, including the program version;
     * computed by the caller. */
    const char *key;
    double (*now_s)(void *ctx); /* monotonic clock, seconds; called with the environment's ctx */
};

/*
 * Like orl_bsdf_make and orl_bsdf_fit, with a cache. *ret_info describes the cache entry; `cached`
 * is true if it existed, and `emitted` counts its paths or rows. Error files (errors_xml) are not
 * cached: a request for them returns ORL_ERR_INVALID. If an entry cannot be stored, or is damaged,
 * the BSDF is computed again.
 */
int orl_bsdf_make_cached(const struct orl_bsdf_make_request *request,
                         const struct orl_bsdf_make_env *env,
                         const struct orl_bsdf_cache_key *cache_key, struct orl_map_info *ret_info,
                         struct orl_bsdf_make_result *ret_result, struct orl_error *err);
int orl_bsdf_fit_cached(const struct orl_bsdf_fit_request *request,
                        const struct orl_bsdf_make_env *env,
                        const struct orl_bsdf_cache_key *cache_key, struct orl_map_info *ret_info,
                        struct orl_bsdf_fit_result *ret_result, struct orl_error *err);

/*
 * Distributes the computation of a panel's BSDF (oriel/bsdf/bsdf_make.h) over processes
 * (oriel/job/job_tasks.h). A task is the paths of a few incident directions; with an accuracy,
 * those of one round.
 */

/* Borrowed. The store never blocks (orl_shared_store). */
struct orl_bsdf_task_store {
    const struct orl_job_tasks *tasks;
    const struct orl_map_store *store;
};

/* Returns the distributor for the environment of orl_bsdf_make; it borrows the state. */
struct orl_bsdf_distributor orl_bsdf_distribute(struct orl_bsdf_task_store *state);

#endif
