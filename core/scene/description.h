/*
 * What a set of Radiance scene files says, after aliases, modifiers and commands are resolved:
 * plain data, in the files' own units and coordinates, in double. The parser (parse.h) makes it;
 * the geometry adapter, the lights and the materials read it.
 *
 * Invariants: every number is finite; every material index is valid; polygons have at least three
 * vertices and a non-zero normal (degenerate ones are counted in n_degenerate and dropped);
 * directions are unit vectors; radii are positive, but that one end of a cone and the inside of a
 * ring may be 0.
 * Ownership: an orl_description owns everything in it; strings lie in its arena, and what goes with
 * the surfaces, their names among it, in another one. Once geometry is built of it that is let go
 * (orl_description_let_go): millions of surfaces take more than what rays meet of them.
 */
#ifndef ORL_SCENE_DESCRIPTION_H
#define ORL_SCENE_DESCRIPTION_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/bsdf.h>
#include <oriel/vec.h>

#include "base/sealed.h"
#include "scene/generate/xform.h"

struct orl_arena;
struct orl_grid;
struct orl_surface_labels;
struct orl_pattern;

enum orl_material_kind {
    ORL_MATERIAL_VOID,       /* what void or a refused modifier stands for while files are read */
    ORL_MATERIAL_PLASTIC,    /* color, specular, roughness, grain (plastic2) */
    ORL_MATERIAL_METAL,      /* color, specular, roughness, grain (metal2) */
    ORL_MATERIAL_TRANS,      /* the same (trans2), transmitted, transmitted_specular */
    ORL_MATERIAL_ASHIKHMIN,  /* color, gloss, power, grain (ashik2) */
    ORL_MATERIAL_GLASS,      /* transmissivity, ior */
    ORL_MATERIAL_GLAZING,    /* angles, front/back/through, transmitted (BRTDfunc) */
    ORL_MATERIAL_DIELECTRIC, /* media: a dielectric has air in front, an interface anything */
    ORL_MATERIAL_LOBED,      /* as trans, and tinted, lobes (plasfunc and the like) */
    ORL_MATERIAL_PRISM,      /* ways (prism1, prism2) */
    ORL_MATERIAL_MIRROR,     /* color, on the front; black behind */
    ORL_MATERIAL_BSDF,       /* bsdf, up, thickness, peak, front/back/through diffuse additions */
    ORL_MATERIAL_LIGHT,      /* radiance; a source to be sampled directly */
    ORL_MATERIAL_GLOW,       /* radiance, max_radius; aimed at if max_radius is above 0 */
    ORL_MATERIAL_SPOTLIGHT,  /* a light that shines within a cone: spot */
    ORL_MATERIAL_MIXTURE,    /* mixed, mix: of unlike materials (material/scatter.h) */
    ORL_MATERIAL_ILLUM,      /* a light that views see as what it stands for: seen_as */
    ORL_MATERIAL_MIST,       /* extinction, scattered, forward: within it (light/mist.h) */
    ORL_MATERIAL_ANTIMATTER, /* what is not there within: cut, lining (geometry/antimatter.h) */
};

enum { ORL_SEEN_AS_ITSELF = -1, ORL_SEEN_AS_NOTHING = -2 };

struct orl_medium {
    struct orl_rgb transmissivity; /* of a unit of length, 0..1 */
    double ior;
};

/* Whose light a surface scatters evenly: what meets that side of it. */
enum orl_evenly { ORL_EVENLY_BOTH, ORL_EVENLY_FRONT, ORL_EVENLY_BACK };

struct orl_material {
    enum orl_material_kind kind;
    char *name;
    struct orl_rgb color; /* reflectors: reflectance as written; lights: radiance */
    double specular;      /* reflectors: share of color, or of white for plastic and trans */
    double roughness[2];  /* reflectors: rms slope along grain and across; equal: isotropic */
    struct orl_pattern
        *rough;            /* reflectors: factors of both roughnesses over the surface; or NULL */
    enum orl_evenly side;  /* plastic, as a part of a sum */
    struct orl_vec3 grain; /* plastic2 and the like: as written, not projected */
    bool tinted;           /* lobed: what is reflected by lobes has the colour (metfunc) */
    bool both_ways; /* lobed: the function is all of it, and of what gets through (BRTDfunc) */
    struct orl_rgb gloss; /* ashik2: specular reflectance at the normal */
    double power[2];      /* ashik2: of its lobe, along the grain and across */
    double transmitted; /* glazing: the most that goes straight through; trans: share of what is not
                           reflected as by a mirror */
    double transmitted_specular;   /* trans: share of that which is not spread evenly */
    struct orl_rgb transmissivity; /* glass: as written (at normal incidence, one pass) */
    double ior;                    /* glass: 1.52 unless written */
    struct orl_medium media[2];    /* dielectric, interface: behind the normal, in front of it */
    double max_radius;             /* glow: fourth argument */
    struct orl_bsdf *bsdf;         /* BSDF: a reference held */
    uint32_t bsdf_file;            /* BSDF: which of the description's files it is */
    double thickness;              /* BSDF: as written, signed */
    struct orl_vec3 up;            /* BSDF: as written, not projected */
    bool peak;                     /* aBSDF: what goes nearly straight through goes straight */
    struct orl_rgb front, back, through;  /* BSDF: additional diffuse of 3, 6 or 9 reals */
    struct orl_vec3 aim;                  /* spotlight: unit; zero: shines evenly */
    double cos_cone;                      /* spotlight: of the half angle */
    double focus;                         /* spotlight: how far behind the lamp its beam starts */
    struct orl_rgb extinction, scattered; /* mist: 1/m */
    double forward;                       /* mist: of its phase function (light/mist.h) */
    int32_t seen_as;                      /* illum: material that views see, or orl_seen_as */
    struct orl_pattern *pattern; /* factor of color, of glass of what passes (material/pattern.h);
                                    or NULL */
    struct orl_pattern *texture; /* turns the normal (material/texture.h); or NULL */
    struct orl_pattern *angles;  /* glazing: six functions of the angle (material/glazing.c) */
    struct orl_pattern *ways;    /* prism: where it sends to (material/own.h) */
    struct orl_pattern *lobes;   /* lobed: values by the directions (material/own.h) */
    struct orl_pattern *mix; /* mixture: the first's share (of pattern.h, a factor of 1); NULL: the
                                sum of both */
    const struct orl_material *mixed; /* mixture: two, in the arena; with no BSDFs among them */
    const uint32_t *cut;              /* antimatter: materials of which it is free, in the arena */
    size_t n_cut;
    int32_t lining;   /* antimatter: the material of its inside where it cuts something, or -1 */
    uint32_t copy_of; /* it is that material, but for a texture, or its part: its index and 1 */
    int32_t sky;      /* light, glow: index into skies that scales color, or -1 */
    uint32_t part;    /* whose windows and shades have it, from 1 (swap.h); 0: no one's */
};

/* Which material it is a copy of, or its own index. */
static inline uint32_t orl_material_origin(const struct orl_material *material, uint32_t index)
{
    return material->copy_of > 0 ? material->copy_of - 1 : index;
}

enum orl_surface_kind {
    ORL_SURFACE_POLYGON,
    ORL_SURFACE_SPHERE,   /* center[0], radius[0]; normal outwards */
    ORL_SURFACE_BUBBLE,   /* the same, normal inwards */
    ORL_SURFACE_CYLINDER, /* center[0..1], radius[0]; normal outwards */
    ORL_SURFACE_TUBE,     /* the same, normal inwards */
    ORL_SURFACE_CONE,     /* center[0..1], radius[0..1]; normal outwards */
    ORL_SURFACE_CUP,      /* the same, normal inwards */
    ORL_SURFACE_RING,     /* center[0], normal, radius[0] < radius[1] */
};

/* What is round has its centres and radii apart: nearly all surfaces are polygons. */
struct orl_curved {
    struct orl_vec3 center[2];
    double radius[2];
};
extern const struct orl_curved orl_curved_none; /* all 0: of polygons */

struct orl_surface {
    enum orl_surface_kind kind;
    bool has_places;  /* polygon of a mesh: orl_surface_places */
    bool has_normals; /* polygon of a mesh: orl_surface_normals */
    uint32_t material;
    uint32_t modifier_order; /* of its modifier's definition among all: later ones are larger */
    uint32_t n_vertices;     /* 0: no polygon, or one that others have cut away */
    int line;
    char *name;
    const char *file;                   /* points into orl_description.files */
    union {                             /* in orl_description.outlines */
        struct orl_vec3 *vertices;      /* polygon */
        const struct orl_curved *round; /* the others; never NULL */
    };
    struct orl_vec3 normal; /* ring; for polygons the unit normal by Newell's method */
};

/* The coordinates (u, v) that a mesh gives each of a polygon's corners, for patterns; they lie
 * behind the vertices. */
static inline const double *orl_surface_places(const struct orl_surface *surface)
{
    return surface->has_places ? (const double *)(surface->vertices + surface->n_vertices) : NULL;
}

/* The normals that a mesh gives each of a polygon's corners, unit or 0; they lie behind the places.
 */
static inline const struct orl_vec3 *orl_surface_normals(const struct orl_surface *surface)
{
    const size_t places = surface->has_places ? 2 * sizeof(double) * surface->n_vertices : 0;
    const char *const behind = (const char *)(surface->vertices + surface->n_vertices);
    return surface->has_normals ? (const struct orl_vec3 *)(const void *)(behind + places) : NULL;
}

/* A "source" primitive: light from infinitely far away, within angle/2 of dir. */
struct orl_distant {
    uint32_t material; /* LIGHT or GLOW */
    char *name;
    struct orl_vec3 direction; /* towards the source, unit */
    double angle_deg;          /* full opening angle, 0 < angle <= 360; 180: a hemisphere */
};

/* A sky or ground pattern as gendaylit and gensky write it: skybright in its two forms. */
enum orl_sky_kind { ORL_SKY_PEREZ, ORL_SKY_CIE };

struct orl_sky {
    enum orl_sky_kind kind;
    double a[10]; /* the arguments, A1..A10, as in perezlum.cal or skybright.cal */
    int n_args;
};

/* Two polygons in one place that face opposite ways: each is met from its front. */
struct orl_opposed {
    uint32_t surfaces[2];
};

/* Surfaces that stand in several places, and are kept once: as they stand in the first of them
 * (parse/repeats.h says which may). */
struct orl_prototype {
    struct orl_surface *surfaces; /* as orl_description's, and so are the labels */
    size_t n_surfaces;
    struct orl_surface_labels *labels;
    struct orl_opposed *opposed; /* coincident.h */
    size_t n_opposed;
    size_t prefix_bytes; /* of their names: what was read there put that before them */
    bool varied;         /* they have patterns or textures, which are where the first of them is */
};

/* One of those places (placements.h). */
struct orl_placement {
    uint32_t prototype;
    struct orl_xform xform; /* of the prototype's surfaces */
    const char *name;       /* of all its surfaces, a mesh's; NULL: they have their own */
    const char *prefix;     /* goes before those, with its full stop; both in the arena */
    size_t before;          /* so many of the surfaces come before it */
    size_t main_file;       /* of those that the caller named */
};

/* A file that was read, and a name under which none was found: the scene's own, or the library's.
 */
struct orl_file_read {
    unsigned char content[32]; /* its SHA-256 */
    bool library;
};
struct orl_file_missed {
    const char *name;
    bool library;
};

struct orl_description {
    struct orl_material *materials;
    size_t n_materials;
    struct orl_surface *surfaces; /* NULL: let go */
    size_t n_surfaces;
    struct orl_surface_labels *labels; /* what is told of them then; before, NULL */
    struct orl_opposed *opposed;       /* coincident.h; let go, too */
    size_t n_opposed;
    struct orl_prototype *prototypes;
    size_t n_prototypes;
    struct orl_placement *placements; /* in the order of the files */
    size_t n_placements;
    struct orl_distant *distants;
    size_t n_distants;
    struct orl_sky *skies;
    size_t n_skies;
    struct orl_pattern **patterns;
    size_t n_patterns;
    struct orl_grid **grids; /* what patterns interpolate: each file once (grid/grid.h) */
    size_t n_grids;
    size_t n_undefined; /* patterns that have no value somewhere (material/pattern.h) */
    char **files;       /* names of all files read, in order of first use */
    size_t n_files;
    struct orl_file_read *read;     /* each of them; in the arena */
    struct orl_file_missed *missed; /* what else was looked for; in the arena */
    size_t n_missed;                /* SIZE_MAX: too many to be listed */
    size_t n_main;          /* the first n_main of them were named by the caller as scene text */
    size_t *first_surfaces; /* of each name that the caller gave; in the arena */
    size_t n_first_surfaces;
    bool settled;             /* of two in one place one is met (light/scene.h), and ... */
    uint64_t n_read;          /* ... so many surfaces there were in the files */
    uint64_t n_degenerate;    /* polygons dropped: zero area or fewer than three distinct corners */
    unsigned char digest[32]; /* SHA-256 over length and content of all files read, in order */
    char **warnings;
    size_t n_warnings;
    struct orl_arena *arena;     /* holds the strings above, but for surfaces' names */
    struct orl_arena *outlines;  /* these, vertices, and what is round; NULL: let go */
    struct orl_sealed_file file; /* in place of outlines, where it was kept (keep/keep.h) */
    const atomic_bool *cancel;   /* heard while geometry is built from this; NULL: nothing */
};

/* Adds a copy of the text to the warnings; without memory for it nothing happens. */
void orl_description_warn(struct orl_description *description, const char *text);

/*
 * Frees the surfaces, but for their labels, which it makes; n_surfaces stays. Where some are a
 * mesh's that has normals or places of its own, which patterns ask for, surfaces stay.
 * ORL_ERR_NOMEM.
 */
int orl_description_let_go(struct orl_description *description);

/* Frees what it owns; NULL and half-filled are fine. */
void orl_description_done(struct orl_description *description);

#endif
