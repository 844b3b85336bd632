#include "bsdf/loaded_bsdf.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "base/io/checked_file.h"
#include "bsdf/bsdf_internal.h"

static const struct orl_checked_file_kind kind = {
    .magic = "ORIELBS",
    .version = ORL_COMPILED_VERSION,
    .shape = ((((uint64_t)sizeof(struct orl_bsdf) * 1000 + sizeof(struct orl_component)) * 1000 +
               sizeof(struct orl_tree)) *
                  1000 +
              sizeof(struct orl_basis)) *
                 100 +
             sizeof(void *),
    .what = "BSDF"};

/* ---- The arrays ------------------------------------------------------------------------------ */

/* Address of a pointer to an array, and the array's size. */
struct array {
    void *slot;
    size_t bytes;
};

enum { ARRAYS_MAX = 48 * ORL_COMPONENT_COUNT };

struct arrays {
    struct array items[ARRAYS_MAX];
    size_t count;
};

static void *pointer_in(const void *slot)
{
    void *pointer;
    memcpy(&pointer, slot, sizeof pointer);
    return pointer;
}

static void add_array(struct arrays *arrays, void *slot, size_t bytes)
{
    if (pointer_in(slot))
        arrays->items[arrays->count++] = (struct array){slot, bytes};
}

static void add_tree(struct arrays *arrays, struct orl_tree *tree)
{
    add_array(arrays, &tree->lines, tree->n_lines * sizeof *tree->lines);
}

static void add_iso(struct arrays *arrays, struct orl_iso *iso)
{
    const size_t half = iso->half, n = 2 * half;
    add_array(arrays, &iso->values, half * n * n * sizeof *iso->values);
    add_array(arrays, &iso->rows, half * n * sizeof *iso->rows);
    add_array(arrays, &iso->edges, half * half * sizeof *iso->edges);
    add_array(arrays, &iso->corners, half * half * sizeof *iso->corners);
}

static void add_matrix(struct arrays *arrays, struct orl_matrix *m)
{
    const size_t cells[2] = {(size_t)m->basis[0].n_cells, (size_t)m->basis[1].n_cells};
    add_array(arrays, &m->values, cells[0] * cells[1] * sizeof *m->values);
    for (int axis = 0; axis < 2; axis++) {
        add_array(arrays, &m->cumulative[axis], cells[0] * cells[1] * sizeof **m->cumulative);
        add_array(arrays, &m->total[axis], cells[axis] * sizeof **m->total);
    }
}

static void add_chroma(struct arrays *arrays, const struct orl_matrix *matrix, struct orl_chroma *c)
{
    for (int k = 0; k < ORL_CHROMA_CHANNELS; k++) {
        add_tree(arrays, &c->tree[k]);
        add_iso(arrays, &c->iso[k]);
        add_matrix(arrays, &c->matrix[k]);
    }
    add_array(arrays, &c->values, c->n_values * sizeof *c->values);
    for (int axis = 0; axis < 2; axis++) {
        const size_t cells = matrix->values ? (size_t)matrix->basis[axis].n_cells : c->cells;
        add_array(arrays, &c->total[axis], cells * sizeof **c->total);
    }
}

static void add_peak(struct arrays *arrays, struct orl_peak *p)
{
    add_array(arrays, &p->members, p->cells * sizeof *p->members);
    add_array(arrays, &p->surround, p->cells * sizeof *p->surround);
    for (int axis = 0; axis < 2; axis++) {
        add_array(arrays, &p->share[axis], p->cells * sizeof **p->share);
        add_array(arrays, &p->tint[axis], p->cells * sizeof **p->tint);
    }
}

static void find_arrays(struct orl_bsdf *bsdf, struct arrays *ret)
{
    ret->count = 0;
    for (int i = 0; i < ORL_COMPONENT_COUNT; i++) {
        struct orl_component *c = &bsdf->document.parts[i];
        if (!c->present)
            continue;
        add_tree(ret, &c->tree);
        add_iso(ret, &c->iso);
        add_matrix(ret, &c->matrix);
        add_chroma(ret, &c->matrix, &c->chroma);
        add_peak(ret, &c->peak);
    }
}

/* ---- Writing --------------------------------------------------------------------------------- */

static void write_aligned(struct orl_checked_writer *out, const void *data, size_t bytes)
{
    orl_checked_writer_put(out, data, bytes);
    orl_checked_writer_align(out, ORL_CHECKED_FILE_BOUNDARY);
}

static void write_body(struct orl_checked_writer *out, struct orl_bsdf *image,
                       const struct arrays *arrays)
{
    const void *data[ARRAYS_MAX];
    uint64_t size = ORL_CHECKED_FILE_HEADER + orl_checked_file_aligned(sizeof *image);
    for (size_t i = 0; i < arrays->count; i++) {
        const uintptr_t offset = size;
        data[i] = pointer_in(arrays->items[i].slot);
        memcpy(arrays->items[i].slot, &offset, sizeof offset);
        size += orl_checked_file_aligned(arrays->items[i].bytes);
    }
    write_aligned(out, image, sizeof *image);
    for (size_t i = 0; i < arrays->count; i++)
        write_aligned(out, data[i], arrays->items[i].bytes);
}

int orl_bsdf_write(const struct orl_bsdf *bsdf, const unsigned char content[ORL_COMPILED_DIGEST],
                   const char *path, uint64_t *ret_bytes, struct orl_error *err)
{
    struct orl_bsdf *image = malloc(sizeof *image);
    struct arrays *arrays = malloc(sizeof *arrays);
    struct orl_checked_writer *out = malloc(sizeof *out);
    int code = image && arrays && out ? 0 : ORL_ERR_NOMEM;
    if (code < 0)
        orl_error_set(err, code, "out of memory writing a BSDF");
    else
        code = orl_checked_writer_begin(out, &kind, path, err);
    if (code == 0) {
        memcpy(image, bsdf, sizeof *image);
        memset(image->views, 0, sizeof image->views);
        find_arrays(image, arrays);
        write_body(out, image, arrays);
        code = orl_checked_writer_end(out, content, ret_bytes, err);
    }
    free(out);
    free(arrays);
    free(image);
    return code;
}

/* ---- Opening --------------------------------------------------------------------------------- */

/* Replaces offsets by pointers into the file. Returns 0 or ORL_ERR_CORRUPT. */
static int restore_pointers(struct orl_bsdf *bsdf, struct arrays *arrays, char *file, size_t size)
{
    find_arrays(bsdf, arrays);
    for (size_t i = 0; i < arrays->count; i++) {
        const struct array *a = &arrays->items[i];
        const uintptr_t offset = (uintptr_t)pointer_in(a->slot);
        const char *at = file + offset;
        if (offset % 64 != 0 || offset > size || a->bytes > size - offset)
            return ORL_ERR_CORRUPT;
        memcpy(a->slot, &at, sizeof at);
    }
    return 0;
}

int orl_bsdf_open(const char *path, const unsigned char content[ORL_COMPILED_DIGEST],
                  struct orl_bsdf **ret_bsdf, struct orl_error *err)
{
    struct orl_bsdf *bsdf = malloc(sizeof *bsdf);
    struct arrays *arrays = malloc(sizeof *arrays);
    struct orl_checked_file file = {0};
    int code;
    if (!bsdf || !arrays) {
        free(bsdf);
        free(arrays);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a BSDF");
    }
    code = orl_checked_file_open(&kind, path, content, &file, err);
    if (code == 0 && file.size < ORL_CHECKED_FILE_HEADER + sizeof *bsdf)
        code = ORL_ERR_CORRUPT;
    if (code == 0) {
        memcpy(bsdf, file.data + ORL_CHECKED_FILE_HEADER, sizeof *bsdf);
        code = restore_pointers(bsdf, arrays, file.data, file.size);
    }
    free(arrays);
    if (code < 0) {
        if (file.data)
            orl_error_set(err, code, "the cached BSDF '%s' is damaged", path);
        orl_checked_file_close(&file);
        free(bsdf);
        return code;
    }
    atomic_init(&bsdf->references, 1);
    bsdf->file = file;
    orl_bsdf_set_views(bsdf);
    *ret_bsdf = bsdf;
    return 0;
}
