#include "render/sequence/contact_sheet.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "render/picture/display.h"

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

int orl_contact_sheet_init(struct orl_contact_sheet *sheet, const struct orl_sequence *sequence,
                           uint32_t width, uint32_t height)
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

void orl_contact_sheet_done(struct orl_contact_sheet *sheet)
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

int orl_contact_sheet_put(struct orl_contact_sheet *sheet, size_t index, const unsigned char *rgb,
                          uint32_t width, uint32_t height, const struct orl_sequence_frame *frame)
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

uint32_t orl_strip_height(uint32_t width)
{
    return (uint32_t)ceil(STRIP * unit_of(width, STRIP_ACROSS));
}

void orl_strip_draw(const struct orl_raster *raster, uint32_t top,
                    const struct orl_sequence_frame *frame)
{
    const double unit = unit_of(raster->width, STRIP_ACROSS), size = STRIP_SIZE * unit;
    const double edge = 4 * unit, room = (raster->width - 3 * edge) / 2;
    const double base = top + (STRIP + STRIP_SIZE) / 2.0 * unit;
    const double right = fmin(orl_stroke_text_width(frame->lines[1], size), room);
    write_line(raster, edge, base, room, size, frame->lines[0]);
    write_line(raster, raster->width - edge - right, base, room, size, frame->lines[1]);
}
