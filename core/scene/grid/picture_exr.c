#include <OpenEXR/openexr.h>

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "scene/grid/grid.h"

struct reading {
    const char *name;
    const unsigned char *data;
    uint64_t size;
    exr_context_t exr;
    int32_t top, rows, chunk; /* rows of a chunk */
    uint32_t width;
    struct orl_grid *grid;
};

static int64_t read_bytes(exr_const_context_t exr, void *user, void *buffer, uint64_t size,
                          uint64_t offset, exr_stream_error_func_ptr_t error)
{
    const struct reading *const r = user;
    (void)exr;
    (void)error;
    if (offset >= r->size)
        return 0;
    const uint64_t left = r->size - offset, n = size < left ? size : left;
    memcpy(buffer, r->data + offset, n);
    return (int64_t)n;
}

static int64_t ask_size(exr_const_context_t exr, void *user)
{
    (void)exr;
    return (int64_t)((const struct reading *)user)->size;
}

/* Discards the library's messages: errors are reported by their codes. */
static void discard_message(exr_const_context_t exr, exr_result_t code, const char *message)
{
    (void)exr;
    (void)code;
    (void)message;
}

/* Returns the grid channels that a channel of the file fills, as bits; Y fills all. */
static unsigned channel_named(const char *name)
{
    if (strcmp(name, "Y") == 0)
        return 7;
    return strcmp(name, "R") == 0 ? 1 : strcmp(name, "G") == 0 ? 2 : strcmp(name, "B") == 0 ? 4 : 0;
}

static int check_channels(struct reading *r, struct orl_error *err)
{
    const exr_attr_chlist_t *list = NULL;
    unsigned found = 0;
    if (exr_get_channels(r->exr, 0, &list) != EXR_ERR_SUCCESS || !list)
        return orl_grid_fail(r->name, ORL_ERR_SYNTAX, err, "the OpenEXR is damaged");
    for (int i = 0; i < list->num_channels; i++) {
        const exr_attr_chlist_entry_t *const channel = list->entries + i;
        const unsigned which = channel_named(channel->name.str);
        if (channel->x_sampling != 1 || channel->y_sampling != 1 || (found & which))
            return orl_grid_fail(
                r->name, ORL_ERR_UNSUPPORTED, err,
                "the OpenEXR has channels of different sizes, or Y together with R G B");
        found |= which;
    }
    if (found != 7)
        return orl_grid_fail(r->name, ORL_ERR_UNSUPPORTED, err,
                             "the OpenEXR has no channels R, G and B, nor Y");
    return 0;
}

static int read_header(struct reading *r, struct orl_error *err)
{
    exr_context_initializer_t how = EXR_DEFAULT_CONTEXT_INITIALIZER;
    exr_storage_t storage;
    exr_attr_box2i_t box;
    float aspect = 1;
    int parts = 0;
    how.error_handler_fn = discard_message;
    how.user_data = r;
    how.read_fn = read_bytes;
    how.size_fn = ask_size;
    how.max_image_width = how.max_image_height = ORL_LIMIT_IMAGE_SIDE;
    if (exr_start_read(&r->exr, r->name, &how) != EXR_ERR_SUCCESS ||
        exr_get_count(r->exr, &parts) != EXR_ERR_SUCCESS ||
        exr_get_storage(r->exr, 0, &storage) != EXR_ERR_SUCCESS ||
        exr_get_data_window(r->exr, 0, &box) != EXR_ERR_SUCCESS ||
        exr_get_pixel_aspect_ratio(r->exr, 0, &aspect) != EXR_ERR_SUCCESS)
        return orl_grid_fail(r->name, ORL_ERR_SYNTAX, err, "the OpenEXR is damaged");
    if (parts != 1 || storage != EXR_STORAGE_SCANLINE)
        return orl_grid_fail(r->name, ORL_ERR_UNSUPPORTED, err,
                             "the OpenEXR is not a scan-line file of one part");
    if (exr_get_scanlines_per_chunk(r->exr, 0, &r->chunk) != EXR_ERR_SUCCESS || r->chunk < 1 ||
        !(aspect > 1e-6F && aspect < 1e6F))
        return orl_grid_fail(r->name, ORL_ERR_SYNTAX, err, "the OpenEXR is damaged");
    const int64_t width = (int64_t)box.max.x - box.min.x + 1;
    const int64_t height = (int64_t)box.max.y - box.min.y + 1;
    if (width < 1 || height < 1 || width > ORL_LIMIT_IMAGE_SIDE || height > ORL_LIMIT_IMAGE_SIDE)
        return orl_grid_fail(r->name, ORL_ERR_LIMIT, err, "the OpenEXR has no pixels, or too many");
    r->top = box.min.y;
    r->rows = (int32_t)height;
    r->width = (uint32_t)width;
    const int code = check_channels(r, err);
    /* OpenEXR's aspect is width by height. */
    return code < 0 ? code
                    : orl_grid_new_picture(r->name, r->width, (uint32_t)height, 1 / (double)aspect,
                                           &r->grid, err);
}

/* Sets where the rows of a chunk are decoded to: three planes, one per channel. */
static void set_decode_targets(const struct reading *r, exr_decode_pipeline_t *pipeline,
                               float *rows)
{
    const size_t plane = (size_t)r->chunk * r->width;
    for (int i = 0; i < pipeline->channel_count; i++) {
        exr_coding_channel_info_t *const channel = pipeline->channels + i;
        const unsigned which = channel_named(channel->channel_name);
        channel->decode_to_ptr = which ? (uint8_t *)(rows + (which == 2   ? plane
                                                             : which == 4 ? 2 * plane
                                                                          : 0))
                                       : NULL;
        channel->user_pixel_stride = sizeof(float);
        channel->user_line_stride = (int32_t)(r->width * sizeof(float));
        channel->user_bytes_per_element = sizeof(float);
        channel->user_data_type = EXR_PIXEL_FLOAT;
    }
}

/* Replaces infinities by the largest half, NaN by 0. */
static float tamed(float value)
{
    const float most = 65504;
    return isnan(value) ? 0 : isinf(value) ? copysignf(most, value) : value;
}

static void store_rows(struct reading *r, const float *rows, int32_t first, bool gray)
{
    const size_t plane = gray ? 0 : (size_t)r->chunk * r->width;
    for (int32_t y = first; y < r->rows && y < first + r->chunk; y++)
        for (uint32_t x = 0; x < r->width; x++)
            for (size_t c = 0; c < ORL_GRID_CHANNELS; c++)
                orl_grid_pixel(r->grid, x, (uint32_t)y)[c] =
                    tamed(rows[c * plane + (size_t)(y - first) * r->width + x]);
}

static exr_result_t read_chunk(struct reading *r, exr_decode_pipeline_t *pipeline, float *rows,
                               int32_t first)
{
    exr_chunk_info_t chunk;
    exr_result_t code = exr_read_scanline_chunk_info(r->exr, 0, r->top + first, &chunk);
    if (code == EXR_ERR_SUCCESS)
        code = first == 0 ? exr_decoding_initialize(r->exr, 0, &chunk, pipeline)
                          : exr_decoding_update(r->exr, 0, &chunk, pipeline);
    if (code != EXR_ERR_SUCCESS)
        return code;
    set_decode_targets(r, pipeline, rows);
    code = exr_decoding_choose_default_routines(r->exr, 0, pipeline);
    return code == EXR_ERR_SUCCESS ? exr_decoding_run(r->exr, 0, pipeline) : code;
}

static int read_pixels(struct reading *r, struct orl_error *err)
{
    exr_decode_pipeline_t pipeline = EXR_DECODE_PIPELINE_INITIALIZER;
    const exr_attr_chlist_t *list = NULL;
    float *const rows =
        calloc((size_t)ORL_GRID_CHANNELS * (size_t)r->chunk * r->width, sizeof *rows);
    exr_result_t code = rows ? exr_get_channels(r->exr, 0, &list) : EXR_ERR_OUT_OF_MEMORY;
    bool gray = false;
    for (int i = 0; code == EXR_ERR_SUCCESS && i < list->num_channels; i++)
        gray = gray || channel_named(list->entries[i].name.str) == 7;
    for (int32_t y = 0; code == EXR_ERR_SUCCESS && y < r->rows; y += r->chunk) {
        code = read_chunk(r, &pipeline, rows, y);
        if (code == EXR_ERR_SUCCESS)
            store_rows(r, rows, y, gray);
    }
    exr_decoding_destroy(r->exr, &pipeline);
    free(rows);
    if (code == EXR_ERR_OUT_OF_MEMORY)
        return orl_grid_fail(r->name, ORL_ERR_NOMEM, err, "out of memory for a picture");
    return code == EXR_ERR_SUCCESS
               ? 0
               : orl_grid_fail(r->name, ORL_ERR_SYNTAX, err, "the OpenEXR is damaged");
}

int orl_grid_read_exr(const char *name, const void *data, size_t size, struct orl_grid **ret_grid,
                      struct orl_error *err)
{
    struct reading r = {.name = name, .data = data, .size = size};
    int code = read_header(&r, err);
    if (code == 0)
        code = read_pixels(&r, err);
    if (r.exr)
        exr_finish(&r.exr);
    if (code < 0)
        orl_grid_free(r.grid);
    else
        *ret_grid = r.grid;
    return code;
}
