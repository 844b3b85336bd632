/* Tone-mapped pictures, one by one or several in a common exposure. The blur to visual acuity
 * comes first. */
#include "render/picture/display.h"

#include <stdlib.h>
#include <string.h>

#include <oriel/base/vec.h>

#include "render/film/image_files.h"

/* ---- Blur ------------------------------------------------------------------------------------ */

/* Makes a level from the finer one: means of two by two pixels, of fewer at the edges. */
static int halve_level(struct orl_blur *blur, int level)
{
    const uint32_t w = blur->levels[level - 1].width, h = blur->levels[level - 1].height;
    float(*const from)[3] = blur->levels[level - 1].pixels;
    const uint32_t width = (w + 1) / 2, height = (h + 1) / 2;
    float(*to)[3] = calloc((size_t)width * height, sizeof *to);
    blur->levels[level].width = width;
    blur->levels[level].height = height;
    blur->levels[level].pixels = to;
    if (!to)
        return ORL_ERR_NOMEM;
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            const uint32_t x0 = 2 * x, x1 = x0 + 1 < w ? x0 + 1 : x0;
            const uint32_t y0 = 2 * y, y1 = y0 + 1 < h ? y0 + 1 : y0;
            for (int c = 0; c < 3; c++)
                to[(size_t)y * width + x][c] =
                    0.25F * (from[(size_t)y0 * w + x0][c] + from[(size_t)y0 * w + x1][c] +
                             from[(size_t)y1 * w + x0][c] + from[(size_t)y1 * w + x1][c]);
        }
    return 0;
}

int orl_blur_init(struct orl_blur *blur, const struct orl_film *film, const struct orl_view *view)
{
    double across, down;
    orl_view_degrees(view, &across, &down);
    *blur = (struct orl_blur){.film = film, .pixels_a_degree = film->width / across, .n_levels = 1};
    blur->levels[0].width = film->width;
    blur->levels[0].height = film->height;
    blur->levels[0].pixels = film->pixels;
    /* The coarsest level resolves two cycles a degree, the least acuity. */
    while (exp2(blur->n_levels - 1) < blur->pixels_a_degree && blur->n_levels < ORL_ACUITY_LEVELS)
        if (halve_level(blur, blur->n_levels++) < 0)
            return ORL_ERR_NOMEM;
    return 0;
}

void orl_blur_done(struct orl_blur *blur)
{
    for (int i = 1; i < blur->n_levels; i++)
        free(blur->levels[i].pixels);
    blur->n_levels = 0;
}

/* Interpolates between the pixels of a level. */
static void read_level(const struct orl_blur *blur, int level, double x, double y, double ret[3])
{
    const uint32_t w = blur->levels[level].width, h = blur->levels[level].height;
    const double scale = exp2(-level);
    const double px = fmin(fmax(x * scale - 0.5, 0), w - 1.0);
    const double py = fmin(fmax(y * scale - 0.5, 0), h - 1.0);
    const uint32_t x0 = (uint32_t)px, x1 = x0 + 1 < w ? x0 + 1 : x0;
    const uint32_t y0 = (uint32_t)py, y1 = y0 + 1 < h ? y0 + 1 : y0;
    const double u = px - x0, v = py - y0;
    float(*const from)[3] = blur->levels[level].pixels;
    for (int c = 0; c < 3; c++) {
        const double a = (1 - u) * (double)from[(size_t)y0 * w + x0][c] +
                         u * (double)from[(size_t)y0 * w + x1][c];
        const double b = (1 - u) * (double)from[(size_t)y1 * w + x0][c] +
                         u * (double)from[(size_t)y1 * w + x1][c];
        ret[c] = (1 - v) * a + v * b;
    }
}

void orl_blur_at(const struct orl_blur *blur, const struct orl_fovea *fovea, uint32_t x, uint32_t y,
                 float ret_rgb[3])
{
    float about[3];
    double fine[3], coarse[3];
    orl_fovea_at(fovea, (x + 0.5) / blur->film->width, (y + 0.5) / blur->film->height, about);
    /* Half a cycle is the smallest visible detail. */
    const double pixels = blur->pixels_a_degree / (2 * orl_acuity(orl_luminance(about)));
    const double level = fmin(fmax(log2(pixels), 0), blur->n_levels - 1.0);
    const int low = (int)level, high = low + 1 < blur->n_levels ? low + 1 : low;
    read_level(blur, low, x + 0.5, y + 0.5, fine);
    read_level(blur, high, x + 0.5, y + 0.5, coarse);
    for (int c = 0; c < 3; c++)
        ret_rgb[c] = (float)(fine[c] + (level - low) * (coarse[c] - fine[c]));
}

/* ---- Tone mapping ---------------------------------------------------------------------------- */

/* Display value of the geometric mean of luminances, relative to white: middle gray. */
static const double middle_gray = 0.18;

/* Adds a film's logarithms for the geometric mean. */
static void add_logarithms(const struct orl_film *film, double *sum, double *lit)
{
    for (size_t i = 0; i < (size_t)film->width * film->height; i++) {
        const double y = orl_luminance(film->pixels[i]);
        if (y > 0) {
            *sum += log(y);
            *lit += 1;
        }
    }
}

static double factor_for_mean(double sum, double lit)
{
    return lit > 0 ? middle_gray / exp(sum / lit) : middle_gray;
}

/* Makes the foveal samples of the film; does nothing for other tones. */
static int make_foveal_samples(struct orl_tonemapped *tonemapped, const struct orl_film *film,
                               const struct orl_view *view, const struct orl_display *how)
{
    *tonemapped = (struct orl_tonemapped){.film = film, .how = *how};
    if (how->tone != ORL_TONE_HUMAN)
        return 0;
    int code = orl_fovea_init(&tonemapped->fovea, tonemapped->film, view);
    if (code == 0 && tonemapped->how.veil)
        code = orl_fovea_add_veiling(&tonemapped->fovea, view);
    return code;
}

int orl_tonemapped_init(struct orl_tonemapped *tonemapped, const struct orl_film *film,
                        const struct orl_view *view, const struct orl_display *how)
{
    double sum = 0, lit = 0;
    int code = make_foveal_samples(tonemapped, film, view, how);
    if (how->tone == ORL_TONE_HUMAN) {
        if (code == 0 && how->acuity)
            code = orl_blur_init(&tonemapped->blur, film, view);
        if (code == 0)
            orl_tonemap_make(&tonemapped->tonemap, film, &tonemapped->fovea);
        return code;
    }
    if (how->tone == ORL_TONE_LINEAR)
        add_logarithms(film, &sum, &lit);
    tonemapped->factor = how->tone == ORL_TONE_EXPOSURE ? how->exposure / ORL_EFFICACY_LM_PER_W
                                                        : factor_for_mean(sum, lit);
    return 0;
}

void orl_tonemapped_done(struct orl_tonemapped *tonemapped)
{
    orl_fovea_done(&tonemapped->fovea);
    orl_blur_done(&tonemapped->blur);
}

/* ---- Shared tone mapping --------------------------------------------------------------------- */

int orl_shared_tonemap_add(struct orl_shared_tonemap *shared_tonemap, const struct orl_film *film,
                           const struct orl_view *view, bool again)
{
    struct orl_tonemapped tonemapped;
    if (shared_tonemap->how.tone != ORL_TONE_HUMAN) {
        if (!again && shared_tonemap->how.tone == ORL_TONE_LINEAR)
            add_logarithms(film, &shared_tonemap->sum, &shared_tonemap->lit);
        return 0;
    }
    const int code = make_foveal_samples(&tonemapped, film, view, &shared_tonemap->how);
    if (code == 0 && again)
        orl_tonemap_histogram_add(&shared_tonemap->histogram, film, &tonemapped.fovea);
    else if (code == 0)
        orl_tonemap_histogram_extend(&shared_tonemap->histogram, film, &tonemapped.fovea);
    orl_tonemapped_done(&tonemapped);
    return code;
}

bool orl_shared_tonemap_range(struct orl_shared_tonemap *shared_tonemap)
{
    shared_tonemap->ranged = orl_tonemap_histogram_range(&shared_tonemap->histogram);
    return shared_tonemap->ranged;
}

void orl_shared_tonemap_finish(struct orl_shared_tonemap *shared_tonemap)
{
    shared_tonemap->factor = shared_tonemap->how.tone == ORL_TONE_EXPOSURE
                                 ? shared_tonemap->how.exposure / ORL_EFFICACY_LM_PER_W
                                 : factor_for_mean(shared_tonemap->sum, shared_tonemap->lit);
    shared_tonemap->tonemap = (struct orl_tonemap){.factor = shared_tonemap->factor};
    if (shared_tonemap->ranged)
        orl_tonemap_from_histogram(&shared_tonemap->tonemap, &shared_tonemap->histogram);
}

int orl_tonemapped_init_shared(struct orl_tonemapped *tonemapped, const struct orl_film *film,
                               const struct orl_view *view,
                               const struct orl_shared_tonemap *shared_tonemap)
{
    int code = make_foveal_samples(tonemapped, film, view, &shared_tonemap->how);
    if (code == 0 && shared_tonemap->how.tone == ORL_TONE_HUMAN && shared_tonemap->how.acuity)
        code = orl_blur_init(&tonemapped->blur, film, view);
    tonemapped->tonemap = shared_tonemap->tonemap;
    tonemapped->factor = shared_tonemap->factor;
    return code;
}

/* ---- Pixels ---------------------------------------------------------------------------------- */

/*
 * Desaturates colours between the luminances of purely photopic and purely scotopic vision.
 * Scotopic luminance is the paper's approximation from X, Y and Z, in Radiance's primaries; white
 * is equally bright by both.
 */
static void desaturate(float rgb[3])
{
    static const double dark = 5.62e-3, light = 5.62;
    static const double scotopic[3] = {0.062, 0.608, 0.330};
    const double y = orl_luminance(rgb);
    const double color = fmin(fmax((y - dark) / (light - dark), 0), 1);
    double gray = 0;
    for (int c = 0; c < 3; c++)
        gray += scotopic[c] * (double)rgb[c];
    for (int c = 0; c < 3; c++)
        rgb[c] = (float)(color * (double)rgb[c] + (1 - color) * gray);
}

/* Moves a colour of that brightness, at most 1, into the display's gamut. */
static void clip_to_gamut(float rgb[3], double brightness)
{
    const double most = fmax((double)rgb[0], fmax((double)rgb[1], (double)rgb[2]));
    if (brightness >= 1)
        rgb[0] = rgb[1] = rgb[2] = 1;
    else if (most > 1)
        for (int c = 0; c < 3; c++)
            rgb[c] = (float)(brightness + (1 - brightness) / (most - brightness) *
                                              ((double)rgb[c] - brightness));
}

void orl_tonemapped_pixel(const struct orl_tonemapped *tonemapped, uint32_t x, uint32_t y,
                          float ret_rgb[3])
{
    const struct orl_film *film = tonemapped->film;
    if (tonemapped->how.acuity)
        orl_blur_at(&tonemapped->blur, &tonemapped->fovea, x, y, ret_rgb);
    else
        memcpy(ret_rgb, film->pixels[(size_t)y * film->width + x], 3 * sizeof *ret_rgb);
    if (tonemapped->how.veil)
        orl_fovea_mix_veiling(&tonemapped->fovea, (x + 0.5) / film->width, (y + 0.5) / film->height,
                              ret_rgb);
    if (tonemapped->how.color_loss)
        desaturate(ret_rgb);
    const double luminance = orl_luminance(ret_rgb);
    const double bright = tonemapped->how.tone == ORL_TONE_HUMAN
                              ? orl_tonemap_apply(&tonemapped->tonemap, luminance)
                              : tonemapped->factor * luminance;
    const double scale = luminance > 0 ? bright * ORL_EFFICACY_LM_PER_W / luminance : 0;
    for (int c = 0; c < 3; c++)
        ret_rgb[c] = luminance > 0 ? (float)(fmax((double)ret_rgb[c], 0) * scale) : 0;
    clip_to_gamut(ret_rgb, bright);
}

/* ---- Files ----------------------------------------------------------------------------------- */

uint16_t orl_srgb(double linear, uint16_t white)
{
    const double c = fmin(fmax(linear, 0), 1);
    const double s = c <= 0.0031308 ? 12.92 * c : 1.055 * pow(c, 1 / 2.4) - 0.055;
    return (uint16_t)lrint(white * s);
}

/* Table of the 8-bit curve: the least linear value of each byte, and the byte at every 1/PARTS,
 * from which the search proceeds upwards. */
enum { PARTS = 1024 };
struct curve {
    double least[257];
    unsigned char byte[PARTS + 1];
};

static void make_curve(struct curve *curve)
{
    curve->least[0] = 0;
    curve->least[256] = INFINITY;
    for (int i = 1; i < 256; i++) {
        const double s = (i - 0.5) / 255;
        curve->least[i] = s <= 0.0404482362771082 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4);
    }
    for (int part = 0, byte = 0; part <= PARTS; part++) {
        while (curve->least[byte + 1] <= (double)part / PARTS)
            byte++;
        curve->byte[part] = (unsigned char)byte;
    }
}

static unsigned char to_byte(const struct curve *curve, float linear)
{
    const double c = fmin(fmax((double)linear, 0), 1);
    unsigned char byte = curve->byte[(int)(c * PARTS)];
    while (curve->least[byte + 1] <= c)
        byte++;
    return byte;
}

void orl_tonemapped_bytes(const struct orl_tonemapped *tonemapped, unsigned char *ret_rgb)
{
    struct curve curve;
    make_curve(&curve);
    for (uint32_t y = 0; y < tonemapped->film->height; y++)
        for (uint32_t x = 0; x < tonemapped->film->width; x++) {
            float rgb[3];
            orl_tonemapped_pixel(tonemapped, x, y, rgb);
            for (int c = 0; c < 3; c++)
                *ret_rgb++ = to_byte(&curve, rgb[c]);
        }
}

/* Writes 16-bit words, the more significant byte first as in PNG. */
static void to_words(const struct orl_tonemapped *tonemapped, unsigned char *ret_rgb)
{
    for (uint32_t y = 0; y < tonemapped->film->height; y++)
        for (uint32_t x = 0; x < tonemapped->film->width; x++) {
            float rgb[3];
            orl_tonemapped_pixel(tonemapped, x, y, rgb);
            for (int c = 0; c < 3; c++) {
                const uint16_t word = orl_srgb(rgb[c], UINT16_MAX);
                *ret_rgb++ = (unsigned char)(word >> 8);
                *ret_rgb++ = (unsigned char)word;
            }
        }
}

int orl_tonemapped_write_png(const struct orl_tonemapped *tonemapped, int bits, const char *path,
                             struct orl_error *err)
{
    const uint32_t width = tonemapped->film->width, height = tonemapped->film->height;
    unsigned char *rgb = malloc((size_t)bits / 8 * 3 * width * height);
    if (!rgb)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory writing an image");
    if (bits == 16)
        to_words(tonemapped, rgb);
    else
        orl_tonemapped_bytes(tonemapped, rgb);
    const int code = bits == 16 ? orl_png_write_16(path, width, height, rgb, err)
                                : orl_png_write(path, width, height, rgb, err);
    free(rgb);
    return code;
}
