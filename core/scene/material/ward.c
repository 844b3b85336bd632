#include "scene/material/kinds.h"

#include "scene/material/patterns/pattern.h"

static double square(double x)
{
    return x * x;
}

static double rough_by(double factor, double roughness)
{
    return fmin(fmax(factor * roughness, ORL_WARD_MIN_ROUGHNESS), 1);
}

struct orl_ward orl_ward_at(const struct orl_material *material, const struct orl_hit *hit,
                            struct orl_vec3 normal)
{
    const struct orl_reflector *const reflector = orl_reflector_of(material);
    double along = reflector->roughness[0], across = reflector->roughness[1];
    if (reflector->roughness_pattern) {
        const struct orl_rgb factors = orl_pattern_at(reflector->roughness_pattern, hit);
        along = rough_by(factors.r, along);
        across = rough_by(factors.g, across);
    }
    struct orl_ward ward = {
        .normal = normal, .along = along, .across = across, .isotropic = along == across};
    if (ward.isotropic)
        return ward;
    const struct orl_vec3 axis = reflector->anisotropy_axis;
    const struct orl_vec3 flat = orl_madd(axis, normal, -orl_dot(axis, normal));
    if (!(orl_length(flat) > 1e-9 * orl_length(axis))) {
        ward.along = ward.across = sqrt(0.5 * (along * along + across * across));
        ward.isotropic = true;
        return ward;
    }
    ward.anisotropy_axis = orl_normalize(flat);
    return ward;
}

/* ---- Reflected ------------------------------------------------------------------------------- */

/* The unnormalised half vector, and the Gaussian of its slope: exp(-tan^2 / a^2). */
struct half {
    double h2, hn, gauss; /* length squared; component along the normal */
};

static struct half half_of(const struct orl_ward *ward, struct orl_vec3 a, struct orl_vec3 b)
{
    const struct orl_vec3 h = orl_add(a, b);
    const double h2 = orl_dot(h, h), hn = orl_dot(h, ward->normal), hn2 = hn * hn;
    if (ward->isotropic)
        return (struct half){h2, hn,
                             exp(-(fmax(0, (h2 - hn2) / hn2)) / (ward->along * ward->along))};
    const double x = orl_dot(h, ward->anisotropy_axis);
    const double y = orl_dot(h, orl_cross(ward->normal, ward->anisotropy_axis));
    return (struct half){h2, hn, exp(-(square(x / ward->along) + square(y / ward->across)) / hn2)};
}

double orl_ward_reflected(const struct orl_ward *ward, struct orl_vec3 a, struct orl_vec3 b)
{
    const struct half h = half_of(ward, a, b);
    const double hn2 = h.hn * h.hn;
    return h.gauss * h.h2 / (ORL_PI * (ward->along * ward->across) * hn2 * hn2);
}

static struct orl_frame frame_of(const struct orl_ward *ward)
{
    if (ward->isotropic)
        return orl_frame_about(ward->normal);
    return (struct orl_frame){ward->anisotropy_axis, orl_cross(ward->normal, ward->anisotropy_axis),
                              ward->normal};
}

bool orl_ward_sample_reflected(const struct orl_ward *ward, struct orl_vec3 from, const double u[2],
                               struct orl_vec3 *ret_direction, double *ret_weight)
{
    const struct orl_frame frame = frame_of(ward);
    const double root = sqrt(-log(1 - u[0])), phi = 2 * ORL_PI * u[1];
    const double x = ward->along * root * cos(phi), y = ward->across * root * sin(phi);
    const struct orl_vec3 half = orl_normalize(orl_to_world(&frame, orl_v3(x, y, 1)));
    const struct orl_vec3 d = orl_sub(orl_scale(half, 2 * orl_dot(from, half)), from);
    const double cos_in = orl_dot(from, ward->normal), cos_out = orl_dot(d, ward->normal);
    if (cos_out <= 0 || orl_dot(from, half) <= 0)
        return false;
    *ret_direction = d;
    *ret_weight = 2 * cos_out / (cos_in + cos_out);
    return true;
}

double orl_ward_pdf_reflected(const struct orl_ward *ward, struct orl_vec3 from, struct orl_vec3 to)
{
    if (orl_dot(to, ward->normal) <= 0)
        return 0;
    const struct half h = half_of(ward, from, to);
    return h.gauss * h.h2 / (2 * ORL_PI * (ward->along * ward->across) * h.hn * h.hn * h.hn);
}

/* ---- Transmitted ----------------------------------------------------------------------------- */

/* A direction in the plane of the equal-area projection about the normal on its side. */
struct point {
    double x, y;
};

static struct point project(const struct orl_frame *frame, struct orl_vec3 d)
{
    const double stretch = sqrt(2 / (1 + fabs(orl_dot(d, frame->n))));
    return (struct point){stretch * orl_dot(d, frame->u), stretch * orl_dot(d, frame->v)};
}

/* Gaussian of the distance between a direction and the straight continuation of the other. */
static double gaussian(const struct orl_ward *ward, struct orl_vec3 a, struct orl_vec3 b)
{
    const struct orl_frame frame = frame_of(ward);
    const struct point p = project(&frame, orl_neg(a)), q = project(&frame, b);
    return exp(-square((p.x - q.x) / ward->along) - square((p.y - q.y) / ward->across)) /
           (ORL_PI * ward->along * ward->across);
}

double orl_ward_transmitted(const struct orl_ward *ward, struct orl_vec3 a, struct orl_vec3 b)
{
    const double cosines = fabs(orl_dot(a, ward->normal)) + fabs(orl_dot(b, ward->normal));
    return 2 * gaussian(ward, a, b) / cosines;
}

bool orl_ward_sample_transmitted(const struct orl_ward *ward, struct orl_vec3 from,
                                 const double u[2], struct orl_vec3 *ret_direction,
                                 double *ret_weight)
{
    const struct orl_frame frame = frame_of(ward);
    const struct point p = project(&frame, orl_neg(from));
    const double root = sqrt(-log(1 - u[0])), phi = 2 * ORL_PI * u[1];
    const double x = p.x + ward->along * root * cos(phi);
    const double y = p.y + ward->across * root * sin(phi), r2 = x * x + y * y;
    const double cos_in = orl_dot(from, ward->normal), cos_out = 1 - r2 / 2;
    if (!(cos_out > 0))
        return false;
    const double shrink = sqrt(1 - r2 / 4);
    *ret_direction = orl_to_world(&frame, orl_v3(x * shrink, y * shrink, -cos_out));
    *ret_weight = 2 * cos_out / (cos_in + cos_out);
    return true;
}

double orl_ward_pdf_transmitted(const struct orl_ward *ward, struct orl_vec3 from,
                                struct orl_vec3 to)
{
    return orl_dot(to, ward->normal) < 0 ? gaussian(ward, from, to) : 0;
}
