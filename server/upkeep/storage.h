/*
 * The byte budget: what photon maps, loaded BSDFs, results and uploads may take together.
 *
 * When they take more, maps and results go, those first that were of use longest ago, until they
 * take no more than the budget: at once when something is kept, and before something new is
 * accepted. Never touched are maps that a running job has in use or builds; what belongs to jobs
 * that wait or run (their scenes, documents, views done); uploads, which only their owners remove;
 * and results that nobody has asked for yet, for ORL_SERVER_UNFETCHED_S after the job ended.
 * When that is not enough, new uploads and jobs are refused (507) and what was accepted goes on. A
 * job is accepted when there is room for the results that it is expected to leave, beside those of
 * all that wait or run.
 *
 * What is on its way in counts too: bodies on the disk, and files unpacked from them (hold.h). What
 * does not fit is refused by its Content-Length, or once it has met the bound.
 *
 * Not counted: maps being built, work folders of running jobs, the database, and folders.
 * Threads: the loop thread; the room is taken from any.
 */
#ifndef ORL_SERVER_UPKEEP_STORAGE_H
#define ORL_SERVER_UPKEEP_STORAGE_H

#include <stdbool.h>
#include <stdint.h>
#include <uv.h>

#include "cache/map_cache.h"
#include "http/hold.h"
#include "jobs/jobs.h"
#include "process/log.h"
#include "store/blobs.h"

struct orl_request;

enum orl_stored { ORL_STORED_MAPS, ORL_STORED_BSDFS, ORL_STORED_RESULTS, ORL_STORED_UPLOADS };
enum { ORL_STORED_COUNT = 4 };
extern const char *const orl_stored_names[ORL_STORED_COUNT]; /* "maps", "bsdfs", ... */

struct orl_storage {
    uint64_t budget;
    struct orl_room room; /* for what is on its way in, beside what has to stay */
    struct orl_db *db;
    struct orl_map_cache *maps;
    struct orl_jobs *jobs;
    struct orl_blobs *blobs;
    const struct orl_log *log;
    const struct orl_retention_clock *clock;
    uint64_t evicted[ORL_STORED_COUNT]; /* how many, since the start */
    uv_timer_t notes;                   /* writes down what was asked for, now and then */
};

/* Half of what the file system could give: its free bytes, and those the daemon has already. */
uint64_t orl_storage_default(const char *folder, uint64_t used);

void orl_storage_use(const struct orl_storage *storage, uint64_t ret_bytes[ORL_STORED_COUNT]);
uint64_t orl_storage_total(const struct orl_storage *storage);
/* Evicts what it takes. */
void orl_storage_trim(struct orl_storage *storage);

/* Makes room for so many bytes more, of which hold has some already. Returns false when that cannot
 * be. */
bool orl_storage_admit(struct orl_storage *storage, const struct orl_hold *hold, uint64_t bytes);

/* Room for a body of so many bytes, before it comes, taken by hold; or false. */
bool orl_storage_receive(struct orl_storage *storage, struct orl_hold *hold, uint64_t bytes);
/* To be called every second or so: what is on its way in has made others go. */
void orl_storage_look(struct orl_storage *storage);

/* A job's results were asked for. */
void orl_storage_fetched(struct orl_storage *storage, const char *job_id);
/* What was asked for is written down, and the timer closed. */
void orl_storage_stop(struct orl_storage *storage);

#endif
