#include "photon/records.h"

#include <stdlib.h>

#include "photon/adapt.h"
#include "photon/flux.h"
#include "photon/pack.h"
#include "photon/site.h"

enum { LEAVES_A_RECORD = 2, PHOTONS_A_RECORD = LEAVES_A_RECORD * ORL_MAP_LEAF };
enum { NEAREST = 12, LEAST_JOINED = 4, MOST_SEARCHED = 256 };
enum { ROUND = 1024, CHUNK = 16 };

/* ---- Making ---------------------------------------------------------------------------------- */

/* Tags count octaves down from the scene's radius, in eighths; 0: nothing is known to be clear. */
static uint8_t tag_of(const struct orl_world *world, double clear)
{
    const double code = floor(255 + 8 * log2(clear / world->geometry->radius));
    return code > 0 ? (uint8_t)fmin(code, 255) : 0;
}

double orl_record_clear(const struct orl_world *world, uint32_t tag)
{
    return tag == 0 ? 0 : world->geometry->radius * exp2(((double)(tag & 255U) - 255) / 8);
}

struct maker {
    const struct orl_records_making *making;
    double reach;
    struct orl_photon *records;
    bool *made;
    size_t count, first;
};

static bool make_record(const struct maker *m, uint64_t leaf, struct orl_search *search,
                        struct orl_photon *ret_record)
{
    const struct orl_records_making *making = m->making;
    const struct orl_photon_map *map = making->global;
    struct orl_site site = orl_site_make(map, leaf);
    struct orl_density_query query = {.k = ORL_ADAPT_MOST, .max_radius = m->reach};
    struct orl_footing footing;
    if (!orl_site_ask(map, &site, leaf, making->world, &query, &footing))
        return false;
    const struct orl_density density = orl_adapt_estimate(map, &query, search);
    const double emitted = (double)map->header->emitted;
    const struct orl_rgb value = orl_rgb_scale(density.irradiance, emitted);
    const struct orl_vec3 p = footing.point;
    *ret_record = (struct orl_photon){.position = {(float)p.x, (float)p.y, (float)p.z},
                                      .flux = {(float)value.r, (float)value.g, (float)value.b},
                                      .normal = orl_normal_encode(footing.normal),
                                      .tag = tag_of(making->world, density.clear),
                                      .facet = footing.facet};
    return orl_rgb_is_finite(value);
}

static void make_chunk(void *arg, size_t chunk, uint32_t member)
{
    struct maker *m = arg;
    const size_t first = m->first + chunk * CHUNK;
    if (atomic_load_explicit(m->making->cancel, memory_order_relaxed))
        return;
    for (size_t i = first; i < first + CHUNK && i < m->count; i++)
        m->made[i] =
            make_record(m, LEAVES_A_RECORD * i, &m->making->searches[member], &m->records[i]);
}

static int make_all(struct maker *m)
{
    const struct orl_records_making *making = m->making;
    for (m->first = 0; m->first < m->count; m->first += ROUND) {
        const size_t left = m->count - m->first, now = left < ROUND ? left : ROUND;
        orl_crew_for(making->crew, (now + CHUNK - 1) / CHUNK, make_chunk, m);
        if (atomic_load(making->cancel))
            return ORL_ERR_CANCELLED;
        if (making->progress)
            making->progress(making->ctx, (double)(m->first + now) / (double)m->count);
    }
    return 0;
}

int orl_records_make(const struct orl_records_making *making, struct orl_photon **ret_records,
                     size_t *ret_count, struct orl_error *err)
{
    const struct orl_photon_map *map = making->global;
    struct maker m = {.making = making};
    size_t kept = 0;
    int code = ORL_ERR_NOMEM;
    m.count = (map->header->count + PHOTONS_A_RECORD - 1) / PHOTONS_A_RECORD;
    m.records = calloc(m.count + 1, sizeof *m.records);
    m.made = calloc(m.count + 1, sizeof *m.made);
    if (!m.records || !m.made) {
        orl_error_set(err, code, "out of memory for precomputed irradiance");
        goto done;
    }
    const double widest = 0.1 * making->world->geometry->radius;
    m.reach = orl_adapt_reach(map, widest, &making->searches[0]);
    code = make_all(&m);
    if (code < 0) {
        orl_error_set(err, code, "cancelled while precomputing irradiance");
        goto done;
    }
    for (size_t i = 0; i < m.count; i++)
        if (m.made[i])
            m.records[kept++] = m.records[i];
    *ret_records = m.records;
    *ret_count = kept;
    m.records = NULL;
done:
    free(m.made);
    free(m.records);
    return code;
}

/* ---- Reading --------------------------------------------------------------------------------- */

/*
 * A weighted fit of a plane to the records about a point: sums of weights, of offsets in the
 * tangent plane over the radius (x, y), and of values with either.
 */
struct fit {
    double weight, x, y, xx, xy, yy;
    struct orl_rgb value, by_x, by_y;
    uint32_t joined;
};

/* Sheets end at 30 degrees between normals: there a record's weight is nothing, too. */
static double facing_weight(struct orl_vec3 normal, uint16_t own, uint16_t code)
{
    static const double cosine_30 = 0.8660254037844386;
    if (code == own)
        return 1;
    const double cosine = orl_dot(orl_normal_decode(code), normal);
    return fmin(fmax((cosine - cosine_30) / (1 - cosine_30), 0), 1);
}

static void add_to_fit(struct fit *fit, double weight, double x, double y, struct orl_rgb value)
{
    fit->weight += weight;
    fit->x += weight * x;
    fit->y += weight * y;
    fit->xx += weight * x * x;
    fit->xy += weight * x * y;
    fit->yy += weight * y * y;
    fit->value = orl_rgb_add(fit->value, orl_rgb_scale(value, weight));
    fit->by_x = orl_rgb_add(fit->by_x, orl_rgb_scale(value, weight * x));
    fit->by_y = orl_rgb_add(fit->by_y, orl_rgb_scale(value, weight * y));
    fit->joined++;
}

/*
 * The plane's value at the point. Records lie closer together where there is more light, so that a
 * mean of them is too high on every slope; and beside walls all lie on one side. Where they hardly
 * tell a slope the plane is held level (the ridge).
 */
static struct orl_rgb fit_value(const struct fit *fit)
{
    const double ridge = 0.02 * fit->weight;
    const double xx = fit->xx + ridge, yy = fit->yy + ridge;
    const double determinant = xx * yy - fit->xy * fit->xy;
    const double a = (yy * fit->x - fit->xy * fit->y) / determinant;
    const double b = (xx * fit->y - fit->xy * fit->x) / determinant;
    const double weight = fit->weight - a * fit->x - b * fit->y;
    const struct orl_rgb sum = orl_rgb_add(
        fit->value, orl_rgb_add(orl_rgb_scale(fit->by_x, -a), orl_rgb_scale(fit->by_y, -b)));
    return (struct orl_rgb){fmax(sum.r / weight, 0), fmax(sum.g / weight, 0),
                            fmax(sum.b / weight, 0)};
}

static void add_record(const struct orl_photon_map *map, const struct orl_footing *footing,
                       const struct orl_frame *frame, const struct orl_search_candidate *c,
                       double radius, struct fit *fit)
{
    const struct orl_photon record = orl_photon_map_get(map, c->index);
    const double distance = sqrt((double)c->distance2) * map->header->cell;
    const double share = distance / radius;
    const struct orl_vec3 at = orl_v3(record.position[0], record.position[1], record.position[2]);
    const struct orl_vec3 way = orl_sub(at, footing->point);
    if (distance > orl_record_clear(footing->world, record.tag) && !orl_footing_joins(footing, at))
        return;
    const double bell = fmax(1 - share * share, 0);
    const double weight =
        bell * bell *
        facing_weight(footing->normal, orl_normal_encode(footing->normal), record.normal);
    const struct orl_rgb value =
        orl_rgb_scale(orl_flux_unpack(map->fluxes[c->index]), map->header->flux_unit);
    add_to_fit(fit, weight, orl_dot(way, frame->u) / radius, orl_dot(way, frame->v) / radius,
               value);
}

bool orl_records_irradiance(const struct orl_photon_map *records, const struct orl_footing *footing,
                            double max_radius, struct orl_search *search,
                            struct orl_rgb *ret_irradiance)
{
    struct orl_density_query query = {.point = footing->point,
                                      .normal = footing->normal,
                                      .k = NEAREST + 1,
                                      .max_radius = max_radius,
                                      .footing = footing};
    const struct orl_frame frame = orl_frame_about(footing->normal);
    struct fit fit;
    for (;; query.k *= 4) {
        double radius;
        const uint32_t found = orl_density_nearest(records, &query, search, &radius);
        fit = (struct fit){.weight = 0};
        for (uint32_t i = 0; i < found; i++)
            add_record(records, footing, &frame, &search->candidates[i], radius, &fit);
        /* Beyond a wall there may be many: look further on this side. */
        if (fit.joined >= LEAST_JOINED || found + 1 < query.k || query.k >= MOST_SEARCHED)
            break;
    }
    if (!(fit.weight > 1e-9))
        return false;
    *ret_irradiance = fit_value(&fit);
    return true;
}
