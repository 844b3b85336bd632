#include "render/film/image_files.h"

#include <OpenEXR/openexr.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/vec.h>

#include "base/io/out_file.h"

enum { BLOCK_LINES = 16 }; /* lines that are compressed together */

struct writer {
    const struct orl_film *film;
    const struct orl_view *view;
    struct orl_out_file *file;
    bool halves;
    float *lines; /* clamped values of a block's lines; owned */
};

/* Ignores the library's messages, which are about files; its return codes give the error. */
static void ignore_message(exr_const_context_t context, exr_result_t code, const char *message)
{
    (void)context;
    (void)code;
    (void)message;
}

static int64_t write_bytes(exr_const_context_t context, void *user, const void *bytes,
                           uint64_t size, uint64_t offset, exr_stream_error_func_ptr_t tell)
{
    const struct writer *writer = user;
    FILE *stream = writer->file->stream;
    (void)context;
    (void)tell;
    if (fseeko(stream, (off_t)offset, SEEK_SET) != 0 || fwrite(bytes, 1, size, stream) != size)
        return -1;
    return (int64_t)size;
}

/* ---- Header ---------------------------------------------------------------------------------- */

static exr_result_t add_channels(exr_context_t exr, bool halves)
{
    static const char *const names[] = {"B", "G", "R"};
    exr_result_t rc = EXR_ERR_SUCCESS;
    for (int c = 0; c < 3 && rc == EXR_ERR_SUCCESS; c++)
        rc = exr_add_channel(exr, 0, names[c], halves ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT,
                             EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    return rc;
}

/* Sets worldToCamera. Its rows are the images of x, y, z and of the origin. */
static exr_result_t add_camera(exr_context_t exr, const struct orl_view *view)
{
    const struct orl_vec3 right = orl_normalize(view->h), up = orl_normalize(view->v);
    const struct orl_vec3 back = orl_scale(view->direction, -1), eye = view->point;
    const exr_attr_m44f_t matrix = {.m = {(float)right.x, (float)up.x, (float)back.x, 0,
                                          (float)right.y, (float)up.y, (float)back.y, 0,
                                          (float)right.z, (float)up.z, (float)back.z, 0,
                                          (float)-orl_dot(eye, right), (float)-orl_dot(eye, up),
                                          (float)-orl_dot(eye, back), 1}};
    return exr_attr_set_m44f(exr, 0, "worldToCamera", &matrix);
}

static exr_result_t add_attributes(exr_context_t exr, const struct writer *w)
{
    static const exr_attr_chromaticities_t radiance = {0.640F, 0.330F, 0.290F,   0.600F,
                                                       0.150F, 0.060F, 1 / 3.0F, 1 / 3.0F};
    const double aspect = orl_view_pixel_aspect(w->view, w->film->width, w->film->height);
    const exr_attr_v2f_t middle = {.x = 0, .y = 0};
    char text[1024];
    orl_view_format(w->view, text, sizeof text);
    exr_result_t rc = exr_attr_set_chromaticities(exr, 0, "chromaticities", &radiance);
    if (rc == EXR_ERR_SUCCESS)
        rc = exr_attr_set_float(exr, 0, "whiteLuminance", (float)ORL_EFFICACY_LM_PER_W);
    if (rc == EXR_ERR_SUCCESS)
        rc = add_camera(exr, w->view);
    if (rc == EXR_ERR_SUCCESS)
        /* Our aspect is a pixel's height over its width, OpenEXR's the inverse. */
        rc = exr_set_pixel_aspect_ratio(exr, 0, (float)(1 / aspect));
    if (rc == EXR_ERR_SUCCESS)
        rc = exr_set_screen_window_center(exr, 0, &middle);
    if (rc == EXR_ERR_SUCCESS)
        rc = exr_set_screen_window_width(exr, 0,
                                         w->view->type == 'v' ? (float)orl_length(w->view->h) : 1);
    if (rc == EXR_ERR_SUCCESS)
        rc = exr_attr_set_string(exr, 0, "software", "Oriel");
    if (rc == EXR_ERR_SUCCESS)
        rc = exr_attr_set_string(exr, 0, "radianceView", text);
    return rc;
}

static exr_result_t write_header(exr_context_t exr, const struct writer *w)
{
    int part;
    exr_result_t rc = exr_add_part(exr, NULL, EXR_STORAGE_SCANLINE, &part);
    if (rc == EXR_ERR_SUCCESS)
        rc = exr_initialize_required_attr_simple(exr, 0, (int32_t)w->film->width,
                                                 (int32_t)w->film->height, EXR_COMPRESSION_ZIP);
    if (rc == EXR_ERR_SUCCESS)
        rc = exr_set_longname_support(exr, 0);
    if (rc == EXR_ERR_SUCCESS)
        rc = add_channels(exr, w->halves);
    if (rc == EXR_ERR_SUCCESS)
        rc = add_attributes(exr, w);
    return rc == EXR_ERR_SUCCESS ? exr_write_header(exr) : rc;
}

/* ---- Pixels ---------------------------------------------------------------------------------- */

/* Fills the block's lines, red first. */
static void fill_lines(const struct writer *w, uint32_t first, uint32_t count)
{
    const float *from = w->film->pixels[(size_t)first * w->film->width];
    for (size_t i = 0; i < 3 * (size_t)count * w->film->width; i++) {
        const float most = w->halves ? ORL_EXR_LARGEST_HALF : INFINITY;
        w->lines[i] = from[i] > most ? most : from[i];
    }
}

static exr_result_t encode_block(exr_context_t exr, const struct writer *w,
                                 exr_encode_pipeline_t *pipeline)
{
    for (int c = 0; c < pipeline->channel_count; c++) {
        exr_coding_channel_info_t *channel = &pipeline->channels[c];
        channel->user_bytes_per_element = (int16_t)sizeof(float);
        channel->user_data_type = EXR_PIXEL_FLOAT;
        channel->user_pixel_stride = 3 * (int32_t)sizeof(float);
        channel->user_line_stride = (int32_t)(3 * sizeof(float) * w->film->width);
        channel->encode_from_ptr =
            (const uint8_t *)(w->lines + 2 - c); /* B, G, R in order of names */
    }
    exr_result_t rc = exr_encoding_choose_default_routines(exr, 0, pipeline);
    return rc == EXR_ERR_SUCCESS ? exr_encoding_run(exr, 0, pipeline) : rc;
}

static exr_result_t write_lines(exr_context_t exr, const struct writer *w)
{
    exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
    exr_result_t rc = EXR_ERR_SUCCESS;
    for (uint32_t y = 0; y < w->film->height && rc == EXR_ERR_SUCCESS; y += BLOCK_LINES) {
        const uint32_t left = w->film->height - y;
        exr_chunk_info_t chunk = {0};
        rc = exr_write_scanline_chunk_info(exr, 0, (int)y, &chunk);
        if (rc == EXR_ERR_SUCCESS)
            rc = y == 0 ? exr_encoding_initialize(exr, 0, &chunk, &pipeline)
                        : exr_encoding_update(exr, 0, &chunk, &pipeline);
        fill_lines(w, y, left < BLOCK_LINES ? left : BLOCK_LINES);
        if (rc == EXR_ERR_SUCCESS)
            rc = encode_block(exr, w, &pipeline);
    }
    const exr_result_t end = exr_encoding_destroy(exr, &pipeline);
    return rc == EXR_ERR_SUCCESS ? end : rc;
}

static exr_result_t write_file(struct writer *w)
{
    exr_context_initializer_t how = EXR_DEFAULT_CONTEXT_INITIALIZER;
    exr_context_t exr;
    how.error_handler_fn = ignore_message;
    how.user_data = w;
    how.write_fn = write_bytes;
    exr_result_t rc = exr_start_write(&exr, w->file->part, EXR_WRITE_FILE_DIRECTLY, &how);
    if (rc != EXR_ERR_SUCCESS)
        return rc;
    rc = write_header(exr, w);
    if (rc == EXR_ERR_SUCCESS)
        rc = write_lines(exr, w);
    const exr_result_t end = exr_finish(&exr);
    return rc == EXR_ERR_SUCCESS ? end : rc;
}

bool orl_exr_exceeds_halves(const struct orl_film *film)
{
    const size_t count = 3 * (size_t)film->width * film->height;
    for (size_t i = 0; i < count; i++)
        if (film->pixels[i / 3][i % 3] > ORL_EXR_LARGEST_HALF)
            return true;
    return false;
}

int orl_exr_write(const struct orl_film *film, const struct orl_view *view, bool halves,
                  const char *path, struct orl_error *err)
{
    struct orl_out_file file = {.stream = NULL};
    struct writer writer = {film, view, &file, halves, NULL};
    int code = orl_out_open(&file, path, err);
    if (code < 0)
        return code;
    writer.lines = malloc(3 * sizeof(float) * BLOCK_LINES * film->width);
    errno = 0;
    const exr_result_t rc = writer.lines ? write_file(&writer) : EXR_ERR_OUT_OF_MEMORY;
    free(writer.lines);
    if (rc != EXR_ERR_SUCCESS) {
        code = rc == EXR_ERR_OUT_OF_MEMORY ? ORL_ERR_NOMEM : orl_err_of_errno(errno);
        orl_error_set(err, code, "OpenEXR failed writing '%s': %s", path,
                      exr_get_default_error_message(rc));
    }
    return orl_out_close(&file, code, err);
}
