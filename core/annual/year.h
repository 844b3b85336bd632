/*
 * A year under way: what its stages hand to each other, and what all of them need.
 *
 * Threads: the lead's, but for what blocks.c says of a crew's members.
 */
#ifndef ORL_ANNUAL_YEAR_H
#define ORL_ANNUAL_YEAR_H

#include <stdatomic.h>

#include <oriel/annual.h>
#include <oriel/sha256.h>

#include "annual/block_sums.h"
#include "annual/keep.h"
#include "annual/overcast.h"
#include "annual/panels.h"
#include "annual/parts.h"
#include "annual/product.h"
#include "annual/scene.h"
#include "annual/terms.h"
#include "light/lights.h"

enum { ORL_YEAR_BLOCK = 64 }; /* sensors at a time, at the most */

struct orl_year;

/* A run that sums light by window group (parts.h). The last part is that of windows in no group.
 * All pointers are borrowed. */
struct orl_year_parts {
    size_t n_groups;
    const bool *used;            /* by group: it must have windows, and what belongs to it near */
    const unsigned char *wanted; /* [part][column]: the part's light is added up there; NULL: all */
    bool direct_as_wanted;       /* direct sunlight is of no use elsewhere */
    /* Direct sunlight of a part at a sensor, by column, if that is all that is asked for. */
    void (*sunlit)(void *ctx, size_t sensor, uint32_t part, const float *lx);
    void *ctx; /* its */
};

/* How a run differs from what its request says. All borrowed. */
struct orl_year_variant {
    const struct orl_year *hours_of;    /* whose hours it takes; NULL: it reads its own */
    const struct orl_swaps *swaps;      /* of the scene's materials; may be NULL */
    const struct orl_year_parts *parts; /* NULL: light is not told apart */
    /* The run finds direct sunlight alone, and the rest stays 0. With parts, it calls their sunlit
     * and puts nothing into the result. */
    bool sun_only;
    bool sensors_checked; /* an earlier run of the job has warned of misplaced sensors */
    /* Told once it is prepared, before sensors are looked at: it may give the year another request,
     * which differs in these alone. May be NULL. A negative orl_err ends the run. */
    int (*prepared)(void *ctx, struct orl_year *year, struct orl_error *err);
    void *ctx; /* its */
};

struct orl_year {
    const struct orl_annual_request *request;
    const struct orl_year_variant *variant;
    const struct orl_annual_env *env;
    struct orl_annual_result *result;
    struct orl_bins bins;
    struct orl_overcast overcast;
    struct orl_hours hours;
    struct orl_sun_nodes nodes;
    struct orl_frame *node_frames; /* as the scene has them */
    struct orl_sun_terms terms;
    size_t n_beams;
    struct orl_lights *lights;
    struct orl_world *world;
    struct orl_annual_scene scene;
    struct orl_panels panels;
    bool has_panels; /* they are made */
    struct orl_keep keep;
    unsigned char digest[ORL_SHA256_BYTES]; /* of the scene */
    bool hushed;                            /* what would be warned of has been told */
    uint32_t batch_samples;
    double started_s, blocks_s; /* by the run's clock: the whole, and its blocks */
    double told;                /* of the run's progress: it never falls */
    size_t kept;                /* sensors that came without being computed */
    uint32_t n_parts;           /* of the windows */
    unsigned char *wanted_suns; /* [part][sun]: in some column; NULL: all */
    uint16_t *part_of_beam;
    /* Of the sensors of a block: */
    bool shares_rows; /* with other runs: whoever makes a block makes its hours */
    size_t block;     /* sensors of each, but for the last one */
    size_t first, count;
    atomic_size_t traced;   /* batches */
    uint32_t traced_before; /* samples of each batch that were there */
    struct orl_place places[ORL_YEAR_BLOCK];
    struct orl_block_sums sums;
    float *rows;                       /* [sensor][of each][column] */
    float *between;                    /* [sensor][column]: of coherence.h, as the next two are */
    struct orl_error_sums *error_sums; /* [tile][sensor][band] */
    struct orl_sun_cells cells;
    bool *lit;                          /* by sensor and part: it has factors */
    struct orl_annual_factors *factors; /* by sensor and part */
    double *factor_nodes;               /* of those */
    struct orl_annual_beams *beams;     /* by sensor */
    double *beam_factors, *lot_factors; /* of those */
    uint32_t *beam_lists;               /* [sensor][those with factors] */
    struct orl_health *healths;         /* by member */
};

/* As orl_annual_run, of one scene: the request's groups are not looked at. variant may be NULL. */
int orl_year_run(const struct orl_annual_request *request, const struct orl_annual_env *env,
                 const struct orl_year_variant *variant, struct orl_annual_result *ret_result,
                 struct orl_error *err);

static inline bool orl_year_is_sun_only(const struct orl_year *y)
{
    return y->variant && y->variant->sun_only;
}

/* Of a year's bins, the hours of its weather file; and what of these its result has. Both have
 * orl_hours_done done to hours. */
int orl_year_read_hours(struct orl_year *y, struct orl_error *err);
int orl_year_borrow_hours(struct orl_year *y, const struct orl_year *from, struct orl_error *err);
void orl_year_tell_hours(struct orl_year *y);

/* A file of the scene, once: ORL_ERR_NOMEM. */
int orl_annual_note_read(struct orl_annual_result *result, const char *name);

void orl_year_warn(struct orl_year *y, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

double orl_year_now(const struct orl_year *y);
/* Books what has passed since *since, which becomes now. */
void orl_year_book(struct orl_year *y, enum orl_annual_stage stage, double *since);

/* Tells how far the run is, by the time that its blocks have taken so far. sensors: that are done,
 * whole or in part. */
void orl_year_tell(struct orl_year *y, enum orl_stage stage, double sensors);

/* All return the code. */
int orl_year_no_memory(struct orl_error *err);
int orl_year_cancelled(struct orl_error *err);
/* One of those two, by the code: ORL_ERR_CANCELLED or ORL_ERR_NOMEM. */
int orl_year_failed(const struct orl_year *y, int code, struct orl_error *err);

#endif
