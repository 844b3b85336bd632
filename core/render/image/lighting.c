#include "render/image/lighting.h"

/* Rows of the few records for places that no other reaches. */
enum { ROWS = 5 };

/*
 * Differences of records, as a share of the value read, from which it is in doubt and from which it
 * is not used at all. They lie far enough apart that no border is visible between read and gathered
 * light.
 */
static const double doubted = 0.13, disbelieved = 0.27;

double orl_lighting_doubt(const struct orl_density *read)
{
    const double luma = orl_luma(read->irradiance), beyond = read->spread - doubted * luma;
    return beyond > 0 ? fmin(beyond / ((disbelieved - doubted) * luma), 1) : 0;
}

struct orl_shadowed orl_lighting_direct(const struct orl_lighting *lighting,
                                        const struct orl_shaded *shaded, uint32_t sequence,
                                        uint32_t first, struct orl_health *health)
{
    struct orl_shadowed sum = {.variance = 0};
    for (uint32_t i = 0; i < shaded->n_vertices; i++) {
        const struct orl_vertex *v = &shaded->vertices[i];
        const double weight = orl_luma(v->weight);
        double variance;
        const struct orl_rgb light = orl_gather_direct(lighting->gather, &v->place, sequence, first,
                                                       lighting->shadow_rays, &variance);
        sum.radiance =
            orl_rgb_add(sum.radiance, orl_health_keep(health, orl_rgb_mul(v->weight, light)));
        sum.variance += weight * weight * variance;
    }
    return sum;
}

/* Returns the irradiance from the stray records, and adds one if none reaches the place. */
static struct orl_cached stray_at(const struct orl_lighting *lighting, const struct orl_vertex *v,
                                  struct orl_strays *strays, struct orl_random *random,
                                  struct orl_search *search)
{
    const uint32_t count = strays->made < ORL_STRAYS ? strays->made : ORL_STRAYS;
    struct orl_cached cached = {.standard_error = 0};
    if (orl_records_lookup(strays->records, count, lighting->cache, &v->place, &cached))
        return cached;
    struct orl_record *record = &strays->records[strays->made++ % ORL_STRAYS];
    *record = orl_record_make(lighting->gather, &v->place,
                              orl_record_least(&lighting->grain, v->distance), ROWS,
                              lighting->cache, random, search);
    if (v->place.textured && orl_records_lookup(record, 1, lighting->cache, &v->place, &cached))
        return cached;
    return (struct orl_cached){record->irradiance,
                               hypot(record->error_by_photons, record->error_by_rays)};
}

/* Returns the value read, blended with the cached records by the doubt about it. */
static struct orl_cached blend_by_doubt(const struct orl_lighting *lighting,
                                        const struct orl_vertex *v, const struct orl_density *read)
{
    const double doubt = orl_lighting_doubt(read), rest = 1 - doubt;
    struct orl_cached cached = {read->irradiance, read->standard_error};
    if (!(doubt > 0) || !orl_icache_lookup(lighting->cache, &v->place, &cached))
        return cached;
    return (struct orl_cached){
        orl_rgb_add(orl_rgb_scale(cached.irradiance, doubt), orl_rgb_scale(read->irradiance, rest)),
        doubt * cached.standard_error + rest * read->standard_error};
}

/* Returns the rest at a vertex by the applicable method. read: the value by densities or records,
 * if there is one. */
static struct orl_cached rest_at(const struct orl_lighting *lighting, const struct orl_vertex *v,
                                 const struct orl_density *read, struct orl_strays *strays,
                                 struct orl_random *random, struct orl_search *search)
{
    struct orl_cached cached;
    if (!orl_lighting_gathers(lighting->gather, &v->place) && read->found > 0)
        return blend_by_doubt(lighting, v, read);
    if (orl_icache_lookup(lighting->cache, &v->place, &cached))
        return cached;
    return stray_at(lighting, v, strays, random, search);
}

/* Returns the distance within which an estimate is nearly constant, because its disc hardly
 * moves. */
static double reach_of(const struct orl_density *density)
{
    return density->radius > 0 ? fmin(0.25 * density->radius, density->clear) : INFINITY;
}

static void add_vertex(const struct orl_lighting *lighting, const struct orl_vertex *v,
                       struct orl_strays *strays, struct orl_random *random,
                       struct orl_search *search, struct orl_smooth *sum)
{
    struct orl_density caustic = {.found = 0}, read = {.found = 0};
    struct orl_footing footing;
    if (!v->place.outside &&
        orl_gather_footing(lighting->gather, v->on_surface, v->place.normal, &footing)) {
        caustic = orl_gather_caustic_seen(lighting->gather, &footing, search);
        read = orl_gather_rest(lighting->gather, &footing, search);
    }
    const struct orl_cached rest = rest_at(lighting, v, &read, strays, random, search);
    const double weight = orl_luma(v->weight);
    const struct orl_rgb radiance =
        orl_rgb_mul(v->weight, orl_rgb_add(caustic.irradiance, rest.irradiance));
    sum->radiance = orl_rgb_add(sum->radiance, orl_health_keep(&search->health, radiance));
    sum->rest_error += weight * rest.standard_error;
    sum->caustic_error += weight * caustic.standard_error;
    sum->reach = fmin(sum->reach, fmin(reach_of(&caustic), reach_of(&read)));
}

struct orl_smooth orl_lighting_smooth(const struct orl_lighting *lighting,
                                      const struct orl_shaded *shaded, struct orl_strays *strays,
                                      struct orl_random *random, struct orl_search *search)
{
    struct orl_smooth sum = {.reach = INFINITY};
    for (uint32_t i = 0; i < shaded->n_vertices; i++)
        add_vertex(lighting, &shaded->vertices[i], strays, random, search, &sum);
    return sum;
}
