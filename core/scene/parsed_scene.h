/*
 * Parsed scene: the contents of a set of Radiance scene files, after aliases, modifiers and
 * commands are resolved. The numbers are doubles in the files' own units and coordinates. The
 * parser (parse.h) fills it; geometry, lights and materials read it.
 *
 * Invariants: every number is finite; every material index is valid; polygons have at least three
 * vertices and a non-zero normal (degenerate ones are counted in n_degenerate and dropped);
 * directions are unit vectors; radii are positive, except that one end of a cone and the inner
 * radius of a ring may be 0.
 *
 * Ownership: an orl_parsed_scene owns everything in it. Its strings lie in `arena`; vertices and
 * names of surfaces lie in `outlines`. orl_parsed_scene_free_surfaces frees the latter once
 * geometry is built: millions of surfaces take more memory than ray tracing needs.
 */
#ifndef ORL_SCENE_PARSED_SCENE_H
#define ORL_SCENE_PARSED_SCENE_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/vec.h>

#include "base/io/checked_file.h"
#include "scene/generate/xform.h"
#include "scene/parsed_material.h"

struct orl_arena;
struct orl_grid;
struct orl_surface_labels;

enum orl_surface_kind {
    ORL_SURFACE_POLYGON,
    ORL_SURFACE_SPHERE,   /* center[0], radius[0]; normal outwards */
    ORL_SURFACE_BUBBLE,   /* center[0], radius[0]; normal inwards */
    ORL_SURFACE_CYLINDER, /* center[0..1], radius[0]; normal outwards */
    ORL_SURFACE_TUBE,     /* center[0..1], radius[0]; normal inwards */
    ORL_SURFACE_CONE,     /* center[0..1], radius[0..1]; normal outwards */
    ORL_SURFACE_CUP,      /* center[0..1], radius[0..1]; normal inwards */
    ORL_SURFACE_RING,     /* center[0], normal, radius[0] < radius[1] */
};

static inline bool orl_surface_kind_is_flat(enum orl_surface_kind kind)
{
    return kind == ORL_SURFACE_POLYGON || kind == ORL_SURFACE_RING;
}

/* Centres and radii of quadrics, stored separately because nearly all surfaces are polygons. */
struct orl_quadric {
    struct orl_vec3 center[2];
    double radius[2];
};
extern const struct orl_quadric orl_quadric_none; /* all 0: for polygons */

struct orl_surface {
    enum orl_surface_kind kind;
    bool has_uv;      /* polygon of a mesh that has (u, v): orl_surface_uv */
    bool has_normals; /* polygon of a mesh that has normals: orl_surface_normals */
    uint32_t material;
    uint32_t modifier_order; /* rank of the modifier's definition in the files; later is larger */
    uint32_t n_vertices;     /* 0: not a polygon, or one that other surfaces cut away completely */
    int line;
    char *name;
    const char *file;                      /* points into orl_parsed_scene.files */
    union {                                /* allocated in orl_parsed_scene.outlines */
        struct orl_vec3 *vertices;         /* polygon */
        const struct orl_quadric *quadric; /* all other kinds; never NULL */
    };
    struct orl_vec3 normal; /* ring: as written; polygon: unit normal by Newell's method */
};

/* Returns the (u, v) coordinates of a mesh polygon's corners, for patterns; NULL if it has none.
 * They lie behind the vertices. */
static inline const double *orl_surface_uv(const struct orl_surface *surface)
{
    return surface->has_uv ? (const double *)(surface->vertices + surface->n_vertices) : NULL;
}

/* Returns the normals of a mesh polygon's corners, unit or 0; NULL if it has none. They lie behind
 * the (u, v) coordinates. */
static inline const struct orl_vec3 *orl_surface_normals(const struct orl_surface *surface)
{
    const size_t uv = surface->has_uv ? 2 * sizeof(double) * surface->n_vertices : 0;
    const char *const behind = (const char *)(surface->vertices + surface->n_vertices);
    return surface->has_normals ? (const struct orl_vec3 *)(const void *)(behind + uv) : NULL;
}

/* A "source" primitive: light from infinitely far away, within angle/2 of dir. */
struct orl_distant_source {
    uint32_t material; /* LIGHT or GLOW */
    char *name;
    struct orl_vec3 direction; /* towards the source, unit */
    double angle_deg;          /* full opening angle, 0 < angle <= 360; 180: a hemisphere */
};

/* A sky or ground pattern as gendaylit and gensky write it: the two forms of skybright. */
enum orl_sky_kind { ORL_SKY_PEREZ, ORL_SKY_CIE };

struct orl_sky {
    enum orl_sky_kind kind;
    double a[10]; /* the arguments, A1..A10, as in perezlum.cal or skybright.cal */
    int n_args;
};

/* Two coincident polygons that face opposite ways: a ray hits each from its front. */
struct orl_opposed_pair {
    uint32_t surfaces[2];
};

/* Surfaces that are instanced, stored once as they are in the first of their places
 * (parse/instance/instanced_files.h says which surfaces may be instanced). */
struct orl_prototype {
    struct orl_surface *surfaces; /* surfaces and labels have the meaning of orl_parsed_scene's */
    size_t n_surfaces;
    struct orl_surface_labels *labels;
    struct orl_opposed_pair *opposed; /* coincident.h */
    size_t n_opposed;
    size_t prefix_bytes; /* length of the prefix that the first place gave their names */
    bool has_patterns;   /* has patterns or textures, which are evaluated in the first place */
};

/* One instance of a prototype (surfaces.h). */
struct orl_placement {
    uint32_t prototype;
    struct orl_xform xform; /* from the prototype's surfaces to this place */
    const char *name;       /* name of all its surfaces (a mesh); NULL: they have their own */
    const char *prefix;     /* prefix of their names, with its full stop; both in the arena */
    size_t before;          /* number of surfaces that come before it in the files */
    size_t main_file;       /* index among the files that the caller named */
};

/* A file that was read; a name under which no file was found. library: it belongs to the library,
 * not to the scene. */
struct orl_file_record {
    unsigned char content[32]; /* its SHA-256 */
    bool library;
};
struct orl_missing_file {
    const char *name;
    bool library;
};

/* The files that a scene was read from; all arrays lie in the arena. */
struct orl_scene_source {
    struct orl_file_record *read;     /* content of each file */
    struct orl_missing_file *missing; /* names that were looked for in vain */
    size_t n_missing;                 /* SIZE_MAX: too many to be listed */
    size_t n_main;          /* number of leading files that the caller named as scene text */
    size_t *first_surfaces; /* index of the first surface of each name that the caller gave */
    size_t n_first_surfaces;
};

struct orl_parsed_scene {
    struct orl_material *materials;
    size_t n_materials;
    struct orl_surface *surfaces; /* NULL once orl_parsed_scene_free_surfaces has freed them */
    size_t n_surfaces;
    struct orl_surface_labels *labels; /* set by orl_parsed_scene_free_surfaces; NULL before */
    struct orl_opposed_pair *opposed;  /* coincident.h; NULL after orl_parsed_scene_free_surfaces */
    size_t n_opposed;
    struct orl_prototype *prototypes;
    size_t n_prototypes;
    struct orl_placement *placements; /* in the order of the files */
    size_t n_placements;
    struct orl_distant_source *distant_sources;
    size_t n_distant_sources;
    struct orl_sky *skies;
    size_t n_skies;
    struct orl_pattern **patterns;
    size_t n_patterns;
    struct orl_grid **grids; /* grids that patterns interpolate, one per file (grid/grid.h) */
    size_t n_grids;
    size_t n_undefined; /* number of patterns without a value at some place
                           (material/patterns/pattern.h) */
    char **files;       /* names of all files read, in order of first use */
    size_t n_files;
    struct orl_scene_source source;
    bool coincidences_resolved; /* coincident surfaces have been resolved (scene/built/scene.h) */
    uint64_t n_read;            /* if they have been resolved: number of surfaces in the files */
    uint64_t n_degenerate;    /* polygons dropped: zero area or fewer than three distinct corners */
    unsigned char digest[32]; /* SHA-256 over length and content of all files read, in order */
    char **warnings;
    size_t n_warnings;
    struct orl_arena *arena; /* holds the strings above, except surface names */
    /* holds surface names, vertices and orl_quadric; NULL after orl_parsed_scene_free_surfaces */
    struct orl_arena *outlines;
    struct orl_checked_file file; /* mapped cache file that replaces outlines (cache/) */
    const atomic_bool *cancel;    /* cancel flag, polled while geometry is built; may be NULL */
};

/* Adds a copy of a material after parsing. Returns 0 or ORL_ERR_NOMEM. */
int orl_parsed_scene_add_material(struct orl_parsed_scene *parsed_scene,
                                  const struct orl_material *material, uint32_t *ret_index);

/* Adds a warning, of at most 639 bytes; does nothing if out of memory. */
void orl_parsed_scene_warn(struct orl_parsed_scene *parsed_scene, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/*
 * Frees the surfaces, but makes their labels first; n_surfaces stays. The surfaces stay if some
 * belong to a mesh with normals or (u, v) coordinates, which patterns read. Returns 0 or
 * ORL_ERR_NOMEM.
 */
int orl_parsed_scene_free_surfaces(struct orl_parsed_scene *parsed_scene);

/* Returns true if the up vector of a BSDF is parallel to the normal of a flat surface of it, so
 * that its azimuth is undefined; false for other materials and surfaces. */
bool orl_bsdf_up_is_undefined(const struct orl_material *material,
                              const struct orl_surface *surface);

/* Frees everything that the parsed scene owns; accepts NULL and half-filled ones. */
void orl_parsed_scene_done(struct orl_parsed_scene *parsed_scene);

#endif
