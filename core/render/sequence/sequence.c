/* Draws a view under several skies for comparison (oriel/job/picture.h): pictures in one exposure,
 * a contact sheet, and an animation. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>
#include <oriel/job/picture.h>

#include "base/text/stroke_font.h"
#include "render/film/image_files.h"
#include "render/picture/display.h"

/* ---- Contact sheet --------------------------------------------------------------------------- */

/*
 * A contact sheet: pictures of one size side by side under a title, each with lines of text below.
 *
 * Coordinates are pixels from the upper left. Pictures are reduced by averages over the area of a
 * pixel, in linear light. Letters scale with the pictures.
 */
struct orl_contact_sheet {
    struct orl_raster raster; /* its pixels are owned */
    uint32_t columns, rows;
    uint32_t width, height;  /* size of a picture on the sheet */
    uint32_t step_x, step_y; /* distance from one to the next */
    uint32_t left, top;      /* position of the first */
    double unit;             /* pixels per unit of the letters */
    double linear[256];      /* linear value of each sRGB byte */
};

/* Sizes in units. A picture is UNITS_ACROSS units wide; a unit is at least a pixel. */
enum { UNITS_ACROSS = 240, USUAL_WIDTH = 240, STRIP_ACROSS = 400 };
enum { MARGIN = 14, TITLE = 30, GAP = 12, LINE = 14, TITLE_SIZE = 11, TEXT_SIZE = 8 };
enum { STRIP = 20, STRIP_SIZE = 9 };

static const unsigned char ink[3] = {26, 26, 26};

static double unit_of(double width, double across)
{
    return fmax(1, width / across);
}

/* ---- Layout ---------------------------------------------------------------------------------- */

/* Returns the number of columns for a sheet that is about square. */
static uint32_t columns_for(const struct orl_contact_sheet *sheet, size_t count)
{
    const double cell = (double)sheet->step_y / sheet->step_x;
    const double columns = ceil(sqrt((double)count * cell));
    return (uint32_t)fmin(fmax(columns, 1), (double)count);
}

static void lay_out(struct orl_contact_sheet *sheet, const struct orl_sequence *sequence,
                    uint32_t picture_width, uint32_t width, uint32_t height)
{
    const double unit = unit_of(picture_width, UNITS_ACROSS);
    const uint32_t count = (uint32_t)sequence->n_frames, asked = sequence->how->columns;
    sheet->unit = unit;
    sheet->width = picture_width;
    sheet->height = (uint32_t)fmax(round((double)height * picture_width / width), 1);
    sheet->left = (uint32_t)lrint(MARGIN * unit);
    sheet->top = (uint32_t)lrint((MARGIN + TITLE) * unit);
    sheet->step_x = picture_width + (uint32_t)lrint(GAP * unit);
    sheet->step_y = sheet->height + (uint32_t)lrint((GAP + ORL_SEQUENCE_LINES * LINE) * unit);
    sheet->columns = asked == 0 ? columns_for(sheet, count) : asked < count ? asked : count;
    sheet->rows = (count + sheet->columns - 1) / sheet->columns;
    sheet->raster.width =
        2 * sheet->left + sheet->columns * sheet->step_x - (sheet->step_x - picture_width);
    sheet->raster.height = sheet->top + sheet->rows * sheet->step_y;
}

static bool is_too_large(const struct orl_contact_sheet *sheet)
{
    return sheet->raster.width > ORL_LIMIT_IMAGE_SIDE ||
           sheet->raster.height > ORL_LIMIT_IMAGE_SIDE ||
           (uint64_t)sheet->raster.width * sheet->raster.height > ORL_LIMIT_IMAGE_PIXELS;
}

/* Draws a text no wider than that; y: its baseline. */
static void write_line(const struct orl_raster *raster, double x, double y, double width,
                       double size, const char *text)
{
    struct orl_pen pen = {.size = size};
    const double needed = orl_stroke_text_width(text, size);
    memcpy(pen.rgb, ink, sizeof ink);
    if (needed > width)
        pen.size *= width / needed;
    orl_stroke_text_draw(raster, &pen, x, y, text);
}

/* Makes a white sheet with the title. width, height: size of the original pictures. Returns 0 or
 * ORL_ERR_NOMEM; call orl_contact_sheet_done in either case. */
static int orl_contact_sheet_init(struct orl_contact_sheet *sheet,
                                  const struct orl_sequence *sequence, uint32_t width,
                                  uint32_t height)
{
    const uint32_t asked = sequence->how->width_px ? sequence->how->width_px : USUAL_WIDTH;
    uint32_t across = asked < width ? asked : width;
    *sheet = (struct orl_contact_sheet){.columns = 0};
    lay_out(sheet, sequence, across, width, height);
    while (is_too_large(sheet) && across > 1) {
        across = across * 3 / 4;
        lay_out(sheet, sequence, across, width, height);
    }
    for (int i = 0; i < 256; i++) {
        const double s = i / 255.0;
        sheet->linear[i] = s <= 0.04045 ? s / 12.92 : pow((s + 0.055) / 1.055, 2.4);
    }
    const size_t bytes = 3 * (size_t)sheet->raster.width * sheet->raster.height;
    sheet->raster.rgb = malloc(bytes);
    if (!sheet->raster.rgb)
        return ORL_ERR_NOMEM;
    memset(sheet->raster.rgb, 0xff, bytes);
    if (sequence->title)
        write_line(&sheet->raster, sheet->left, (MARGIN + TITLE_SIZE) * sheet->unit,
                   sheet->raster.width - 2.0 * sheet->left, TITLE_SIZE * sheet->unit,
                   sequence->title);
    return 0;
}

static void orl_contact_sheet_done(struct orl_contact_sheet *sheet)
{
    free(sheet->raster.rgb);
    sheet->raster.rgb = NULL;
}

/* ---- Reduced pictures ------------------------------------------------------------------------ */

/* Adds a row of the picture to the sums of the reduced row's pixels. */
static void add_row(const struct orl_contact_sheet *sheet, const unsigned char *row, uint32_t width,
                    double weight, double *sums)
{
    const double step = (double)width / sheet->width;
    for (uint32_t x = 0; x < sheet->width; x++) {
        const double from = x * step, to = fmin((x + 1) * step, width);
        for (uint32_t u = (uint32_t)from; u < to; u++) {
            const double share = (fmin(u + 1, to) - fmax(u, from)) / step * weight;
            for (int c = 0; c < 3; c++)
                sums[3 * (size_t)x + (size_t)c] +=
                    share * sheet->linear[row[3 * (size_t)u + (size_t)c]];
        }
    }
}

static void put_row(const struct orl_contact_sheet *sheet, const double *sums, unsigned char *out)
{
    for (size_t i = 0; i < 3 * (size_t)sheet->width; i++)
        out[i] = (unsigned char)orl_srgb(sums[i], 255);
}

static unsigned char *place_at(const struct orl_contact_sheet *sheet, uint32_t x, uint32_t y)
{
    return sheet->raster.rgb + 3 * ((size_t)y * sheet->raster.width + x);
}

/* Draws a picture, three bytes a pixel, at its position, with its texts. Returns 0 or
 * ORL_ERR_NOMEM. */
static int orl_contact_sheet_put(struct orl_contact_sheet *sheet, size_t index,
                                 const unsigned char *rgb, uint32_t width, uint32_t height,
                                 const struct orl_sequence_frame *frame)
{
    const uint32_t left = sheet->left + (uint32_t)(index % sheet->columns) * sheet->step_x;
    const uint32_t top = sheet->top + (uint32_t)(index / sheet->columns) * sheet->step_y;
    const double step = (double)height / sheet->height;
    const size_t bytes = 3 * (size_t)sheet->width * sizeof(double);
    double *sums = malloc(bytes);
    if (!sums)
        return ORL_ERR_NOMEM;
    for (uint32_t y = 0; y < sheet->height; y++) {
        const double from = y * step, to = fmin((y + 1) * step, height);
        memset(sums, 0, bytes);
        for (uint32_t v = (uint32_t)from; v < to; v++)
            add_row(sheet, rgb + 3 * (size_t)v * width, width,
                    (fmin(v + 1, to) - fmax(v, from)) / step, sums);
        put_row(sheet, sums, place_at(sheet, left, top + y));
    }
    free(sums);
    for (int i = 0; i < ORL_SEQUENCE_LINES; i++)
        write_line(&sheet->raster, left, top + sheet->height + (LINE * (i + 1) - 2) * sheet->unit,
                   sheet->width, TEXT_SIZE * sheet->unit, frame->lines[i]);
    return 0;
}

/* ---- Strip ----------------------------------------------------------------------------------- */

/* Returns the height of the strip of text below a single picture of that width. */
static uint32_t orl_strip_height(uint32_t width)
{
    return (uint32_t)ceil(STRIP * unit_of(width, STRIP_ACROSS));
}

/* Draws the strip's text from row `top` on: both lines side by side, as large as they fit. */
static void orl_strip_draw(const struct orl_raster *raster, uint32_t top,
                           const struct orl_sequence_frame *frame)
{
    const double unit = unit_of(raster->width, STRIP_ACROSS), size = STRIP_SIZE * unit;
    const double edge = 4 * unit, room = (raster->width - 3 * edge) / 2;
    const double base = top + (STRIP + STRIP_SIZE) / 2.0 * unit;
    const double right = fmin(orl_stroke_text_width(frame->lines[1], size), room);
    write_line(raster, edge, base, room, size, frame->lines[0]);
    write_line(raster, raster->width - edge - right, base, room, size, frame->lines[1]);
}

/* ---- Passes over the pictures ---------------------------------------------------------------- */

static const double usual_frame_s = 0.5;

/* State of a pass over all pictures. */
struct passage {
    const struct orl_sequence *sequence;
    uint32_t width, height; /* size of the first picture */
    struct orl_shared_tonemap shared_tonemap;
    struct orl_contact_sheet sheet;
    struct orl_apng *animation;
    struct orl_raster frame; /* a picture with its strip; its pixels are owned */
    size_t brightest;
    double most; /* light of the brightest picture: sum of its luminances; 0: all are black */
    bool begins_black;
};

typedef int picture_step(struct passage *p, size_t index, const struct orl_hdr_picture *picture,
                         struct orl_error *err);

static int check_size(struct passage *p, const struct orl_hdr_picture *picture, const char *name,
                      struct orl_error *err)
{
    if (p->width == 0) {
        p->width = picture->film.width;
        p->height = picture->film.height;
    }
    if (picture->film.width == p->width && picture->film.height == p->height)
        return 0;
    return orl_error_set(err, ORL_ERR_RANGE, "'%s' has %u x %u pixels, the first picture %u x %u",
                         name, picture->film.width, picture->film.height, p->width, p->height);
}

static int process_picture(struct passage *p, size_t index, picture_step *step,
                           struct orl_error *err)
{
    const struct orl_files *files = p->sequence->files;
    const char *name = p->sequence->frames[index].picture;
    struct orl_hdr_picture picture = {.has_view = false};
    struct orl_file file;
    int code = files->open(files->ctx, name, &file, err);
    if (code < 0)
        return code;
    code = orl_hdr_read(name, file.data, file.size, &picture, err);
    files->close(files->ctx, &file);
    if (code == 0 && !picture.has_view)
        code = orl_view_parse("", &picture.view, err);
    if (code == 0)
        code = check_size(p, &picture, name, err);
    if (code == 0)
        code = step(p, index, &picture, err);
    orl_hdr_done(&picture);
    return code;
}

static int process_pictures(struct passage *p, picture_step *step, struct orl_error *err)
{
    int code = 0;
    for (size_t i = 0; i < p->sequence->n_frames && code == 0; i++) {
        const atomic_bool *cancel = p->sequence->cancel;
        code = cancel && atomic_load(cancel)
                   ? orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while drawing a sequence")
                   : process_picture(p, i, step, err);
    }
    return code;
}

/* ---- The common exposure --------------------------------------------------------------------- */

static int memory_error(int code, struct orl_error *err)
{
    return code < 0 ? orl_error_set(err, code, "out of memory drawing a sequence") : 0;
}

static double light_of(const struct orl_film *film)
{
    double sum = 0;
    for (size_t i = 0; i < (size_t)film->width * film->height; i++)
        sum += fmax(orl_luminance(film->pixels[i]), 0);
    return sum;
}

static int measure_picture(struct passage *p, size_t index, const struct orl_hdr_picture *picture,
                           struct orl_error *err)
{
    const double light = light_of(&picture->film);
    if (light > p->most) {
        p->most = light;
        p->brightest = index;
    }
    p->begins_black |= index == 0 && !(light > 0);
    return memory_error(
        orl_shared_tonemap_add(&p->shared_tonemap, &picture->film, &picture->view, false), err);
}

static int count_picture(struct passage *p, size_t index, const struct orl_hdr_picture *picture,
                         struct orl_error *err)
{
    (void)index;
    return memory_error(
        orl_shared_tonemap_add(&p->shared_tonemap, &picture->film, &picture->view, true), err);
}

static int find_exposure(struct passage *p, struct orl_error *err)
{
    int code = process_pictures(p, measure_picture, err);
    if (code == 0 && orl_shared_tonemap_range(&p->shared_tonemap))
        code = process_pictures(p, count_picture, err);
    orl_shared_tonemap_finish(&p->shared_tonemap);
    return code;
}

/* ---- Pictures -------------------------------------------------------------------------------- */

/* Tone-maps the picture, without its strip. */
static int tone_map_picture(struct passage *p, const struct orl_hdr_picture *picture,
                            struct orl_error *err)
{
    struct orl_tonemapped tonemapped;
    const int code = memory_error(
        orl_tonemapped_init_shared(&tonemapped, &picture->film, &picture->view, &p->shared_tonemap),
        err);
    if (code == 0)
        orl_tonemapped_bytes(&tonemapped, p->frame.rgb);
    orl_tonemapped_done(&tonemapped);
    return code;
}

static void draw_strip(struct passage *p, size_t index)
{
    const size_t bytes = 3 * (size_t)p->width * p->height;
    memset(p->frame.rgb + bytes, 0xff, 3 * (size_t)p->width * (p->frame.height - p->height));
    orl_strip_draw(&p->frame, p->height, &p->sequence->frames[index]);
}

static int write_frame(struct passage *p, size_t index, const struct orl_hdr_picture *picture,
                       struct orl_error *err)
{
    const struct orl_sequence_frame *frame = &p->sequence->frames[index];
    int code = tone_map_picture(p, picture, err);
    if (code == 0)
        code = orl_png_write(frame->shown, p->width, p->height, p->frame.rgb, err);
    if (code == 0)
        code = memory_error(
            orl_contact_sheet_put(&p->sheet, index, p->frame.rgb, p->width, p->height, frame), err);
    if (code == 0) {
        draw_strip(p, index);
        code = orl_apng_add(p->animation, p->frame.rgb, err);
    }
    return code;
}

static int write_poster(struct passage *p, size_t index, const struct orl_hdr_picture *picture,
                        struct orl_error *err)
{
    const int code = tone_map_picture(p, picture, err);
    if (code < 0)
        return code;
    draw_strip(p, index);
    return orl_apng_put_poster(p->animation, p->frame.rgb, err);
}

static int open_all(struct passage *p, struct orl_error *err)
{
    const struct orl_sequence *s = p->sequence;
    const double frame_s = s->how->frame_s > 0 ? s->how->frame_s : usual_frame_s;
    int code = memory_error(orl_contact_sheet_init(&p->sheet, s, p->width, p->height), err);
    p->frame.width = p->width;
    p->frame.height = p->height + orl_strip_height(p->width);
    p->frame.rgb = malloc(3 * (size_t)p->frame.width * p->frame.height);
    if (code == 0 && !p->frame.rgb)
        code = memory_error(ORL_ERR_NOMEM, err);
    return code < 0 ? code
                    : orl_apng_open(s->animation, p->frame.width, p->frame.height,
                                    (uint32_t)s->n_frames, frame_s, &p->animation, err);
}

int orl_sequence_write(const struct orl_sequence *sequence, struct orl_error *err)
{
    struct passage p = {.sequence = sequence, .shared_tonemap = {.how = *sequence->display}};
    int code = find_exposure(&p, err);
    if (code == 0)
        code = open_all(&p, err);
    if (code == 0 && p.begins_black && p.most > 0)
        code = process_picture(&p, p.brightest, write_poster, err);
    if (code == 0)
        code = process_pictures(&p, write_frame, err);
    code = orl_apng_close(p.animation, code, err);
    if (code == 0)
        code = orl_png_write(sequence->sheet, p.sheet.raster.width, p.sheet.raster.height,
                             p.sheet.raster.rgb, err);
    orl_contact_sheet_done(&p.sheet);
    free(p.frame.rgb);
    return code;
}
