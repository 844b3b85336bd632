/*
 * A shelf: what jobs have worked out from scenes and maps, kept in memory for jobs that come after
 * them, up to a number of bytes; what was put there longest ago goes first. What lies on it can be
 * made again at any time, and says the same then: results do not depend on a shelf.
 *
 * A scene is shared by all jobs that use it at the time. Anything else is one job's: who takes it
 * from the shelf has it alone, and puts it back.
 *
 * Locks: one mutex inside. Any thread may take and put.
 */
#ifndef ORIEL_SHELF_H
#define ORIEL_SHELF_H

#include <stdint.h>

struct orl_shelf;

/* On one of 0 bytes nothing ever lies. NULL when out of memory. */
struct orl_shelf *orl_shelf_new(uint64_t most_bytes);
/* With all that lies on it. NULL is allowed. */
void orl_shelf_free(struct orl_shelf *shelf);

struct orl_shelf_totals {
    uint64_t bytes, things; /* that lie there now */
    uint64_t shared;        /* of these things: scenes, which several jobs may use at once */
    uint64_t hits;          /* times that a job found something there, since the shelf was made */
    uint64_t shared_hits;   /* of these: scenes */
};

/* Of no shelf, zeros. */
struct orl_shelf_totals orl_shelf_totals(struct orl_shelf *shelf);

#endif
