/*
 * Prisms (prism1, prism2): a ray continues in one or two directions, each with a share, by
 * functions of its direction; nothing else is scattered. For eye rays the functions are used as in
 * Radiance: the share of the radiance from the new direction comes back along the ray.
 *
 * Light takes the same ways backwards. The functions, evaluated for a ray that travels as the light
 * does, give the ways; the share is that of an eye ray which looks back along the way. So the
 * functions must be their own inverse, as those of a real prism are. This is tested over all
 * surfaces before rendering (orl_own_settle), and refused where it fails.
 *
 * Flux is radiance times projected solid angle, which a prism may stretch. Light's shares are
 * multiplied by that ratio, found by finite differences of the directions.
 */
#include "scene/material/prism.h"

#include "scene/material/hemisphere.h"
#include "scene/material/kinds.h"

/* Cosine above which two directions are a way and its inverse: allows for rounding in the
 * functions. */
static const double same_way = 1 - 1e-7;
static const double step = 1e-4; /* step of finite differences, radians */

/* An outgoing direction and its share. */
struct way {
    double share;
    struct orl_vec3 towards;
    bool transmitted;
};

static bool is_through(const struct orl_hit *hit, struct orl_vec3 ray, struct orl_vec3 towards)
{
    return orl_dot(ray, hit->normal) * orl_dot(towards, hit->normal) > 0;
}

/* Share of an eye ray that looks back along `towards`, for light that travels along ray. */
static double seen_share(const struct orl_material *m, const struct orl_hit *hit,
                         struct orl_vec3 ray, struct orl_vec3 towards)
{
    struct orl_own_way back[ORL_PRISM_WAYS];
    const int n = orl_own_ways(m->ways, hit, orl_neg(towards), back);
    double share = 0;
    for (int i = 0; i < n; i++)
        if (back[i].share > 0 && orl_dot(back[i].towards, orl_neg(ray)) > same_way)
            share += back[i].share;
    return share;
}

/* ---- Eye rays -------------------------------------------------------------------------------- */

/* Ways of an eye ray travelling along ray that light takes too; returns their number. */
static int ways_of_eye(const struct orl_material *m, const struct orl_hit *hit, struct orl_vec3 ray,
                       struct way ret_ways[ORL_PRISM_WAYS])
{
    struct orl_own_way ways[ORL_PRISM_WAYS];
    const int all = orl_own_ways(m->ways, hit, ray, ways);
    int n = 0;
    for (int i = 0; i < all; i++)
        if (ways[i].share > 0 && seen_share(m, hit, ray, ways[i].towards) > 0)
            ret_ways[n++] =
                (struct way){ways[i].share, ways[i].towards, is_through(hit, ray, ways[i].towards)};
    return n;
}

/* ---- Light ------------------------------------------------------------------------------------
 */

/* Returns the direction from the function of that index; false if it has none. */
static bool sent_by(const struct orl_material *m, const struct orl_hit *hit, struct orl_vec3 ray,
                    int number, struct orl_vec3 *ret_towards)
{
    struct orl_own_way ways[ORL_PRISM_WAYS];
    const int n = orl_own_ways(m->ways, hit, ray, ways);
    for (int i = 0; i < n; i++)
        if (ways[i].number == number && ways[i].share > 0) {
            *ret_towards = ways[i].towards;
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
            if (!sent_by(m, hit, near, number, &ends[k]))
                return 0;
        }
        slopes[axis] = orl_scale(orl_sub(ends[1], ends[0]), 0.5 / step);
    }
    return orl_length(orl_cross(slopes[0], slopes[1]));
}

/* Ways of light that travels along ray, with shares of flux; returns their number. */
static int ways_of_light(const struct orl_material *m, const struct orl_hit *hit,
                         struct orl_vec3 ray, struct way ret_ways[ORL_PRISM_WAYS])
{
    struct orl_own_way ways[ORL_PRISM_WAYS];
    const int all = orl_own_ways(m->ways, hit, ray, ways);
    const double arriving = fabs(orl_dot(ray, hit->normal));
    int n = 0;
    for (int i = 0; i < all && arriving > 0; i++) {
        if (!(ways[i].share > 0))
            continue;
        const double seen = seen_share(m, hit, ray, ways[i].towards);
        const double leaving = fabs(orl_dot(ways[i].towards, hit->normal));
        const double share =
            seen > 0 ? seen * stretch(m, hit, ray, ways[i].number) * leaving / arriving : 0;
        if (share > 0 && isfinite(share))
            ret_ways[n++] =
                (struct way){share, ways[i].towards, is_through(hit, ray, ways[i].towards)};
    }
    return n;
}

/* ---- Sampling -------------------------------------------------------------------------------- */

static int ways_at(const struct orl_material *m, const struct orl_hit *hit, struct orl_vec3 from,
                   enum orl_transport transport, enum orl_lobes lobes,
                   struct way ret_ways[ORL_PRISM_WAYS])
{
    const struct orl_vec3 ray = orl_neg(from);
    const int all = transport == ORL_TRANSPORT_EYE ? ways_of_eye(m, hit, ray, ret_ways)
                                                   : ways_of_light(m, hit, ray, ret_ways);
    int n = 0;
    for (int i = 0; i < all; i++)
        if (lobes & (ret_ways[i].transmitted ? ORL_LOBE_TRANSMITTED : ORL_LOBE_REFLECTED))
            ret_ways[n++] = ret_ways[i];
    return n;
}

static struct orl_scatter scatter_of(const struct way *way, double weight)
{
    return (struct orl_scatter){.event = ORL_EVENT_REFRACTED,
                                .transmitted = way->transmitted,
                                .direction = way->towards,
                                .weight = orl_gray(weight),
                                .clarity = orl_gray(1)};
}

int orl_prism_ways(const struct orl_material *material, const struct orl_hit *hit,
                   struct orl_vec3 from, enum orl_transport transport,
                   struct orl_scatter ret_scatters[ORL_PRISM_WAYS])
{
    struct way ways[ORL_PRISM_WAYS];
    const int n = ways_at(material, hit, from, transport, ORL_LOBE_ALL, ways);
    for (int i = 0; i < n; i++)
        ret_scatters[i] = scatter_of(&ways[i], ways[i].share);
    return n;
}

struct orl_rgb orl_prism_albedo(const struct orl_material *material, const struct orl_hit *hit,
                                struct orl_vec3 light, enum orl_lobes lobes)
{
    struct way ways[ORL_PRISM_WAYS];
    double sum = 0;
    /* For a surface as a whole nothing better is known. */
    if (orl_hit_is_anywhere(hit))
        return orl_gray(lobes & ORL_LOBE_TRANSMITTED ? 1 : 0);
    const int n = ways_at(material, hit, light, ORL_TRANSPORT_LIGHT, lobes, ways);
    for (int i = 0; i < n; i++)
        sum += ways[i].share;
    return orl_gray(sum);
}

struct orl_scatter orl_prism_sample(const struct orl_draw *draw, const double u[3])
{
    struct way ways[ORL_PRISM_WAYS];
    double sum = 0, passed = 0;
    const int n =
        ways_at(draw->material, draw->hit, draw->from, draw->transport, draw->lobes, ways);
    for (int i = 0; i < n; i++)
        sum += ways[i].share;
    if (!(sum > 0))
        return (struct orl_scatter){.event = ORL_EVENT_ABSORBED};
    for (int i = 0; i + 1 < n; i++) {
        passed += ways[i].share;
        if (u[2] * sum < passed)
            return scatter_of(&ways[i], sum);
    }
    return scatter_of(&ways[n - 1], sum);
}

/* ---- Tests before rendering ------------------------------------------------------------------ */

void orl_prism_look(const struct orl_material *material, const struct orl_hit *hit,
                    struct orl_prism_findings *findings)
{
    enum { DIRECTIONS = 512 };
    for (int i = 0; i < DIRECTIONS; i++) {
        const double u = fmod(0.5 + 0.7548776662466927 * i, 1);
        const double v = fmod(0.5 + 0.5698402909980532 * i, 1);
        const struct orl_vec3 side = i & 1 ? hit->normal : orl_neg(hit->normal);
        const struct orl_vec3 ray = orl_hemisphere_about(side, u, v);
        struct orl_own_way ways[ORL_PRISM_WAYS];
        const int n = orl_own_ways(material->ways, hit, ray, ways);
        double eye = 0, light = 0;
        struct way flux[ORL_PRISM_WAYS];
        for (int k = 0; k < n; k++) {
            if (!(ways[k].share > 0))
                continue;
            eye += ways[k].share;
            findings->all += ways[k].share;
            if (!(seen_share(material, hit, ray, ways[k].towards) > 0))
                findings->one_way += ways[k].share;
        }
        const int n_flux = ways_of_light(material, hit, ray, flux);
        for (int k = 0; k < n_flux; k++)
            light += flux[k].share;
        findings->most_seen = fmax(findings->most_seen, eye);
        findings->most_sent = fmax(findings->most_sent, light);
    }
}
