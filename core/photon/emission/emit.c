#include "photon/emission/emit.h"

#include "photon/emission/emit_sampling.h"
#include "photon/emission/port_emission.h"
#include "photon/map/map.h"
#include "scene/material/scatter.h"

/* ---- Emissions that pass no port ------------------------------------------------------------- */

/* Samples a direction uniformly over a spotlight's cone. Returns the flux for radiance 1 from a
 * unit of area. */
static double spot_direction(const struct orl_spotlight *spot, struct orl_vec3 normal,
                             const double u[2], struct orl_vec3 *ret_direction)
{
    const struct orl_frame frame = orl_frame_about(spot->beam_axis);
    const double down = u[0] * (1 - spot->cos_cone), cosine = 1 - down;
    const double sine = sqrt(down * (2 - down)), phi = 2 * ORL_PI * u[1];
    *ret_direction = orl_to_world(&frame, orl_v3(sine * cos(phi), sine * sin(phi), cosine));
    return 2 * ORL_PI * (1 - spot->cos_cone) * fmax(orl_dot(*ret_direction, normal), 0);
}

/* Fills in the members of a photon ray that depend on the emitter; u: five numbers in [0,1) as for
 * orl_emission_sample_stratum. Returns false if no photon is emitted. */
static bool emit_from_lamp(const struct orl_emission *e, const struct orl_stratum *stratum,
                           const double *u, struct orl_photon_ray *ret_photon_ray)
{
    const struct orl_lit_scene *lit_scene = e->lit_scene;
    const struct orl_emitter *emitter = &lit_scene->emitters[stratum->port];
    struct orl_facet own;
    const struct orl_facet *facet = orl_facet_get_own(lit_scene->geometry, emitter->facet, &own);
    const struct orl_material *m = &lit_scene->materials[facet->material];
    struct orl_vec3 point, normal;
    double measure = ORL_PI;
    orl_facet_sample(lit_scene->geometry, emitter->facet, u + 1, &point, &normal);
    ret_photon_ray->origin = orl_madd(point, normal, facet->offset);
    /* A cone of 60 degrees half angle has the solid angle pi, the same as the cosine's measure. */
    if (m->kind == ORL_MATERIAL_SPOTLIGHT && orl_spotlight_of(m)->cos_cone > 0.5)
        measure = spot_direction(orl_spotlight_of(m), normal, u + 3, &ret_photon_ray->direction);
    else
        ret_photon_ray->direction = orl_hemisphere_about(normal, u[3], u[4]);
    if (!orl_spotlight_covers(m, ret_photon_ray->direction))
        return false;
    const struct orl_hit hit = {
        .point = point, .normal = normal, .facet = emitter->facet, .front = true};
    const struct orl_rgb radiance = orl_material_radiance_varies(m)
                                        ? orl_material_emission(m, &hit, ret_photon_ray->direction)
                                        : emitter->radiance;
    ret_photon_ray->flux = orl_rgb_scale(radiance, measure * facet->area);
    ret_photon_ray->from_light = ret_photon_ray->lamp = emitter->direct;
    ret_photon_ray->lamp_facet = emitter->facet;
    ret_photon_ray->focus = orl_material_focus(m);
    return measure > 0;
}

/* Fills in the members of a photon ray for light from the sky of an open scene; u and the result
 * are as for emit_from_lamp. */
static bool emit_from_sky(const struct orl_emission *e, const struct orl_stratum *stratum,
                          bool caustic, const double *u, struct orl_photon_ray *ret_photon_ray)
{
    const struct orl_lit_scene *lit_scene = e->lit_scene;
    struct orl_vec3 towards;
    struct orl_rgb radiance;
    double measure;
    if (stratum->kind == ORL_STRATUM_OPEN_SUN) {
        towards = orl_sun_sample(&lit_scene->suns[stratum->sun], u + 3);
        radiance = lit_scene->suns[stratum->sun].radiance;
        measure = lit_scene->suns[stratum->sun].solid_angle_sr;
        ret_photon_ray->from_light = true;
        ret_photon_ray->sun = stratum->sun;
    } else {
        double at[2];
        const double pdf = orl_distribution_2d_sample(&e->dome_distribution, u + 3, at);
        const double z = 2 * at[1] - 1, s = sqrt(fmax(0, 1 - z * z)), phi = 2 * ORL_PI * at[0];
        towards = orl_v3(s * cos(phi), s * sin(phi), z);
        radiance = orl_lit_scene_dome_radiance(lit_scene, towards);
        measure = 4 * ORL_PI / pdf;
    }
    double place[2] = {u[1], u[2]}, pdf = 1;
    const struct orl_distribution_2d *importance =
        orl_emission_importance_find(e, stratum, caustic, towards);
    if (importance)
        pdf = orl_distribution_2d_sample(importance, u + 1, place);
    const double area =
        orl_parallel_beam_sample(lit_scene->geometry, towards, place, &ret_photon_ray->origin);
    ret_photon_ray->direction = orl_neg(towards);
    ret_photon_ray->flux = orl_rgb_scale(radiance, measure * area / pdf);
    return orl_rgb_max(ret_photon_ray->flux) > 0;
}

/* ---- Emissions through ports ----------------------------------------------------------------- */

_Static_assert((int)ORL_SOBOL_BLOCK == (int)ORL_MAP_BATCHES, "a point of each batch");

/* Cosine of half an angle: rays of a sun with a smaller angle have about one direction. */
static const double narrow_cosine = 0.9999;

/* Returns the port's hit as a path from outside meets it. */
static struct orl_hit port_hit(const struct orl_lit_scene *lit_scene, const struct orl_port *port,
                               struct orl_vec3 point)
{
    return (struct orl_hit){.point = point,
                            .normal = orl_facet_normal(lit_scene->geometry, port->facet),
                            .facet = port->facet,
                            .front = port->outside_is_front};
}

/* Light with a flux that arrives at a port from the direction `outwards`. sun_bsdf_table: sampler
 * of the pane's transmission, or NULL. */
struct port_arrival {
    const struct orl_port *port;
    const struct orl_sun_bsdf_table *sun_bsdf_table;
    struct orl_vec3 point, outwards;
    struct orl_rgb flux;
    /* domes: start of the ray that finds the radiance; measure: flux for radiance 1 */
    struct orl_vec3 start;
    double measure;
    struct orl_hit hit;
};

/* Stage of an emission. */
enum stage { NOT_EMITTED, EMITTED, AT_PORT, NEEDS_RADIANCE };

/* Sets up the BSDF query for the pane. Returns false if the sun BSDF table samples it instead. */
static bool set_bsdf_query(const struct orl_lit_scene *lit_scene, struct port_arrival *a,
                           struct orl_random *random, double ret_u[3],
                           struct orl_bsdf_query *ret_draw)
{
    a->hit = port_hit(lit_scene, a->port, a->point);
    ret_u[0] = orl_random_uniform(random);
    ret_u[1] = orl_random_uniform(random);
    ret_u[2] = orl_random_uniform(random);
    *ret_draw = (struct orl_bsdf_query){orl_lit_scene_material(lit_scene, &a->hit), &a->hit,
                                        a->outwards, ORL_TRANSPORT_LIGHT, ORL_LOBE_TRANSMITTED};
    return !a->sun_bsdf_table;
}

/* Starts the photon behind the pane in the sampled direction. Returns false if it was absorbed. */
static bool start_photon(const struct orl_lit_scene *lit_scene, const struct port_arrival *a,
                         const struct orl_surface_sample *s, struct orl_photon_ray *ret_photon_ray)
{
    if (s->event == ORL_EVENT_ABSORBED)
        return false;
    ret_photon_ray->origin = orl_hit_ray_origin(lit_scene->geometry, &a->hit, s->direction);
    ret_photon_ray->direction = s->direction;
    ret_photon_ray->flux = orl_rgb_mul(a->flux, s->weight);
    ret_photon_ray->deflection = orl_deflection_after(ret_photon_ray->deflection, s->event);
    ret_photon_ray->parallel = ret_photon_ray->parallel && s->event == ORL_EVENT_STRAIGHT;
    ret_photon_ray->from_port = true;
    ret_photon_ray->medium_transmissivity =
        orl_medium_after_sample(orl_lit_scene_material(lit_scene, &a->hit), s, orl_gray(1));
    return orl_rgb_max(ret_photon_ray->flux) > 0;
}

static enum stage sample_port_dome(const struct orl_emission *e, const struct orl_stratum *stratum,
                                   const struct orl_port_start *start, struct port_arrival *ret)
{
    const struct orl_geometry *g = e->lit_scene->geometry;
    const struct orl_port *port = &e->lit_scene->ports[stratum->port];
    ret->port = port;
    ret->sun_bsdf_table = NULL;
    ret->point = start->point;
    ret->outwards = start->out;
    ret->start = orl_facet_ray_origin(g, port->facet, start->point,
                                      orl_facet_normal(g, port->facet), port->outward);
    /* The square is uniform in projected solid angle, pi in all. */
    ret->measure = ORL_PI * port->area / start->pdf;
    return NEEDS_RADIANCE;
}

/* Sets the flux from the radiance that the ray outwards found. */
static enum stage set_radiance(struct port_arrival *a, struct orl_rgb radiance)
{
    a->flux = orl_rgb_scale(radiance, a->measure);
    return orl_rgb_max(a->flux) > 0 ? AT_PORT : NOT_EMITTED;
}

static enum stage sample_port_sun(const struct orl_emission *e, const struct orl_stratum *stratum,
                                  const struct orl_port_start *start, struct port_arrival *ret,
                                  struct orl_photon_ray *ret_photon_ray)
{
    const struct orl_lit_scene *lit_scene = e->lit_scene;
    const struct orl_port *port = &lit_scene->ports[stratum->port];
    const struct orl_sun *sun = &lit_scene->suns[stratum->sun];
    const struct orl_virtual_sun *image =
        stratum->kind == ORL_STRATUM_PORT_IMAGE ? &lit_scene->images.nodes[stratum->image] : NULL;
    const struct orl_vec3 out = start->out;
    const struct orl_vec3 from =
        orl_facet_ray_origin(lit_scene->geometry, port->facet, start->point,
                             orl_facet_normal(lit_scene->geometry, port->facet), port->outward);
    const struct orl_rgb share =
        image ? orl_virtual_sun_transmittance(lit_scene, from, out, image, false)
        : stratum->shadow_boxes && !orl_shadow_boxes_contain(stratum->shadow_boxes, start->point)
            ? orl_gray(1)
            : orl_transmittance(lit_scene, from, out, INFINITY, false);
    const double cosine = orl_dot(out, port->outward);
    if (!(cosine > 0) || !(orl_rgb_max(share) > 0))
        return NOT_EMITTED;
    ret_photon_ray->from_light = true;
    ret_photon_ray->deflection.mirror = image != NULL;
    ret_photon_ray->sun = stratum->sun;
    ret_photon_ray->image = image ? (int16_t)stratum->image : -1;
    ret_photon_ray->parallel = !image && stratum->sun == 0 && sun->cos_half_angle > narrow_cosine;
    ret->port = port;
    ret->sun_bsdf_table = image ? NULL : stratum->sun_bsdf_table;
    ret->point = start->point;
    ret->outwards = out;
    ret->flux =
        orl_rgb_scale(orl_rgb_mul(sun->irradiance, share), cosine * port->area / start->pdf);
    return AT_PORT;
}

static enum stage sample_port_lamp(const struct orl_emission *e, const struct orl_stratum *stratum,
                                   const double *u, const struct orl_port_start *start,
                                   struct orl_random *random, struct port_arrival *ret,
                                   struct orl_photon_ray *ret_photon_ray)
{
    const struct orl_port *port = &e->lit_scene->ports[stratum->port];
    struct orl_light_sample light_sample;
    uint32_t lamp;
    const struct orl_rgb arriving =
        orl_port_lamp_arriving(e, stratum, start->point, u, random, &lamp, &light_sample);
    if (!(orl_rgb_max(arriving) > 0))
        return NOT_EMITTED;
    ret_photon_ray->from_light = ret_photon_ray->lamp = true;
    ret_photon_ray->lamp_facet = e->lit_scene->emitters[lamp].facet;
    ret_photon_ray->focus = orl_emitter_focus(e->lit_scene, lamp);
    ret_photon_ray->lamp_distance = light_sample.distance;
    ret->port = port;
    ret->sun_bsdf_table = NULL;
    ret->point = start->point;
    ret->outwards = light_sample.light;
    ret->flux = orl_rgb_scale(arriving, orl_dot(light_sample.light, port->outward) * port->area);
    return AT_PORT;
}

static bool passes_port(const struct orl_stratum *s)
{
    return s->kind == ORL_STRATUM_PORT_DOME || s->kind == ORL_STRATUM_PORT_SUN ||
           s->kind == ORL_STRATUM_PORT_IMAGE || s->kind == ORL_STRATUM_PORT_LAMP;
}

/* Initialises all of the photon ray but its start, direction and flux. */
static void init_photon_ray(struct orl_photon_ray *photon_ray, double roulette_u)
{
    photon_ray->from_light = photon_ray->from_port = photon_ray->lamp = photon_ray->parallel =
        false;
    photon_ray->deflection = (struct orl_deflection){.mirror = false};
    photon_ray->sun = 0;
    photon_ray->image = -1;
    photon_ray->focus = photon_ray->lamp_distance = 0;
    photon_ray->roulette_u = roulette_u;
    photon_ray->reflected = 1;
}

/* Starts an emission up to its arrival at a port, or its photon ray. start: for strata that pass a
 * port; other strata use the numbers in point. */
static enum stage sample_emission(const struct orl_emission *e, const struct orl_stratum *stratum,
                                  bool caustic, const double *point,
                                  const struct orl_port_start *start, struct orl_random *random,
                                  struct port_arrival *ret_port_arrival,
                                  struct orl_photon_ray *ret_photon_ray)
{
    init_photon_ray(ret_photon_ray, orl_random_uniform(random));
    switch (stratum->kind) {
    case ORL_STRATUM_PORT_DOME:
        return sample_port_dome(e, stratum, start, ret_port_arrival);
    case ORL_STRATUM_PORT_SUN:
    case ORL_STRATUM_PORT_IMAGE:
        return sample_port_sun(e, stratum, start, ret_port_arrival, ret_photon_ray);
    case ORL_STRATUM_PORT_LAMP:
        return sample_port_lamp(e, stratum, point + 3, start, random, ret_port_arrival,
                                ret_photon_ray);
    case ORL_STRATUM_EMITTER:
        return emit_from_lamp(e, stratum, point, ret_photon_ray) ? EMITTED : NOT_EMITTED;
    case ORL_STRATUM_OPEN_DOME:
    case ORL_STRATUM_OPEN_SUN:
        return emit_from_sky(e, stratum, caustic, point, ret_photon_ray) ? EMITTED : NOT_EMITTED;
    }
    return NOT_EMITTED;
}

bool orl_emission_sample_stratum(const struct orl_emission *emission,
                                 const struct orl_stratum *stratum, bool caustic,
                                 const double *point, struct orl_random *random,
                                 struct orl_health *health, struct orl_photon_ray *ret_photon_ray)
{
    const struct orl_lit_scene *lit_scene = emission->lit_scene;
    double u[3];
    struct orl_bsdf_query query;
    struct port_arrival a;
    struct orl_port_start start;
    if (passes_port(stratum))
        orl_port_starts(emission, stratum, caustic, &point, 1, &start);
    enum stage stage =
        sample_emission(emission, stratum, caustic, point, &start, random, &a, ret_photon_ray);
    if (stage == NEEDS_RADIANCE)
        stage = set_radiance(
            &a, orl_port_radiance(lit_scene, a.port, a.start, a.outwards, random, health));
    if (stage != AT_PORT)
        return stage == EMITTED;
    if (!orl_port_owns(lit_scene->geometry, a.port, a.point))
        return false;
    const struct orl_surface_sample s =
        set_bsdf_query(lit_scene, &a, random, u, &query)
            ? orl_material_sample_at(query.material, &a.hit, a.outwards, query.transport,
                                     query.lobes, u)
            : orl_sun_bsdf_table_sample(a.sun_bsdf_table, a.outwards, u);
    return start_photon(lit_scene, &a, &s, ret_photon_ray);
}

static const struct orl_stratum *pick_stratum(const struct orl_emission *e, double u, bool caustic)
{
    size_t low = 0, high = e->n_strata;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        const struct orl_stratum *s = &e->strata[middle];
        if ((caustic ? s->cdf_caustic : s->cdf) <= u)
            low = middle;
        else
            high = middle;
    }
    return &e->strata[low];
}

void orl_emission_points(const struct orl_emission *emission, uint64_t seed, uint64_t index,
                         bool caustic, struct orl_sobol_block *ret_points)
{
    const uint64_t within = index / ORL_MAP_BATCHES;
    uint32_t sequences[ORL_MAP_BATCHES];
    for (uint64_t batch = 0; batch < ORL_MAP_BATCHES; batch++)
        sequences[batch] =
            (uint32_t)orl_mix64(orl_mix64(seed * 2 + caustic) + batch) + (uint32_t)(within >> 32);
    orl_sobol_block(&emission->sobol, (uint32_t)within, sequences, ret_points);
}

/* ---- Many emissions at once ------------------------------------------------------------------ */

/* Emissions that take each step together. */
struct emission_wavefront {
    const struct orl_emission *emission;
    struct orl_random *randoms;
    struct orl_photon_ray *photon_rays;
    const struct orl_stratum *strata[ORL_EMISSIONS_AT_ONCE];
    enum stage stages[ORL_EMISSIONS_AT_ONCE];
    struct port_arrival arrivals[ORL_EMISSIONS_AT_ONCE];
    uint16_t order[ORL_EMISSIONS_AT_ONCE]; /* emissions sorted by stratum, or nearly so */
    size_t n;
};

static void sort_by_stratum(struct emission_wavefront *w)
{
    enum { KINDS = 64 };
    uint16_t next[KINDS + 1] = {0};
    for (size_t i = 0; i < w->n; i++)
        next[(size_t)(w->strata[i] - w->emission->strata) % KINDS + 1]++;
    for (size_t k = 0; k < KINDS; k++)
        next[k + 1] = (uint16_t)(next[k + 1] + next[k]);
    for (size_t i = 0; i < w->n; i++)
        w->order[next[(size_t)(w->strata[i] - w->emission->strata) % KINDS]++] = (uint16_t)i;
}

static double share_of(const struct orl_stratum *s, bool caustic)
{
    return caustic ? s->share_caustic : s->share;
}

/* Returns the end of a run of emissions of one stratum from `first` on, at most
 * ORL_STARTS_AT_ONCE. */
static size_t end_of_stratum(const struct emission_wavefront *w, size_t first)
{
    size_t end = first + 1;
    while (end < w->n && end < first + ORL_STARTS_AT_ONCE &&
           w->strata[w->order[end]] == w->strata[w->order[first]])
        end++;
    return end;
}

/* Starts emissions of one stratum. */
static void sample_emissions(struct emission_wavefront *w, size_t first, size_t end, bool caustic,
                             const double (*points)[ORL_SOBOL_DIMENSIONS])
{
    const struct orl_stratum *stratum = w->strata[w->order[first]];
    const bool has_photons = share_of(stratum, caustic) > 0;
    struct orl_port_start starts[ORL_STARTS_AT_ONCE];
    const double *u[ORL_STARTS_AT_ONCE];
    for (size_t k = first; k < end; k++)
        u[k - first] = points[w->order[k]];
    if (has_photons && passes_port(stratum))
        orl_port_starts(w->emission, stratum, caustic, u, end - first, starts);
    for (size_t k = first; k < end; k++) {
        const uint16_t i = w->order[k];
        w->stages[i] = !has_photons ? NOT_EMITTED
                                    : sample_emission(w->emission, stratum, caustic, points[i],
                                                      &starts[k - first], &w->randoms[i],
                                                      &w->arrivals[i], &w->photon_rays[i]);
    }
}

/* Finds the light of domes: traces paths outwards from the ports. */
static void find_port_radiance(struct emission_wavefront *w, struct orl_health *health)
{
    const struct orl_lit_scene *lit_scene = w->emission->lit_scene;
    struct orl_ray rays[ORL_EMISSIONS_AT_ONCE];
    struct orl_hit hits[ORL_EMISSIONS_AT_ONCE];
    bool found[ORL_EMISSIONS_AT_ONCE];
    uint16_t emission_of[ORL_EMISSIONS_AT_ONCE];
    size_t n = 0;
    for (size_t k = 0; k < w->n; k++) {
        const uint16_t i = w->order[k];
        struct port_arrival *a = &w->arrivals[i];
        if (w->stages[i] != NEEDS_RADIANCE)
            continue;
        if (!orl_port_traces_exterior(lit_scene, a->port)) {
            w->stages[i] = set_radiance(a, orl_port_radiance(lit_scene, a->port, a->start,
                                                             a->outwards, &w->randoms[i], health));
            continue;
        }
        emission_of[n] = i;
        rays[n++] = (struct orl_ray){a->start, a->outwards};
    }
    orl_geometry_intersect_many(lit_scene->geometry, rays, n, false, hits, found);
    for (size_t k = 0; k < n; k++) {
        struct port_arrival *a = &w->arrivals[emission_of[k]];
        w->stages[emission_of[k]] =
            set_radiance(a, orl_exterior_radiance_from(
                                lit_scene, a->outwards, found[k] ? &hits[k] : NULL,
                                orl_mis_pdf_zero_straight(), &w->randoms[emission_of[k]], health));
    }
}

/* Samples the transmission of the panes. */
static void pass_ports(struct emission_wavefront *w)
{
    const struct orl_lit_scene *lit_scene = w->emission->lit_scene;
    struct orl_bsdf_query queries[ORL_EMISSIONS_AT_ONCE];
    struct orl_surface_sample samples[ORL_EMISSIONS_AT_ONCE];
    double u[ORL_EMISSIONS_AT_ONCE][3];
    uint16_t emission_of[ORL_EMISSIONS_AT_ONCE];
    size_t n = 0;
    for (size_t k = 0; k < w->n; k++) {
        const uint16_t i = w->order[k];
        struct port_arrival *a = &w->arrivals[i];
        if (w->stages[i] != AT_PORT)
            continue;
        w->stages[i] = NOT_EMITTED;
        if (!orl_port_owns(lit_scene->geometry, a->port, a->point))
            continue;
        if (set_bsdf_query(lit_scene, a, &w->randoms[i], u[n], &queries[n])) {
            emission_of[n++] = i;
            continue;
        }
        const struct orl_surface_sample s =
            orl_sun_bsdf_table_sample(a->sun_bsdf_table, a->outwards, u[n]);
        if (start_photon(lit_scene, a, &s, &w->photon_rays[i]))
            w->stages[i] = EMITTED;
    }
    orl_material_sample_many(queries, (const double(*)[3])u, n, samples);
    for (size_t k = 0; k < n; k++)
        if (start_photon(lit_scene, &w->arrivals[emission_of[k]], &samples[k],
                         &w->photon_rays[emission_of[k]]))
            w->stages[emission_of[k]] = EMITTED;
}

void orl_emission_sample_many(const struct orl_emission *emission,
                              const double (*points)[ORL_SOBOL_DIMENSIONS], size_t n, bool caustic,
                              struct orl_random *randoms, struct orl_health *health,
                              struct orl_photon_ray *ret_photon_rays, bool *ret_is_emitted)
{
    struct emission_wavefront w;
    w.emission = emission;
    w.randoms = randoms;
    w.photon_rays = ret_photon_rays;
    w.n = emission->n_strata > 0 ? n : 0;
    for (size_t i = 0; i < w.n; i++)
        w.strata[i] = pick_stratum(emission, points[i][0], caustic);
    sort_by_stratum(&w);
    for (size_t first = 0, end; first < w.n; first = end) {
        end = end_of_stratum(&w, first);
        sample_emissions(&w, first, end, caustic, points);
    }
    find_port_radiance(&w, health);
    pass_ports(&w);
    for (size_t i = 0; i < n; i++) {
        struct orl_photon_ray *photon_ray = &ret_photon_rays[i];
        ret_is_emitted[i] = i < w.n && w.stages[i] == EMITTED;
        if (!ret_is_emitted[i])
            continue;
        photon_ray->flux = orl_rgb_scale(photon_ray->flux, 1 / share_of(w.strata[i], caustic));
        photon_ray->roulette_u = points[i][5];
        photon_ray->reflected = caustic ? 1 : w.strata[i]->reflected;
    }
}
