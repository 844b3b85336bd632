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
#include <oriel/bsdf/bsdf.h>

#include "base/io/checked_file.h"
#include "scene/generate/xform.h"

struct orl_arena;
struct orl_grid;
struct orl_surface_labels;
struct orl_pattern;

enum orl_material_kind {
    ORL_MATERIAL_VOID,    /* placeholder for void or a refused modifier while files are read */
    ORL_MATERIAL_PLASTIC, /* color, specular, roughness, anisotropy axis (plastic2) */
    ORL_MATERIAL_METAL,   /* color, specular, roughness, anisotropy axis (metal2) */
    /* color, specular, roughness, anisotropy axis (trans2), transmitted, transmitted_specular */
    ORL_MATERIAL_TRANS,
    ORL_MATERIAL_ASHIKHMIN,      /* color, gloss, power, anisotropy axis (ashik2) */
    ORL_MATERIAL_GLASS,          /* transmissivity, ior */
    ORL_MATERIAL_GLAZING,        /* angles, front/back/through, transmitted (BRTDfunc) */
    ORL_MATERIAL_DIELECTRIC,     /* media: a dielectric has air in front, an interface any medium */
    ORL_MATERIAL_FUNCTION_LOBES, /* the fields of trans, tints_lobes, lobes (plasfunc) */
    ORL_MATERIAL_PRISM,          /* prism_rays (prism1, prism2) */
    ORL_MATERIAL_MIRROR,         /* color on the front; the back is black */
    ORL_MATERIAL_BSDF,      /* bsdf, up, thickness, peak, front/back/through diffuse additions */
    ORL_MATERIAL_LIGHT,     /* radiance; sampled directly */
    ORL_MATERIAL_GLOW,      /* radiance, max_radius; sampled directly if max_radius is above 0 */
    ORL_MATERIAL_SPOTLIGHT, /* a light within a cone: beam_axis, cos_cone, focus */
    ORL_MATERIAL_MIXTURE,   /* mixed, mix: two materials of different kinds (material/scatter.h) */
    ORL_MATERIAL_ILLUM,     /* a light that view rays see as another material: seen_as */
    /* participating medium inside: extinction, scattering, asymmetry (built/scene.h) */
    ORL_MATERIAL_MIST,
    ORL_MATERIAL_ANTIMATTER, /* removes surfaces inside it: cut, lining
                                (geometry/antimatter/antimatter.h) */
};

enum { ORL_SEEN_AS_ITSELF = -1, ORL_SEEN_AS_NOTHING = -2 };

struct orl_medium {
    struct orl_rgb transmissivity; /* per unit of length, 0..1 */
    double ior;
};

/* Incident side of the diffuse reflection: both sides, or only the front or the back. */
enum orl_diffuse_side { ORL_DIFFUSE_SIDE_BOTH, ORL_DIFFUSE_SIDE_FRONT, ORL_DIFFUSE_SIDE_BACK };

struct orl_material {
    enum orl_material_kind kind;
    char *name;
    struct orl_rgb color; /* reflectors: reflectance as written; lights: radiance */
    double specular;      /* reflectors: share of color, or of white for plastic and trans */
    double
        roughness[2]; /* reflectors: rms slope along anisotropy axis and across; equal: isotropic */
    struct orl_pattern
        *roughness_pattern; /* reflectors: factors of both roughnesses over the surface; or NULL */
    enum orl_diffuse_side
        diffuse_side;                /* plastic as a term of a sum: sides that reflect diffusely */
    struct orl_vec3 anisotropy_axis; /* plastic2 and the like: as written, not projected */
    bool tints_lobes;     /* function lobes: reflection has the material's colour (metfunc) */
    bool is_whole_bsdf;   /* function lobes: the function is the whole BRDF and BTDF (BRTDfunc) */
    struct orl_rgb gloss; /* ashik2: specular reflectance at the normal */
    double power[2];      /* ashik2: exponents of the lobe, along the anisotropy axis and across */
    /* glazing: upper bound of the direct transmittance; trans: fraction of the light not reflected
     * specularly that is transmitted */
    double transmitted;
    /* trans: fraction of the transmitted light that is not diffuse */
    double transmitted_specular;
    struct orl_rgb transmissivity; /* glass: as written (at normal incidence, one pass) */
    double ior;                    /* glass: 1.52 unless written */
    struct orl_medium media[2];    /* dielectric, interface: behind the normal, in front of it */
    double max_radius;             /* glow: fourth argument */
    struct orl_bsdf *bsdf;         /* BSDF: one reference, owned */
    uint32_t bsdf_file;            /* BSDF: index into the parsed scene's files */
    double thickness;              /* BSDF: as written, signed */
    struct orl_vec3 up;            /* BSDF: as written, not projected */
    bool peak;                     /* aBSDF: nearly direct transmission is taken as direct */
    /* BSDF: additional diffuse reflectance and transmittance (3, 6 or 9 reals) */
    struct orl_rgb front, back, through;
    struct orl_vec3 beam_axis; /* spotlight: unit axis; zero: isotropic */
    double cos_cone;           /* spotlight: cosine of the half angle */
    /* spotlight: distance of the beam's apex behind the lamp */
    double focus;
    struct orl_rgb extinction, scattering; /* mist: coefficients, 1/m */
    double asymmetry; /* mist: asymmetry of its phase function (built/scene.h) */
    /* illum: index of the material that view rays see, or ORL_SEEN_AS_* */
    int32_t seen_as;
    /* factor of color, for glass of its transmissivity (material/patterns/pattern.h); or NULL */
    struct orl_pattern *pattern;
    struct orl_pattern *texture; /* perturbs the normal (material/patterns/texture.h); or NULL */
    struct orl_pattern
        *angles; /* glazing: six functions of the angle (material/function_brdf/glazing.c) */
    struct orl_pattern *prism_rays; /* prism: directions of the outgoing rays
                                       (material/function_brdf/function_brdf.h) */
    struct orl_pattern *lobes;      /* function lobes: BRDF values by direction
                                       (material/function_brdf/function_brdf.h) */
    /* mixture: the first material's share (a factor of 1, see pattern.h); NULL: the sum of both */
    struct orl_pattern *mix;
    /* mixture: two materials, in the arena; none of them has a BSDF */
    const struct orl_material *mixed;
    /* antimatter: materials that are removed inside it; in the arena */
    const uint32_t *cut;
    size_t n_cut;
    int32_t lining; /* antimatter: material of the inner face where it cuts a surface, or -1 */
    /* index + 1 of the material that this one copies, except for texture or window group; 0: none
     */
    uint32_t copy_of;
    int32_t sky;           /* light, glow: index into skies that scales color, or -1 */
    uint32_t window_group; /* window group (surfaces.h), from 1; 0: none */
};

/* Returns the index of the material that this one is a copy of, or its own index. */
static inline uint32_t orl_material_origin(const struct orl_material *material, uint32_t index)
{
    return material->copy_of > 0 ? material->copy_of - 1 : index;
}

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
