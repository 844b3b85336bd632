#include "scene/material/kinds.h"

#include "base/multiversion.h"
#include "scene/material/scatter.h"

/*
 * Division of the light, as in Radiance: a share `specular` is mirrored, white for plastic and
 * trans. The rest takes the material's colour; trans transmits `transmitted` of it, and of that
 * `transmitted_specular` is not diffuse.
 */
enum part { DIFFUSE, SPECULAR, SPREAD, STRAIGHT, PARTS };

static bool is_rough(const struct orl_material *material)
{
    return orl_reflector_of(material)->roughness[0] > 0;
}

struct orl_rgb orl_reflector_diffuse(const struct orl_material *material, const struct orl_hit *hit)
{
    const struct orl_reflector *const reflector = orl_reflector_of(material);
    const double share = 1.0 - reflector->shares.specular;
    if (reflector->diffuse_side != ORL_DIFFUSE_SIDE_BOTH &&
        hit->front != (reflector->diffuse_side == ORL_DIFFUSE_SIDE_FRONT))
        return orl_gray(0);
    if (material->kind != ORL_MATERIAL_TRANS)
        return orl_rgb_scale(orl_color_at(material, hit), share);
    return orl_rgb_scale(orl_color_at(material, hit), share * (1 - reflector->shares.transmitted));
}

struct orl_rgb orl_reflector_specular(const struct orl_material *material,
                                      const struct orl_hit *hit)
{
    const double specular = orl_reflector_of(material)->shares.specular;
    if (material->kind == ORL_MATERIAL_METAL)
        return orl_rgb_scale(orl_color_at(material, hit), specular);
    return orl_gray(specular);
}

struct orl_rgb orl_trans_diffuse(const struct orl_material *material, const struct orl_hit *hit)
{
    if (material->kind != ORL_MATERIAL_TRANS)
        return orl_gray(0);
    const struct orl_reflector_shares *const shares = &orl_reflector_of(material)->shares;
    return orl_rgb_scale(orl_color_at(material, hit), (1 - shares->specular) * shares->transmitted *
                                                          (1 - shares->transmitted_specular));
}

struct orl_rgb orl_trans_straight(const struct orl_material *material, const struct orl_hit *hit)
{
    if (material->kind != ORL_MATERIAL_TRANS)
        return orl_gray(0);
    const struct orl_reflector_shares *const shares = &orl_reflector_of(material)->shares;
    return orl_rgb_scale(orl_color_at(material, hit), (1 - shares->specular) * shares->transmitted *
                                                          shares->transmitted_specular);
}

/* Returns the weights of the allowed lobes, and their luminances, by which one is chosen. */
static void parts_of(const struct orl_material *m, const struct orl_hit *hit, enum orl_lobes lobes,
                     struct orl_rgb ret_part[PARTS], double ret_luma[PARTS])
{
    ret_part[DIFFUSE] = lobes & ORL_LOBE_DIFFUSE ? orl_reflector_diffuse(m, hit) : orl_gray(0);
    ret_part[SPECULAR] = lobes & ORL_LOBE_REFLECTED ? orl_reflector_specular(m, hit) : orl_gray(0);
    ret_luma[DIFFUSE] = orl_luma(ret_part[DIFFUSE]);
    ret_luma[SPECULAR] = orl_luma(ret_part[SPECULAR]);
    ret_part[SPREAD] = ret_part[STRAIGHT] = orl_gray(0);
    ret_luma[SPREAD] = ret_luma[STRAIGHT] = 0;
    if (m->kind != ORL_MATERIAL_TRANS || !(lobes & ORL_LOBE_TRANSMITTED))
        return;
    ret_part[SPREAD] = orl_trans_diffuse(m, hit);
    ret_part[STRAIGHT] = orl_trans_straight(m, hit);
    ret_luma[SPREAD] = orl_luma(ret_part[SPREAD]);
    ret_luma[STRAIGHT] = orl_luma(ret_part[STRAIGHT]);
}

/* Chooses in sequence: this lobe, or one of those that follow. */
static enum part choose_part(const double luma[PARTS], double u, double *ret_chance)
{
    double after[PARTS];
    after[PARTS - 1] = 0;
    for (int i = PARTS - 1; i > 0; i--)
        after[i - 1] = luma[i] + after[i];
    *ret_chance = 1;
    for (int i = 0; i < PARTS - 1; i++) {
        if (!(after[i] > 0))
            return (enum part)i;
        if (!(luma[i] > 0))
            continue;
        const double p = luma[i] / (luma[i] + after[i]);
        if (u < p) {
            *ret_chance *= p;
            return (enum part)i;
        }
        *ret_chance *= 1 - p;
        u = (u - p) / (1 - p);
    }
    return STRAIGHT;
}

static struct orl_vec3 facing(const struct orl_hit *hit, struct orl_vec3 from)
{
    return orl_dot(from, hit->normal) >= 0 ? hit->normal : orl_neg(hit->normal);
}

/* Sets event and direction; returns f cos / pdf of the lobe alone, 0 if the light is lost. */
static double sample_part(struct orl_surface_sample *s, enum part part,
                          const struct orl_bsdf_query *query, const double u[2])
{
    const struct orl_material *m = query->material;
    const struct orl_vec3 from = query->from, normal = facing(query->hit, from);
    double weight = 1;
    s->transmitted = part == SPREAD || part == STRAIGHT;
    if (part == DIFFUSE || part == SPREAD) {
        s->event = part == DIFFUSE ? ORL_EVENT_DIFFUSE : ORL_EVENT_GLOSSY;
        s->direction = orl_hemisphere_about(part == DIFFUSE ? normal : orl_neg(normal), u[0], u[1]);
        return 1;
    }
    if (!is_rough(m)) {
        s->event = part == SPECULAR ? ORL_EVENT_MIRROR : ORL_EVENT_STRAIGHT;
        s->direction = part == SPECULAR ? orl_mirrored_at(m, query->hit, from) : orl_neg(from);
        return 1;
    }
    const struct orl_ward ward =
        orl_ward_at(m, query->hit, part == SPECULAR ? orl_normal_at(m, query->hit, from) : normal);
    if (part == SPECULAR ? orl_ward_sample_reflected(&ward, from, u, &s->direction, &weight) &&
                               orl_dot(s->direction, normal) > 0
                         : orl_ward_sample_transmitted(&ward, from, u, &s->direction, &weight))
        s->event = ORL_EVENT_GLOSSY;
    return weight;
}

bool orl_reflector_is_matt(const struct orl_bsdf_query *query)
{
    return orl_material_is_matt(query->material) && query->lobes & ORL_LOBE_DIFFUSE &&
           orl_reflector_of(query->material)->diffuse_side == ORL_DIFFUSE_SIDE_BOTH &&
           orl_luma(orl_color_at(query->material, query->hit)) > 0;
}

/* Directions about normals, in columns for vector instructions. */
struct turns {
    double normals[3][ORL_MATT_SAMPLES_MAX], points[2][ORL_MATT_SAMPLES_MAX];
    double directions[3][ORL_MATT_SAMPLES_MAX];
};

ORL_FOR_WIDE_VECTORS
static void turn_about(struct turns *t)
{
    for (int i = 0; i < ORL_MATT_SAMPLES_MAX; i++) {
        const struct orl_vec3 normal = orl_v3(t->normals[0][i], t->normals[1][i], t->normals[2][i]);
        const struct orl_vec3 d = orl_hemisphere_about(normal, t->points[0][i], t->points[1][i]);
        t->directions[0][i] = d.x;
        t->directions[1][i] = d.y;
        t->directions[2][i] = d.z;
    }
}

void orl_reflector_sample_matt_many(const struct orl_bsdf_query *queries, const double (*u)[3],
                                    const size_t *which, size_t n, struct orl_surface_sample *ret)
{
    struct turns t = {.normals = {{0}}};
    if (n == 0)
        return;
    for (size_t i = 0; i < n; i++) {
        const struct orl_bsdf_query *query = &queries[which[i]];
        const struct orl_vec3 normal = facing(query->hit, query->from);
        t.normals[0][i] = normal.x;
        t.normals[1][i] = normal.y;
        t.normals[2][i] = normal.z;
        t.points[0][i] = u[which[i]][0];
        t.points[1][i] = u[which[i]][1];
    }
    turn_about(&t);
    for (size_t i = 0; i < n; i++) {
        const struct orl_bsdf_query *query = &queries[which[i]];
        ret[which[i]] = (struct orl_surface_sample){
            .event = ORL_EVENT_DIFFUSE,
            .direction = orl_v3(t.directions[0][i], t.directions[1][i], t.directions[2][i]),
            .weight = orl_reflector_diffuse(query->material, query->hit)};
    }
}

struct orl_surface_sample orl_reflector_sample(const struct orl_bsdf_query *query,
                                               const double u[3])
{
    struct orl_surface_sample s = {.event = ORL_EVENT_ABSORBED};
    struct orl_rgb parts[PARTS];
    double luma[PARTS], chance;
    /* Fast path for most surfaces of a room, which are only diffuse. */
    if (orl_reflector_is_matt(query)) {
        s.event = ORL_EVENT_DIFFUSE;
        s.direction = orl_hemisphere_about(facing(query->hit, query->from), u[0], u[1]);
        s.weight = orl_reflector_diffuse(query->material, query->hit);
        return s;
    }
    parts_of(query->material, query->hit, query->lobes, parts, luma);
    if (!(luma[DIFFUSE] + luma[SPECULAR] + luma[SPREAD] + luma[STRAIGHT] > 0))
        return s;
    const enum part part = choose_part(luma, u[2], &chance);
    const double weight = sample_part(&s, part, query, u);
    s.weight = orl_rgb_scale(parts[part], weight / chance);
    return s;
}

double orl_reflector_pdf(const struct orl_bsdf_query *query, struct orl_vec3 towards)
{
    const struct orl_vec3 normal = facing(query->hit, query->from);
    const double cosine = orl_dot(towards, normal);
    const bool rough = is_rough(query->material);
    struct orl_rgb parts[PARTS];
    double luma[PARTS], sum = 0;
    parts_of(query->material, query->hit, query->lobes, parts, luma);
    const double total = luma[DIFFUSE] + luma[SPECULAR] + luma[SPREAD] + luma[STRAIGHT];
    if (!(total > 0))
        return 0;
    sum += luma[cosine > 0 ? DIFFUSE : SPREAD] * fabs(cosine) / ORL_PI;
    if (rough && cosine > 0 && luma[SPECULAR] > 0) {
        const struct orl_ward ward = orl_ward_at(
            query->material, query->hit, orl_normal_at(query->material, query->hit, query->from));
        sum += luma[SPECULAR] * orl_ward_pdf_reflected(&ward, query->from, towards);
    }
    if (rough && cosine < 0 && luma[STRAIGHT] > 0) {
        const struct orl_ward ward = orl_ward_at(query->material, query->hit, normal);
        sum += luma[STRAIGHT] * orl_ward_pdf_transmitted(&ward, query->from, towards);
    }
    return sum / total;
}

/* Returns true if a colour of a material is not zero, for any values of its pattern. */
static bool is_part(struct orl_rgb (*part)(const struct orl_material *material,
                                           const struct orl_hit *hit),
                    const struct orl_material *material)
{
    const struct orl_hit hit = orl_hit_surface_mean(orl_v3(0, 0, 1), true);
    return orl_rgb_max(part(material, &hit)) > 0;
}

bool orl_trans_transmits(const struct orl_material *material)
{
    return is_part(orl_trans_diffuse, material) || is_part(orl_trans_straight, material);
}

bool orl_reflector_transmits_lobes(const struct orl_material *material)
{
    return material->kind == ORL_MATERIAL_TRANS &&
           (is_part(orl_trans_diffuse, material) ||
            (is_rough(material) && is_part(orl_trans_straight, material)));
}

bool orl_reflector_has_lobes(const struct orl_material *material)
{
    return (is_rough(material) && is_part(orl_reflector_specular, material)) ||
           orl_reflector_transmits_lobes(material);
}

/* The lobe about a perturbed normal, weighted by the cosine to that normal. */
static struct orl_rgb textured_gloss(const struct orl_material *material, const struct orl_hit *hit,
                                     struct orl_vec3 light, struct orl_vec3 eye, double cos_light)
{
    const struct orl_vec3 normal = orl_normal_at(material, hit, eye);
    const double turned = orl_dot(light, normal);
    if (!(turned > 0) || !(orl_dot(eye, normal) > 0))
        return orl_gray(0);
    const struct orl_ward ward = orl_ward_at(material, hit, normal);
    return orl_rgb_scale(orl_reflector_specular(material, hit),
                         orl_ward_reflected(&ward, light, eye) * turned / cos_light);
}

struct orl_rgb orl_reflector_lobes(const struct orl_material *material, const struct orl_hit *hit,
                                   struct orl_vec3 light, struct orl_vec3 eye)
{
    const double cos_light = orl_dot(light, hit->normal), cos_eye = orl_dot(eye, hit->normal);
    struct orl_rgb sum = orl_gray(0);
    if (cos_light * cos_eye > 0) {
        if (!is_rough(material))
            return sum;
        if (material->texture)
            return textured_gloss(material, hit, light, eye, fabs(cos_light));
        const struct orl_ward ward = orl_ward_at(material, hit, hit->normal);
        return orl_rgb_scale(orl_reflector_specular(material, hit),
                             orl_ward_reflected(&ward, light, eye));
    }
    if (!(cos_light * cos_eye < 0) || material->kind != ORL_MATERIAL_TRANS)
        return sum;
    sum = orl_rgb_scale(orl_trans_diffuse(material, hit), 1 / ORL_PI);
    if (is_rough(material)) {
        const struct orl_ward ward = orl_ward_at(material, hit, hit->normal);
        sum = orl_rgb_add(sum, orl_rgb_scale(orl_trans_straight(material, hit),
                                             orl_ward_transmitted(&ward, light, eye)));
    }
    return sum;
}
