#include "light/virtual_lamps.h"

#include <math.h>
#include <stdlib.h>

#include "light/lit_scene.h"
#include "light/path.h"
#include "scene/material/scatter.h"

/* Limit of pairs, beyond which they are left out: testing that many takes some tenths of a
 * second. */
static const uint64_t most_pairs = 4000000;
/* Limit of mirrors for which rays test whether they are inside. Mirrors beyond it are left out. */
enum { MOST_MIRRORS_LOOKED_AT = 4096 };
/* LEAST_PAIRS pairs are selected, or PAIRS_A_LAMP for each lamp if that is more; at most
 * MOST_PAIRS. */
enum { LEAST_PAIRS = 64, PAIRS_A_LAMP = 2, MOST_PAIRS = 1024 };
/* Limit of mirrors for the estimate of light by two mirrors; bright ones come first. */
enum { MOST_TWICE = 256 };
/* Light of two mirrors that are not bright counts from this share of all light on. */
static const double least_share = 1e-5;
/* Reflectance of two mirrors together from which they are bright; that of panes is 0.03. */
static const double bright_pair = 0.05;
/* Points of a mirror that test whether light of another one reaches it, along each side; limit of
 * all such points, a tenth of a second. Beyond it mirrors count as reached. */
enum { POINTS_A_SIDE = 8, MOST_POINTS = 1 << 17 };

/* A lamp and a mirror. */
struct pair {
    struct orl_virtual_lamp image;
    double strength; /* upper bound of the lamp's flux that the mirror reflects */
    bool bright;     /* the mirror is bright */
};

/* A min-heap of the strongest pairs so far. */
struct pairs {
    struct pair kept[MOST_PAIRS];
    size_t n, most;
    double left_out;      /* sum of the strengths of pairs that are not selected */
    bool bright_left_out; /* some of them have bright mirrors */
    bool overflown;       /* there are pairs that were not tested */
    size_t looked_at;     /* mirrors from which rays were traced */
};

/* ---- Mirrors --------------------------------------------------------------------------------- */

/* Computes the bounding sphere of a polygon or a ring. */
static void find_sphere(const struct orl_geometry *g, const struct orl_facet *f,
                        struct orl_virtual_lamp *image)
{
    struct orl_vec3 low = {INFINITY, INFINITY, INFINITY}, high = {-INFINITY, -INFINITY, -INFINITY};
    if (f->kind == ORL_SURFACE_RING) {
        image->center = f->quadric->center[0];
        image->radius = orl_larger(f->quadric->radius[0], f->quadric->radius[1]);
        return;
    }
    for (uint32_t i = 0; i < f->n_triangles; i++) {
        const struct orl_triangle t = orl_triangle_get(g, orl_facet_triangle(f, i));
        const struct orl_vec3 corners[3] = {t.a, t.b, t.c};
        for (int k = 0; k < 3; k++) {
            low = orl_v3(fmin(low.x, corners[k].x), fmin(low.y, corners[k].y),
                         fmin(low.z, corners[k].z));
            high = orl_v3(fmax(high.x, corners[k].x), fmax(high.y, corners[k].y),
                          fmax(high.z, corners[k].z));
        }
    }
    const struct orl_triangle first = orl_triangle_get(g, orl_facet_triangle(f, 0));
    const struct orl_vec3 middle = orl_scale(orl_add(low, high), 0.5);
    image->radius = orl_length(orl_sub(high, low)) / 2 + f->offset;
    image->center = orl_madd(middle, f->normal, -orl_dot(orl_sub(middle, first.a), f->normal));
}

/* ---- Pairs ----------------------------------------------------------------------------------- */

/* A lamp, approximated by a point. */
struct spot {
    uint32_t emitter, facet;
    struct orl_vec3 middle;
    double area, power; /* power: area times radiance */
};

/* Lists the lamps that shadow rays sample; returns their number. */
static size_t list_spots(const struct orl_lit_scene *lit_scene, struct spot *ret_spots)
{
    static const double half[2] = {0.5, 0.5};
    size_t n = 0;
    for (size_t i = 0; i < lit_scene->n_emitters; i++) {
        const struct orl_emitter *emitter = &lit_scene->emitters[i];
        struct orl_vec3 normal;
        if (!emitter->direct)
            continue;
        struct spot *spot = &ret_spots[n++];
        spot->emitter = (uint32_t)i;
        spot->facet = emitter->facet;
        spot->area = orl_facet_area(lit_scene->geometry, emitter->facet);
        spot->power = spot->area * orl_luma(emitter->most);
        orl_facet_sample(lit_scene->geometry, emitter->facet, half, &spot->middle, &normal);
    }
    return n;
}

/* A mirror, with its reflectance at 60 degrees of incidence for its front and its back. */
struct mirror {
    struct orl_virtual_lamp image;
    double area, reflectance[2];
};

static double brightest(const struct mirror *mirror)
{
    return orl_larger(mirror->reflectance[0], mirror->reflectance[1]);
}

/* Returns true if the mirror is as bright as one of two that are bright together. */
static bool is_bright(const struct mirror *mirror)
{
    return brightest(mirror) * brightest(mirror) >= bright_pair;
}

/* Returns the flux of the lamp, times the share of it that may hit the mirror, times the
 * mirror's reflectance. */
static double strength_of(const struct spot *spot, const struct mirror *mirror)
{
    const struct orl_vec3 way = orl_sub(spot->middle, mirror->image.center);
    const double d2 = orl_dot(way, way) + spot->area;
    const bool front = orl_dot(way, mirror->image.normal) > 0;
    return spot->power * fmin(mirror->area / (ORL_PI * d2), 1) * mirror->reflectance[!front];
}

/* Moves a pair down the heap, until the pairs below it are stronger. */
static void sift_down(struct pairs *pairs, size_t at)
{
    const struct pair moved = pairs->kept[at];
    for (size_t next = 2 * at + 1; next < pairs->n; next = 2 * at + 1) {
        if (next + 1 < pairs->n && pairs->kept[next + 1].strength < pairs->kept[next].strength)
            next++;
        if (moved.strength <= pairs->kept[next].strength)
            break;
        pairs->kept[at] = pairs->kept[next];
        at = next;
    }
    pairs->kept[at] = moved;
}

/* Moves the last pair of the heap up, until the pair above it is weaker. */
static void sift_up(struct pairs *pairs)
{
    size_t at = pairs->n - 1;
    const struct pair moved = pairs->kept[at];
    for (; at > 0 && moved.strength < pairs->kept[(at - 1) / 2].strength; at = (at - 1) / 2)
        pairs->kept[at] = pairs->kept[(at - 1) / 2];
    pairs->kept[at] = moved;
}

/* Returns true if a pair of that strength would be among the strongest. */
static bool is_strong(const struct pairs *pairs, double strength)
{
    return strength > 0 && (pairs->n < pairs->most || strength > pairs->kept[0].strength);
}

static void leave_out(struct pairs *pairs, double strength, bool bright)
{
    pairs->left_out += strength;
    pairs->bright_left_out |= bright && strength > 0;
}

/* Adds a pair for which is_strong is true; in a full heap it replaces the weakest. */
static void add_pair(struct pairs *pairs, const struct pair *pair)
{
    if (pairs->n < pairs->most) {
        pairs->kept[pairs->n++] = *pair;
        sift_up(pairs);
        return;
    }
    leave_out(pairs, pairs->kept[0].strength, pairs->kept[0].bright);
    pairs->kept[0] = *pair;
    sift_down(pairs, 0);
}

/* Returns true if at least one side of a mirror is inside, or the scene is open. Paths outdoors
 * do not use images of lamps. */
static bool is_inside(const struct orl_lit_scene *lit_scene, uint32_t facet)
{
    static const double middle[2] = {0.5, 0.5};
    struct orl_vec3 point, normal;
    if (lit_scene->open)
        return true;
    orl_facet_sample(lit_scene->geometry, facet, middle, &point, &normal);
    return !orl_lit_scene_is_outside(lit_scene, orl_facet_ray_origin(lit_scene->geometry, facet,
                                                                     point, normal, normal)) ||
           !orl_lit_scene_is_outside(
               lit_scene,
               orl_facet_ray_origin(lit_scene->geometry, facet, point, normal, orl_neg(normal)));
}

static struct mirror mirror_of(const struct orl_lit_scene *lit_scene, const struct orl_facet *f,
                               uint32_t facet)
{
    const struct orl_material *m = &lit_scene->materials[f->material];
    struct mirror mirror = {.image = {.mirror = facet, .normal = f->normal},
                            .area = f->area,
                            .reflectance = {orl_material_max_mirrored(m, true, 0.5),
                                            orl_material_max_mirrored(m, false, 0.5)}};
    find_sphere(lit_scene->geometry, f, &mirror.image);
    return mirror;
}

/* Pairs a mirror with the lamps. Rays test whether the mirror is inside once one of its pairs is
 * strong. */
static void pair_mirror(struct pairs *pairs, const struct orl_lit_scene *lit_scene,
                        const struct mirror *mirror, const struct spot *spots, size_t n_spots)
{
    struct pair pair = {.image = mirror->image, .bright = is_bright(mirror)};
    bool known_inside = false;
    for (size_t i = 0; i < n_spots; i++) {
        pair.strength = strength_of(&spots[i], mirror);
        if (spots[i].facet == pair.image.mirror)
            continue;
        if (!is_strong(pairs, pair.strength)) {
            leave_out(pairs, pair.strength, pair.bright);
            continue;
        }
        if (!known_inside && pairs->looked_at++ >= MOST_MIRRORS_LOOKED_AT) {
            pairs->overflown = true;
            return;
        }
        if (!known_inside && !is_inside(lit_scene, pair.image.mirror))
            return;
        known_inside = true;
        pair.image.emitter = spots[i].emitter;
        pair.image.lamp = spots[i].facet;
        add_pair(pairs, &pair);
    }
}

/* Finds the strongest pairs of all mirrors and lamps. Returns 0 or ORL_ERR_CANCELLED. */
static int find_pairs(struct pairs *pairs, const struct orl_lit_scene *lit_scene,
                      const struct spot *spots, size_t n_spots, const struct orl_thread_pool *pool)
{
    uint64_t looked_at = 0;
    for (size_t i = 0; i < lit_scene->geometry->n_facets && n_spots > 0; i++) {
        struct orl_facet own;
        const struct orl_facet *f = orl_facet_get_own(lit_scene->geometry, i, &own);
        if (!orl_facet_is_plane(f) || !orl_is_flat_mirror(lit_scene, f))
            continue;
        if (orl_thread_pool_cancelled(pool))
            return ORL_ERR_CANCELLED;
        looked_at += n_spots;
        if (looked_at > most_pairs) {
            pairs->overflown = true;
            break;
        }
        const struct mirror mirror = mirror_of(lit_scene, f, (uint32_t)i);
        pair_mirror(pairs, lit_scene, &mirror, spots, n_spots);
    }
    return 0;
}

/* Orders images by mirror, then by lamp. */
static int compare_images(const void *a, const void *b)
{
    const struct orl_virtual_lamp *x = a, *y = b;
    const int by_mirror = (x->mirror > y->mirror) - (x->mirror < y->mirror);
    return by_mirror ? by_mirror : (x->lamp > y->lamp) - (x->lamp < y->lamp);
}

static int keep_images(struct orl_virtual_lamps *images, const struct pairs *pairs)
{
    double kept = 0;
    images->images = calloc(pairs->n + 1, sizeof *images->images);
    if (!images->images)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < pairs->n; i++) {
        images->images[images->n_images++] = pairs->kept[i].image;
        kept += pairs->kept[i].strength;
    }
    qsort(images->images, images->n_images, sizeof *images->images, compare_images);
    images->bright_left_out = pairs->bright_left_out;
    images->left_out = pairs->overflown      ? 1
                       : pairs->left_out > 0 ? pairs->left_out / (pairs->left_out + kept)
                                             : 0;
    return 0;
}

/* ---- Two mirrors ----------------------------------------------------------------------------- */

/* The image of a lamp in a mirror: a spot behind the mirror. */
struct mirrored_spot {
    const struct orl_virtual_lamp *image;
    struct spot spot; /* power: the lamp's times the mirror's reflectance */
};

/* Returns true if a ray reaches the facet, straight through panes. */
static bool is_visible(const struct orl_lit_scene *lit_scene, struct orl_vec3 origin,
                       struct orl_vec3 direction, uint32_t facet)
{
    struct orl_path path = orl_path_from(origin, direction);
    struct orl_hit hit;
    for (int pane = 0; pane < ORL_MOST_PANES; pane++) {
        if (!orl_path_intersect(lit_scene, &path, &hit))
            return false;
        if (hit.facet == facet)
            return true;
        if (!orl_path_transmit_straight(&path, orl_lit_scene_material(lit_scene, &hit), &hit))
            return false;
        orl_path_skip_surface(&path, lit_scene, &hit);
    }
    return false;
}

/* Returns true if the first mirror may reflect the lamp's light to a point of the other one. */
static bool reaches_point(const struct orl_lit_scene *lit_scene, const struct mirrored_spot *from,
                          uint32_t facet, struct orl_vec3 point)
{
    const struct orl_virtual_lamp *image = from->image;
    const struct orl_vec3 way = orl_sub(point, from->spot.middle);
    const double height = orl_dot(orl_sub(image->center, from->spot.middle), image->normal);
    const double climb = orl_dot(way, image->normal), share = height / climb;
    if (!(climb * height > 0) || !(share < 1))
        return false;
    const struct orl_vec3 at = orl_madd(from->spot.middle, way, share);
    const struct orl_vec3 off = orl_sub(at, image->center), ahead = orl_normalize(way);
    struct orl_facet own;
    const double offset = orl_facet_get_own(lit_scene->geometry, image->mirror, &own)->offset;
    return orl_dot(off, off) < image->radius * image->radius &&
           is_visible(lit_scene, orl_madd(at, ahead, 2 * offset), ahead, facet);
}

/* Returns false if no ray from the image of the lamp meets the bounding spheres of both mirrors, or
 * all of the second one lies behind the first. */
static bool may_reach(const struct mirrored_spot *from, const struct mirror *to)
{
    const struct orl_virtual_lamp *first = from->image, *second = &to->image;
    const struct orl_vec3 to_first = orl_sub(first->center, from->spot.middle),
                          to_second = orl_sub(second->center, from->spot.middle);
    const double height = orl_dot(to_first, first->normal),
                 beyond = orl_dot(to_second, first->normal) - height;
    const double far_first = orl_length(to_first), far_second = orl_length(to_second);
    if ((height > 0 ? beyond : -beyond) <= -second->radius)
        return false;
    if (far_first <= first->radius || far_second <= second->radius)
        return true;
    const double cosine = orl_dot(to_first, to_second) / (far_first * far_second);
    return acos(fmin(fmax(cosine, -1), 1)) <
           asin(first->radius / far_first) + asin(second->radius / far_second);
}

/* Returns true if a mirror may reflect the lamp's light to another mirror. Many points of it are
 * tested, since the lamp itself, or a part of the room, may stand in front of some. */
static bool reaches_mirror(const struct orl_lit_scene *lit_scene, const struct mirrored_spot *from,
                           const struct mirror *to, int *points_left)
{
    if (!may_reach(from, to))
        return false;
    for (int i = 0; i < POINTS_A_SIDE * POINTS_A_SIDE; i++) {
        const int row = i / POINTS_A_SIDE, column = i % POINTS_A_SIDE;
        const double u[2] = {(column + 0.5) / POINTS_A_SIDE, (row + 0.5) / POINTS_A_SIDE};
        struct orl_vec3 point, normal;
        if (*points_left == 0)
            return true;
        --*points_left;
        orl_facet_sample(lit_scene->geometry, to->image.mirror, u, &point, &normal);
        if (reaches_point(lit_scene, from, to->image.mirror, point))
            return true;
    }
    return false;
}

/* Appends the flat mirrors inside that are bright, or the others; returns the new length, at most
 * MOST_TWICE. */
static size_t append_mirrors(const struct orl_lit_scene *lit_scene, bool bright,
                             struct mirror *mirrors, size_t n)
{
    size_t looked_at = 0;
    for (size_t i = 0;
         i < lit_scene->geometry->n_facets && n < MOST_TWICE && looked_at < MOST_MIRRORS_LOOKED_AT;
         i++) {
        struct orl_facet own;
        const struct orl_facet *f = orl_facet_get_own(lit_scene->geometry, i, &own);
        if (!orl_facet_is_plane(f) || !orl_is_flat_mirror(lit_scene, f))
            continue;
        mirrors[n] = mirror_of(lit_scene, f, (uint32_t)i);
        if (is_bright(&mirrors[n]) != bright)
            continue;
        looked_at++;
        n += is_inside(lit_scene, (uint32_t)i);
    }
    return n;
}

static struct mirrored_spot mirror_spot(const struct orl_virtual_lamp *image,
                                        const struct spot *spot, const struct mirror *mirror)
{
    struct mirrored_spot mirrored = {image, *spot};
    const bool front = orl_virtual_lamp_height(image, spot->middle) > 0;
    mirrored.spot.middle = orl_virtual_lamp_mirror_point(image, spot->middle);
    mirrored.spot.power *= mirror->reflectance[!front];
    return mirrored;
}

static const struct spot *find_spot(const struct spot *spots, size_t n, uint32_t facet)
{
    for (size_t i = 0; i < n; i++)
        if (spots[i].facet == facet)
            return &spots[i];
    return NULL;
}

/* Mirrors that may be the second of two, and the flux of all lamps. */
struct second_mirrors {
    struct mirror mirrors[MOST_TWICE + 1]; /* the last one is scratch */
    size_t n;
    double power;
    int points_left; /* of MOST_POINTS */
};

/* Adds the light of an image by way of each second mirror. */
static void add_second_mirrors(struct orl_virtual_lamps *images,
                               const struct orl_lit_scene *lit_scene,
                               const struct mirrored_spot *from, double first_reflectance,
                               struct second_mirrors *second)
{
    for (size_t k = 0; k < second->n && !orl_virtual_lamps_omit_pairs(images); k++) {
        const struct mirror *to = &second->mirrors[k];
        const double share = strength_of(&from->spot, to) / second->power;
        const bool bright = first_reflectance * brightest(to) >= bright_pair;
        if (to->image.mirror == from->image->mirror || !(share > (bright ? 0 : least_share)) ||
            !reaches_mirror(lit_scene, from, to, &second->points_left))
            continue;
        images->two_mirror_share += share;
        images->two_bright_mirrors |= bright;
    }
}

/*
 * Sets images->two_mirror_share and two_bright_mirrors, until orl_virtual_lamps_omit_pairs is
 * decided. The second mirror need not face the lamp: in a periscope it does not. Returns 0,
 * ORL_ERR_NOMEM or ORL_ERR_CANCELLED.
 */
static int estimate_two_mirrors(struct orl_virtual_lamps *images,
                                const struct orl_lit_scene *lit_scene, const struct spot *spots,
                                size_t n_spots, const struct orl_thread_pool *pool)
{
    if (images->n_images == 0)
        return 0;
    struct second_mirrors *second = calloc(1, sizeof *second);
    if (!second)
        return ORL_ERR_NOMEM;
    second->points_left = MOST_POINTS;
    second->n = append_mirrors(lit_scene, true, second->mirrors, 0);
    second->n = append_mirrors(lit_scene, false, second->mirrors, second->n);
    for (size_t i = 0; i < n_spots; i++)
        second->power += spots[i].power;
    for (size_t i = 0; i < images->n_images && second->power > 0 && second->n > 1 &&
                       !orl_thread_pool_cancelled(pool);
         i++) {
        const struct orl_virtual_lamp *image = &images->images[i];
        const struct spot *spot = find_spot(spots, n_spots, image->lamp);
        struct orl_facet own;
        const struct mirror first = mirror_of(
            lit_scene, orl_facet_get_own(lit_scene->geometry, image->mirror, &own), image->mirror);
        if (!spot)
            continue;
        const struct mirrored_spot from = mirror_spot(image, spot, &first);
        add_second_mirrors(images, lit_scene, &from, brightest(&first), second);
    }
    free(second);
    return orl_thread_pool_cancelled(pool) ? ORL_ERR_CANCELLED : 0;
}

int orl_virtual_lamps_build(struct orl_virtual_lamps *images, const struct orl_lit_scene *lit_scene,
                            const struct orl_thread_pool *pool)
{
    *images = (struct orl_virtual_lamps){.n_images = 0};
    struct pairs *const pairs = calloc(1, sizeof *pairs);
    struct spot *const spots = calloc(lit_scene->n_emitters + 1, sizeof *spots);
    int code = pairs && spots ? 0 : ORL_ERR_NOMEM;
    if (code == 0) {
        const size_t n_spots = list_spots(lit_scene, spots), wanted = PAIRS_A_LAMP * n_spots;
        pairs->most = wanted < LEAST_PAIRS  ? LEAST_PAIRS
                      : wanted < MOST_PAIRS ? wanted
                                            : MOST_PAIRS;
        code = find_pairs(pairs, lit_scene, spots, n_spots, pool);
    }
    if (code == 0)
        code = keep_images(images, pairs);
    if (code == 0)
        code = estimate_two_mirrors(images, lit_scene, spots, list_spots(lit_scene, spots), pool);
    free(spots);
    free(pairs);
    return code;
}

void orl_virtual_lamps_done(struct orl_virtual_lamps *images)
{
    free(images->images);
    *images = (struct orl_virtual_lamps){.n_images = 0};
}

/* Returns the index of the first image that is not before the given mirror and lamp; n_images if
 * there is none. */
static size_t find_image(const struct orl_virtual_lamps *images, uint32_t mirror, uint32_t lamp)
{
    const struct orl_virtual_lamp wanted = {.mirror = mirror, .lamp = lamp};
    size_t low = 0, high = images->n_images;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (compare_images(&images->images[middle], &wanted) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

const struct orl_virtual_lamp *orl_virtual_lamps_in_mirror(const struct orl_virtual_lamps *images,
                                                           uint32_t mirror)
{
    const size_t i = find_image(images, mirror, 0);
    return i < images->n_images && images->images[i].mirror == mirror ? &images->images[i] : NULL;
}

bool orl_virtual_lamps_contain(const struct orl_virtual_lamps *images, uint32_t lamp,
                               uint32_t mirror)
{
    const size_t i = find_image(images, mirror, lamp);
    return i < images->n_images && images->images[i].mirror == mirror &&
           images->images[i].lamp == lamp;
}
