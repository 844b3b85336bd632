/* Correction of the blur of a shape's Gaussians. */
#include <stdlib.h>
#include <string.h>

#include "base/multiversion.h"
#include "bsdf/fit/scan/scan_light.h"

enum { DECONVOLUTIONS = 6, BLOCK = 64 };

/* Gaussians of all lobes with the kernel of rasters (fit.h), in blocks of lobes that are close. */
struct block {
    float x, y, z, radius; /* bounding sphere of the lobes' centres */
    float reach;           /* kernel radius of the widest lobe */
};

struct lobes {
    struct orl_fit_shape *shape;
    size_t n, n_blocks;
    float *x, *y, *z, *narrow, *height; /* owned, in one allocation */
    struct block *blocks;               /* owned */
};

static double slant_of(const struct orl_fit_lobe *lobe)
{
    const double z = (double)lobe->z, sigma = (double)lobe->sigma_rad;
    return sqrt(z * z + 2 / ORL_PI * sigma * sigma);
}

/* Returns the peak value of a lobe's Gaussian, 1/sr. */
static float height_of(const struct orl_fit_lobe *lobe)
{
    const double sigma = (double)lobe->sigma_rad;
    return (float)((double)lobe->mass / (slant_of(lobe) * 12 * ORL_PI / 5 * sigma * sigma));
}

static struct orl_fit_lobe *lobe_of(const struct lobes *l, size_t i)
{
    const size_t broad = l->shape->parts[ORL_FIT_BROAD].n_lobes;
    return i < broad ? &l->shape->parts[ORL_FIT_BROAD].lobes[i]
                     : &l->shape->parts[ORL_FIT_NARROW].lobes[i - broad];
}

static void set_block(struct lobes *l, size_t b)
{
    const size_t first = b * BLOCK, end = first + BLOCK < l->n ? first + BLOCK : l->n;
    struct orl_vec3 sum = {0};
    double radius = 0, reach = 0;
    for (size_t i = first; i < end; i++)
        sum = orl_add(sum, orl_v3((double)l->x[i], (double)l->y[i], (double)l->z[i]));
    sum = orl_scale(sum, 1 / (double)(end - first));
    for (size_t i = first; i < end; i++) {
        const struct orl_vec3 d = orl_v3((double)l->x[i], (double)l->y[i], (double)l->z[i]);
        radius = fmax(radius, orl_length(orl_sub(d, sum)));
        reach = fmax(reach, sqrt(1 / (double)l->narrow[i]));
    }
    l->blocks[b] = (struct block){(float)sum.x, (float)sum.y, (float)sum.z, (float)(radius * 1.001),
                                  (float)reach};
}

static bool make_lobes(struct orl_fit_shape *shape, struct lobes *l)
{
    l->shape = shape;
    l->n = shape->parts[ORL_FIT_BROAD].n_lobes + shape->parts[ORL_FIT_NARROW].n_lobes;
    l->n_blocks = (l->n + BLOCK - 1) / BLOCK;
    const size_t padded_count = l->n_blocks * BLOCK;
    l->x = calloc(5 * padded_count + 1, sizeof *l->x);
    l->blocks = calloc(l->n_blocks + 1, sizeof *l->blocks);
    if (!l->x || !l->blocks)
        return false;
    l->y = l->x + padded_count;
    l->z = l->y + padded_count;
    l->narrow = l->z + padded_count;
    l->height = l->narrow + padded_count;
    for (size_t i = 0; i < l->n; i++) {
        const struct orl_fit_lobe *lobe = lobe_of(l, i);
        l->x[i] = lobe->x;
        l->y[i] = lobe->y;
        l->z[i] = lobe->z;
        l->narrow[i] = 1 / (12 * lobe->sigma_rad * lobe->sigma_rad);
        l->height[i] = height_of(lobe);
    }
    for (size_t b = 0; b < l->n_blocks; b++)
        set_block(l, b);
    return true;
}

/* Returns the sum of a block's lobes at a place; padding after the last lobe has height 0. */
ORL_FOR_WIDE_VECTORS
static float height_by(const struct lobes *l, size_t block, float x, float y, float z)
{
    const size_t first = block * BLOCK;
    const float *lx = l->x + first, *ly = l->y + first, *lz = l->z + first;
    const float *narrow = l->narrow + first, *height = l->height + first;
    float sums[8] = {0};
    for (size_t j = 0; j < BLOCK; j += 8)
        for (size_t k = 0; k < 8; k++) {
            const float dx = lx[j + k] - x, dy = ly[j + k] - y, dz = lz[j + k] - z;
            const float up = lz[j + k] + z, flat = dx * dx + dy * dy;
            const float q = 1 - (flat + dz * dz) * narrow[j + k], p = q > 0 ? q : 0;
            const float fq = 1 - (flat + up * up) * narrow[j + k], fp = fq > 0 ? fq : 0;
            sums[k] += height[j + k] * ((p * p) * (p * p) + (fp * fp) * (fp * fp));
        }
    return ((sums[0] + sums[4]) + (sums[1] + sums[5])) +
           ((sums[2] + sums[6]) + (sums[3] + sums[7]));
}

static float height_at(const struct lobes *l, size_t i)
{
    const float x = l->x[i], y = l->y[i], z = l->z[i];
    float sum = 0;
    for (size_t b = 0; b < l->n_blocks; b++) {
        const struct block *block = &l->blocks[b];
        const float dx = block->x - x, dy = block->y - y, dz = block->z - z, up = block->z + z;
        const float flat = dx * dx + dy * dy, most = block->radius + block->reach;
        if (flat + dz * dz < most * most || flat + up * up < most * most)
            sum += height_by(l, b, x, y, z);
    }
    return sum;
}

bool orl_fit_deconvolve(struct orl_fit_shape *shape)
{
    struct lobes l = {0};
    double was = 0, is = 0;
    bool fine = make_lobes(shape, &l);
    for (int round = 0; round < DECONVOLUTIONS && fine; round++) {
        for (size_t i = 0; i < l.n; i++) {
            struct orl_fit_lobe *lobe = lobe_of(&l, i);
            const float height = height_at(&l, i);
            lobe->mass *= height > 0 ? lobe->target / height : 1;
        }
        for (size_t i = 0; i < l.n; i++)
            l.height[i] = height_of(lobe_of(&l, i));
    }
    for (int kind = 0; kind < ORL_FIT_KINDS; kind++) {
        was += shape->parts[kind].mass;
        shape->parts[kind].mass = 0;
    }
    for (size_t i = 0; i < l.n && fine; i++)
        is += (double)lobe_of(&l, i)->mass;
    for (size_t i = 0; i < l.n && fine && is > 0; i++) {
        struct orl_fit_lobe *lobe = lobe_of(&l, i);
        lobe->mass = (float)((double)lobe->mass * was / is);
        shape->parts[i >= shape->parts[ORL_FIT_BROAD].n_lobes].mass += (double)lobe->mass;
    }
    free(l.x);
    free(l.blocks);
    return fine;
}
