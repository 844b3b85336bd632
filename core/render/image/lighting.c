#include "render/image/lighting.h"

/* Rows of the few records for places that no other reaches. */
enum { ROWS = 5 };

/*
 * Differences of records, as a share of the value read, from which it is in doubt and from which it
 * is not used at all. They lie far enough apart that no border is visible between read and gathered
 * light.
 */
static const double doubted = 0.13, disbelieved = 0.27;

double orl_lighting_gathered_share(const struct orl_density *read)
{
    const double luma = orl_luma(read->irradiance), beyond = read->spread - doubted * luma;
    return beyond > 0 ? fmin(beyond / ((disbelieved - doubted) * luma), 1) : 0;
}

struct orl_direct_lighting orl_lighting_direct(const struct orl_lighting *lighting,
                                               const struct orl_shaded_ray *shaded,
                                               uint32_t sequence, uint32_t first,
                                               struct orl_health *health)
{
    struct orl_direct_lighting sum = {.variance = 0};
    for (uint32_t i = 0; i < shaded->n_vertices; i++) {
        const struct orl_vertex *v = &shaded->vertices[i];
        const double weight = orl_luma(v->weight);
        double variance;
        const struct orl_rgb light = orl_gather_direct(lighting->gather, &v->place, sequence, first,
                                                       lighting->shadow_rays, &variance);
        sum.radiance =
            orl_rgb_add(sum.radiance, orl_health_filter(health, orl_rgb_mul(v->weight, light)));
        sum.variance += weight * weight * variance;
    }
    return sum;
}

/* Returns the irradiance from the recent records, and adds one if none reaches the place. */
static struct orl_cached_irradiance recent_record_at(const struct orl_lighting *lighting,
                                                     const struct orl_vertex *v,
                                                     struct orl_recent_records *recent_records,
                                                     struct orl_random *random,
                                                     struct orl_search *search)
{
    const uint32_t count =
        recent_records->made < ORL_RECENT_RECORDS ? recent_records->made : ORL_RECENT_RECORDS;
    struct orl_cached_irradiance cached = {.standard_error = 0};
    if (orl_irradiance_records_lookup(recent_records->records, count, lighting->cache, &v->place,
                                      &cached))
        return cached;
    struct orl_irradiance_record *record =
        &recent_records->records[recent_records->made++ % ORL_RECENT_RECORDS];
    *record = orl_irradiance_record_make(
        lighting->gather, &v->place, orl_pixel_footprint_radius(&lighting->footprint, v->distance),
        ROWS, lighting->cache, random, search);
    if (v->place.textured &&
        orl_irradiance_records_lookup(record, 1, lighting->cache, &v->place, &cached))
        return cached;
    return (struct orl_cached_irradiance){record->irradiance,
                                          hypot(record->photon_error, record->ray_error)};
}

/* Returns the value read, blended with the cached records by the doubt about it. */
static struct orl_cached_irradiance blend_gathered(const struct orl_lighting *lighting,
                                                   const struct orl_vertex *v,
                                                   const struct orl_density *read)
{
    const double doubt = orl_lighting_gathered_share(read), indirect = 1 - doubt;
    struct orl_cached_irradiance cached = {read->irradiance, read->standard_error};
    if (!(doubt > 0) || !orl_icache_lookup(lighting->cache, &v->place, &cached))
        return cached;
    return (struct orl_cached_irradiance){orl_rgb_add(orl_rgb_scale(cached.irradiance, doubt),
                                                      orl_rgb_scale(read->irradiance, indirect)),
                                          doubt * cached.standard_error +
                                              indirect * read->standard_error};
}

/* Returns the rest at a vertex by the applicable method. read: the value by densities or records,
 * if there is one. */
static struct orl_cached_irradiance
indirect_at(const struct orl_lighting *lighting, const struct orl_vertex *v,
            const struct orl_density *read, struct orl_recent_records *recent_records,
            struct orl_random *random, struct orl_search *search)
{
    struct orl_cached_irradiance cached;
    if (!orl_lighting_gathers(lighting->gather, &v->place) && read->found > 0)
        return blend_gathered(lighting, v, read);
    if (orl_icache_lookup(lighting->cache, &v->place, &cached))
        return cached;
    return recent_record_at(lighting, v, recent_records, random, search);
}

/* Returns the distance within which an estimate is nearly constant, because its disc hardly
 * moves. */
static double reach_of(const struct orl_density *density)
{
    return density->radius > 0 ? fmin(0.25 * density->radius, density->clearance) : INFINITY;
}

static void add_vertex(const struct orl_lighting *lighting, const struct orl_vertex *v,
                       struct orl_recent_records *recent_records, struct orl_random *random,
                       struct orl_search *search, struct orl_smooth_lighting *sum)
{
    struct orl_density caustic = {.found = 0}, read = {.found = 0};
    struct orl_surface_point surface_point;
    if (!v->place.outside &&
        orl_gather_find_surface(lighting->gather, v->on_surface, v->place.normal, &surface_point)) {
        caustic = orl_gather_caustic_for_view(lighting->gather, &surface_point, search);
        read = orl_gather_indirect(lighting->gather, &surface_point, search);
    }
    const struct orl_cached_irradiance indirect =
        indirect_at(lighting, v, &read, recent_records, random, search);
    const double weight = orl_luma(v->weight);
    const struct orl_rgb radiance =
        orl_rgb_mul(v->weight, orl_rgb_add(caustic.irradiance, indirect.irradiance));
    sum->radiance = orl_rgb_add(sum->radiance, orl_health_filter(&search->health, radiance));
    sum->caustic += orl_luma(orl_rgb_mul(v->weight, caustic.irradiance));
    sum->rest_error += weight * indirect.standard_error;
    sum->caustic_error += weight * caustic.standard_error;
    sum->reach = fmin(sum->reach, fmin(reach_of(&caustic), reach_of(&read)));
}

struct orl_smooth_lighting orl_lighting_smooth(const struct orl_lighting *lighting,
                                               const struct orl_shaded_ray *shaded,
                                               struct orl_recent_records *recent_records,
                                               struct orl_random *random, struct orl_search *search)
{
    struct orl_smooth_lighting sum = {.reach = INFINITY};
    for (uint32_t i = 0; i < shaded->n_vertices; i++)
        add_vertex(lighting, &shaded->vertices[i], recent_records, random, search, &sum);
    return sum;
}
