/* Shadow rays to the suns' images, and the test whether they cover a ray that hit a sun by
 * chance. */
#include "light/images.h"

#include "light/path.h"

enum { MOST_BRANCHES = 16, MOST_STEPS = 256 };

/* ---- Shadow rays ----------------------------------------------------------------------------- */

/* A ray towards an image, or its continuation after mirrors. */
struct chain {
    struct orl_path path;
    int16_t node;
    uint8_t reflections;
    bool outside;
};

struct chains {
    const struct orl_world *world;
    bool through_ports;
    int steps;
    uint32_t depth;
    struct chain stack[MOST_BRANCHES];
};

static void push_reflection(struct chains *chains, const struct chain *c, const struct orl_hit *hit,
                            const struct orl_material *m)
{
    const struct orl_world *world = chains->world;
    const struct orl_images *images = &world->images;
    const int16_t class = orl_images_class(images, hit->facet);
    const int next = class < 0 ? -1 : orl_images_next(images, c->node, class);
    if (next < 0 || c->reflections == ORL_IMAGE_REFLECTIONS || chains->depth == MOST_BRANCHES ||
        (c->outside && world->omit.exterior))
        return;
    struct chain on = *c;
    on.path.weight =
        orl_rgb_mul(c->path.weight, orl_material_mirrored(m, hit, orl_path_back(&c->path)));
    if (!(orl_rgb_max(on.path.weight) > ORL_IMAGE_DIMMEST))
        return;
    on.path.direction = orl_image_turned(c->path.direction, images->mirrors[class]);
    orl_path_pass(&on.path, world, hit);
    on.node = (int16_t)next;
    on.reflections++;
    chains->stack[chains->depth++] = on;
}

/* Follows one branch to its end, and pushes the others on the stack. Returns the branch's
 * transmittance if it arrives at the sun, else zero. */
static struct orl_rgb follow_chain(struct chains *chains, struct chain c)
{
    const struct orl_world *world = chains->world;
    const struct orl_rgb none = orl_gray(0);
    while (chains->steps++ < MOST_STEPS) {
        const bool arrives = c.reflections > 0 && world->images.nodes[c.node].is_sun;
        struct orl_hit hit;
        if (!orl_path_meet(world, &c.path, &hit))
            return arrives ? c.path.weight : none;
        const struct orl_material *m = orl_world_material(world, &hit);
        const enum orl_crossing crossing = orl_world_crossing(world, &hit);
        push_reflection(chains, &c, &hit, m);
        if (!orl_path_look_through(&c.path, m, &hit) ||
            (!chains->through_ports && crossing != ORL_CROSSING_NONE))
            return none;
        if (orl_world_leaves_clear(world, &hit))
            return arrives ? c.path.weight : none;
        if (crossing != ORL_CROSSING_NONE)
            c.outside = crossing == ORL_CROSSING_OUTWARDS;
        orl_path_pass(&c.path, world, &hit);
    }
    return none;
}

struct orl_vec3 orl_image_sample(const struct orl_world *world, const struct orl_image *image,
                                 const double u[2])
{
    struct orl_sun disc = world->suns[image->sun];
    disc.frame = image->frame;
    return orl_sun_sample(&disc, u);
}

struct orl_rgb orl_image_transmittance(const struct orl_world *world, struct orl_vec3 origin,
                                       struct orl_vec3 direction, const struct orl_image *image,
                                       bool through_ports)
{
    struct chains chains = {.world = world, .through_ports = through_ports};
    const size_t node = (size_t)(image - world->images.nodes);
    struct orl_rgb sum = orl_gray(0);
    if (!orl_images_may_show(&world->images, node, origin))
        return sum;
    chains.stack[chains.depth++] = (struct chain){
        .path = orl_path_from(origin, direction), .node = (int16_t)node, .outside = !through_ports};
    while (chains.depth > 0) {
        const struct chain c = chains.stack[--chains.depth];
        sum = orl_rgb_add(sum, follow_chain(&chains, c));
    }
    return sum;
}

/* ---- Suns hit by chance ---------------------------------------------------------------------- */

void orl_image_trail_add(struct orl_image_trail *trail, const struct orl_images *images,
                         uint32_t facet)
{
    const int16_t class = orl_images_class(images, facet);
    if (trail->reflections == ORL_IMAGE_REFLECTIONS || class < 0) {
        trail->strange = true;
        return;
    }
    trail->classes[trail->reflections++] = class;
}

/* Returns true if the mirrors of a trail lead from the node to the sun itself. */
static bool leads_to_sun(const struct orl_images *images, size_t node,
                         const struct orl_image_trail *trail)
{
    int at = (int)node;
    for (uint8_t i = 0; i < trail->reflections && at >= 0; i++)
        at = orl_images_next(images, at, trail->classes[i]);
    return at >= 0 && images->nodes[at].is_sun;
}

bool orl_images_cover(const struct orl_world *world, const struct orl_image_trail *trail)
{
    const struct orl_images *images = &world->images;
    if (trail->strange)
        return false;
    for (size_t i = 0; i < images->n_nodes; i++) {
        const struct orl_image *image = &images->nodes[i];
        /* The disc, widened by the tolerance of a class. */
        const double nearest = world->suns[image->sun].cos_half_angle - 1e-5;
        if (image->shown && orl_dot(image->frame.n, trail->start) > nearest &&
            leads_to_sun(images, i, trail))
            return true;
    }
    return false;
}
