/*
 * Patterns: factors of a material's colour that vary over its surface. They are functions
 * (brightfunc, colorfunc), or values on grids (brightdata, colordata, colorpict), of the place, the
 * normal and, for emitters, the direction. A pattern may modify another: their factors multiply.
 *
 * A mixture of two materials that differ only in colours and patterns is a pattern too. Its
 * function's value, clamped to 0..1, is the first's share of the colour; where it has no value, the
 * share is 1. For two materials of different kinds (scatter.h) the pattern's factor is the first's
 * share, by the same rule.
 *
 * A reflector's colour with its pattern is clamped to 0..1 in each channel; Radiance would let a
 * surface reflect more than it gets, or less than nothing. Where a function has no value
 * (function.h) or takes too long, the colour is left unchanged.
 *
 * Mean and maximum come from evaluation at 1 024 places of equal area, fewer if there are very many
 * patterns, towards cosine-distributed directions; the planners' bound of a patterned surface is
 * this maximum. For patterns used only by distant light, mean and maximum are over its directions.
 * Rays find such light by chance: a warning is given where a thousandth of all directions has more
 * than a fourth of the light.
 *
 * Spectra (spectrum, specfile, specfunc, specdata) are converted by the standard observer
 * (observer.h): constant ones when they are read, others at every hit, band by band.
 *
 * Texts have two factors, in letters and around them (orl_lettering); as mixtures their share is 1
 * or 0.
 *
 * A texture (texture.h) is a pattern whose three values perturb the normal; patterns and textures
 * may modify each other.
 *
 * Frames: hits are in the geometry's moved coordinates, functions in their own. Patterns on
 * instances (instances.h) are evaluated where the prototype was read. Ownership: a parsed scene
 * owns its patterns. Threads: immutable once the scene is built; each thread has its own scratch.
 */
#ifndef ORL_SCENE_MATERIAL_PATTERNS_PATTERN_H
#define ORL_SCENE_MATERIAL_PATTERNS_PATTERN_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/base/vec.h>

#include "function/function.h"
#include "scene/geometry/geometry.h"
#include "scene/grid/grid.h"
#include "scene/material/function_brdf/function_brdf.h"
#include "scene/material/patterns/observer.h"
#include "scene/parsed_material.h"

/*
 * Texts in a polygonal font: tests whether a place lies in one of the letters.
 *
 * A place's coordinates are (x, y) of origin + x right + y down; lines are 1 apart from the top. A
 * letter is a polygon on a square of 255 by 255, from the lower left, by the even-odd rule; letters
 * may overlap. Units: the scene's. Ownership: all in a parsed scene's arena. Immutable once made.
 */

enum { ORL_GLYPH_SIDE = 255 };

struct orl_glyph {
    const unsigned char *corners; /* x, y, x, y, ... */
    int n;                        /* number of corners; 0: a space */
    int left, right, bottom, top;
};

struct orl_placed_letter {
    const struct orl_glyph *glyph;
    int at; /* left side of its square, in 255ths of a letter's height */
};

struct orl_lettering_line {
    const struct orl_placed_letter *letters;
    size_t n;
    int width; /* right end of the line's last letter, in 255ths */
};

struct orl_lettering {
    struct orl_vec3 origin;
    struct orl_vec3 right, down; /* a place's coordinates are its dot products with these */
    /* units of `at` and `width` per 1 to the right */
    double unit;
    const struct orl_lettering_line *lines;
    size_t n_lines;
};

/* limit of function evaluations of one pattern with all it depends on */
enum { ORL_PATTERN_STEPS = 64 };

/* ---- Sources of a pattern's values ----------------------------------------------------------- */

enum orl_pattern_source {
    ORL_PATTERN_FUNCTION,     /* the program, with or without grids */
    ORL_PATTERN_CONSTANT,     /* constant: a spectrum that does not depend on the place */
    ORL_PATTERN_SPECTRUM,     /* spectrum: the program is evaluated for each band */
    ORL_PATTERN_TEXT,         /* text */
    ORL_PATTERN_MESH_NORMALS, /* corner normals of a mesh's surfaces; textures only */
};

/* Functions of the place, or of values on grids there. All NULL for texts and mesh normals; a
 * constant that was made from functions keeps them. */
struct orl_pattern_program {
    /* owned; gives one factor, or three; with grids, their coordinates */
    struct orl_function *function;
    const struct orl_grid *grids[ORL_GRID_CHANNELS]; /* borrowed from the parsed scene */
    uint32_t n_grids;                                /* 1 for a picture with all channels */
    struct orl_function *values; /* owned; factors from the grids' values; NULL without grids */
};

struct orl_pattern_spectrum {
    const struct orl_spectral_band *bands; /* in the arena */
    uint32_t n_bands;
};

struct orl_pattern_text {
    const struct orl_lettering *lettering; /* in the arena */
    struct orl_rgb inside, around;         /* factors in its letters and elsewhere */
};

/* ---- Roles of a pattern ---------------------------------------------------------------------- */

enum orl_pattern_role {
    ORL_PATTERN_FACTOR,  /* factor of a colour, share of a mixture, factors of a roughness */
    ORL_PATTERN_BLEND,   /* blend: two materials that differ only in colours and patterns */
    ORL_PATTERN_TEXTURE, /* its values perturb the normal (texture.h) */
    ORL_PATTERN_GLAZING, /* not a pattern, but shares of a glazing by the angle */
    ORL_PATTERN_PRISM,   /* prism: not a pattern, but directions of a prism's rays */
    ORL_PATTERN_LOBES,   /* lobes: not a pattern, but values of a material's lobes */
};

/* One of the two components of a blend. */
struct orl_mixed {
    struct orl_rgb color;
    const struct orl_pattern *pattern; /* or NULL */
};

struct orl_pattern_blend {
    struct orl_mixed mixed[2]; /* the pattern's value is the first's share */
};

struct orl_pattern_prism {
    uint32_t n_rays; /* number of rays that the functions give */
};

/* Sampling table of lobes on flat surfaces with that normal. */
struct orl_lobe_table {
    struct orl_vec3 normal;
    float *values;
};

struct orl_pattern_lobes {
    struct orl_lobe_table *tables; /* owned: tables by normal */
    uint32_t n_tables;
    bool sided;          /* the front is the surface's, not the eye's side (BRTDfunc) */
    bool narrow;         /* too narrow for the sampling tables */
    bool opaque;         /* none transmits light */
    double integrals[2]; /* mean integrals, reflected and transmitted */
};

/* ---- Patterns -------------------------------------------------------------------------------- */

/*
 * as_source and as_role hold what only one source or role has. Code that reads them calls the
 * functions below, which assert the source or role in builds with ORL_DEBUG; only the parser, the
 * cache, and the measurements before rendering name the unions (tests/check_boundaries).
 */
struct orl_pattern {
    enum orl_pattern_source source;
    enum orl_pattern_role role;
    const char *name; /* name in messages: "brightfunc dirt" */
    const char *file; /* file of the definition */
    int line;
    uint32_t index;           /* in the parsed scene */
    const unsigned char *key; /* contents of its definition; patterns with equal keys are one */
    size_t key_size;
    const struct orl_pattern *under; /* pattern of the same sort that modifies this one; or NULL */
    const struct orl_pattern *other; /* first of the other sort that modifies this one; or NULL */
    struct orl_pattern_program program;
    union {
        /* The largest comes first: initialisers that leave the union out set all of it to 0. */
        struct orl_pattern_text text;
        struct orl_pattern_spectrum spectrum;
        struct orl_rgb constant;
    } as_source;
    union {
        struct orl_pattern_blend blend;
        struct orl_pattern_prism prism;
        struct orl_pattern_lobes lobes;
    } as_role;
    uint32_t steps;         /* upper bound of function evaluations */
    bool is_rgb;            /* three factors, one per channel */
    bool coloured;          /* true if it or a pattern under it has three factors */
    bool directed;          /* it or a pattern under it depends on the ray's direction */
    bool uses_mesh_uv;      /* it uses a mesh's coordinates (Lu Lv) */
    struct orl_vec3 row[3]; /* from the files' coordinates to the function's */
    struct orl_vec3 offset;
    double scale;                        /* length of the function's unit in the files' units */
    struct orl_vec3 center;              /* the geometry's centre */
    const struct orl_geometry *geometry; /* NULL until geometry is built */
    const struct orl_parsed_scene *parsed_scene; /* the parsed scene that owns it */
    struct orl_rgb mean, maximum;
};
_Static_assert(sizeof((struct orl_pattern *)0)->as_source == sizeof(struct orl_pattern_text) &&
                   sizeof((struct orl_pattern *)0)->as_role == sizeof(struct orl_pattern_blend),
               "the first members of the unions are the largest");

static inline const struct orl_pattern_text *orl_text_of(const struct orl_pattern *pattern)
{
    orl_material_require(pattern->source == ORL_PATTERN_TEXT);
    return &pattern->as_source.text;
}

static inline const struct orl_pattern_spectrum *orl_spectrum_of(const struct orl_pattern *pattern)
{
    orl_material_require(pattern->source == ORL_PATTERN_SPECTRUM);
    return &pattern->as_source.spectrum;
}

static inline struct orl_rgb orl_constant_of(const struct orl_pattern *pattern)
{
    orl_material_require(pattern->source == ORL_PATTERN_CONSTANT);
    return pattern->as_source.constant;
}

static inline const struct orl_pattern_blend *orl_blend_of(const struct orl_pattern *pattern)
{
    orl_material_require(pattern->role == ORL_PATTERN_BLEND);
    return &pattern->as_role.blend;
}

static inline const struct orl_pattern_prism *
orl_prism_functions_of(const struct orl_pattern *pattern)
{
    orl_material_require(pattern->role == ORL_PATTERN_PRISM);
    return &pattern->as_role.prism;
}

static inline const struct orl_pattern_lobes *
orl_lobe_functions_of(const struct orl_pattern *pattern)
{
    orl_material_require(pattern->role == ORL_PATTERN_LOBES);
    return &pattern->as_role.lobes;
}

void orl_pattern_free(struct orl_pattern *pattern); /* NULL is allowed */

/* Lists a material's patterns and textures, including those of mixed materials; returns their
 * number. */
enum { ORL_MIXED_MAX = 8, ORL_MATERIAL_PATTERNS = 5 * ORL_MIXED_MAX };
size_t orl_patterns_of(const struct orl_material *material,
                       struct orl_pattern *ret_patterns[ORL_MATERIAL_PATTERNS]);

/*
 * Returns the factor at a hit; the mean at orl_hit_surface_mean. It is clamped to 0 from below
 * only. towards: unit direction in which the light leaves the surface.
 */
struct orl_rgb orl_pattern_towards(const struct orl_pattern *pattern, const struct orl_hit *hit,
                                   struct orl_vec3 towards);
/* orl_pattern_towards for patterns that do not depend on the direction. */
static inline struct orl_rgb orl_pattern_at(const struct orl_pattern *pattern,
                                            const struct orl_hit *hit)
{
    return orl_pattern_towards(pattern, hit, hit->normal);
}

/* Returns the function's values, three or one, without the patterns under it; false where it has
 * none. */
bool orl_pattern_values(const struct orl_pattern *pattern, const struct orl_hit *hit,
                        struct orl_vec3 towards, double ret_values[3]);

/* Returns the values of a glazing's functions (glazing.c) at that cosine to the front normal; false
 * where one has no value. */
enum { ORL_PATTERN_ANGLES = 6 };
bool orl_pattern_of_angle(const struct orl_pattern *pattern, double cosine,
                          double ret_values[ORL_PATTERN_ANGLES]);

/* Returns the surface that was hit as it was read, if it belongs to a mesh; other surfaces are not
 * stored. orl_pattern_corners: barycentric coordinates of corners b and c at a hit. */
const struct orl_surface *orl_pattern_surface(const struct orl_pattern *pattern,
                                              const struct orl_hit *hit);
void orl_pattern_corners(const struct orl_pattern *pattern, const struct orl_hit *hit,
                         double *ret_b, double *ret_c);

/* Makes a spectrum that does not depend on the place a constant factor. */
void orl_pattern_make_constant(struct orl_pattern *pattern);

/* Returns the factor for distant light from a unit direction. As in Radiance the place is 1e10 away
 * and the normal points at the observer. */
struct orl_rgb orl_pattern_of_sky(const struct orl_pattern *pattern, struct orl_vec3 direction);

/* A colour times a factor, clamped to 1. */
static inline struct orl_rgb orl_patterned(struct orl_rgb color, struct orl_rgb factor)
{
    const struct orl_rgb product = orl_rgb_mul(color, factor);
    return (struct orl_rgb){fmin(product.r, 1), fmin(product.g, 1), fmin(product.b, 1)};
}

/*
 * Evaluates all patterns over their surfaces and sets the fields that depend on geometry. Warns of
 * patterns without a value somewhere. Returns 0; ORL_ERR_LIMIT with file and line if one takes too
 * long; or ORL_ERR_NOMEM.
 */
int orl_patterns_measure(struct orl_parsed_scene *parsed_scene, const struct orl_geometry *geometry,
                         struct orl_error *err);

/*
 * Shared by the files that evaluate patterns: inputs of functions, and validity of values. Internal
 * to this folder and function_brdf.c.
 */

/* Validity of a function's values at a hit; without a value the colour stays unchanged. */
enum orl_pattern_validity { ORL_PATTERN_VALID, ORL_PATTERN_UNDEFINED, ORL_PATTERN_TOO_LONG };

/* Stores a direction in the function's frame, from that input on (function/function.h). */
void orl_pattern_set_direction(const struct orl_pattern *pattern, double *inputs,
                               enum orl_ray_input first, struct orl_vec3 direction);
/* Sets all inputs for a hit seen from that direction. */
void orl_pattern_inputs(const struct orl_pattern *pattern, const struct orl_hit *hit,
                        struct orl_vec3 towards, double inputs[ORL_RAY_INPUTS]);
enum orl_pattern_validity orl_pattern_run(const struct orl_function *function, const double *inputs,
                                          double *ret_values);

/* The factor with the patterns under it. */
enum orl_pattern_validity orl_pattern_factor(const struct orl_pattern *pattern,
                                             const struct orl_hit *hit, struct orl_vec3 towards,
                                             struct orl_rgb *ret_factor);
/* Returns the hit at which distant light from that direction is evaluated. */
struct orl_hit orl_pattern_hit_of_sky(struct orl_vec3 direction);

#endif
