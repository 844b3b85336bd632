/*
 * Shades a view ray. The ray is followed through panes and mirrors, both ways where it splits, to
 * diffuse surfaces; all else that it meets (sky, lights, lobes) is summed up on the way. The
 * technique supplies the radiance along the rays of a lobe.
 */
#ifndef ORL_RENDER_IMAGE_SHADE_H
#define ORL_RENDER_IMAGE_SHADE_H

#include "render/gather/gather.h"

enum { ORL_SHADE_VERTICES = 8 };

/* A diffuse surface that the ray meets. */
struct orl_vertex {
    struct orl_shading_point place; /* on the visible side, offset from the surface */
    struct orl_vec3 on_surface;
    /* Weight of its irradiance in the ray's radiance: path weight times albedo / pi. */
    struct orl_rgb weight;
    double distance; /* from the eye */
};

/* Result of a ray. */
struct orl_shaded_ray {
    struct orl_vertex vertices[ORL_SHADE_VERTICES];
    uint32_t n_vertices;
    /* Names the surfaces met, in order; equal for rays that see the same. */
    uint64_t path_signature;
    uint64_t visible_surfaces; /* orl_shade_visible_surfaces */
    struct orl_rgb rest;   /* radiance that comes neither from diffuse surfaces nor from lobes */
    struct orl_rgb lobes;  /* radiance from lobes, by a few rays */
    double lobes_variance; /* variance of their luma, as if rays were random */
    struct orl_rgb gloss;  /* the part of lobes by surfaces that transmit no lobes */
    double gloss_variance; /* the part of lobes_variance by these */
    bool has_lobes;
    /* True if a vertex is textured, so that neighbouring ones may be lit otherwise. */
    bool textured;
};

/* A ray of a lobe. */
struct orl_lobe_ray {
    struct orl_vec3 origin, direction;
    struct orl_mis_pdf mis_pdf; /* MIS density with which the lobe sends it there */
    double weight;              /* weight of its radiance in the surface's: the largest channel */
    bool outside;
};

/* Returns a technique's radiance along a lobe's ray. Suns seen directly are left out; lamps count
 * with the share of the ray's MIS density. */
typedef struct orl_rgb orl_shade_radiance(const void *ctx, const struct orl_lobe_ray *ray,
                                          struct orl_random *random, struct orl_search *search);

/* Suns that a ray shows if it meets them directly: through any number of panes that do not deflect
 * it. */
enum orl_sun_visibility {
    ORL_SUNS_VISIBLE,  /* all */
    ORL_SUNS_EXCLUDED, /* none: rays of their own add them (image.h) */
    ORL_SUNS_ONLY,     /* only suns, and nothing else: for a ray of a sun */
    ORL_LAMP_ONLY      /* only one lamp: for a ray of that lamp */
};

/* Parameters of shading for any technique. */
struct orl_shader {
    const struct orl_lit_scene *lit_scene;
    const struct orl_sobol *sobol;
    uint32_t pane_samples, gloss_samples; /* rays into a pane's lobes, and into other lobes */
    bool only_gloss;                      /* true if panes' lobes are left out */
    uint32_t sequence;    /* gloss sequence shared by several view rays; 0: each has its own */
    uint32_t first_gloss; /* first index of this view ray in the shared sequence */
    double least_weight;  /* branches below this share of the ray are omitted */
    bool roulette;        /* true if those undergo Russian roulette instead, without bias */
    bool backs_unseen;    /* true if backs of opaque surfaces are invisible */
    /* If true, the result is the irradiance of the first diffuse surface, also behind glass,
     * instead of radiance. */
    bool irradiance;
    enum orl_sun_visibility suns;
    const bool *excluded_lamps; /* by facet: lamps not shown when seen directly; NULL: none */
    uint32_t lamp;              /* facet, for ORL_LAMP_ONLY */
    orl_shade_radiance *radiance;
    const void *ctx;
};

/* Shades one ray. If lobes is false they are detected but not sampled. */
void orl_shade_ray(const struct orl_shader *shader, struct orl_vec3 origin,
                   struct orl_vec3 direction, bool outside, bool lobes, struct orl_random *random,
                   struct orl_search *search, struct orl_shaded_ray *ret_shaded);

/*
 * Returns a name of the surfaces that a ray meets on its straight way: through panes, to the first
 * surface that is opaque or deflects light. Names are equal for rays that see the same surfaces.
 * It traces one ray a surface and computes no light.
 */
uint64_t orl_shade_visible_surfaces(const struct orl_shader *shader, struct orl_vec3 origin,
                                    struct orl_vec3 direction, struct orl_health *health);

#endif
