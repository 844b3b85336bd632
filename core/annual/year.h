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

#include "annual/keep.h"
#include "annual/overcast.h"
#include "annual/panels.h"
#include "annual/parts.h"
#include "annual/product.h"
#include "annual/reach.h"
#include "annual/scene.h"
#include "annual/terms.h"
#include "light/lights.h"

enum { ORL_YEAR_BLOCK = 64 }; /* sensors at a time, at the most */

struct orl_year;

/* How a run differs from what its request says. All borrowed. */
struct orl_year_variant {
    const struct orl_year *hours_of; /* whose hours it takes; NULL: it reads its own */
    const struct orl_swaps *swaps;   /* of the scene's materials; may be NULL */
    uint32_t part; /* light of that part of the windows alone (parts.h), or of 0: of all */
    bool sun_only; /* direct light alone is wanted: the rest stays 0 */
    struct orl_ports_of_parts *ret_ports; /* may be NULL */
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
    size_t n_sun, n_beams; /* nodes and beams; beams alone */
    struct orl_lights *lights;
    struct orl_world *world;
    int32_t *port_of_facet; /* the world's, where ports are closed; owned */
    struct orl_reach reach; /* of those that are open then */
    double open_share;      /* of the area of all ports; 1 where none is closed */
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
    /* Of the sensors of a block: */
    bool shares_rows; /* with other runs: whoever makes a block makes its hours */
    size_t block;     /* sensors of each, but for the last one */
    size_t first, count;
    atomic_size_t traced;   /* batches */
    uint32_t traced_before; /* samples of each batch that were there */
    struct orl_place places[ORL_YEAR_BLOCK];
    bool dark[ORL_YEAR_BLOCK];          /* no light of the part reaches them */
    float *bin_sums;                    /* [sensor][batch][bin] */
    double *sun_sums;                   /* [sensor][batch][nodes, beams] */
    float *lot_sums;                    /* [sensor][batch][lot][beam] */
    float *rows;                        /* [sensor][of each][column] */
    float *sun_rows;                    /* [sensor][of each][sun] */
    struct orl_annual_factors *factors; /* by sensor */
    double *sun_by_lot;                 /* of those: [sensor][beam][lot] */
    double *sun_by_batch;               /* of those, and their means */
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
