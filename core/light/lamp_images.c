#include "light/lamp_images.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "light/world.h"
#include "scene/material/bounds.h"

/* A pair's share of the lamp's light, at most, times its power. */
struct pair {
    struct orl_lamp_image image;
    double strength;
};

struct pairs {
    struct pair kept[ORL_MOST_LAMP_IMAGES];
    size_t n, n_left_out;
};

/* ---- Mirrors --------------------------------------------------------------------------------- */

static bool is_plane(const struct orl_facet *f)
{
    return f->area > 0 &&
           (f->kind == ORL_SURFACE_RING || (f->kind == ORL_SURFACE_POLYGON && !f->bent));
}

static bool is_flat_mirror(const struct orl_world *world, const struct orl_facet *f)
{
    const struct orl_material *m = &world->materials[f->material];
    return is_plane(f) && !m->texture && orl_material_is_mirror(m);
}

/* The sphere about a polygon's corners or a ring. */
static void find_sphere(const struct orl_geometry *g, const struct orl_facet *f,
                        struct orl_lamp_image *image)
{
    struct orl_vec3 low = {INFINITY, INFINITY, INFINITY}, high = {-INFINITY, -INFINITY, -INFINITY};
    if (f->kind == ORL_SURFACE_RING) {
        image->center = f->round->center[0];
        image->radius = orl_larger(f->round->radius[0], f->round->radius[1]);
        return;
    }
    for (uint32_t i = 0; i < f->n_triangles; i++) {
        const struct orl_triangle t = orl_triangle_of(g, orl_facet_triangle(f, i));
        const struct orl_vec3 corners[3] = {t.a, t.b, t.c};
        for (int k = 0; k < 3; k++) {
            low = orl_v3(fmin(low.x, corners[k].x), fmin(low.y, corners[k].y),
                         fmin(low.z, corners[k].z));
            high = orl_v3(fmax(high.x, corners[k].x), fmax(high.y, corners[k].y),
                          fmax(high.z, corners[k].z));
        }
    }
    const struct orl_triangle first = orl_triangle_of(g, orl_facet_triangle(f, 0));
    const struct orl_vec3 middle = orl_scale(orl_add(low, high), 0.5);
    image->radius = orl_length(orl_sub(high, low)) / 2 + f->offset;
    image->center = orl_madd(middle, f->normal, -orl_dot(orl_sub(middle, first.a), f->normal));
}

/* ---- Pairs ----------------------------------------------------------------------------------- */

/* Flux of the lamp times what the mirror may catch of it and sends on; 0: it sees only its edge. */
static double strength_of(const struct orl_world *world, const struct orl_emitter *emitter,
                          const struct orl_facet *mirror, const struct orl_lamp_image *image)
{
    struct orl_facet own;
    const struct orl_facet *lamp = orl_facet_own(world->geometry, emitter->facet, &own);
    static const double middle[2] = {0.5, 0.5};
    struct orl_vec3 point, normal;
    orl_facet_sample(world->geometry, emitter->facet, middle, &point, &normal);
    const struct orl_vec3 way = orl_sub(point, image->center);
    const double d2 = orl_dot(way, way) + lamp->area;
    const struct orl_material *m = &world->materials[mirror->material];
    const bool front = orl_dot(way, mirror->normal) > 0;
    const double caught = fmin(mirror->area / (ORL_PI * d2), 1);
    return orl_luma(emitter->most) * lamp->area * caught *
           orl_material_mirrored_most(m, front, 0.5);
}

/* Keeps the strongest. */
static void keep(struct pairs *pairs, const struct orl_lamp_image *image, double strength)
{
    size_t weakest = 0;
    if (!(strength > 0))
        return;
    if (pairs->n < ORL_MOST_LAMP_IMAGES) {
        pairs->kept[pairs->n++] = (struct pair){*image, strength};
        return;
    }
    pairs->n_left_out++;
    for (size_t i = 1; i < pairs->n; i++)
        if (pairs->kept[i].strength < pairs->kept[weakest].strength)
            weakest = i;
    if (strength > pairs->kept[weakest].strength)
        pairs->kept[weakest] = (struct pair){*image, strength};
}

/* In a sealed scene only mirrors inside count: on one side of the surface at least. Paths outdoors
 * look for no lamps in mirrors. */
static bool is_inside(const struct orl_world *world, uint32_t facet)
{
    static const double middle[2] = {0.5, 0.5};
    struct orl_vec3 point, normal;
    if (world->open)
        return true;
    orl_facet_sample(world->geometry, facet, middle, &point, &normal);
    return !orl_world_is_outside(world,
                                 orl_facet_leave(world->geometry, facet, point, normal, normal)) ||
           !orl_world_is_outside(
               world, orl_facet_leave(world->geometry, facet, point, normal, orl_neg(normal)));
}

static void pair_mirror(struct pairs *pairs, const struct orl_world *world, uint32_t facet)
{
    struct orl_facet own;
    const struct orl_facet *f = orl_facet_own(world->geometry, facet, &own);
    if (!is_flat_mirror(world, f) || !is_inside(world, facet))
        return;
    struct orl_lamp_image image = {.mirror = facet, .normal = f->normal};
    find_sphere(world->geometry, f, &image);
    for (size_t i = 0; i < world->n_emitters; i++) {
        if (!world->emitters[i].direct || world->emitters[i].facet == facet)
            continue;
        image.emitter = (uint32_t)i;
        image.lamp = world->emitters[i].facet;
        keep(pairs, &image, strength_of(world, &world->emitters[i], f, &image));
    }
}

static bool has_lamps(const struct orl_world *world)
{
    for (size_t i = 0; i < world->n_emitters; i++)
        if (world->emitters[i].direct)
            return true;
    return false;
}

int orl_lamp_images_build(struct orl_lamp_images *images, const struct orl_world *world,
                          const struct orl_crew *crew)
{
    *images = (struct orl_lamp_images){.n_images = 0};
    if (!has_lamps(world))
        return 0;
    struct pairs *const pairs = calloc(1, sizeof *pairs);
    int code = pairs ? 0 : ORL_ERR_NOMEM;
    for (size_t f = 0; f < world->geometry->n_facets && code == 0; f++) {
        if (f % 256 == 0 && orl_crew_cancelled(crew))
            code = ORL_ERR_CANCELLED;
        else
            pair_mirror(pairs, world, (uint32_t)f);
    }
    if (code == 0 && pairs->n > 0) {
        images->images = calloc(pairs->n, sizeof *images->images);
        code = images->images ? 0 : ORL_ERR_NOMEM;
    }
    for (size_t i = 0; code == 0 && i < pairs->n; i++)
        images->images[images->n_images++] = pairs->kept[i].image;
    images->n_left_out = code == 0 ? pairs->n_left_out : 0;
    free(pairs);
    return code;
}

void orl_lamp_images_done(struct orl_lamp_images *images)
{
    free(images->images);
    *images = (struct orl_lamp_images){.n_images = 0};
}

const struct orl_lamp_image *orl_lamp_images_in(const struct orl_lamp_images *images,
                                                uint32_t mirror)
{
    for (size_t i = 0; i < images->n_images; i++)
        if (images->images[i].mirror == mirror)
            return &images->images[i];
    return NULL;
}

bool orl_lamp_images_cover(const struct orl_lamp_images *images, uint32_t lamp, uint32_t mirror)
{
    for (size_t i = 0; i < images->n_images; i++)
        if (images->images[i].mirror == mirror && images->images[i].lamp == lamp)
            return true;
    return false;
}
