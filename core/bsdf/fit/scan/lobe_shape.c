/* Light of a scan as lobes in three parts, and clusters of lobes. */
#include "bsdf/fit/scan/scan_light.h"

#include <oriel/base/thread_pool.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory/memory.h"
#include "base/statistics/numeric.h"

/* Cells of the raster for the broad part are 4.5 degrees wide. */
enum { BRIGHT_LEVELS = 2, POLL_LEVEL = 2 };
enum { BASE_LEVEL = 5, BASE_SIDE = 1 << BASE_LEVEL, BASE_CELLS = BASE_SIDE * BASE_SIDE };
/* Unevenness allowed in a leaf, as a share of all light. */
static const double least_uneven = 1e-3;
/* Factor of least_uneven in leaves as small as those of bright regions: smaller ones among them
 * would cause ripples. */
static const double finer_uneven = 2;
/* Limit for bright values, as a share of dark values above these. */
static const double least_bright = 0.05;
/* Limit for the narrow part, as a multiple of the broad value. */
static const double least_narrow = 1.25;
/* Sigma of a lobe in sides of its cell: uniform to 1 % where the square is most sheared. */
static const double sigma_of_side = 0.7;
/* Largest share of a part's mass in a cluster. */
static const double cluster_share = 1.0 / 160;
static const double opening_rad = 8 * ORL_DEG_TO_RAD, smoothing_rad = 5 * ORL_DEG_TO_RAD;

/* ---- Leaves ---------------------------------------------------------------------------------- */

struct leaf {
    uint32_t code, level;
    float value, z;     /* means over the cell */
    struct orl_vec3 at; /* mean direction of its light */
};

struct tree {
    const struct orl_fit_rbf *centers;
    const atomic_bool *cancel;
    unsigned bright_level, finest; /* coarsest level of bright leaves; finest level of all */
    double uneven;                 /* unevenness allowed in a leaf, 1/sr times sr */
    double bright[BRIGHT_LEVELS];  /* 1/sr: above [k], leaves reach level bright_level - k */
    struct leaf *leaves;
    size_t n, capacity;
    float low[BASE_CELLS], base[BASE_CELLS]; /* by cells in the order of codes; 1/sr */
};

/* Returns a place in a cell; u and v from 0 to 1. */
static struct orl_vec3 place_within(uint32_t code, unsigned level, double u, double v)
{
    const uint32_t cell = code >> 2 * (ORL_FIT_SQUARE_LEVELS - level);
    const double side = UINT32_C(1) << level;
    return orl_fit_from_square((orl_morton_even(cell) + u) / side,
                               (orl_morton_even(cell >> 1) + v) / side);
}

/* Returns the first center whose code is at least `code`. */
static size_t first_center(const struct orl_fit_rbf *k, size_t begin, size_t end, uint64_t code)
{
    while (begin < end) {
        const size_t middle = begin + (end - begin) / 2;
        if (k->centers[middle].code < code)
            begin = middle + 1;
        else
            end = middle;
    }
    return begin;
}

struct range {
    size_t begin, end; /* range of centers */
};

/* Returns true if the leaf must be divided. Leaves of different sizes next to each other cause
 * ripples, so all are small in bright regions. */
static bool is_uneven(const struct tree *t, const double values[4], double z, unsigned level,
                      struct range centers)
{
    double least = INFINITY, most = 0;
    for (int i = 0; i < 4; i++) {
        least = fmin(least, values[i]);
        most = fmax(most, values[i]);
    }
    for (size_t i = centers.begin; i < centers.end; i++) {
        least = fmin(least, orl_larger(0, (double)t->centers->centers[i].value));
        most = fmax(most, (double)t->centers->centers[i].value);
    }
    if (level < t->bright_level && most > t->bright[t->bright_level - 1 - level])
        return true;
    const double uneven = level < t->bright_level ? t->uneven : finer_uneven * t->uneven;
    return (most - least) * orl_fit_cell_sr(level) * z > uneven;
}

static bool add_leaf(struct tree *t, struct leaf leaf)
{
    if (!orl_array_reserve(&t->leaves, &t->capacity, t->n, sizeof *t->leaves))
        return false;
    t->leaves[t->n++] = leaf;
    return true;
}

/* Returns a leaf with the mean of side * side values of a cell, weighted by projected solid angle.
 * values: the first four. */
static struct leaf sample_leaf(const struct tree *t, uint32_t code, unsigned level, int side,
                               double values[4])
{
    const int n = side * side;
    struct orl_vec3 at = {0};
    double sum = 0, z = 0;
    for (int i = 0; i < n; i++) {
        const int row = i / side;
        const struct orl_vec3 d =
            place_within(code, level, (i % side + 0.5) / side, (row + 0.5) / side);
        const double value = orl_fit_rbf_value(t->centers, d);
        if (i < 4)
            values[i] = value;
        at = orl_madd(at, d, value * d.z + 1e-12);
        sum += value * d.z;
        z += d.z;
    }
    at = orl_normalize(at);
    return (struct leaf){
        .code = code, .level = level, .value = (float)(sum / z), .z = (float)(z / n), .at = at};
}

/* Returns the samples a side for a leaf that is too coarse for its centers: about one per center.
 */
static int side_for(struct range centers)
{
    enum { MOST = 8 };
    const double n = (double)(centers.end - centers.begin);
    int side = 2;
    while (side < MOST && side * side < n)
        side *= 2;
    return side;
}

static bool grow_leaves(struct tree *t, uint32_t code, unsigned level, struct range centers)
{
    if (level >= BASE_LEVEL) {
        const bool once = centers.end - centers.begin < 2 && level == t->bright_level;
        double values[4];
        const struct leaf leaf = sample_leaf(t, code, level, once ? 1 : 2, values);
        if (once || !is_uneven(t, values, (double)leaf.z, level, centers))
            return add_leaf(t, leaf);
        if (level >= t->finest)
            return add_leaf(t, sample_leaf(t, code, level, side_for(centers), values));
    }
    if (level == POLL_LEVEL && orl_is_cancelled(t->cancel))
        return false;
    const unsigned below = 2 * (ORL_FIT_SQUARE_LEVELS - level - 1);
    bool fine = true;
    for (uint32_t q = 0; q < 4 && fine; q++) {
        const uint64_t from = (uint64_t)code + ((uint64_t)q << below);
        const size_t begin = first_center(t->centers, centers.begin, centers.end, from);
        const size_t end =
            first_center(t->centers, begin, centers.end, from + (UINT64_C(1) << below));
        fine = grow_leaves(t, (uint32_t)from, level + 1, (struct range){begin, end});
    }
    return fine;
}

static uint32_t base_cell(uint32_t code)
{
    return code >> 2 * (ORL_FIT_SQUARE_LEVELS - BASE_LEVEL);
}

/* ---- The broad part ------------------------------------------------------------------------- */

/* Sets each cell to the least, or the most, value within reach. */
static void sweep_cells(const struct orl_vec3 *places, const float *from, bool most, float *to)
{
    const double within_reach = cos(opening_rad);
    for (size_t i = 0; i < BASE_CELLS; i++) {
        to[i] = from[i];
        for (size_t j = 0; j < BASE_CELLS; j++)
            if (orl_dot(places[i], places[j]) >= within_reach &&
                (most ? from[j] > to[i] : from[j] < to[i]))
                to[i] = from[j];
    }
}

static void smooth_cells(const struct orl_vec3 *places, const float *from, float *to)
{
    const double within_reach = cos(smoothing_rad);
    for (size_t i = 0; i < BASE_CELLS; i++) {
        double sum = 0, count = 0;
        for (size_t j = 0; j < BASE_CELLS; j++)
            if (orl_dot(places[i], places[j]) >= within_reach) {
                sum += (double)from[j];
                count++;
            }
        to[i] = (float)(sum / count);
    }
}

static void open_base(struct tree *t)
{
    struct orl_vec3 places[BASE_CELLS];
    float eroded[BASE_CELLS], opened[BASE_CELLS];
    for (size_t i = 0; i < BASE_CELLS; i++) {
        t->low[i] = INFINITY;
        places[i] = place_within((uint32_t)i << 2 * (ORL_FIT_SQUARE_LEVELS - BASE_LEVEL),
                                 BASE_LEVEL, 0.5, 0.5);
    }
    for (size_t i = 0; i < t->n; i++) {
        float *low = &t->low[base_cell(t->leaves[i].code)];
        *low = t->leaves[i].value < *low ? t->leaves[i].value : *low;
    }
    sweep_cells(places, t->low, false, eroded);
    sweep_cells(places, eroded, true, opened);
    smooth_cells(places, opened, t->base);
}

/* Returns the broad value of a leaf, including the floor. */
static double broad_value(const struct tree *t, const struct leaf *leaf)
{
    const double base = (double)t->base[base_cell(leaf->code)], value = (double)leaf->value;
    return value <= least_narrow * base ? value : fmin(value, base);
}

static double lowest_value(const struct tree *t)
{
    double least = INFINITY;
    for (size_t i = 0; i < t->n; i++)
        least = fmin(least, broad_value(t, &t->leaves[i]));
    return fmax(0, least);
}

/* ---- Lobes ----------------------------------------------------------------------------------- */

/* Returns the sigma of a cell's lobe: sigma_of_side times the geometric mean of the cell's mean
 * side and its longest extent. Cells are elongated towards the horizon, where narrower lobes would
 * leave gaps. */
static double sigma_of(uint32_t code, unsigned level)
{
    const struct orl_vec3 across =
        orl_sub(place_within(code, level, 1, 0.5), place_within(code, level, 0, 0.5));
    const struct orl_vec3 up =
        orl_sub(place_within(code, level, 0.5, 1), place_within(code, level, 0.5, 0));
    const double side = orl_fit_cell_rad(level);
    const double most = fmax(side, fmax(orl_length(across), orl_length(up)));
    return sigma_of_side * sqrt(side * most);
}

static bool add_lobe(struct orl_fit_part *part, const struct leaf *leaf, double target, double mass)
{
    if (!orl_array_reserve(&part->lobes, &part->capacity, part->n_lobes, sizeof *part->lobes))
        return false;
    const uint32_t code = leaf->code, level = leaf->level;
    const struct orl_vec3 d = leaf->at;
    part->lobes[part->n_lobes++] = (struct orl_fit_lobe){.x = (float)d.x,
                                                         .y = (float)d.y,
                                                         .z = (float)d.z,
                                                         .mass = (float)mass,
                                                         .sigma_rad = (float)sigma_of(code, level),
                                                         .code = code,
                                                         .level = level,
                                                         .target = (float)target};
    part->mass += mass;
    return true;
}

static double light_of(const struct leaf *leaf, double value)
{
    return value * (double)leaf->z * orl_fit_cell_sr(leaf->level);
}

/* Adds the lobes of both parts. */
static bool add_lobes(const struct tree *t, struct orl_fit_shape *shape)
{
    const double least = 1e-9 * shape->total;
    bool fine = true;
    for (size_t i = 0; i < t->n && fine; i++) {
        const struct leaf *leaf = &t->leaves[i];
        const double broad = broad_value(t, leaf);
        const double masses[ORL_FIT_KINDS] = {
            [ORL_FIT_BROAD] = light_of(leaf, broad - shape->floor),
            [ORL_FIT_NARROW] = light_of(leaf, (double)leaf->value - broad)};
        for (int kind = 0; kind < ORL_FIT_KINDS && fine; kind++)
            if (masses[kind] > least)
                fine = add_lobe(&shape->parts[kind], leaf, (double)leaf->value - shape->floor,
                                masses[kind]);
    }
    return fine;
}

/* ---- Clusters -------------------------------------------------------------------------------- */

static bool add_cluster(struct orl_fit_part *part, size_t begin, size_t end)
{
    struct orl_vec3 sum = {0};
    double mass = 0, spread = 0;
    if (!orl_array_reserve(&part->clusters, &part->cluster_capacity, part->n_clusters,
                           sizeof *part->clusters))
        return false;
    for (size_t i = begin; i < end; i++) {
        struct orl_fit_lobe *lobe = &part->lobes[i];
        const struct orl_vec3 d = orl_v3((double)lobe->x, (double)lobe->y, (double)lobe->z);
        sum = orl_madd(sum, d, (double)lobe->mass);
        mass += (double)lobe->mass;
        lobe->cluster = (uint32_t)part->n_clusters;
    }
    const struct orl_vec3 middle = orl_normalize(sum);
    for (size_t i = begin; i < end; i++) {
        const struct orl_fit_lobe *lobe = &part->lobes[i];
        const struct orl_vec3 d = orl_v3((double)lobe->x, (double)lobe->y, (double)lobe->z);
        const struct orl_vec3 off = orl_sub(d, middle);
        spread += (double)lobe->mass *
                  (0.5 * orl_dot(off, off) + (double)lobe->sigma_rad * (double)lobe->sigma_rad);
    }
    part->clusters[part->n_clusters++] = (struct orl_fit_cluster){
        (float)middle.x, (float)middle.y, (float)middle.z, (float)mass, (float)sqrt(spread / mass)};
    return true;
}

/* Clusters the lobes of a cell, whose codes begin with the cell's bits. */
static bool cluster_lobes(struct orl_fit_part *part, size_t begin, size_t end, unsigned level,
                          uint64_t code)
{
    double mass = 0;
    if (begin == end)
        return true;
    for (size_t i = begin; i < end; i++)
        mass += (double)part->lobes[i].mass;
    if (end - begin == 1 || mass <= cluster_share * part->mass || level == ORL_FIT_SQUARE_LEVELS)
        return add_cluster(part, begin, end);
    const unsigned below = 2 * (ORL_FIT_SQUARE_LEVELS - level - 1);
    bool fine = true;
    for (uint64_t q = 0; q < 4 && fine; q++) {
        size_t stop = begin;
        while (stop < end && part->lobes[stop].code < code + ((q + 1) << below))
            stop++;
        fine = cluster_lobes(part, begin, stop, level + 1, code + (q << below));
        begin = stop;
    }
    return fine;
}

/* ---- The whole ------------------------------------------------------------------------------- */

static void find_peak(const struct orl_fit_rbf *centers, struct orl_fit_shape *shape)
{
    size_t top = 0;
    for (size_t i = 1; i < centers->n; i++)
        if (centers->centers[i].value > centers->centers[top].value)
            top = i;
    const double half = 0.5 * (double)centers->centers[top].value;
    struct orl_vec3 sum = {0};
    for (unsigned j = 0; j < ORL_FIT_NEIGHBOURS; j++) {
        const struct orl_fit_center *k =
            &centers->centers[centers->neighbors[top * ORL_FIT_NEIGHBOURS + j]];
        const double weight = orl_larger(0, (double)k->value - half);
        sum = orl_madd(sum, orl_v3((double)k->x, (double)k->y, (double)k->z), weight);
    }
    shape->peak = orl_normalize(sum);
    shape->peak_value = (double)centers->centers[top].value;
}

/* Returns the extrapolated light between the last rows and the surface. It would be twice this if
 * value times cosine were constant. */
static double rim_light(const struct orl_fit_rbf *k)
{
    enum { AZIMUTHS = 72 };
    double sum = 0;
    for (int i = 0; i < AZIMUTHS; i++) {
        const double phi = 2 * ORL_PI * (i + 0.5) / AZIMUTHS;
        const struct orl_vec3 d = orl_v3(cos(phi), sin(phi), 0);
        struct orl_fit_nearest found;
        orl_fit_kd_tree_find(k, d, &found);
        const double z = (double)k->centers[found.center[0]].z;
        sum += orl_fit_rbf_value(k, d) * 0.5 * z * z * 2 * ORL_PI / AZIMUTHS;
    }
    return sum;
}

/* Returns the standard error of the total from three sources: the noise of rows; the centers'
 * corrections, which are large if rows are too far apart for the features; and light at the rim,
 * which may be anything from zero to twice its estimate. */
static double error_of(const struct orl_fit_rbf *k)
{
    double sum = 0;
    for (size_t i = 0; i < k->n; i++) {
        const struct orl_fit_center *center = &k->centers[i];
        const double part = (double)center->z * orl_fit_cell_sr(center->level);
        const double off = (double)center->coefficient - (double)center->value;
        sum += part * part * (k->noise * k->noise / center->rows + off * off);
    }
    const double rim = rim_light(k) / sqrt(3);
    return sqrt(sum + rim * rim);
}

static double estimate_total(const struct orl_fit_rbf *k)
{
    double sum = 0;
    for (size_t i = 0; i < k->n; i++)
        sum += orl_larger(0, (double)k->centers[i].value) * (double)k->centers[i].z *
               orl_fit_cell_sr(k->centers[i].level);
    return sum;
}

/* Sets the limits of bright values from the darkest twentieth and the brightest center. */
static bool set_bright(struct tree *t)
{
    static const double shares[BRIGHT_LEVELS] = {0.03, 0.003};
    const size_t n = t->centers->n;
    double *values = malloc(n * sizeof *values), most = 0;
    if (!values)
        return false;
    for (size_t i = 0; i < n; i++) {
        values[i] = orl_larger(0, (double)t->centers->centers[i].value);
        most = fmax(most, values[i]);
    }
    const double dark = orl_nth_element(values, n, n / 20);
    free(values);
    for (int k = 0; k < BRIGHT_LEVELS; k++)
        t->bright[k] = dark + fmax(shares[k] * (most - dark),
                                   fmax(least_bright * dark, 4 * t->centers->noise));
    return true;
}

static bool make_shape(struct tree *t, struct orl_fit_shape *shape)
{
    t->uneven = least_uneven * estimate_total(t->centers);
    if (!set_bright(t))
        return false;
    if (!grow_leaves(t, 0, 0, (struct range){0, t->centers->n}))
        return false;
    for (size_t i = 0; i < t->n; i++)
        shape->total += light_of(&t->leaves[i], (double)t->leaves[i].value);
    open_base(t);
    shape->floor = lowest_value(t);
    if (!add_lobes(t, shape) || !orl_fit_deconvolve(shape))
        return false;
    bool fine = true;
    shape->total = ORL_PI * shape->floor; /* equal to the light that is interpolated */
    for (int kind = 0; kind < ORL_FIT_KINDS; kind++)
        shape->total += shape->parts[kind].mass;
    for (int kind = 0; kind < ORL_FIT_KINDS && fine; kind++)
        fine = cluster_lobes(&shape->parts[kind], 0, shape->parts[kind].n_lobes, 0, 0);
    return fine;
}

int orl_fit_shape_make(const struct orl_fit_rbf *centers, struct orl_vec3 in,
                       const unsigned levels[2], const atomic_bool *cancel,
                       struct orl_fit_shape *ret_shape, struct orl_error *err)
{
    struct tree *tree = calloc(1, sizeof *tree);
    struct orl_fit_shape shape = {.in = in};
    int code = 0;
    if (tree) {
        tree->centers = centers;
        tree->cancel = cancel;
        tree->bright_level = levels[0];
        tree->finest = levels[1];
    }
    if (!tree || !make_shape(tree, &shape))
        code = orl_is_cancelled(cancel) ? ORL_ERR_CANCELLED : ORL_ERR_NOMEM;
    if (tree)
        free(tree->leaves);
    free(tree);
    if (code < 0) {
        orl_fit_shape_done(&shape);
        return orl_error_set(err, code, code == ORL_ERR_CANCELLED ? "cancelled" : "out of memory");
    }
    find_peak(centers, &shape);
    shape.total_error = error_of(centers);
    *ret_shape = shape;
    return 0;
}

void orl_fit_shape_done(struct orl_fit_shape *shape)
{
    for (int kind = 0; kind < ORL_FIT_KINDS; kind++) {
        free(shape->parts[kind].lobes);
        free(shape->parts[kind].clusters);
    }
    memset(shape, 0, sizeof *shape);
}

bool orl_fit_shape_mirror(const struct orl_fit_shape *shape, unsigned mirror,
                          struct orl_fit_shape *ret_shape)
{
    const double sx = mirror & 1 ? -1 : 1, sy = mirror & 2 ? -1 : 1;
    struct orl_fit_shape copy = *shape;
    bool fine = true;
    copy.in = orl_v3(sx * copy.in.x, sy * copy.in.y, copy.in.z);
    copy.peak = orl_v3(sx * copy.peak.x, sy * copy.peak.y, copy.peak.z);
    for (int kind = 0; kind < ORL_FIT_KINDS; kind++) {
        struct orl_fit_part *part = &copy.parts[kind];
        const struct orl_fit_part *of = &shape->parts[kind];
        part->lobes = malloc((of->n_lobes + 1) * sizeof *part->lobes);
        part->clusters = malloc((of->n_clusters + 1) * sizeof *part->clusters);
        fine = fine && part->lobes && part->clusters;
        for (size_t i = 0; i < of->n_lobes && fine; i++) {
            part->lobes[i] = of->lobes[i];
            part->lobes[i].x *= (float)sx;
            part->lobes[i].y *= (float)sy;
        }
        for (size_t i = 0; i < of->n_clusters && fine; i++) {
            part->clusters[i] = of->clusters[i];
            part->clusters[i].x *= (float)sx;
            part->clusters[i].y *= (float)sy;
        }
    }
    if (!fine)
        orl_fit_shape_done(&copy);
    else
        *ret_shape = copy;
    return fine;
}
