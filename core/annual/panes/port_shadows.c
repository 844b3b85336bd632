#include "annual/panes/port_shadows.h"

#include <stdlib.h>

#include "base/sampling/sincos.h"
#include "light/direct.h"

enum { MOST_POINTS = 64, LEAST_POINTS = 8, DIMENSIONS = 5 };
static const double most_rays = 4e6; /* for all suns and kinds: some seconds of one thread */

static struct orl_port_point draw_point(const struct orl_lit_scene *lit_scene, uint32_t port,
                                        const double u[DIMENSIONS])
{
    const double far = sqrt(u[3]);
    const struct orl_sincos circle = orl_sincos_turn(u[4]);
    struct orl_port_point point = {.port = port,
                                   .hit = {.facet = lit_scene->ports[port].facet},
                                   .on_disc = {far * circle.cosine, far * circle.sine}};
    orl_facet_sample(lit_scene->geometry, point.hit.facet, u, &point.hit.point, &point.hit.normal);
    point.hit.front = lit_scene->ports[port].outside_is_front;
    return point;
}

/* Draws a kind's points, from each port in proportion to its area. */
static void draw_points(struct orl_port_shadows *shadows, const struct orl_sobol *sobol,
                        uint32_t kind)
{
    const struct orl_sun_beams *beams = shadows->beams;
    const struct orl_lit_scene *lit_scene = beams->lit_scene;
    struct orl_port_point *points = shadows->points + (size_t)kind * shadows->n_points;
    double area = 0, below = 0;
    uint32_t n = 0;
    for (size_t i = 0; i < lit_scene->n_ports; i++)
        area += beams->kind_of_port[i] == kind ? lit_scene->ports[i].area : 0;
    for (uint32_t i = 0; i < lit_scene->n_ports; i++) {
        if (beams->kind_of_port[i] != kind)
            continue;
        below += lit_scene->ports[i].area;
        for (; n < shadows->n_points && (n + 0.5) * area < below * shadows->n_points; n++) {
            double u[DIMENSIONS];
            orl_sobol_point(sobol, n, kind + 1, DIMENSIONS, u);
            points[n] = draw_point(lit_scene, i, u);
        }
    }
    for (; n > 0 && n < shadows->n_points; n++) /* rounding may have left out the last point */
        points[n] = points[n - 1];
}

static void find_clear(struct orl_port_shadows *shadows)
{
    const struct orl_sun_beams *beams = shadows->beams;
    for (uint32_t kind = 0; kind < beams->n_kinds; kind++)
        shadows->clear[kind] = true;
    for (size_t i = 0; i < beams->lit_scene->n_ports; i++)
        if (!beams->lit_scene->ports[i].clear)
            shadows->clear[beams->kind_of_port[i]] = false;
}

int orl_port_shadows_init(struct orl_port_shadows *shadows, const struct orl_sun_beams *beams,
                          const struct orl_sobol *sobol, size_t n_suns)
{
    const double wanted = most_rays / ((double)n_suns * beams->n_kinds + 1);
    *shadows = (struct orl_port_shadows){
        .beams = beams, .n_points = (uint32_t)fmin(fmax(wanted, LEAST_POINTS), MOST_POINTS)};
    shadows->points =
        calloc((size_t)beams->n_kinds * shadows->n_points + 1, sizeof *shadows->points);
    shadows->clear = calloc(beams->n_kinds + 1, sizeof *shadows->clear);
    if (!shadows->points || !shadows->clear)
        return ORL_ERR_NOMEM;
    find_clear(shadows);
    for (uint32_t kind = 0; kind < beams->n_kinds; kind++)
        if (!shadows->clear[kind])
            draw_points(shadows, sobol, kind);
    return 0;
}

void orl_port_shadows_done(struct orl_port_shadows *shadows)
{
    free(shadows->points);
    free(shadows->clear);
    *shadows = (struct orl_port_shadows){.points = NULL};
}

double orl_port_shadows_lit(const struct orl_port_shadows *shadows, uint32_t kind,
                            struct orl_vec3 towards)
{
    const struct orl_lit_scene *lit_scene = shadows->beams->lit_scene;
    const struct orl_port_point *points = shadows->points + (size_t)kind * shadows->n_points;
    const struct orl_frame frame = orl_frame_about(towards);
    const double radius = tan(0.5 * ORL_SUN_DIAMETER_DEG * ORL_DEG_TO_RAD);
    double faced = 0, lit = 0;
    if (shadows->clear[kind])
        return 1;
    for (uint32_t i = 0; i < shadows->n_points; i++) {
        const struct orl_port_point *point = &points[i];
        const struct orl_vec3 light =
            orl_normalize(orl_madd(orl_madd(towards, frame.u, radius * point->on_disc[0]), frame.v,
                                   radius * point->on_disc[1]));
        const double cosine = orl_dot(light, lit_scene->ports[point->port].outward);
        if (!(cosine > 0))
            continue;
        const struct orl_vec3 origin = orl_hit_ray_origin(lit_scene->geometry, &point->hit, light);
        faced += cosine;
        lit += cosine * orl_luma(orl_transmittance(lit_scene, origin, light, INFINITY, false));
    }
    return faced > 0 ? lit / faced : 0;
}
