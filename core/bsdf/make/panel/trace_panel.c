/* Paths through a panel: the periodic unit cell, then one path from its entry to its exits. */
#include "bsdf/make/panel/panel.h"

#include "scene/geometry/instances.h"

enum { MOST_SIDES = 1 << 16, MARGIN = 4 };

struct orl_gonio_unit_cell orl_gonio_unit_cell_around(const struct orl_geometry *geometry,
                                                      const double sides[4])
{
    double offset = 0;
    for (size_t i = 0; i < geometry->n_facets; i++)
        offset = fmax(offset, orl_facet_offset(geometry, i));
    for (size_t i = 0; i < geometry->n_instances; i++)
        offset = fmax(offset, geometry->instance[i].offset);
    const double m = MARGIN * offset;
    return (struct orl_gonio_unit_cell){
        .low = {sides[0] - m, sides[2] - m, geometry->low.z - m},
        .high = {sides[1] + m, sides[3] + m, geometry->high.z + m},
        .margin = m,
    };
}

/* Returns a place beside the panel. */
static struct orl_vec3 entry_of(const struct orl_gonio_unit_cell *cell, bool front,
                                const double u[2])
{
    const double width = cell->high.x - cell->low.x - 2 * cell->margin;
    const double height = cell->high.y - cell->low.y - 2 * cell->margin;
    return orl_v3(cell->low.x + cell->margin + u[0] * width,
                  cell->low.y + cell->margin + u[1] * height, front ? cell->high.z : cell->low.z);
}

/* Returns the distance to the side that faces the ray; 0 if the ray is beyond it. */
static double distance_to_side(double from, double along, double low, double high)
{
    if (along == 0)
        return INFINITY;
    const double distance = ((along > 0 ? high : low) - from) / along;
    return distance > 0 ? distance : 0;
}

enum orl_gonio_crossing orl_gonio_unit_cell_intersect(const struct orl_gonio_unit_cell *cell,
                                                      const struct orl_lit_scene *lit_scene,
                                                      struct orl_path *path,
                                                      struct orl_hit *ret_hit)
{
    const struct orl_vec3 d = path->direction;
    struct orl_vec3 *const o = &path->origin;
    double travelled = 0;
    for (int sides = 0; sides < MOST_SIDES; sides++) {
        const double x = distance_to_side(o->x, d.x, cell->low.x, cell->high.x);
        const double y = distance_to_side(o->y, d.y, cell->low.y, cell->high.y);
        const double z = distance_to_side(o->z, d.z, cell->low.z, cell->high.z);
        const double distance = fmin(x, fmin(y, z));
        if (distance > 0 && orl_geometry_intersect(lit_scene->geometry, *o, d, distance, ret_hit)) {
            ret_hit->distance += travelled;
            return ORL_GONIO_HIT_SURFACE;
        }
        if (distance == z)
            return d.z > 0 ? ORL_GONIO_LEFT_FRONT : ORL_GONIO_LEFT_BACK;
        *o = orl_madd(*o, d, distance);
        travelled += distance;
        if (distance == x)
            o->x = d.x > 0 ? cell->low.x : cell->high.x;
        else
            o->y = d.y > 0 ? cell->low.y : cell->high.y;
    }
    return ORL_GONIO_MANY_CROSSINGS;
}

enum { MOST_SURFACES = 4096, SOBOL_SCATTERINGS = 4, MOST_BRANCHES = 16 };

/* Weights below which paths end by Russian roulette, and below which paths are not split. */
static const double least_weight = 0.02, least_branch = 0.005;

/* A path in progress, and the number of surfaces it has hit. */
struct branch {
    struct orl_path path;
    int surfaces;
};

struct panel_tracer {
    const struct orl_gonio_sample *sample;
    struct orl_gonio_sampler *sampler;
    struct branch pending[MOST_BRANCHES];
    int n_pending;
};

struct orl_gonio_sampler orl_gonio_sampler_at(const struct orl_gonio_measurement *measurement,
                                              uint64_t stream, uint32_t index, double ret_u[4])
{
    const uint64_t seed = measurement->request->seed;
    const struct orl_gonio_sampler sampler = {
        .sobol = measurement->sobol,
        .index = index,
        .seed = (uint32_t)orl_mix64(seed ^ orl_mix64(stream + 1)),
        .random = orl_random_stream(seed, ORL_PURPOSE_GONIOMETER, stream << 32 | (uint64_t)index)};
    orl_sobol_point(sampler.sobol, index, sampler.seed, 4, ret_u);
    return sampler;
}

static void next_sample(struct orl_gonio_sampler *sampler, int scattering, double ret_u[3])
{
    if (scattering < SOBOL_SCATTERINGS) {
        const uint64_t step = 0x9e3779b97f4a7c15ULL * ((uint64_t)scattering + 1);
        orl_sobol_point(sampler->sobol, sampler->index, (uint32_t)orl_mix64(sampler->seed + step),
                        3, ret_u);
        return;
    }
    for (int i = 0; i < 3; i++)
        ret_u[i] = orl_random_uniform(&sampler->random);
}

/* Scatters the path by one of the lobes; returns false if it ends. */
static bool scatter_by_lobes(const struct panel_tracer *j, struct branch *b,
                             const struct orl_hit *hit, enum orl_lobes lobes, const double u[3])
{
    const struct orl_lit_scene *lit_scene = j->sample->lit_scene;
    const struct orl_material *material = orl_lit_scene_material(lit_scene, hit);
    const struct orl_surface_sample sample = orl_material_sample_at(
        material, hit, orl_path_back(&b->path), ORL_TRANSPORT_LIGHT, lobes, u);
    if (sample.event == ORL_EVENT_ABSORBED)
        return false;
    b->path.weight = orl_rgb_mul(b->path.weight, sample.weight);
    b->surfaces++;
    const double most = orl_rgb_max(b->path.weight);
    if (most < least_weight &&
        !orl_path_roulette(&b->path, most / least_weight, &j->sampler->random))
        return false;
    orl_path_spawn_ray(&b->path, lit_scene, hit, &sample);
    return true;
}

/* Returns true if the reflected and the transmitted part are both worth tracing. */
static bool is_split(const struct panel_tracer *j, const struct branch *b,
                     const struct orl_hit *hit)
{
    const struct orl_material *m = orl_lit_scene_material(j->sample->lit_scene, hit);
    if ((m->kind != ORL_MATERIAL_DIELECTRIC && m->kind != ORL_MATERIAL_GLASS) ||
        j->n_pending == MOST_BRANCHES)
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
static bool handle_hit(struct panel_tracer *j, struct branch *b, const struct orl_hit *hit)
{
    double u[3];
    orl_path_attenuate(&b->path, orl_lit_scene_material(j->sample->lit_scene, hit), hit);
    next_sample(j->sampler, b->surfaces, u);
    if (!is_split(j, b, hit))
        return scatter_by_lobes(j, b, hit, ORL_LOBE_ALL, u);
    struct branch mirrored = *b;
    if (scatter_by_lobes(j, &mirrored, hit, ORL_LOBE_DIFFUSE | ORL_LOBE_REFLECTED, u))
        j->pending[j->n_pending++] = mirrored;
    return scatter_by_lobes(j, b, hit, ORL_LOBE_TRANSMITTED, u);
}

/* Traces one branch to its end. */
static void trace_branch(struct panel_tracer *j, struct branch b, orl_gonio_on_exit *on_exit,
                         void *ctx)
{
    struct orl_gonio_exit exit = {.end = ORL_GONIO_PATH_CUT};
    while (b.surfaces < MOST_SURFACES) {
        struct orl_hit hit;
        const enum orl_gonio_crossing meeting =
            orl_gonio_unit_cell_intersect(&j->sample->cell, j->sample->lit_scene, &b.path, &hit);
        if (meeting == ORL_GONIO_HIT_SURFACE) {
            if (!handle_hit(j, &b, &hit))
                return;
            continue;
        }
        if (meeting != ORL_GONIO_MANY_CROSSINGS) {
            exit.end = ORL_GONIO_PATH_LEFT;
            exit.front = meeting == ORL_GONIO_LEFT_FRONT;
        }
        break;
    }
    exit.direction = b.path.direction;
    exit.weight = b.path.weight;
    on_exit(ctx, &exit);
}

void orl_gonio_trace(const struct orl_gonio_sample *sample, bool front, struct orl_vec3 towards,
                     const double u[2], struct orl_gonio_sampler *sampler,
                     orl_gonio_on_exit *on_exit, void *ctx)
{
    if (front)
        towards.z = -towards.z;
    struct panel_tracer j = {.sample = sample, .sampler = sampler, .n_pending = 1};
    j.pending[0] = (struct branch){orl_path_from(entry_of(&sample->cell, front, u), towards), 0};
    while (j.n_pending > 0)
        trace_branch(&j, j.pending[--j.n_pending], on_exit, ctx);
}
