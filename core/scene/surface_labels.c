#include "scene/surfaces.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory/memory.h"

/*
 * Labels are packed one after the other: the name with its NUL, then the difference of its line to
 * the previous one's; each row starts from line 0. A difference has its sign in the lowest bit,
 * then the magnitude: seven bits a byte, lowest first. The highest bit of a byte is set if more
 * follow.
 */
enum { ROW = 16, MOST_LINE_BYTES = 5 };

struct stretch {
    size_t first; /* first surface of the file */
    const char *file;
};

struct orl_surface_labels {
    unsigned char *packed;
    size_t *rows; /* offset at which each row begins */
    struct stretch *stretches;
    size_t bytes, n, n_stretches;
};

static unsigned char *write_step(unsigned char *to, int64_t step)
{
    uint64_t left = step < 0 ? (uint64_t)-step << 1 | 1 : (uint64_t)step << 1;
    for (; left > 0x7f; left >>= 7)
        *to++ = (unsigned char)(0x80 | (left & 0x7f));
    *to++ = (unsigned char)left;
    return to;
}

static const unsigned char *read_step(const unsigned char *from, int64_t *ret_step)
{
    uint64_t all = 0;
    int shift = 0;
    do {
        all |= (uint64_t)(*from & 0x7f) << shift;
        shift += 7;
    } while (*from++ & 0x80);
    *ret_step = all & 1 ? -(int64_t)(all >> 1) : (int64_t)(all >> 1);
    return from;
}

static void pack_labels(struct orl_surface_labels *labels, const struct orl_surface *surfaces)
{
    unsigned char *to = labels->packed;
    for (size_t i = 0; i < labels->n; i++) {
        const size_t size = strlen(surfaces[i].name) + 1;
        if (i % ROW == 0)
            labels->rows[i / ROW] = (size_t)(to - labels->packed);
        memcpy(to, surfaces[i].name, size);
        to = write_step(to + size,
                        (int64_t)surfaces[i].line - (i % ROW == 0 ? 0 : surfaces[i - 1].line));
    }
    labels->bytes = (size_t)(to - labels->packed);
}

static bool record_files(struct orl_surface_labels *labels, const struct orl_surface *surfaces)
{
    size_t room = 0;
    for (size_t i = 0; i < labels->n; i++) {
        if (i > 0 && surfaces[i].file == surfaces[i - 1].file)
            continue;
        if (!orl_array_reserve(&labels->stretches, &room, labels->n_stretches,
                               sizeof *labels->stretches))
            return false;
        labels->stretches[labels->n_stretches++] = (struct stretch){i, surfaces[i].file};
    }
    return true;
}

struct orl_surface_labels *orl_surface_labels_new(const struct orl_surface *surfaces, size_t n)
{
    struct orl_surface_labels *const labels = calloc(1, sizeof *labels);
    size_t most = 1;
    if (!labels)
        return NULL;
    labels->n = n;
    for (size_t i = 0; i < n; i++)
        most += strlen(surfaces[i].name) + 1 + MOST_LINE_BYTES;
    labels->packed = malloc(most);
    labels->rows = malloc((n / ROW + 1) * sizeof *labels->rows);
    if (!labels->packed || !labels->rows || !record_files(labels, surfaces)) {
        orl_surface_labels_free(labels);
        return NULL;
    }
    pack_labels(labels, surfaces);
    unsigned char *const fit = realloc(labels->packed, labels->bytes + 1);
    if (fit)
        labels->packed = fit;
    return labels;
}

void orl_surface_labels_free(struct orl_surface_labels *labels)
{
    if (!labels)
        return;
    free(labels->packed);
    free(labels->rows);
    free(labels->stretches);
    free(labels);
}

static const char *file_of(const struct orl_surface_labels *labels, size_t surface)
{
    size_t low = 0, high = labels->n_stretches;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if (labels->stretches[middle].first <= surface)
            low = middle;
        else
            high = middle;
    }
    return labels->stretches[low].file;
}

struct orl_surface_label orl_surface_label_of(const struct orl_surface_labels *labels,
                                              size_t surface)
{
    const unsigned char *at = labels->packed + labels->rows[surface / ROW];
    const char *name = NULL;
    int64_t line = 0, step;
    for (size_t i = surface / ROW * ROW; i <= surface; i++) {
        name = (const char *)at;
        at = read_step(at + strlen(name) + 1, &step);
        line += step;
    }
    return (struct orl_surface_label){name, file_of(labels, surface), (int)line};
}

uint64_t orl_surface_labels_bytes(const struct orl_surface_labels *labels)
{
    return labels ? sizeof *labels + labels->bytes + (labels->n / ROW + 1) * sizeof *labels->rows +
                        labels->n_stretches * sizeof *labels->stretches
                  : 0;
}
