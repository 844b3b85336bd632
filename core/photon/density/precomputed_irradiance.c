#include "photon/density/precomputed_irradiance.h"

#include <stdlib.h>
#include <string.h>

#include "photon/density/adaptive_density.h"
#include "photon/density/leaf_sites.h"
#include "photon/map/map_layout.h"
#include "photon/map/quantization.h"
#include "photon/surface/footprint.h"

enum { LEAVES_A_RECORD = 2, PHOTONS_A_RECORD = LEAVES_A_RECORD * ORL_MAP_LEAF };
enum { GROUP = 4 };
enum { NEAREST = 8, LEAST_UNOCCLUDED = 4, MOST_SEARCHED = 256, MEAN_OF = 3 };
enum { ROUND = 4096, CHUNK = 16 };
_Static_assert((int)CHUNK % (int)GROUP == 0 && (int)ROUND % (int)CHUNK == 0, "whole groups");

/* Thresholds of a density's evenness: the widest disc was used, or nearly so. */
static const double even = 0.9, quite_even = 0.995;

/* ---- Making records -------------------------------------------------------------------------- */

/* Codes a distance in eighths of octaves down from the scene's radius; 0: unknown. */
static uint8_t tag_of(const struct orl_lit_scene *lit_scene, double clearance)
{
    const double code = floor(255 + 8 * log2(clearance / lit_scene->geometry->radius));
    return code > 0 ? (uint8_t)orl_smaller(code, 255) : 0;
}

/* Returns the distance around a record within which there is no wall, from its tag. */
static double clearance_of_tag(const struct orl_lit_scene *lit_scene, uint32_t tag)
{
    return tag == 0 ? 0 : lit_scene->geometry->radius * exp2(((double)(tag & 255U) - 255) / 8);
}

struct record_builder {
    const struct orl_precomputed_build_args *args;
    struct orl_adaptive_density adapt;
    struct orl_precomputed records;
    bool *made;
    size_t first;
};

static struct orl_precomputed_note note_of(const struct orl_density *density)
{
    const double luma = orl_luma(density->irradiance), mean = luma / ORL_MAP_BATCHES;
    struct orl_precomputed_note note = {.sparse = density->unreliable};
    double most = 0;
    for (int i = 0; i < ORL_MAP_BATCHES; i++)
        most = orl_larger(most, fabs(density->parts.luma[i] - mean));
    if (!(luma > 0) || !(most > 0))
        return note;
    note.unit = (float)(most / INT8_MAX / luma);
    note.bias = (float)(density->bias / luma);
    for (int i = 0; i < ORL_MAP_BATCHES; i++)
        note.off[i] = (int8_t)lround(INT8_MAX * (density->parts.luma[i] - mean) / most);
    return note;
}

/* Initial values passed from record to record of a chunk (struct orl_density_query). */
struct hint {
    double disc;
    bool cut;
};

static bool make_record(struct record_builder *m, size_t index, struct orl_search *search,
                        struct hint *hint, struct orl_surface_point *ret_surface_point,
                        struct orl_density *ret_density)
{
    const struct orl_precomputed_build_args *args = m->args;
    const struct orl_photon_map *map = args->global;
    const uint64_t leaf = LEAVES_A_RECORD * (uint64_t)index;
    struct orl_leaf_center site = orl_leaf_center_make(map, leaf);
    struct orl_density_query query = {.k = ORL_ADAPTIVE_DENSITY_MOST,
                                      .max_radius = m->adapt.reach,
                                      .hint = hint->disc,
                                      .hint_cut = hint->cut};
    if (!orl_leaf_center_set_query(map, &site, leaf, args->lit_scene, &query, ret_surface_point))
        return false;
    const struct orl_density density = orl_adaptive_density_estimate(&m->adapt, &query, search);
    *hint = (struct hint){density.disc, density.cut};
    const double emitted = (double)map->header->emitted;
    const struct orl_rgb value = orl_rgb_scale(density.irradiance, emitted);
    const struct orl_vec3 p = ret_surface_point->point;
    m->records.photons[index] =
        (struct orl_photon){.position = {(float)p.x, (float)p.y, (float)p.z},
                            .flux = {(float)value.r, (float)value.g, (float)value.b},
                            .normal = orl_normal_encode(ret_surface_point->normal),
                            .tag = tag_of(args->lit_scene, density.clearance),
                            .facet = ret_surface_point->facet};
    m->records.notes[index] = note_of(&density);
    *ret_density = density;
    return orl_rgb_is_finite(value);
}

/*
 * Returns true if a record also represents that patch of photons: the patch is on the same plane,
 * within the disc that was found to be even, and not occluded. Beside walls the light must be very
 * even.
 */
static bool represents_patch(const struct record_builder *m, uint64_t patch,
                             const struct orl_surface_point *surface_point,
                             const struct orl_density *density)
{
    const struct orl_leaf_sums *sums = &m->adapt.sums;
    const double cell = sums->map->header->cell;
    uint32_t lane;
    const struct orl_patch_group *group = orl_patch_find(sums, patch, &lane);
    float at[3];
    orl_box_locate(sums->map, surface_point->point, at);
    const struct orl_vec3 chord =
        orl_v3(group->at[0][lane] - at[0], group->at[1][lane] - at[1], group->at[2][lane] - at[2]);
    const double far = (orl_length(chord) + (double)group->reach[lane]) * cell;
    if (group->count[lane] == 0)
        return true;
    if (group->normal[lane] != orl_normal_encode(surface_point->normal) ||
        !(far < density->radius) || !orl_chord_fits(surface_point->normal, chord, 0))
        return false;
    return far < density->clearance ||
           (density->evenness >= quite_even &&
            orl_surface_point_unoccluded(surface_point,
                                         orl_madd(surface_point->point, chord, cell)));
}

/* A record just made, to test whether others around it are needed. */
struct candidate {
    size_t index;
    bool made;
    struct orl_surface_point surface_point;
    struct orl_density density;
};

static struct candidate make_candidate(struct record_builder *m, size_t index,
                                       struct orl_search *search, struct hint *hint)
{
    struct candidate candidate = {.index = index};
    if (index < m->records.count)
        candidate.made = m->made[index] =
            make_record(m, index, search, hint, &candidate.surface_point, &candidate.density);
    return candidate;
}

/* Returns true if the record represents the leaves of all n records from `first`. */
static bool represents_leaves(const struct record_builder *m, const struct candidate *candidate,
                              size_t first, size_t n)
{
    const struct orl_leaf_sums *sums = &m->adapt.sums;
    const uint64_t leaf = LEAVES_A_RECORD * (uint64_t)first, end = leaf + LEAVES_A_RECORD * n;
    if (!candidate->made || !(candidate->density.evenness >= even) || end > sums->count)
        return false;
    for (uint64_t i = ORL_PATCHES * leaf; i < ORL_PATCHES * end; i++)
        if (!represents_patch(m, i, &candidate->surface_point, &candidate->density))
            return false;
    return true;
}

/*
 * Makes records for n places. Where light is even, one in the middle represents all; otherwise each
 * half is handled in turn. `candidate`: one of them that exists already, or NULL.
 */
static void make_group(struct record_builder *m, size_t first, size_t n,
                       const struct candidate *candidate, struct orl_search *search,
                       struct hint *hint)
{
    const size_t half = n / 2;
    struct candidate own;
    if (!candidate) {
        own = make_candidate(m, first + half, search, hint);
        candidate = &own;
    }
    if (n == 1 || represents_leaves(m, candidate, first, n))
        return;
    const bool above = candidate->index >= first + half;
    make_group(m, first + half, n - half, above ? candidate : NULL, search, hint);
    make_group(m, first, half, above ? NULL : candidate, search, hint);
}

static void make_chunk(void *arg, size_t chunk, uint32_t member)
{
    struct record_builder *m = arg;
    const size_t first = m->first + chunk * CHUNK;
    struct hint hint = {0};
    if (atomic_load_explicit(m->args->cancel, memory_order_relaxed))
        return;
    for (size_t i = first; i < first + CHUNK && i < m->records.count; i += GROUP)
        make_group(m, i, GROUP, NULL, &m->args->searches[member], &hint);
}

static int make_all(struct record_builder *m)
{
    const struct orl_precomputed_build_args *args = m->args;
    const size_t count = m->records.count;
    for (m->first = 0; m->first < count; m->first += ROUND) {
        const size_t left = count - m->first, now = left < ROUND ? left : ROUND;
        orl_parallel_for(args->pool, (now + CHUNK - 1) / CHUNK, make_chunk, m);
        if (atomic_load(args->cancel))
            return ORL_ERR_CANCELLED;
        if (args->progress)
            args->progress(args->ctx, (double)(m->first + now) / (double)count);
    }
    return 0;
}

void orl_precomputed_done(struct orl_precomputed *records)
{
    free(records->photons);
    free(records->notes);
    memset(records, 0, sizeof *records);
}

/* Drops the records that could not be made. */
static void keep_made(struct orl_precomputed *records, const bool *made)
{
    size_t kept = 0;
    for (size_t i = 0; i < records->count; i++) {
        if (!made[i])
            continue;
        records->photons[kept] = records->photons[i];
        records->notes[kept++] = records->notes[i];
    }
    records->count = kept;
}

int orl_precomputed_build(const struct orl_precomputed_build_args *args,
                          struct orl_precomputed *ret_records, struct orl_error *err)
{
    const struct orl_photon_map *map = args->global;
    struct record_builder m = {.args = args};
    int code = ORL_ERR_NOMEM;
    const size_t count = (map->header->count + PHOTONS_A_RECORD - 1) / PHOTONS_A_RECORD;
    m.records.count = count;
    m.records.photons = calloc(count + 1, sizeof *m.records.photons);
    m.records.notes = calloc(count + 1, sizeof *m.records.notes);
    m.made = calloc(count + 1, sizeof *m.made);
    const double widest = 0.1 * args->lit_scene->geometry->radius;
    if (m.records.photons && m.records.notes && m.made)
        code = orl_adaptive_density_init(&m.adapt, map, widest, args->pool, &args->searches[0]);
    if (code == 0)
        code = make_all(&m);
    if (code < 0) {
        orl_error_set(err, code,
                      code == ORL_ERR_CANCELLED ? "cancelled while precomputing irradiance"
                                                : "out of memory for precomputed irradiance");
        goto done;
    }
    keep_made(&m.records, m.made);
    *ret_records = m.records;
    m.records = (struct orl_precomputed){0};
done:
    orl_adaptive_density_done(&m.adapt);
    free(m.made);
    orl_precomputed_done(&m.records);
    return code;
}

/* ---- Reading records ------------------------------------------------------------------------- */

/*
 * Weighted fit of a plane to the records around a point: sums of weights, of offsets in the tangent
 * plane over the radius (x, y), and of values with either.
 */
struct value_errors { /* errors of a value's luma */
    struct orl_batches parts;
    double bias;
    double sparse; /* 1: the estimate has few photons; in sums it is weighted */
};
struct fit {
    double weight, x, y, xx, xy, yy;
    struct orl_rgb value, by_x, by_y;
    struct value_errors value_errors, errors_by_x, errors_by_y;
    double squares; /* weighted squares of the value's luma */
    uint32_t unoccluded;
    double nearest, farthest; /* distances of the records used, as shares of the radius */
};

/* Returns a weight that falls to 0 at 30 degrees between normals, where sheets end. */
static double facing_weight(struct orl_vec3 normal, uint16_t own, uint16_t code)
{
    static const double cosine_30 = 0.8660254037844386;
    if (code == own)
        return 1;
    const double cosine = orl_dot(orl_normal_decode(code), normal);
    return orl_smaller(orl_larger((cosine - cosine_30) / (1 - cosine_30), 0), 1);
}

static void add_value_errors(struct value_errors *sum, const struct value_errors *more,
                             double factor)
{
    orl_batches_add(&sum->parts, &more->parts, factor);
    sum->bias += more->bias * factor;
    sum->sparse += more->sparse * factor;
}

static void add_to_fit(struct fit *fit, double weight, double x, double y, struct orl_rgb value,
                       const struct value_errors *value_errors)
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
    add_value_errors(&fit->value_errors, value_errors, weight);
    add_value_errors(&fit->errors_by_x, value_errors, weight * x);
    add_value_errors(&fit->errors_by_y, value_errors, weight * y);
    fit->squares += weight * orl_luma(value) * orl_luma(value);
    fit->unoccluded++;
}

/*
 * Returns the plane's value at the point. Records are denser where there is more light, so their
 * mean is too high on every slope; beside walls all are on one side. A ridge term levels the plane
 * if records hardly determine a slope.
 */
static struct orl_rgb fit_value(const struct fit *fit, struct value_errors *ret_errors)
{
    const double ridge = 0.02 * fit->weight;
    const double xx = fit->xx + ridge, yy = fit->yy + ridge;
    const double determinant = xx * yy - fit->xy * fit->xy;
    const double a = (yy * fit->x - fit->xy * fit->y) / determinant;
    const double b = (xx * fit->y - fit->xy * fit->x) / determinant;
    const double weight = fit->weight - a * fit->x - b * fit->y;
    const struct orl_rgb sum = orl_rgb_add(
        fit->value, orl_rgb_add(orl_rgb_scale(fit->by_x, -a), orl_rgb_scale(fit->by_y, -b)));
    *ret_errors = (struct value_errors){.bias = 0};
    add_value_errors(ret_errors, &fit->value_errors, 1 / weight);
    add_value_errors(ret_errors, &fit->errors_by_x, -a / weight);
    add_value_errors(ret_errors, &fit->errors_by_y, -b / weight);
    return (struct orl_rgb){orl_larger(sum.r / weight, 0), orl_larger(sum.g / weight, 0),
                            orl_larger(sum.b / weight, 0)};
}

/* Returns a record's note times its luma. A map without notes has no errors. */
static struct value_errors value_errors_of(const struct orl_photon_map *map, uint32_t index,
                                           double luma)
{
    const unsigned char *at = orl_photon_map_note(map, index);
    struct orl_precomputed_note note;
    if (!at || map->header->note_bytes < sizeof note)
        return (struct value_errors){.bias = 0};
    memcpy(&note, at, sizeof note);
    struct value_errors value_errors = {.bias = luma * (double)note.bias, .sparse = note.sparse};
    for (int i = 0; i < ORL_MAP_BATCHES; i++)
        value_errors.parts.luma[i] =
            luma * (1.0 / ORL_MAP_BATCHES + (double)note.unit * note.off[i]);
    return value_errors;
}

static void add_record(const struct orl_photon_map *map,
                       const struct orl_surface_point *surface_point, const struct orl_frame *frame,
                       const struct orl_search_candidate *c, double radius, struct fit *fit)
{
    const struct orl_photon record = orl_photon_map_get(map, c->index);
    const double distance = sqrt((double)c->distance2) * map->header->cell;
    const double share = distance / radius;
    const struct orl_vec3 at = orl_v3(record.position[0], record.position[1], record.position[2]);
    const struct orl_vec3 way = orl_sub(at, surface_point->point);
    if (distance > clearance_of_tag(surface_point->lit_scene, record.tag) &&
        !orl_surface_point_unoccluded(surface_point, at))
        return;
    const double bell = orl_larger(1 - share * share, 0);
    const double weight = bell * bell *
                          facing_weight(surface_point->normal,
                                        orl_normal_encode(surface_point->normal), record.normal);
    const struct orl_rgb value =
        orl_rgb_scale(orl_flux_unpack(map->fluxes[c->index]), map->header->flux_unit);
    const struct value_errors value_errors = value_errors_of(map, c->index, orl_luma(value));
    fit->nearest = fit->unoccluded == 0 ? share : orl_smaller(fit->nearest, share);
    fit->farthest = orl_larger(fit->farthest, share);
    add_to_fit(fit, weight, orl_dot(way, frame->u) / radius, orl_dot(way, frame->v) / radius, value,
               &value_errors);
}

/*
 * Returns true if the records do not determine the light at the point: they are few, most have few
 * photons, they are biased, or the point lies beyond them. Photons, and so records, end where
 * little light arrives. Then the nearest records lie to one side, far away relative to their
 * spacing, and differ. If n points are spread evenly around the point, or around it at an end of
 * the surface, the nearest is that far off in one of thirty cases: (1 - (nearest / farthest)^2)^(n
 * - 1).
 */
static bool is_unreliable(const struct fit *fit, const struct orl_density *density, double mean)
{
    static const double seldom = 1.0 / 30, uneven = 0.3, biased = 0.1;
    const double ratio = fit->farthest > 0 ? fit->nearest / fit->farthest : 0;
    if (fit->unoccluded < LEAST_UNOCCLUDED || fit->value_errors.sparse > fit->weight / 2 ||
        fabs(density->bias) > biased * orl_luma(density->irradiance))
        return true;
    return pow(1 - ratio * ratio, fit->unoccluded - 1.0) < seldom &&
           density->spread > uneven * mean;
}

struct orl_density orl_precomputed_estimate(const struct orl_photon_map *records,
                                            const struct orl_surface_point *surface_point,
                                            double max_radius, struct orl_search *search)
{
    struct orl_density density = {.unreliable = true};
    struct orl_density_query query = {.point = surface_point->point,
                                      .normal = surface_point->normal,
                                      .k = NEAREST + 1,
                                      .max_radius = max_radius,
                                      .surface_point = surface_point};
    const struct orl_frame frame = orl_frame_about(surface_point->normal);
    struct fit fit;
    for (;; query.k *= 4) {
        double radius;
        const uint32_t found = orl_density_nearest(records, &query, search, &radius);
        fit = (struct fit){.weight = 0};
        for (uint32_t i = 0; i < found; i++)
            add_record(records, surface_point, &frame, &search->candidates[i], radius, &fit);
        /* Many may be behind a wall: search further on this side. */
        if (fit.unoccluded >= LEAST_UNOCCLUDED || found + 1 < query.k || query.k >= MOST_SEARCHED)
            break;
    }
    if (!(fit.weight > 1e-9))
        return density;
    density.found = 1;
    struct value_errors value_errors;
    density.irradiance = fit_value(&fit, &value_errors);
    density.parts = value_errors.parts;
    density.bias = value_errors.bias;
    density.standard_error = sqrt(orl_batches_variance(&density.parts));
    const double mean = orl_luma(fit.value) / fit.weight;
    density.spread = sqrt(orl_larger(fit.squares / fit.weight - mean * mean, 0));
    density.unreliable = is_unreliable(&fit, &density, mean);
    return density;
}

struct orl_density orl_precomputed_mean(const struct orl_photon_map *records,
                                        const struct orl_surface_point *surface_point,
                                        double max_radius, struct orl_search *search)
{
    const struct orl_density_query query = {.point = surface_point->point,
                                            .normal = surface_point->normal,
                                            .k = MEAN_OF + 1,
                                            .max_radius = max_radius,
                                            .surface_point = surface_point};
    struct orl_density density = {.found = 0};
    const uint32_t found = orl_density_nearest(records, &query, search, &density.radius);
    for (uint32_t i = 0; i < found; i++) {
        const uint32_t index = search->candidates[i].index;
        const struct orl_rgb value =
            orl_rgb_scale(orl_flux_unpack(records->fluxes[index]), records->header->flux_unit);
        const struct value_errors value_errors = value_errors_of(records, index, orl_luma(value));
        density.irradiance = orl_rgb_add(density.irradiance, orl_rgb_scale(value, 1.0 / found));
        orl_batches_add(&density.parts, &value_errors.parts, 1.0 / found);
    }
    density.found = found > 0;
    return density;
}
