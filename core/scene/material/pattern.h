/*
 * Patterns: factors of a material's colour that vary over its surface, by functions (brightfunc,
 * colorfunc), or by values on grids (brightdata, colordata, colorpict), of the place, the normal
 * and, of what shines, the direction. A pattern may modify another: their factors multiply.
 *
 * A mixture of two materials that differ in nothing but colours and patterns is a pattern too: its
 * function's value, cut to 0 to 1, is the first's share of the colour, which is all of it where
 * there is no value.
 *
 * Of two that are unlike (scatter.h) its factor is the first's share, by the same rule.
 *
 * What a pattern makes of a reflector's colour is from 0 to 1 in each channel: where Radiance would
 * have a surface return more than it gets, or less than nothing, it is cut to that. Where anything
 * in a function has no value (function.h), or it takes too long, the colour is left as it is.
 *
 * Mean and most are found by evaluation at 1 024 places of even area, fewer where there are very
 * many patterns, towards directions spread by the cosine: what planners call a bound of a patterned
 * surface is the most of these. Of what lies on distant light alone they are over its directions.
 * Rays find that by chance: where a thousandth of all directions has more than a fourth of its
 * light, a warning says so.
 *
 * Spectra (spectrum, specfile, specfunc, specdata) are what an eye makes of them (observer.h):
 * those that are the same everywhere when they are read, others at every hit, band by band.
 *
 * Texts have two factors, in letters and around them (text.h); as mixtures, all of one or the
 * other.
 *
 * A texture (texture.h) is one whose three values turn the normal; both sorts may modify each
 * other.
 *
 * Frames: hits are in the geometry's moved coordinates, functions in their own. What the scene
 * keeps once for several places (placed.h) is asked where it was read. Ownership: a description
 * owns its patterns. Threads: immutable once settled; each thread has scratch of its own.
 */
#ifndef ORL_SCENE_MATERIAL_PATTERN_H
#define ORL_SCENE_MATERIAL_PATTERN_H

#include "function/function.h"
#include "scene/geometry/geometry.h"
#include "scene/grid/grid.h"
#include "scene/material/observer.h"
#include "scene/material/own.h"

enum { ORL_PATTERN_STEPS = 64 }; /* functions of one pattern, with all that it depends on */

/* What a mixture mixes. */
struct orl_mixed {
    struct orl_rgb color;
    const struct orl_pattern *pattern; /* or NULL */
};

struct orl_lettering;

/* What draws of lobes are by, on flat surfaces of that normal. */
struct orl_known_lobes {
    struct orl_vec3 normal;
    float *values;
};

struct orl_pattern {
    const char *name; /* as errors have it: "brightfunc dirt" */
    const char *file; /* where it is defined */
    int line;
    const unsigned char *key; /* what it was made of: two of the same are one */
    size_t key_size;
    struct orl_function *function; /* owned; one factor, or three; of grids, the coordinates */
    const struct orl_grid *grids[ORL_GRID_CHANNELS]; /* the description's */
    uint32_t n_grids;                                /* 1 of a picture, with all channels */
    struct orl_function *values;     /* owned; factors by what the grids hold; NULL without */
    const struct orl_pattern *under; /* modifies this one, and is of its sort; or NULL */
    const struct orl_pattern *other; /* the first of the other sort that does; or NULL */
    bool texture;                    /* its values turn the normal (texture.h): the other sort */
    bool smooth;                     /* a texture: the normals of a mesh's corners, no function */
    bool fixed;                      /* factor is its own factor everywhere: no function */
    struct orl_rgb factor;
    const struct orl_lettering
        *text; /* the arena's: factor in its letters, around elsewhere; or NULL */
    struct orl_rgb around;
    const struct orl_band
        *bands; /* of a spectrum, the arena's: values is asked for each; or NULL */
    uint32_t n_bands;
    enum orl_own_kind own; /* no pattern, but a material's own functions */
    uint32_t n_own;        /* how many */
    bool sided;            /* of lobes: the front is the surface's, not the eye's side (BRTDfunc) */
    struct orl_known_lobes *known; /* owned; of lobes: tables by normals (lobed.h) */
    uint32_t n_known;
    bool narrow;    /* of lobes: draws do not see all of them (lobed.h) */
    bool opaque;    /* of lobes: none lets light through */
    double sent[2]; /* of lobes: what they come to, reflected and transmitted, on the whole */
    bool mixture;
    struct orl_mixed mixed[2];
    uint32_t steps;         /* evaluations of functions that it takes, at most */
    bool three;             /* factors: one for each channel */
    bool coloured;          /* the same of it and all under it */
    bool directed;          /* it, or one under it, asks for the ray's direction */
    bool meshed;            /* it asks for a mesh's coordinates (Lu Lv) */
    uint32_t index;         /* in the description */
    struct orl_vec3 row[3]; /* from the files' coordinates to the function's */
    struct orl_vec3 offset;
    double scale;                        /* lengths of the function's in units of the files' */
    struct orl_vec3 center;              /* the geometry's */
    const struct orl_geometry *geometry; /* NULL: before there is one */
    const struct orl_description *description; /* that it is of */
    struct orl_rgb mean, most;
};

void orl_pattern_free(struct orl_pattern *pattern); /* NULL is allowed */

/* A material's patterns and textures, those of what it mixes too; how many. */
enum { ORL_MIXED_MOST = 8, ORL_MATERIAL_PATTERNS = 5 * ORL_MIXED_MOST };
size_t orl_patterns_of(const struct orl_material *material,
                       struct orl_pattern *ret_patterns[ORL_MATERIAL_PATTERNS]);

/*
 * Its factor at a hit; the mean at one that is anywhere. Not cut to anything but 0. towards: unit,
 * away from the surface, to whom the light goes.
 */
struct orl_rgb orl_pattern_towards(const struct orl_pattern *pattern, const struct orl_hit *hit,
                                   struct orl_vec3 towards);
/* Of one that asks for no direction. */
static inline struct orl_rgb orl_pattern_at(const struct orl_pattern *pattern,
                                            const struct orl_hit *hit)
{
    return orl_pattern_towards(pattern, hit, hit->normal);
}

/* What its function gives there, without those under it: three numbers, or one; false where it has
 * none. */
bool orl_pattern_values(const struct orl_pattern *pattern, const struct orl_hit *hit,
                        struct orl_vec3 towards, double ret_values[3]);

/* What the functions of a glazing (glazing.c) give at that cosine to the front's normal; false
 * where one has no value. */
enum { ORL_PATTERN_ANGLES = 6 };
bool orl_pattern_of_angle(const struct orl_pattern *pattern, double cosine,
                          double ret_values[ORL_PATTERN_ANGLES]);

/* The surface that was hit, as it was read: of meshes, which alone are kept. Shares of a triangle's
 * corners b and c at a hit on it. */
const struct orl_surface *orl_pattern_surface(const struct orl_pattern *pattern,
                                              const struct orl_hit *hit);
void orl_pattern_corners(const struct orl_pattern *pattern, const struct orl_hit *hit,
                         double *ret_b, double *ret_c);

/* A spectrum that depends on no place is found once. */
void orl_pattern_fix(struct orl_pattern *pattern);

/* Its factor for distant light from a direction (unit): the place is as far away as Radiance has it
 * there, 1e10, the normal points at who looks. */
struct orl_rgb orl_pattern_of_sky(const struct orl_pattern *pattern, struct orl_vec3 direction);

/* A colour with a factor, cut as above. */
static inline struct orl_rgb orl_patterned(struct orl_rgb color, struct orl_rgb factor)
{
    const struct orl_rgb product = orl_rgb_mul(color, factor);
    return (struct orl_rgb){fmin(product.r, 1), fmin(product.g, 1), fmin(product.b, 1)};
}

/*
 * Evaluates all patterns over the surfaces that have them, and fills in what depends on the
 * geometry. A warning tells of those that have no value somewhere. ORL_ERR_LIMIT, with its place,
 * when one takes too long somewhere; ORL_ERR_NOMEM.
 */
int orl_patterns_settle(struct orl_description *description, const struct orl_geometry *geometry,
                        struct orl_error *err);

#endif
