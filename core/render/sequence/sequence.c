#include <oriel/job/sequence.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/film/apng.h"
#include "render/film/png.h"
#include "render/film/read_hdr.h"
#include "render/picture/display.h"
#include "render/sequence/contact_sheet.h"

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
