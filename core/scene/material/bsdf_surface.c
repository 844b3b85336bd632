/*
 * BSDF surfaces: the data, and the diffuse scattering that the material adds. BSDF takes 3, 6 or 9
 * numbers: diffuse reflectances of the front and of the back, and a diffuse transmittance for both
 * directions. For an aBSDF, the light that orl_bsdf_straight returns goes straight through.
 *
 * Where data and additions together exceed an albedo of 1, both are divided by the excess: for
 * light from that direction, by the largest channel.
 */
#include <stdlib.h>

#include "bsdf/loaded_bsdf.h"
#include "scene/material/kinds.h"

struct orl_frame orl_bsdf_frame(const struct orl_material *material, struct orl_vec3 normal)
{
    struct orl_frame frame;
    const struct orl_vec3 up = orl_bsdf_surface_of(material)->up;
    frame.n = normal;
    frame.v = orl_normalize(orl_madd(up, normal, -orl_dot(up, normal)));
    frame.u = orl_cross(frame.v, frame.n);
    return frame;
}

static enum orl_bsdf_side sides_of(enum orl_lobes lobes)
{
    return (enum orl_bsdf_side)((lobes & ORL_LOBE_REFLECTED ? ORL_BSDF_REFLECT : 0) |
                                (lobes & ORL_LOBE_TRANSMITTED ? ORL_BSDF_TRANSMIT : 0));
}

/* ---- Diffuse additions
 * ------------------------------------------------------------------------ */

/* Added diffuse reflectance for light from one side, and transmittance; 0 for sides that are not
 * wanted. */
struct added {
    struct orl_rgb reflected, transmitted;
};

static struct added added_to(const struct orl_bsdf_surface *surface, bool front,
                             enum orl_bsdf_side sides)
{
    const struct orl_diffuse_parts *const diffuse = &surface->diffuse;
    const struct orl_rgb none = orl_gray(0);
    return (struct added){sides & ORL_BSDF_REFLECT ? (front ? diffuse->front : diffuse->back)
                                                   : none,
                          sides & ORL_BSDF_TRANSMIT ? diffuse->through : none};
}

static double added_luma(const struct added *added)
{
    return orl_luma(added->reflected) + orl_luma(added->transmitted);
}

/* Returns the divisor that keeps the albedo for light from that direction at most 1. */
static double excess(const struct orl_bsdf_surface *surface, struct orl_vec3 in)
{
    const struct added a = added_to(surface, in.z > 0, ORL_BSDF_BOTH);
    const struct orl_rgb sum = orl_rgb_add(a.reflected, a.transmitted);
    if (!(orl_rgb_max(sum) > 0) ||
        orl_rgb_max(sum) + orl_bsdf_max_albedo(surface->bsdf, in.z > 0) <= 1)
        return 1;
    return fmax(1,
                orl_rgb_max(orl_rgb_add(sum, orl_bsdf_albedo(surface->bsdf, in, ORL_BSDF_BOTH))));
}

/* ---- Values ---------------------------------------------------------------------------------- */

/* f without straight transmission; directions in the surface's frame. */
static struct orl_rgb lobes_between(const struct orl_bsdf_surface *surface, struct orl_vec3 in,
                                    struct orl_vec3 out)
{
    const struct added a = added_to(surface, in.z > 0, ORL_BSDF_BOTH);
    struct orl_rgb f = orl_bsdf_eval(surface->bsdf, in, out);
    if (surface->peak && orl_rgb_max(f) > 0)
        f = orl_rgb_scale(f, 1 - orl_bsdf_straight_part(surface->bsdf, in, out));
    f = orl_rgb_add(
        f, orl_rgb_scale((in.z > 0) == (out.z > 0) ? a.reflected : a.transmitted, 1 / ORL_PI));
    return orl_rgb_scale(f, 1 / excess(surface, in));
}

struct orl_rgb orl_bsdf_surface_lobes(const struct orl_material *material,
                                      const struct orl_hit *hit, struct orl_vec3 light,
                                      struct orl_vec3 eye)
{
    const struct orl_frame frame = orl_bsdf_frame(material, hit->normal);
    return lobes_between(orl_bsdf_surface_of(material), orl_to_local(&frame, light),
                         orl_to_local(&frame, eye));
}

struct orl_rgb orl_bsdf_surface_albedo(const struct orl_material *material,
                                       const struct orl_hit *hit, struct orl_vec3 light,
                                       enum orl_lobes lobes)
{
    const struct orl_bsdf_surface *const surface = orl_bsdf_surface_of(material);
    const struct orl_frame frame = orl_bsdf_frame(material, hit->normal);
    const struct orl_vec3 in = orl_to_local(&frame, light);
    const enum orl_bsdf_side sides = sides_of(lobes);
    const struct added a = added_to(surface, in.z > 0, sides);
    if (!sides)
        return orl_gray(0);
    return orl_rgb_scale(orl_rgb_add(orl_rgb_add(a.reflected, a.transmitted),
                                     orl_bsdf_albedo(surface->bsdf, in, sides)),
                         1 / excess(surface, in));
}

/* Straight transmittance of light from that direction; in the surface's frame. */
static struct orl_rgb straight_from(const struct orl_bsdf_surface *surface, struct orl_vec3 in)
{
    return orl_rgb_scale(orl_bsdf_straight(surface->bsdf, in), 1 / excess(surface, in));
}

struct orl_rgb orl_bsdf_surface_straight(const struct orl_material *material,
                                         const struct orl_hit *hit, struct orl_vec3 eye)
{
    const struct orl_bsdf_surface *const surface = orl_bsdf_surface_of(material);
    if (!surface->peak)
        return orl_gray(0);
    const struct orl_frame frame = orl_bsdf_frame(material, hit->normal);
    return straight_from(surface, orl_neg(orl_to_local(&frame, eye)));
}

/* ---- Sampling -------------------------------------------------------------------------------- */

/* The arguments of a query in the surface's frame. */
struct local {
    const struct orl_bsdf_surface *surface;
    struct orl_vec3 from;
    bool adjoint;
    enum orl_bsdf_side sides;
    struct added added;
    /* luminances: of the data, and of the sum with the additions; both 1 if nothing is added */
    double data, sum;
};

static struct local local_of(const struct orl_bsdf_query *query, const struct orl_frame *frame)
{
    struct local l = {.surface = orl_bsdf_surface_of(query->material),
                      .from = orl_to_local(frame, query->from),
                      .adjoint = query->transport == ORL_TRANSPORT_EYE,
                      .sides = sides_of(query->lobes)};
    l.added = added_to(l.surface, l.from.z > 0, l.sides);
    l.data = l.sides ? 1 : 0;
    if (l.sides && added_luma(&l.added) > 0)
        l.data = orl_bsdf_total(l.surface->bsdf, l.from, l.adjoint, l.sides);
    l.sum = l.data + added_luma(&l.added);
    return l;
}

static double local_pdf(const struct local *l, struct orl_vec3 towards)
{
    const struct orl_bsdf *bsdf = l->surface->bsdf;
    const struct orl_rgb added =
        (towards.z > 0) == (l->from.z > 0) ? l->added.reflected : l->added.transmitted;
    double pdf = l->adjoint ? orl_bsdf_pdf_adjoint(bsdf, l->from, l->sides, towards)
                            : orl_bsdf_pdf(bsdf, l->from, l->sides, towards);
    if (!(l->sum > 0))
        return 0;
    if (l->surface->peak && pdf > 0)
        pdf *= 1 - (l->adjoint ? orl_bsdf_straight_part(bsdf, towards, l->from)
                               : orl_bsdf_straight_part(bsdf, l->from, towards));
    return (l->data * pdf + orl_luma(added) * fabs(towards.z) / ORL_PI) / l->sum;
}

double orl_bsdf_surface_pdf(const struct orl_bsdf_query *query, struct orl_vec3 towards)
{
    const struct orl_frame frame = orl_bsdf_frame(query->material, query->hit->normal);
    const struct local l = local_of(query, &frame);
    return local_pdf(&l, orl_to_local(&frame, towards));
}

/* Samples the cosine distribution on one side, chosen by its share; choice is below the sum of
 * both. */
static struct orl_vec3 sample_added(const struct local *l, double choice, const double u[3])
{
    const double sine = sqrt(u[0]), phi = 2 * ORL_PI * u[1];
    const bool front = (l->from.z > 0) == (choice < orl_luma(l->added.reflected));
    const double cosine = fmax(sqrt(1 - u[0]), 1e-9);
    return orl_v3(sine * cos(phi), sine * sin(phi), front ? cosine : -cosine);
}

/* Weight of a sample that came from the data alone or went straight. */
static void scale_weight(const struct local *l, struct orl_bsdf_sample_result *sample)
{
    const struct orl_vec3 in = l->adjoint ? sample->direction : l->from;
    sample->weight = orl_rgb_scale(sample->weight, l->sum / l->data / excess(l->surface, in));
}

/* Samples the data or the additions; false if nothing is scattered. */
static bool sample_local(const struct local *l, const double u[3],
                         struct orl_bsdf_sample_result *ret)
{
    const double choice = u[2] * l->sum, v[3] = {u[0], u[1], l->data > 0 ? choice / l->data : 0};
    const bool mixed = l->sum > l->data;
    const struct orl_bsdf *bsdf = l->surface->bsdf;
    *ret = (struct orl_bsdf_sample_result){.straight = false};
    if (mixed && choice >= l->data)
        ret->direction = sample_added(l, choice - l->data, u);
    else if (l->surface->peak) {
        if (!orl_bsdf_sample_split(bsdf, l->from, l->adjoint, l->sides, mixed ? v : u, ret))
            return false;
    } else if (!(l->adjoint ? orl_bsdf_sample_adjoint(bsdf, l->from, l->sides, mixed ? v : u,
                                                      &ret->direction, &ret->weight, &ret->pdf)
                            : orl_bsdf_sample(bsdf, l->from, l->sides, mixed ? v : u,
                                              &ret->direction, &ret->weight, &ret->pdf))) {
        return false;
    }
    if (ret->straight || !mixed) {
        scale_weight(l, ret);
        return true;
    }
    const struct orl_vec3 in = l->adjoint ? ret->direction : l->from;
    const struct orl_vec3 out = l->adjoint ? l->from : ret->direction;
    ret->weight = orl_rgb_scale(lobes_between(l->surface, in, out),
                                fabs(ret->direction.z) / local_pdf(l, ret->direction));
    return true;
}

static struct orl_surface_sample sample_of(const struct orl_bsdf_query *query,
                                           const struct orl_frame *frame, const struct local *l,
                                           const struct orl_bsdf_sample_result *next)
{
    struct orl_surface_sample s = {.event = next->straight ? ORL_EVENT_STRAIGHT : ORL_EVENT_GLOSSY};
    s.transmitted = next->straight || next->direction.z * l->from.z < 0;
    s.direction = next->straight ? orl_neg(query->from) : orl_to_world(frame, next->direction);
    s.weight = next->weight;
    return s;
}

struct orl_surface_sample orl_bsdf_surface_sample(const struct orl_bsdf_query *query,
                                                  const double u[3])
{
    const struct orl_frame frame = orl_bsdf_frame(query->material, query->hit->normal);
    const struct local l = local_of(query, &frame);
    struct orl_bsdf_sample_result next;
    if (!(l.sum > 0) || !sample_local(&l, u, &next))
        return (struct orl_surface_sample){.event = ORL_EVENT_ABSORBED};
    return sample_of(query, &frame, &l, &next);
}

bool orl_bsdf_surface_is_data_only(const struct orl_material *m)
{
    if (m->kind != ORL_MATERIAL_BSDF)
        return false;
    const struct orl_bsdf_surface *const s = orl_bsdf_surface_of(m);
    return !s->peak && !(orl_rgb_max(s->diffuse.front) > 0) &&
           !(orl_rgb_max(s->diffuse.back) > 0) && !(orl_rgb_max(s->diffuse.through) > 0);
}

void orl_bsdf_surface_sample_many(const struct orl_bsdf_query *queries, const double (*u)[3],
                                  const size_t *which, size_t n, struct orl_surface_sample *ret)
{
    struct orl_frame frames[ORL_BSDF_SAMPLES_MAX];
    struct local locals[ORL_BSDF_SAMPLES_MAX];
    struct orl_bsdf_sample_request asks[ORL_BSDF_SAMPLES_MAX];
    struct orl_bsdf_sample_result next[ORL_BSDF_SAMPLES_MAX];
    bool found[ORL_BSDF_SAMPLES_MAX];
    if (n == 0)
        return;
    for (size_t i = 0; i < n; i++) {
        const struct orl_bsdf_query *query = &queries[which[i]];
        const double *numbers = u[which[i]];
        frames[i] = orl_bsdf_frame(query->material, query->hit->normal);
        locals[i] = local_of(query, &frames[i]);
        asks[i] = (struct orl_bsdf_sample_request){locals[i].surface->bsdf,
                                                   locals[i].from,
                                                   locals[i].adjoint,
                                                   locals[i].sides,
                                                   {numbers[0], numbers[1], numbers[2]}};
    }
    orl_bsdf_sample_many(asks, n, next, found);
    for (size_t i = 0; i < n; i++) {
        struct orl_surface_sample *s = &ret[which[i]];
        *s = (struct orl_surface_sample){.event = ORL_EVENT_ABSORBED};
        if (!found[i])
            continue;
        scale_weight(&locals[i], &next[i]);
        *s = sample_of(&queries[which[i]], &frames[i], &locals[i], &next[i]);
    }
}

struct orl_sun_bsdf_table {
    const struct orl_material *material;
    struct orl_vec3 towards;
    struct orl_frame frame;
    struct orl_cone_table *cone_table;
};

int orl_sun_bsdf_table_new(const struct orl_material *material, struct orl_vec3 normal,
                           struct orl_vec3 towards, double half_angle_rad,
                           struct orl_sun_bsdf_table **ret_table)
{
    *ret_table = NULL;
    if (!orl_bsdf_surface_is_data_only(material))
        return 0;
    struct orl_sun_bsdf_table *sun_bsdf_table = calloc(1, sizeof *sun_bsdf_table);
    if (!sun_bsdf_table)
        return ORL_ERR_NOMEM;
    sun_bsdf_table->material = material;
    sun_bsdf_table->towards = towards;
    sun_bsdf_table->frame = orl_bsdf_frame(material, normal);
    const int code = orl_cone_table_new(orl_bsdf_surface_of(material)->bsdf,
                                        orl_to_local(&sun_bsdf_table->frame, towards),
                                        half_angle_rad, &sun_bsdf_table->cone_table);
    if (code < 0 || !sun_bsdf_table->cone_table) {
        free(sun_bsdf_table);
        return code;
    }
    *ret_table = sun_bsdf_table;
    return 0;
}

static bool is_same(struct orl_vec3 a, struct orl_vec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

bool orl_sun_bsdf_table_matches(const struct orl_sun_bsdf_table *sun_bsdf_table,
                                const struct orl_material *material, struct orl_vec3 normal,
                                struct orl_vec3 towards)
{
    return sun_bsdf_table->material == material && is_same(sun_bsdf_table->frame.n, normal) &&
           is_same(sun_bsdf_table->towards, towards);
}

void orl_sun_bsdf_table_free(struct orl_sun_bsdf_table *sun_bsdf_table)
{
    if (!sun_bsdf_table)
        return;
    orl_cone_table_free(sun_bsdf_table->cone_table);
    free(sun_bsdf_table);
}

struct orl_surface_sample orl_sun_bsdf_table_sample(const struct orl_sun_bsdf_table *sun_bsdf_table,
                                                    struct orl_vec3 from, const double u[3])
{
    struct orl_surface_sample s = {.event = ORL_EVENT_ABSORBED, .transmitted = true};
    struct orl_vec3 out;
    if (!orl_cone_table_sample(sun_bsdf_table->cone_table,
                               orl_to_local(&sun_bsdf_table->frame, from), u, &out, &s.weight))
        return s;
    s.event = ORL_EVENT_GLOSSY;
    s.direction = orl_to_world(&sun_bsdf_table->frame, out);
    return s;
}
