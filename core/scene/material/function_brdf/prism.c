/*
 * Prisms (prism1, prism2): a ray continues in one or two directions, each with a share, by
 * functions of its direction; nothing else is scattered. For eye rays the functions are used as in
 * Radiance: the share of the radiance from the new direction comes back along the ray.
 *
 * Light takes the same paths backwards. The functions, evaluated for a ray that travels as the
 * light does, give the directions; the share is that of an eye ray that travels back along them. So
 * the functions must be their own inverse, as those of a real prism are. This is tested over all
 * surfaces before rendering (orl_function_brdf_check), and refused where it fails.
 *
 * Flux is radiance times projected solid angle, which a prism may stretch. Light's shares are
 * multiplied by that ratio, found by finite differences of the directions.
 */
#include "scene/material/function_brdf/function_brdf_check.h"

#include "scene/material/kinds.h"
#include "scene/material/scatter.h"

/* Cosine above which two directions are a path and its inverse: allows for rounding in the
 * functions. */
static const double same_way = 1 - 1e-7;
static const double step = 1e-4; /* step of finite differences, radians */

/* An outgoing direction and its share. */
struct prism_ray {
    double share;
    struct orl_vec3 towards;
    bool transmitted;
};

static bool is_through(const struct orl_hit *hit, struct orl_vec3 ray, struct orl_vec3 towards)
{
    return orl_dot(ray, hit->normal) * orl_dot(towards, hit->normal) > 0;
}

/* Share of an eye ray that travels back along `towards`, for light that travels along ray. */
static double seen_share(const struct orl_material *m, const struct orl_hit *hit,
                         struct orl_vec3 ray, struct orl_vec3 towards)
{
    struct orl_prism_ray back[ORL_PRISM_RAYS];
    const int n = orl_function_brdf_prism_rays(orl_prism_of(m)->rays, hit, orl_neg(towards), back);
    double share = 0;
    for (int i = 0; i < n; i++)
        if (back[i].share > 0 && orl_dot(back[i].towards, orl_neg(ray)) > same_way)
            share += back[i].share;
    return share;
}

/* ---- Eye rays -------------------------------------------------------------------------------- */

/* Outgoing rays of an eye ray travelling along ray that light takes too; returns their number. */
static int rays_of_eye(const struct orl_material *m, const struct orl_hit *hit, struct orl_vec3 ray,
                       struct prism_ray ret_ways[ORL_PRISM_RAYS])
{
    struct orl_prism_ray prism_rays[ORL_PRISM_RAYS];
    const int all = orl_function_brdf_prism_rays(orl_prism_of(m)->rays, hit, ray, prism_rays);
    int n = 0;
    for (int i = 0; i < all; i++)
        if (prism_rays[i].share > 0 && seen_share(m, hit, ray, prism_rays[i].towards) > 0)
            ret_ways[n++] = (struct prism_ray){prism_rays[i].share, prism_rays[i].towards,
                                               is_through(hit, ray, prism_rays[i].towards)};
    return n;
}

/* ---- Light ------------------------------------------------------------------------------------
 */

/* Returns the direction from the function of that index; false if it has none. */
static bool flux_share(const struct orl_material *m, const struct orl_hit *hit, struct orl_vec3 ray,
                       int number, struct orl_vec3 *ret_towards)
{
    struct orl_prism_ray prism_rays[ORL_PRISM_RAYS];
    const int n = orl_function_brdf_prism_rays(orl_prism_of(m)->rays, hit, ray, prism_rays);
    for (int i = 0; i < n; i++)
        if (prism_rays[i].number == number && prism_rays[i].share > 0) {
            *ret_towards = prism_rays[i].towards;
            return true;
        }
    return false;
}

/* Ratio of the solid angle of the image to that of a small cone about ray; 0 at the edge of the
 * domain. */
static double stretch(const struct orl_material *m, const struct orl_hit *hit, struct orl_vec3 ray,
                      int number)
{
    const struct orl_frame frame = orl_frame_about(ray);
    struct orl_vec3 slopes[2];
    for (int axis = 0; axis < 2; axis++) {
        const struct orl_vec3 across = axis ? frame.v : frame.u;
        struct orl_vec3 ends[2];
        for (int k = 0; k < 2; k++) {
            const struct orl_vec3 near = orl_normalize(orl_madd(ray, across, k ? step : -step));
            if (!flux_share(m, hit, near, number, &ends[k]))
                return 0;
        }
        slopes[axis] = orl_scale(orl_sub(ends[1], ends[0]), 0.5 / step);
    }
    return orl_length(orl_cross(slopes[0], slopes[1]));
}

/* Outgoing rays of light that travels along ray, with shares of flux; returns their number. */
static int rays_of_light(const struct orl_material *m, const struct orl_hit *hit,
                         struct orl_vec3 ray, struct prism_ray ret_ways[ORL_PRISM_RAYS])
{
    struct orl_prism_ray prism_rays[ORL_PRISM_RAYS];
    const int all = orl_function_brdf_prism_rays(orl_prism_of(m)->rays, hit, ray, prism_rays);
    const double arriving = fabs(orl_dot(ray, hit->normal));
    int n = 0;
    for (int i = 0; i < all && arriving > 0; i++) {
        if (!(prism_rays[i].share > 0))
            continue;
        const double seen = seen_share(m, hit, ray, prism_rays[i].towards);
        const double leaving = fabs(orl_dot(prism_rays[i].towards, hit->normal));
        const double share =
            seen > 0 ? seen * stretch(m, hit, ray, prism_rays[i].number) * leaving / arriving : 0;
        if (share > 0 && isfinite(share))
            ret_ways[n++] = (struct prism_ray){share, prism_rays[i].towards,
                                               is_through(hit, ray, prism_rays[i].towards)};
    }
    return n;
}

/* ---- Sampling -------------------------------------------------------------------------------- */

static int rays_at(const struct orl_material *m, const struct orl_hit *hit, struct orl_vec3 from,
                   enum orl_transport transport, enum orl_lobes lobes,
                   struct prism_ray ret_ways[ORL_PRISM_RAYS])
{
    const struct orl_vec3 ray = orl_neg(from);
    const int all = transport == ORL_TRANSPORT_EYE ? rays_of_eye(m, hit, ray, ret_ways)
                                                   : rays_of_light(m, hit, ray, ret_ways);
    int n = 0;
    for (int i = 0; i < all; i++)
        if (lobes & (ret_ways[i].transmitted ? ORL_LOBE_TRANSMITTED : ORL_LOBE_REFLECTED))
            ret_ways[n++] = ret_ways[i];
    return n;
}

static struct orl_surface_sample sample_of(const struct prism_ray *prism_ray, double weight)
{
    return (struct orl_surface_sample){.event = ORL_EVENT_REFRACTED,
                                       .transmitted = prism_ray->transmitted,
                                       .direction = prism_ray->towards,
                                       .weight = orl_gray(weight),
                                       .medium_transmissivity = orl_gray(1)};
}

int orl_prism_deviated_rays(const struct orl_material *material, const struct orl_hit *hit,
                            struct orl_vec3 from, enum orl_transport transport,
                            struct orl_surface_sample ret_samples[ORL_PRISM_RAYS])
{
    struct prism_ray prism_rays[ORL_PRISM_RAYS];
    const int n = rays_at(material, hit, from, transport, ORL_LOBE_ALL, prism_rays);
    for (int i = 0; i < n; i++)
        ret_samples[i] = sample_of(&prism_rays[i], prism_rays[i].share);
    return n;
}

struct orl_rgb orl_prism_albedo(const struct orl_material *material, const struct orl_hit *hit,
                                struct orl_vec3 light, enum orl_lobes lobes)
{
    struct prism_ray prism_rays[ORL_PRISM_RAYS];
    double sum = 0;
    /* For a surface as a whole nothing better is known. */
    if (orl_hit_is_surface_mean(hit))
        return orl_gray(lobes & ORL_LOBE_TRANSMITTED ? 1 : 0);
    const int n = rays_at(material, hit, light, ORL_TRANSPORT_LIGHT, lobes, prism_rays);
    for (int i = 0; i < n; i++)
        sum += prism_rays[i].share;
    return orl_gray(sum);
}

struct orl_surface_sample orl_prism_sample(const struct orl_bsdf_query *query, const double u[3])
{
    struct prism_ray prism_rays[ORL_PRISM_RAYS];
    double sum = 0, passed = 0;
    const int n = rays_at(query->material, query->hit, query->from, query->transport, query->lobes,
                          prism_rays);
    for (int i = 0; i < n; i++)
        sum += prism_rays[i].share;
    if (!(sum > 0))
        return (struct orl_surface_sample){.event = ORL_EVENT_ABSORBED};
    for (int i = 0; i + 1 < n; i++) {
        passed += prism_rays[i].share;
        if (u[2] * sum < passed)
            return sample_of(&prism_rays[i], sum);
    }
    return sample_of(&prism_rays[n - 1], sum);
}

/* ---- Tests before rendering ------------------------------------------------------------------ */

void orl_prism_measure(const struct orl_material *material, const struct orl_hit *hit,
                       struct orl_prism_statistics *statistics)
{
    enum { DIRECTIONS = 512 };
    for (int i = 0; i < DIRECTIONS; i++) {
        const double u = fmod(0.5 + 0.7548776662466927 * i, 1);
        const double v = fmod(0.5 + 0.5698402909980532 * i, 1);
        const struct orl_vec3 side = i & 1 ? hit->normal : orl_neg(hit->normal);
        const struct orl_vec3 ray = orl_hemisphere_about(side, u, v);
        struct orl_prism_ray prism_rays[ORL_PRISM_RAYS];
        const int n =
            orl_function_brdf_prism_rays(orl_prism_of(material)->rays, hit, ray, prism_rays);
        double eye = 0, light = 0;
        struct prism_ray flux[ORL_PRISM_RAYS];
        for (int k = 0; k < n; k++) {
            if (!(prism_rays[k].share > 0))
                continue;
            eye += prism_rays[k].share;
            statistics->all += prism_rays[k].share;
            if (!(seen_share(material, hit, ray, prism_rays[k].towards) > 0))
                statistics->irreversible += prism_rays[k].share;
        }
        const int n_flux = rays_of_light(material, hit, ray, flux);
        for (int k = 0; k < n_flux; k++)
            light += flux[k].share;
        statistics->max_seen = fmax(statistics->max_seen, eye);
        statistics->max_sent = fmax(statistics->max_sent, light);
    }
}
