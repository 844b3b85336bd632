#include "bsdf/compiled.h"

#include <errno.h>
#include <fcntl.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/checksum.h"
#include "bsdf/front.h"

struct header {
    char magic[8]; /* "ORIELBS" and NUL */
    uint32_t version, byte_order;
    uint64_t shape; /* of the structs */
    uint64_t size;  /* of the file */
    unsigned char content[ORL_COMPILED_DIGEST];
    unsigned char checksum[ORL_CHECKSUM_BYTES]; /* of all after the header */
    unsigned char reserved[32];                 /* 0 */
    unsigned char of_header[ORL_CHECKSUM_BYTES];
};
_Static_assert(sizeof(struct header) == 128, "a multiple of 64");

/* Sizes of all that is written as it stands. */
static const uint64_t shape =
    ((((uint64_t)sizeof(struct orl_bsdf) * 1000 + sizeof(struct orl_component)) * 1000 +
      sizeof(struct orl_tree)) *
         1000 +
     sizeof(struct orl_basis)) *
        100 +
    sizeof(void *);

enum { STEP = 16 << 20, BOUNDARY = 64 };

static uint64_t aligned(uint64_t offset)
{
    return (offset + BOUNDARY - 1) / BOUNDARY * BOUNDARY;
}

/* ---- The arrays ------------------------------------------------------------------------------ */

/* Where a pointer to an array is, and how long that is. */
struct array {
    void *slot;
    size_t bytes;
};

enum { ARRAYS_MAX = 48 * ORL_PART_COUNT };

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

static void add(struct arrays *arrays, void *slot, size_t bytes)
{
    if (pointer_in(slot))
        arrays->items[arrays->count++] = (struct array){slot, bytes};
}

static void add_tree(struct arrays *arrays, struct orl_tree *tree)
{
    add(arrays, &tree->lines, tree->n_lines * sizeof *tree->lines);
}

static void add_iso(struct arrays *arrays, struct orl_iso *iso)
{
    const size_t half = iso->half, n = 2 * half;
    add(arrays, &iso->values, half * n * n * sizeof *iso->values);
    add(arrays, &iso->rows, half * n * sizeof *iso->rows);
    add(arrays, &iso->edges, half * half * sizeof *iso->edges);
    add(arrays, &iso->corners, half * half * sizeof *iso->corners);
}

static void add_matrix(struct arrays *arrays, struct orl_matrix *m)
{
    const size_t cells[2] = {(size_t)m->basis[0].n_cells, (size_t)m->basis[1].n_cells};
    add(arrays, &m->values, cells[0] * cells[1] * sizeof *m->values);
    for (int axis = 0; axis < 2; axis++) {
        add(arrays, &m->cumulative[axis], cells[0] * cells[1] * sizeof **m->cumulative);
        add(arrays, &m->total[axis], cells[axis] * sizeof **m->total);
    }
}

static void add_chroma(struct arrays *arrays, const struct orl_matrix *matrix, struct orl_chroma *c)
{
    for (int k = 0; k < ORL_CHROMA_CHANNELS; k++) {
        add_tree(arrays, &c->tree[k]);
        add_iso(arrays, &c->iso[k]);
        add_matrix(arrays, &c->matrix[k]);
    }
    add(arrays, &c->values, c->n_values * sizeof *c->values);
    for (int axis = 0; axis < 2; axis++) {
        const size_t cells = matrix->values ? (size_t)matrix->basis[axis].n_cells : c->cells;
        add(arrays, &c->total[axis], cells * sizeof **c->total);
    }
}

static void add_peak(struct arrays *arrays, struct orl_peak *p)
{
    add(arrays, &p->members, p->cells * sizeof *p->members);
    add(arrays, &p->surround, p->cells * sizeof *p->surround);
    for (int axis = 0; axis < 2; axis++) {
        add(arrays, &p->share[axis], p->cells * sizeof **p->share);
        add(arrays, &p->tint[axis], p->cells * sizeof **p->tint);
    }
}

static void find_arrays(struct orl_bsdf *bsdf, struct arrays *ret)
{
    ret->count = 0;
    for (int i = 0; i < ORL_PART_COUNT; i++) {
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

struct output {
    int fd;
    struct orl_checksum sum;
};

static int write_all(int fd, const char *data, size_t size)
{
    while (size > 0) {
        const ssize_t n = write(fd, data, size);
        if (n < 0 && errno != EINTR)
            return -1;
        data += n > 0 ? n : 0;
        size -= n > 0 ? (size_t)n : 0;
    }
    return 0;
}

/* With zeros up to the next boundary. */
static int put(struct output *out, const void *data, size_t bytes)
{
    static const char zeros[BOUNDARY];
    const size_t rest = aligned(bytes) - bytes;
    orl_checksum_add(&out->sum, data, bytes);
    orl_checksum_add(&out->sum, zeros, rest);
    return write_all(out->fd, data, bytes) < 0 ? -1 : write_all(out->fd, zeros, rest);
}

static int write_file(int fd, struct orl_bsdf *image, const struct arrays *arrays,
                      const unsigned char *content, uint64_t *ret_bytes)
{
    const void *data[ARRAYS_MAX];
    struct output out = {.fd = fd};
    struct header h = {.magic = "ORIELBS",
                       .version = ORL_COMPILED_VERSION,
                       .byte_order = 0x01020304U,
                       .shape = shape,
                       .size = sizeof h + aligned(sizeof *image)};
    orl_checksum_init(&out.sum);
    for (size_t i = 0; i < arrays->count; i++) {
        const uintptr_t offset = h.size;
        data[i] = pointer_in(arrays->items[i].slot);
        memcpy(arrays->items[i].slot, &offset, sizeof offset);
        h.size += aligned(arrays->items[i].bytes);
    }
    int failed = write_all(fd, (const char *)&h, sizeof h) < 0 || put(&out, image, sizeof *image);
    for (size_t i = 0; i < arrays->count && !failed; i++)
        failed = put(&out, data[i], arrays->items[i].bytes);
    memcpy(h.content, content, sizeof h.content);
    orl_checksum_finish(&out.sum, h.checksum);
    orl_checksum_of(&h, offsetof(struct header, of_header), h.of_header);
    *ret_bytes = h.size;
    return !failed && pwrite(fd, &h, sizeof h, 0) == (ssize_t)sizeof h ? 0 : -1;
}

int orl_bsdf_write(const struct orl_bsdf *bsdf, const unsigned char content[ORL_COMPILED_DIGEST],
                   const char *path, uint64_t *ret_bytes, struct orl_error *err)
{
    struct orl_bsdf *image = malloc(sizeof *image);
    struct arrays *arrays = malloc(sizeof *arrays);
    int fd = -1, code = 0;
    if (!image || !arrays) {
        code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory writing a BSDF");
        goto done;
    }
    memcpy(image, bsdf, sizeof *image);
    memset(image->views, 0, sizeof image->views);
    find_arrays(image, arrays);
    fd = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (fd < 0 || write_file(fd, image, arrays, content, ret_bytes) < 0)
        code = orl_error_set(err, orl_err_of_errno(errno), "cannot write the BSDF '%s': %s", path,
                             strerror(errno));
done:
    if (fd >= 0)
        close(fd);
    if (fd >= 0 && code < 0)
        unlink(path);
    free(arrays);
    free(image);
    return code;
}

/* ---- Opening --------------------------------------------------------------------------------- */

static int map_file(const char *path, char **ret_file, size_t *ret_size, struct orl_error *err)
{
    const int fd = open(path, O_RDONLY | O_CLOEXEC);
    struct stat st;
    int code = 0;
    if (fd < 0)
        return orl_error_set(err, ORL_ERR_IO, "cannot open the BSDF '%s': %s", path,
                             strerror(errno));
    if (fstat(fd, &st) != 0 ||
        st.st_size < (off_t)(sizeof(struct header) + sizeof(struct orl_bsdf)))
        code = orl_error_set(err, ORL_ERR_CORRUPT, "the compiled BSDF '%s' is cut short", path);
    if (code == 0) {
        *ret_size = (size_t)st.st_size;
        *ret_file = mmap(NULL, *ret_size, PROT_READ, MAP_SHARED, fd, 0);
        if (*ret_file == MAP_FAILED)
            code = orl_error_set(err, ORL_ERR_IO, "cannot map the BSDF '%s': %s", path,
                                 strerror(errno));
    }
    close(fd);
    return code;
}

/* Of a large file the pages are let go as they are read: what is asked of it comes back. */
static void sum_body(const char *file, size_t size, unsigned char ret_sum[ORL_CHECKSUM_BYTES])
{
    struct orl_checksum sum;
    orl_checksum_init(&sum);
    for (size_t at = sizeof(struct header); at < size;) {
        const size_t end = size - at < STEP ? size : at + STEP;
        orl_checksum_add(&sum, file + at, end - at);
        if (size > STEP)
            madvise((void *)(uintptr_t)file, end / STEP * STEP, MADV_DONTNEED);
        at = end;
    }
    orl_checksum_finish(&sum, ret_sum);
}

static int check(const char *file, size_t size, const unsigned char *content, const char *path,
                 struct orl_error *err)
{
    const struct header *h = (const void *)file;
    unsigned char sum[ORL_CHECKSUM_BYTES];
    if (memcmp(h->magic, "ORIELBS", 8) != 0)
        return orl_error_set(err, ORL_ERR_CORRUPT, "'%s' is no compiled BSDF", path);
    if (h->version != ORL_COMPILED_VERSION || h->byte_order != 0x01020304U || h->shape != shape)
        return orl_error_set(err, ORL_ERR_VERSION, "'%s' is a compiled BSDF of another version",
                             path);
    orl_checksum_of(h, offsetof(struct header, of_header), sum);
    if (memcmp(sum, h->of_header, sizeof sum) != 0 || h->size != size ||
        memcmp(h->content, content, ORL_COMPILED_DIGEST) != 0)
        return orl_error_set(err, ORL_ERR_CORRUPT,
                             "the compiled BSDF '%s' is cut, damaged or of another file", path);
    sum_body(file, size, sum);
    if (memcmp(sum, h->checksum, sizeof sum) != 0)
        return orl_error_set(err, ORL_ERR_CORRUPT, "the compiled BSDF '%s' fails its checksum",
                             path);
    return 0;
}

/* From offsets to pointers. */
static int take_apart(struct orl_bsdf *bsdf, struct arrays *arrays, char *file, size_t size)
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
    char *file = MAP_FAILED;
    size_t size = 0;
    int code;
    if (!bsdf || !arrays) {
        free(bsdf);
        free(arrays);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a BSDF");
    }
    code = map_file(path, &file, &size, err);
    if (code == 0)
        code = check(file, size, content, path, err);
    if (code == 0) {
        memcpy(bsdf, file + sizeof(struct header), sizeof *bsdf);
        code = take_apart(bsdf, arrays, file, size);
        if (code < 0)
            orl_error_set(err, code, "the compiled BSDF '%s' is damaged", path);
    }
    free(arrays);
    if (code < 0) {
        if (file != MAP_FAILED)
            munmap(file, size);
        free(bsdf);
        return code;
    }
    atomic_init(&bsdf->references, 1);
    bsdf->file = file;
    bsdf->file_size = size;
    orl_bsdf_set_views(bsdf);
    *ret_bsdf = bsdf;
    return 0;
}
