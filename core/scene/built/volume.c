#include "scene/built/scene.h"

#include <stdlib.h>

enum { MOST_CROSSINGS = 64, MOST_MISTS = 16 };

/* ---- Boundaries ------------------------------------------------------------------------------ */

static bool is_mist(const struct orl_scene *scene, size_t facet)
{
    return orl_scene_material(scene, facet)->kind == ORL_MATERIAL_MIST;
}

static int check_count(const struct orl_scene *scene, struct orl_error *err)
{
    const struct orl_parsed_scene *const d = &scene->parsed_scene;
    size_t n = 0;
    for (size_t i = 0; i < d->n_materials; i++)
        n += d->materials[i].kind == ORL_MATERIAL_MIST;
    if (n <= MOST_MISTS)
        return 0;
    return orl_error_set(err, ORL_ERR_LIMIT, "more than %d different kinds of mist", MOST_MISTS);
}

int orl_volume_split(struct orl_scene *scene, struct orl_error *err)
{
    struct orl_geometry *const whole = scene->geometry;
    struct orl_geometry *rest = NULL;
    size_t n = 0;
    for (size_t i = 0; i < whole->n_facets; i++)
        n += is_mist(scene, i);
    if (n == 0)
        return 0;
    bool *const keep = malloc(whole->n_facets * sizeof *keep);
    if (!keep)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < whole->n_facets; i++)
        keep[i] = is_mist(scene, i);
    int code = check_count(scene, err);
    if (code == 0)
        code = orl_geometry_subset(whole, keep, &scene->mist, err);
    for (size_t i = 0; i < whole->n_facets; i++)
        keep[i] = !keep[i];
    if (code == 0)
        code = orl_geometry_subset(whole, keep, &rest, err);
    free(keep);
    if (code < 0)
        return code;
    scene->geometry = rest;
    orl_geometry_free(whole);
    return 0;
}

/* ---- Crossings ------------------------------------------------------------------------------- */

/* A crossing of a volume's boundary; change: 1 for entering, -1 for leaving. */
struct crossing {
    double at;
    const struct orl_mist *mist;
    int change;
};

/* The crossings of a ray with volumes, in order, and the volumes around the current position. */
struct way {
    struct crossing crossings[MOST_CROSSINGS];
    int n;
    struct {
        const struct orl_mist *mist;
        int depth; /* number of this medium's volumes that contain the position */
    } within[MOST_MISTS];
    int n_mists;
};

static int index_of(struct way *way, const struct orl_mist *mist)
{
    for (int i = 0; i < way->n_mists; i++)
        if (way->within[i].mist == mist)
            return i;
    way->within[way->n_mists].mist = mist;
    way->within[way->n_mists].depth = 0;
    return way->n_mists++;
}

static void cross_surface(struct way *way, const struct crossing *crossing)
{
    way->within[index_of(way, crossing->mist)].depth += crossing->change;
}

/* Computes the volumes in which the ray starts: those that it leaves without having entered them.
 * */
static void find_start(struct way *way)
{
    int lowest[MOST_MISTS] = {0};
    for (int i = 0; i < way->n; i++) {
        const int which = index_of(way, way->crossings[i].mist);
        cross_surface(way, &way->crossings[i]);
        if (way->within[which].depth < lowest[which])
            lowest[which] = way->within[which].depth;
    }
    for (int i = 0; i < way->n_mists; i++)
        way->within[i].depth = -lowest[i];
}

/* Finds all crossings, also those beyond the ray's end, because they determine where it starts. */
static void find_crossings(const struct orl_scene *scene, struct orl_vec3 origin,
                           struct orl_vec3 direction, struct way *ret)
{
    double at = 0;
    *ret = (struct way){.n = 0};
    while (ret->n < MOST_CROSSINGS) {
        struct orl_hit hit;
        if (!orl_geometry_intersect(scene->mist, orl_madd(origin, direction, at), direction,
                                    INFINITY, &hit))
            break;
        struct orl_facet own;
        const struct orl_facet *const facet = orl_facet_get_own(scene->mist, hit.facet, &own);
        at += hit.distance;
        const struct orl_material *const m = &scene->parsed_scene.materials[facet->material];
        ret->crossings[ret->n++] = (struct crossing){at, orl_mist_of(m), hit.front ? 1 : -1};
        at += facet->offset;
    }
    find_start(ret);
}

/* A segment of a ray with constant extinction. */
struct stretch {
    double from, to;
    struct orl_rgb extinction;
};

static struct orl_rgb extinction_of(const struct way *way)
{
    struct orl_rgb sum = orl_gray(0);
    for (int i = 0; i < way->n_mists; i++)
        sum = orl_rgb_add(
            sum, orl_rgb_scale(way->within[i].mist->extinction, way->within[i].depth > 0 ? 1 : 0));
    return sum;
}

/* Computes the i-th segment; i counts up from 0. Returns false beyond the end. */
static bool next_stretch(struct way *way, int i, double end, struct stretch *ret)
{
    if (i > way->n)
        return false;
    if (i > 0)
        cross_surface(way, &way->crossings[i - 1]);
    ret->from = i > 0 ? way->crossings[i - 1].at : 0;
    if (!(ret->from < end))
        return false;
    ret->to = i < way->n ? fmin(way->crossings[i].at, end) : end;
    ret->extinction = extinction_of(way);
    return true;
}

static double depth_along(double extinction, double length)
{
    return extinction > 0 ? extinction * length : 0;
}

static struct orl_rgb dimmed(struct orl_rgb weight, struct orl_rgb extinction, double length)
{
    return (struct orl_rgb){weight.r * exp(-depth_along(extinction.r, length)),
                            weight.g * exp(-depth_along(extinction.g, length)),
                            weight.b * exp(-depth_along(extinction.b, length))};
}

struct orl_rgb orl_volume_transmittance(const struct orl_scene *scene, struct orl_vec3 origin,
                                        struct orl_vec3 direction, double distance)
{
    struct orl_rgb share = orl_gray(1);
    struct way way;
    struct stretch s;
    if (!scene->mist)
        return share;
    find_crossings(scene, origin, direction, &way);
    for (int i = 0; next_stretch(&way, i, distance, &s); i++)
        share = dimmed(share, s.extinction, s.to - s.from);
    return share;
}

/* ---- Scattering ------------------------------------------------------------------------------ */

static double mean_of(struct orl_rgb c)
{
    return (c.r + c.g + c.b) / 3;
}

/* Samples one of the media at the position, in proportion to its scattering coefficient. */
static struct orl_volume_event scatter_in_mist(const struct way *way, double at,
                                               struct orl_rgb left, struct orl_rgb extinction,
                                               struct orl_random *random)
{
    const double density = mean_of(orl_rgb_mul(left, extinction));
    double sum = 0, seen = 0;
    struct orl_volume_event event = {.scattered = true, .distance = at};
    for (int i = 0; i < way->n_mists; i++)
        if (way->within[i].depth > 0)
            sum += mean_of(way->within[i].mist->scattering);
    const double drawn = orl_random_uniform(random) * sum;
    for (int i = 0; i < way->n_mists && seen <= drawn; i++)
        if (way->within[i].depth > 0) {
            const double share = mean_of(way->within[i].mist->scattering);
            seen += share;
            event.asymmetry = way->within[i].mist->asymmetry;
            if (share > 0)
                event.weight = orl_rgb_scale(way->within[i].mist->scattering, sum / share);
        }
    event.weight = orl_rgb_scale(orl_rgb_mul(event.weight, left), 1 / density);
    return event;
}

struct orl_volume_event orl_volume_sample_event(const struct orl_scene *scene,
                                                struct orl_vec3 origin, struct orl_vec3 direction,
                                                double distance, struct orl_random *random)
{
    struct orl_rgb left = orl_gray(1);
    struct way way;
    struct stretch s;
    if (!scene->mist)
        return (struct orl_volume_event){.weight = left};
    find_crossings(scene, origin, direction, &way);
    const int by = (int)(3 * orl_random_uniform(random));
    double to_go = -log(1 - orl_random_uniform(random));
    for (int i = 0; next_stretch(&way, i, distance, &s); i++) {
        const double extinction = by == 0   ? s.extinction.r
                                  : by == 1 ? s.extinction.g
                                            : s.extinction.b;
        const double here = depth_along(extinction, s.to - s.from);
        if (here > to_go) {
            const double length = to_go / extinction;
            return scatter_in_mist(&way, s.from + length, dimmed(left, s.extinction, length),
                                   s.extinction, random);
        }
        to_go -= here;
        left = dimmed(left, s.extinction, s.to - s.from);
    }
    const double through = mean_of(left);
    return (struct orl_volume_event){.weight = through > 0 ? orl_rgb_scale(left, 1 / through)
                                                           : orl_gray(0)};
}

double orl_phase_function(double asymmetry, double cosine)
{
    const double g2 = asymmetry * asymmetry, d = 1 + g2 - 2 * asymmetry * cosine;
    return (1 - g2) / (4 * ORL_PI * d * sqrt(d));
}

struct orl_vec3 orl_phase_function_sample(double asymmetry, struct orl_vec3 along,
                                          const double u[2])
{
    const struct orl_frame frame = orl_frame_about(along);
    double cosine = 1 - 2 * u[0];
    if (fabs(asymmetry) > 1e-4) {
        const double part = (1 - asymmetry * asymmetry) / (1 - asymmetry + 2 * asymmetry * u[0]);
        cosine = (1 + asymmetry * asymmetry - part * part) / (2 * asymmetry);
    }
    cosine = fmin(fmax(cosine, -1), 1);
    const double sine = sqrt(fmax(0, 1 - cosine * cosine)), phi = 2 * ORL_PI * u[1];
    return orl_to_world(&frame, orl_v3(sine * cos(phi), sine * sin(phi), cosine));
}
