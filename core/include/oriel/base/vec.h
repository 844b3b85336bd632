/*
 * Vectors, colours, and physical constants with their sources. Quantities carry their unit as a
 * suffix elsewhere: _m, _rad, _sr, _w, _lm, _lx.
 */
#ifndef ORIEL_BASE_VEC_H
#define ORIEL_BASE_VEC_H

#include <math.h>

#define ORL_PI 3.14159265358979323846

/* Luminous efficacy of equal-energy white, lm/W: Radiance's WHTEFFICACY. */
#define ORL_EFFICACY_LM_PER_W 179.0

/* Radiance's default RGB primaries: the luminance of each, summing to 1. */
#define ORL_LUMA_R 0.265074126
#define ORL_LUMA_G 0.670114631
#define ORL_LUMA_B 0.064811243

/* Mean angular diameter of the solar disc, degrees, as gendaylit writes it; gensky writes 0.5. */
#define ORL_SUN_DIAMETER_DEG 0.533

#define ORL_DEG_TO_RAD (ORL_PI / 180.0)

/* Horizontal illuminance outdoors under the CIE overcast sky; reference of daylight factors. */
#define ORL_OVERCAST_LX 10000.0

/*
 * Vectors and colours. World axes: +X east, +Y north, +Z up, metres (scene files may use any unit).
 * Colours are Radiance RGB: W/sr/m2 for radiance, W/m2 for irradiance, W for flux, per channel.
 */

struct orl_vec3 {
    double x, y, z;
};

struct orl_rgb {
    double r, g, b;
};

/* A right-handed orthonormal frame: local (x, y, z) is x*u + y*v + z*n. */
struct orl_frame {
    struct orl_vec3 u, v, n;
};

static inline struct orl_vec3 orl_v3(double x, double y, double z)
{
    return (struct orl_vec3){x, y, z};
}
static inline struct orl_vec3 orl_add(struct orl_vec3 a, struct orl_vec3 b)
{
    return orl_v3(a.x + b.x, a.y + b.y, a.z + b.z);
}
static inline struct orl_vec3 orl_sub(struct orl_vec3 a, struct orl_vec3 b)
{
    return orl_v3(a.x - b.x, a.y - b.y, a.z - b.z);
}
static inline struct orl_vec3 orl_scale(struct orl_vec3 a, double s)
{
    return orl_v3(a.x * s, a.y * s, a.z * s);
}
static inline int orl_equal(struct orl_vec3 a, struct orl_vec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}
/* Returns a + s b. */
static inline struct orl_vec3 orl_madd(struct orl_vec3 a, struct orl_vec3 b, double s)
{
    return orl_v3(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z);
}
static inline struct orl_vec3 orl_neg(struct orl_vec3 a)
{
    return orl_v3(-a.x, -a.y, -a.z);
}
static inline double orl_dot(struct orl_vec3 a, struct orl_vec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline struct orl_vec3 orl_cross(struct orl_vec3 a, struct orl_vec3 b)
{
    return orl_v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline double orl_length(struct orl_vec3 a)
{
    return sqrt(orl_dot(a, a));
}
/* Returns the component along axis 0, 1 or 2. */
static inline double orl_component(struct orl_vec3 a, int axis)
{
    return axis == 0 ? a.x : axis == 1 ? a.y : a.z;
}
/* Returns the largest magnitude of a component. */
static inline double orl_largest(struct orl_vec3 a)
{
    return fmax(fabs(a.x), fmax(fabs(a.y), fabs(a.z)));
}
/* Extends the box from low to high so that it holds a point. */
static inline void orl_box_include(struct orl_vec3 point, struct orl_vec3 *low,
                                   struct orl_vec3 *high)
{
    *low = orl_v3(fmin(low->x, point.x), fmin(low->y, point.y), fmin(low->z, point.z));
    *high = orl_v3(fmax(high->x, point.x), fmax(high->y, point.y), fmax(high->z, point.z));
}
/* Returns the unit vector along a; the zero vector stays zero. */
static inline struct orl_vec3 orl_normalize(struct orl_vec3 a)
{
    const double length = orl_length(a);
    return length > 0 ? orl_scale(a, 1.0 / length) : a;
}

/* Returns a frame about the unit vector n, with a branch only on n's sign (Duff et al. 2017). */
static inline struct orl_frame orl_frame_about(struct orl_vec3 n)
{
    const double sign = copysign(1.0, n.z), a = -1.0 / (sign + n.z), b = n.x * n.y * a;
    return (struct orl_frame){
        {1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}
static inline struct orl_vec3 orl_to_local(const struct orl_frame *f, struct orl_vec3 w)
{
    return orl_v3(orl_dot(w, f->u), orl_dot(w, f->v), orl_dot(w, f->n));
}
static inline struct orl_vec3 orl_to_world(const struct orl_frame *f, struct orl_vec3 l)
{
    return orl_add(orl_add(orl_scale(f->u, l.x), orl_scale(f->v, l.y)), orl_scale(f->n, l.z));
}

/* Returns the solid angle of the triangle that three unit vectors span (van Oosterom and Strackee
 * 1983). */
static inline double orl_triangle_sr(struct orl_vec3 a, struct orl_vec3 b, struct orl_vec3 c)
{
    const double volume = fabs(orl_dot(a, orl_cross(b, c)));
    return 2 * atan2(volume, 1 + orl_dot(a, b) + orl_dot(b, c) + orl_dot(c, a));
}

static inline struct orl_rgb orl_gray(double value)
{
    return (struct orl_rgb){value, value, value};
}
static inline struct orl_rgb orl_rgb_add(struct orl_rgb a, struct orl_rgb b)
{
    return (struct orl_rgb){a.r + b.r, a.g + b.g, a.b + b.b};
}
static inline struct orl_rgb orl_rgb_mul(struct orl_rgb a, struct orl_rgb b)
{
    return (struct orl_rgb){a.r * b.r, a.g * b.g, a.b * b.b};
}
static inline struct orl_rgb orl_rgb_scale(struct orl_rgb a, double s)
{
    return (struct orl_rgb){a.r * s, a.g * s, a.b * s};
}
/* Returns the luminance-weighted mean; times ORL_EFFICACY_LM_PER_W it is photometric. */
static inline double orl_luma(struct orl_rgb a)
{
    return ORL_LUMA_R * a.r + ORL_LUMA_G * a.g + ORL_LUMA_B * a.b;
}
/* Same as fmax, inlined: if one argument is NaN, returns the other. */
static inline double orl_larger(double a, double b)
{
    const double larger = a > b ? a : b;
    return b == b ? larger : a;
}
/* Same as fmin, inlined: if one argument is NaN, returns the other. */
static inline double orl_smaller(double a, double b)
{
    const double smaller = a < b ? a : b;
    return b == b ? smaller : a;
}
static inline double orl_rgb_max(struct orl_rgb a)
{
    return orl_larger(a.r, orl_larger(a.g, a.b));
}
static inline int orl_rgb_is_finite(struct orl_rgb a)
{
    return isfinite(a.r) && isfinite(a.g) && isfinite(a.b);
}

#endif
