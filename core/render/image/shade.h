/*
 * What a view ray sees: the ray is followed through panes and mirrors, both ways where it splits,
 * down to diffuse surfaces; what else it meets (sky, lights, lobes) is summed on the way. What
 * light comes along the rays of a lobe is for the technique to say.
 */
#ifndef ORL_RENDER_IMAGE_SHADE_H
#define ORL_RENDER_IMAGE_SHADE_H

#include "render/gather/gather.h"

enum { ORL_SHADE_VERTICES = 8 };

/* A diffuse surface on the ray's way. */
struct orl_vertex {
    struct orl_place place; /* the side seen, clear of the surface */
    struct orl_vec3 on_surface;
    struct orl_rgb weight; /* of its irradiance in the ray's radiance: path times albedo / pi */
    double distance;       /* from the eye */
};

/* What a ray saw. */
struct orl_shaded {
    struct orl_vertex vertices[ORL_SHADE_VERTICES];
    uint32_t n_vertices;
    uint64_t way;          /* names what was met, in order: what goes the same way sees alike */
    struct orl_rgb rest;   /* radiance of all that is neither diffuse nor of a lobe */
    struct orl_rgb lobes;  /* of these, by a few rays */
    double lobes_variance; /* of their luma, as if rays were drawn by chance */
    struct orl_rgb gloss;  /* what of the lobes is gloss: of those that send no light through, */
    double gloss_variance; /* and what of the variance */
    bool has_lobes;
    bool textured; /* one of the vertices: those beside it may be lit otherwise */
};

/* A ray of a lobe. */
struct orl_lobe_ray {
    struct orl_vec3 origin, direction;
    struct orl_chance chance; /* with which the lobe sends it there */
    double weight;            /* of what it sees, in what the surface shows: the largest channel */
    bool outside;
};

/* A technique's radiance along one: suns not seen straight, and of lamps the share of that chance.
 */
typedef struct orl_rgb orl_shade_radiance(const void *ctx, const struct orl_lobe_ray *ray,
                                          struct orl_random *random, struct orl_search *search);

/* Which suns a ray shows that it meets straight: by any number of panes, but turned by none. */
enum orl_suns {
    ORL_SUNS_SEEN,  /* all, as anything else */
    ORL_SUNS_APART, /* none: they are put in by rays of their own (discs.h) */
    ORL_SUNS_ALONE, /* these, and nothing else at all: such a ray */
    ORL_LAMP_ALONE  /* nothing but one lamp: a ray of that lamp's own */
};

/* How rays of a view are shaded, by whichever technique. */
struct orl_shader {
    const struct orl_world *world;
    const struct orl_sobol *sobol;
    uint32_t pane_samples, gloss_samples; /* rays into a pane's lobes, into others */
    bool only_gloss;                      /* panes' lobes are left out */
    uint32_t sequence;    /* of even numbers for gloss, that several looks share, ... */
    uint32_t first_gloss; /* ... and which of them come first; sequence 0: each look has its own */
    double dimmest;       /* branches below this share of the ray are not followed; */
    bool by_lot;          /* or one in some is, and then counts for all: no bias */
    bool backs_unseen;    /* those of opaque surfaces are passed as if they were not there */
    bool irradiance;      /* of the first diffuse surface, behind glass too, instead of radiance */
    enum orl_suns suns;
    const bool *lamps_apart; /* by facet: not shown where met straight either; NULL: none are */
    uint32_t lamp;           /* a facet, with ORL_LAMP_ALONE */
    orl_shade_radiance *radiance;
    const void *ctx;
};

/* Follows one ray; without lobes these are noticed but not sampled. */
void orl_shade_ray(const struct orl_shader *shader, struct orl_vec3 origin,
                   struct orl_vec3 direction, bool outside, bool lobes, struct orl_random *random,
                   struct orl_search *search, struct orl_shaded *ret_shaded);

#endif
