/* Beams: kinds of ports, their flux, and shadows on them. */
#include "annual/sun_map/sun_beams.h"

#include <stdlib.h>

#include "base/sampling/sampling.h"
#include "light/direct.h"
#include "scene/material/scatter.h"

/* Returns the kind of a port, and adds one if there is room. most: largest number of kinds of a
 * window group. */
static uint32_t find_kind(struct orl_sun_beams *beams, const struct orl_port *port,
                          uint16_t window_group, uint32_t most)
{
    static const double about = 0.98; /* least cosine between ports of a kind */
    const struct orl_lit_scene *lit_scene = beams->lit_scene;
    const struct orl_material *m = orl_lit_scene_material_of(lit_scene, port->facet);
    uint32_t of_group = 0, last = 0;
    for (uint32_t k = 0; k < beams->n_kinds; k++) {
        const struct orl_sun_kind *kind = &beams->kinds[k];
        if (kind->window_group != window_group)
            continue;
        if (kind->material == m && orl_dot(kind->outward, port->outward) >= about)
            return k;
        of_group++;
        last = k;
    }
    if (of_group == most)
        return last;
    beams->kinds[beams->n_kinds] = (struct orl_sun_kind){m, port->outward, window_group};
    return beams->n_kinds++;
}

static double flux_by_port(const struct orl_sun_beams *beams, const struct orl_port *port,
                           struct orl_vec3 towards)
{
    const struct orl_lit_scene *lit_scene = beams->lit_scene;
    struct orl_facet own;
    const struct orl_facet *facet = orl_facet_get_own(lit_scene->geometry, port->facet, &own);
    const double cosine = orl_dot(towards, port->outward);
    if (!(cosine > 0))
        return 0;
    const struct orl_hit hit =
        orl_hit_surface_mean(facet->normal, orl_dot(towards, facet->normal) > 0);
    return port->area * cosine *
           orl_luma(orl_material_albedo(&lit_scene->materials[facet->material], &hit, towards,
                                        ORL_LOBE_TRANSMITTED));
}

/*
 * Points of the disc: its centre and six around it, for equal parts of its area. The disc may
 * overlap two cells of a BSDF. Other panes transmit all of it alike, and the centre suffices.
 */
enum { DISC_POINTS = 7 };
/* Mean distance from the centre, in disc radii, of the outer six sevenths of the area. */
static const double mean_of_ring = 0.73578;
static double flux_of_disc(const struct orl_sun_beams *beams, const struct orl_port *port,
                           struct orl_vec3 towards)
{
    const struct orl_material *m = orl_lit_scene_material_of(beams->lit_scene, port->facet);
    const struct orl_frame frame = orl_frame_about(towards);
    const double ring = mean_of_ring * tan(0.5 * ORL_SUN_DIAMETER_DEG * ORL_DEG_TO_RAD);
    double sum = flux_by_port(beams, port, towards);
    if (m->kind != ORL_MATERIAL_BSDF)
        return sum;
    for (int i = 1; i < DISC_POINTS; i++) {
        const struct orl_sincos at = orl_sincos_turn((i - 1) / (DISC_POINTS - 1.0));
        const struct orl_vec3 off =
            orl_madd(orl_scale(frame.u, ring * at.cosine), frame.v, ring * at.sine);
        sum += flux_by_port(beams, port, orl_normalize(orl_add(towards, off)));
    }
    return sum / DISC_POINTS;
}

/* Ports of a kind differ only by small rotations. A port that faces exactly like the one before,
 * with the same material, takes that one's value per area. */
double orl_sun_beams_flux(const struct orl_sun_beams *beams, uint32_t kind, struct orl_vec3 towards)
{
    const struct orl_lit_scene *lit_scene = beams->lit_scene;
    const struct orl_port *last = NULL;
    double sum = 0, of_last = 0;
    for (size_t i = 0; i < lit_scene->n_ports; i++) {
        const struct orl_port *port = &lit_scene->ports[i];
        if (beams->kind_of_port[i] != kind)
            continue;
        const bool same = last && orl_dot(last->outward, port->outward) > 1 - 1e-12 &&
                          orl_lit_scene_material_of(lit_scene, last->facet) ==
                              orl_lit_scene_material_of(lit_scene, port->facet);
        of_last = same ? of_last / last->area * port->area : flux_of_disc(beams, port, towards);
        last = port;
        sum += of_last;
    }
    return sum;
}

int orl_sun_beams_init(struct orl_sun_beams *beams, const struct orl_lit_scene *lit_scene,
                       const struct orl_frame *nodes, size_t n_nodes,
                       const uint16_t *window_group_of_port)
{
    *beams = (struct orl_sun_beams){
        .lit_scene = lit_scene,
        .kind_of_port = calloc(lit_scene->n_ports + 1, sizeof *beams->kind_of_port)};
    if (!beams->kind_of_port)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < lit_scene->n_ports; i++)
        beams->kind_of_port[i] = (uint8_t)find_kind(
            beams, &lit_scene->ports[i], window_group_of_port ? window_group_of_port[i] : 0,
            window_group_of_port ? ORL_SUN_KINDS_OF_GROUP : ORL_SUN_KINDS_OF_ALL);
    beams->at = malloc((n_nodes * beams->n_kinds + 1) * sizeof *beams->at);
    if (!beams->at)
        return ORL_ERR_NOMEM;
    for (uint32_t node = 0; node < n_nodes; node++)
        for (uint32_t kind = 0; kind < beams->n_kinds; kind++)
            if (orl_sun_beams_flux(beams, kind, nodes[node].n) > 0)
                beams->at[beams->count++] = (struct orl_sun_beam){node, kind};
    return 0;
}

void orl_sun_beams_done(struct orl_sun_beams *beams)
{
    free(beams->at);
    free(beams->kind_of_port);
    *beams = (struct orl_sun_beams){.at = NULL};
}

uint32_t orl_sun_beams_of_node(const struct orl_sun_beams *beams, size_t beam)
{
    const uint32_t node = beams->at[beam].node;
    uint32_t n = 1;
    for (size_t i = beam; i > 0 && beams->at[i - 1].node == node; i--)
        n++;
    for (size_t i = beam + 1; i < beams->count && beams->at[i].node == node; i++)
        n++;
    return n;
}

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
    if (!shadows->points)
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
