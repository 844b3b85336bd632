#include "goniometer/trace_panel.h"

enum { MOST_SURFACES = 4096, EVEN_SCATTERINGS = 4, MOST_BRANCHES = 16 };

/* Weights below which paths end by Russian roulette, and below which paths are not split. */
static const double least_weight = 0.02, least_branch = 0.005;

/* A path in progress, and the number of surfaces it has hit. */
struct branch {
    struct orl_path path;
    int surfaces;
};

struct journey {
    const struct orl_gonio_sample *sample;
    struct orl_gonio_numbers *numbers;
    struct branch waiting[MOST_BRANCHES];
    int n_waiting;
};

static void next_numbers(struct orl_gonio_numbers *numbers, int scattering, double ret_u[3])
{
    if (scattering < EVEN_SCATTERINGS) {
        const uint64_t step = 0x9e3779b97f4a7c15ULL * ((uint64_t)scattering + 1);
        orl_sobol_point(numbers->sobol, numbers->index, (uint32_t)orl_mix64(numbers->seed + step),
                        3, ret_u);
        return;
    }
    for (int i = 0; i < 3; i++)
        ret_u[i] = orl_random_uniform(&numbers->random);
}

/* Scatters the path by one of the lobes; returns false if it ends. */
static bool scatter_by_lobes(const struct journey *j, struct branch *b, const struct orl_hit *hit,
                             enum orl_lobes lobes, const double u[3])
{
    const struct orl_world *world = j->sample->world;
    const struct orl_material *material = orl_world_material(world, hit);
    const struct orl_scatter scatter = orl_scatter_sample_at(material, hit, orl_path_back(&b->path),
                                                             ORL_TRANSPORT_LIGHT, lobes, u);
    if (scatter.event == ORL_EVENT_ABSORBED)
        return false;
    b->path.weight = orl_rgb_mul(b->path.weight, scatter.weight);
    b->surfaces++;
    const double most = orl_rgb_max(b->path.weight);
    if (most < least_weight &&
        !orl_path_survives(&b->path, most / least_weight, &j->numbers->random))
        return false;
    orl_path_leave(&b->path, world, hit, &scatter);
    return true;
}

/* Returns true if the reflected and the transmitted part are both worth tracing. */
static bool is_split(const struct journey *j, const struct branch *b, const struct orl_hit *hit)
{
    const struct orl_material *m = orl_world_material(j->sample->world, hit);
    if ((m->kind != ORL_MATERIAL_DIELECTRIC && m->kind != ORL_MATERIAL_GLASS) ||
        j->n_waiting == MOST_BRANCHES)
        return false;
    const struct orl_vec3 from = orl_path_back(&b->path);
    const struct orl_rgb w = b->path.weight;
    const struct orl_rgb mirrored = orl_material_mirrored(m, hit, from);
    const struct orl_rgb through = m->kind == ORL_MATERIAL_GLASS
                                       ? orl_material_straight(m, hit, from)
                                       : orl_gray(1 - mirrored.r);
    return orl_rgb_max(orl_rgb_mul(w, mirrored)) > least_branch &&
           orl_rgb_max(orl_rgb_mul(w, through)) > least_branch;
}

/* Scatters the path at a surface. If it is split, the reflected part is queued. Returns false if
 * the path ends. */
static bool handle_hit(struct journey *j, struct branch *b, const struct orl_hit *hit)
{
    double u[3];
    orl_path_arrive(&b->path, orl_world_material(j->sample->world, hit), hit);
    next_numbers(j->numbers, b->surfaces, u);
    if (!is_split(j, b, hit))
        return scatter_by_lobes(j, b, hit, ORL_LOBE_ALL, u);
    struct branch mirrored = *b;
    if (scatter_by_lobes(j, &mirrored, hit, ORL_LOBE_DIFFUSE | ORL_LOBE_REFLECTED, u))
        j->waiting[j->n_waiting++] = mirrored;
    return scatter_by_lobes(j, b, hit, ORL_LOBE_TRANSMITTED, u);
}

/* Traces one branch to its end. */
static void trace_branch(struct journey *j, struct branch b, orl_gonio_sink *sink, void *ctx)
{
    struct orl_gonio_exit exit = {.end = ORL_GONIO_GIVEN_UP};
    while (b.surfaces < MOST_SURFACES) {
        struct orl_hit hit;
        const enum orl_gonio_meeting meeting =
            orl_gonio_meet(&j->sample->cell, j->sample->world, &b.path, &hit);
        if (meeting == ORL_GONIO_SURFACE) {
            if (!handle_hit(j, &b, &hit))
                return;
            continue;
        }
        if (meeting != ORL_GONIO_LOST) {
            exit.end = ORL_GONIO_LEFT;
            exit.front = meeting == ORL_GONIO_FRONT;
        }
        break;
    }
    exit.direction = b.path.direction;
    exit.weight = b.path.weight;
    sink(ctx, &exit);
}

void orl_gonio_follow(const struct orl_gonio_sample *sample, struct orl_path path,
                      struct orl_gonio_numbers *numbers, orl_gonio_sink *sink, void *ctx)
{
    struct journey j = {.sample = sample, .numbers = numbers, .n_waiting = 1};
    j.waiting[0] = (struct branch){path, 0};
    while (j.n_waiting > 0)
        trace_branch(&j, j.waiting[--j.n_waiting], sink, ctx);
}
