/* Glare at viewpoints over a year. */
#ifndef ORL_ANNUAL_VIEWPOINTS_VIEWPOINTS_H
#define ORL_ANNUAL_VIEWPOINTS_VIEWPOINTS_H

#include <stddef.h>
#include <stdint.h>

#include <oriel/annual/annual_glare.h>
#include <oriel/base/thread_pool.h>

#include "annual/year/annual_scene.h"
#include "annual/year/annual_year.h"
#include "base/sampling/sampling.h"
#include "metrics/glare_sources.h"
#include "scene/geometry/geometry.h"

/*
 * Terms of one pixel while its rays are traced: a weight for each bin or visible point seen. Adding
 * a term takes constant time. If a pixel has more terms than a limit, some are sampled without
 * bias.
 *
 * The method is threshold sampling (Duffield, Lund and Thorup 2007, "Priority sampling for
 * estimation of arbitrary subset sums", J. ACM 54(6)), with systematic draws. Weights above a
 * threshold are kept unchanged. Each other weight is kept with a probability proportional to it,
 * and is then set to the threshold. The sum of the weights does not change.
 *
 * Threads: one thread at a time.
 */

/* A bin or visible point that a pixel sees, and its weight (luma). */
struct orl_pixel_term {
    uint32_t which;
    float weight;
};

struct orl_pixel_terms {
    struct orl_pixel_term *at; /* in the order in which they were added */
    size_t count, room;
    uint32_t *slots; /* by which: index in at, plus one; 0: none */
    size_t n_slots;
};

void orl_pixel_terms_done(struct orl_pixel_terms *terms); /* zeros are allowed */

/* Adds the weight to the term `which`. Returns 0 or ORL_ERR_NOMEM. */
int orl_pixel_terms_add(struct orl_pixel_terms *terms, uint32_t which, double weight);
/* Samples at most `most` terms. Returns 0 or ORL_ERR_NOMEM. */
int orl_pixel_terms_thin(struct orl_pixel_terms *terms, size_t most, struct orl_random *random);
/* Removes all terms; memory is reused for the next pixel. */
void orl_pixel_terms_clear(struct orl_pixel_terms *terms);

/*
 * Samples at most `most` of n weights, none of them negative. ret_factors: factor for each weight;
 * 0: not sampled. Returns 0 or ORL_ERR_NOMEM.
 */
int orl_threshold_sample(const double *weights, size_t n, size_t most, struct orl_random *random,
                         double *ret_factors);

/*
 * Points of surfaces that a viewpoint sees, used as sensors of a year. Hits in one cell of
 * directions from the eye, on one side of one surface, form one visible point. To bound memory,
 * beyond ORL_VISIBLE_POINTS_MOST_CLUSTERS visible points surfaces with a similar orientation share
 * a visible point per cell. At most ORL_VISIBLE_POINTS_MOST visible points are kept. The others,
 * which are seen least, take the light of the most similar visible point kept: near it as seen from
 * the eye, and facing alike.
 */

enum { ORL_VISIBLE_POINTS_MOST = 128, ORL_VISIBLE_POINTS_MOST_CLUSTERS = 1 << 17 };

struct orl_hit_cluster {
    uint64_t key;           /* surface, side and cell */
    struct orl_vec3 point;  /* a randomly chosen hit; relative to the scene's centre */
    struct orl_vec3 facing; /* normal of that hit, unit */
    double importance;      /* sum over its hits */
    uint32_t selected;      /* set by choosing: index of the visible point whose light it takes */
};

struct orl_visible_point {
    struct orl_vec3 point, facing; /* relative to the scene's centre; facing is unit */
};

struct orl_visible_points {
    struct orl_vec3 eye;
    struct orl_hit_cluster *found;
    uint32_t *slots; /* hash table by key: index in found, plus one */
    size_t n_found, n_slots;
    uint32_t *selected;                /* indices in found of the visible points that are sensors */
    struct orl_visible_point *sensors; /* the kept visible points */
    size_t n_selected;
};

int orl_visible_points_init(struct orl_visible_points *visible_points, struct orl_vec3 eye);
void orl_visible_points_done(struct orl_visible_points *visible_points);

/* Finds or adds the visible point of a hit. importance: solid angle times the share of light that
 * it sends. Returns 0 or ORL_ERR_NOMEM. */
int orl_visible_points_add(struct orl_visible_points *visible_points, const struct orl_hit *hit,
                           double importance, struct orl_random *random, uint32_t *ret_found);
/* Chooses the visible points to keep. Returns 0, ORL_ERR_NOMEM or _CANCELLED. */
int orl_visible_points_choose(struct orl_visible_points *visible_points,
                              const struct orl_thread_pool *pool);
/* Frees everything except the kept visible points. */
void orl_visible_points_trim(struct orl_visible_points *visible_points);

/*
 * Image of a viewpoint, built once for all hours of a year. It is a fisheye picture. Each pixel is
 * a sum of sky bins, of the light on visible points of surfaces, and of spots that the sun may
 * light.
 *
 * A pixel's rays pass panes, mirrors and lobes (viewpoint_image.c). At each diffuse surface on the
 * path, the surface's visible point adds to the pixel. A visible point represents the visible part
 * of its surface around it; a sensor of the year gives the light there. A pixel's spot is where its
 * first ray hits. Sunlight there is computed hour by hour, so the visible point's own direct
 * sunlight is left out for such rays.
 *
 * Immutable once made. The picture has Radiance's projection -vta with 180 degrees.
 */

enum { ORL_VIEWPOINT_SIDE = 160, ORL_VIEWPOINT_PIXELS = ORL_VIEWPOINT_SIDE * ORL_VIEWPOINT_SIDE };

/* Most terms and spots of a pixel. */
enum { ORL_VIEWPOINT_PIXEL_TERMS = 64, ORL_VIEWPOINT_PIXEL_SPOTS = 8 };

/* A point seen by a pixel's first ray, directly or through panes, where the sun may shine. */
struct orl_viewpoint_spot {
    struct orl_shading_point
        place; /* on the visible side; for transmitted light, on the far side */
    struct orl_hit hit;
    struct orl_vec3 eye;                 /* direction from the spot to the eye */
    const struct orl_material *material; /* material whose lobes send the light on; NULL: diffuse */
    /* Factor of the light sent to the eye; includes 1/pi for diffuse surfaces. */
    struct orl_rgb weight;
    uint32_t pixel;
};

struct orl_viewpoint_image {
    struct orl_view_field field;
    struct orl_shading_point eye;
    uint32_t *first; /* by pixel, and one more: index into terms */
    /* `which` of a term: first the bins, 0 to ORL_BINS - 1; then two per visible point, its light
     * without direct sunlight, and all of its light. */
    struct orl_pixel_term *terms;
    struct orl_viewpoint_spot *spots;
    size_t n_spots;
    struct orl_visible_points visible_points;
    uint64_t n_steps; /* traced ray segments */
};

/* name: the viewpoint's number, for random numbers. The cancel flag of the pool is polled before
 * each pixel. Returns 0, ORL_ERR_NOMEM, _CANCELLED or _RANGE; the caller calls
 * orl_viewpoint_image_done in any case. */
int orl_viewpoint_image_init(struct orl_viewpoint_image *view, const struct orl_annual_scene *scene,
                             const struct orl_viewpoint *viewpoint, uint64_t name,
                             const struct orl_thread_pool *pool, struct orl_error *err);
void orl_viewpoint_image_done(struct orl_viewpoint_image *view);

/*
 * Glare of a viewpoint by hour. Each hour has a picture with its glare sources; the sun's disc and
 * its mirror images are added. DGP uses the vertical illuminance of a sensor at the eye.
 */

/* Light of a year by column; borrowed. */
struct orl_viewpoint_light {
    const struct orl_year *year;
    const unsigned char *wanted;               /* by column */
    const float *eye, *eye_direct, *eye_error; /* lx, by column */
    /* [visible point of the view][two][column], lx: without direct sunlight, and all. */
    const float *visible_points;
};

/* Rates all wanted columns. ret has room for the year's columns. Returns 0, ORL_ERR_NOMEM or
 * ORL_ERR_CANCELLED. */
int orl_viewpoint_glare_compute(const struct orl_viewpoint_image *view,
                                const struct orl_viewpoint_light *light,
                                const struct orl_viewpoint_hours *ret);

#endif
