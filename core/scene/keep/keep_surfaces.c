#include "scene/keep/keep_parts.h"

#include <stdlib.h>
#include <string.h>

/* A surface in the file; name and outline are offsets into the blocks of all names and outlines. */
struct kept_surface {
    struct orl_vec3 normal;
    uint64_t name, outline;
    uint32_t material, modifier_order, n_vertices, file;
    int32_t line;
    uint8_t kind, none; /* none: padding, 0 */
    bool has_places, has_normals;
};

static size_t outline_bytes(const struct orl_surface *s)
{
    const size_t corner = sizeof(struct orl_vec3) + (s->has_places ? 2 * sizeof(double) : 0) +
                          (s->has_normals ? sizeof(struct orl_vec3) : 0);
    return s->kind == ORL_SURFACE_POLYGON ? s->n_vertices * corner : sizeof *s->round;
}

/* ---- Writing --------------------------------------------------------------------------------- */

/* Returns the index of a file's name. Surfaces of a file follow each other: *at is the previous
 * surface's index. */
static uint32_t file_of(const struct orl_description *d, const char *file, uint32_t *at)
{
    for (size_t tried = 0; tried < d->n_files; tried++) {
        if (d->files[*at] == file)
            break;
        *at = (*at + 1) % (uint32_t)d->n_files;
    }
    return *at;
}

static void write_records(struct orl_scene_keeping *k, const struct orl_surface *surfaces, size_t n)
{
    uint64_t names = 0, outlines = 0;
    uint32_t file = 0;
    for (size_t i = 0; i < n; i++) {
        const struct orl_surface *const s = &surfaces[i];
        struct kept_surface kept = {.normal = s->normal,
                                    .name = names,
                                    .outline = outlines,
                                    .material = s->material,
                                    .modifier_order = s->modifier_order,
                                    .n_vertices = s->n_vertices,
                                    .file = file_of(k->d, s->file, &file),
                                    .line = s->line,
                                    .kind = (uint8_t)s->kind,
                                    .has_places = s->has_places,
                                    .has_normals = s->has_normals};
        orl_stream_in_place(&k->stream, &kept, sizeof kept);
        names += strlen(s->name) + 1;
        outlines += outline_bytes(s);
    }
    orl_stream_value(&k->stream, &names);
    orl_stream_value(&k->stream, &outlines);
}

static void write_surfaces(struct orl_scene_keeping *k, const struct orl_surface *surfaces,
                           size_t n)
{
    write_records(k, surfaces, n);
    orl_stream_in_place(&k->stream, NULL, 0);
    for (size_t i = 0; i < n; i++)
        orl_stream_bytes(&k->stream,
                         surfaces[i].kind == ORL_SURFACE_POLYGON
                             ? (void *)surfaces[i].vertices
                             : (void *)(uintptr_t)surfaces[i].round,
                         outline_bytes(&surfaces[i]));
    for (size_t i = 0; i < n; i++)
        orl_stream_bytes(&k->stream, surfaces[i].name, strlen(surfaces[i].name) + 1);
}

/* ---- Reading --------------------------------------------------------------------------------- */

/* The blocks of the file that surfaces refer to. */
struct blocks {
    const struct kept_surface *records;
    const char *names, *outlines;
    uint64_t name_bytes, outline_bytes;
};

static bool find_blocks(struct orl_stream *stream, size_t n, struct blocks *ret)
{
    if (n > (size_t)(stream->end - stream->at) / sizeof *ret->records)
        orl_stream_fail(stream, ORL_ERR_CORRUPT);
    else
        ret->records = orl_stream_in_place(stream, NULL, n * sizeof *ret->records);
    orl_stream_value(stream, &ret->name_bytes);
    orl_stream_value(stream, &ret->outline_bytes);
    ret->outlines = orl_stream_in_place(stream, NULL, ret->outline_bytes);
    if (stream->code == 0 && ret->name_bytes <= (size_t)(stream->end - stream->at)) {
        ret->names = stream->at;
        stream->at += ret->name_bytes;
    } else {
        orl_stream_fail(stream, ORL_ERR_CORRUPT);
    }
    return stream->code == 0;
}

static bool fill_surface(const struct orl_description *d, const struct kept_surface *kept,
                         const struct blocks *blocks, struct orl_surface *ret)
{
    *ret = (struct orl_surface){.kind = (enum orl_surface_kind)kept->kind,
                                .has_places = kept->has_places,
                                .has_normals = kept->has_normals,
                                .material = kept->material,
                                .modifier_order = kept->modifier_order,
                                .n_vertices = kept->n_vertices,
                                .line = kept->line,
                                .normal = kept->normal};
    if (kept->name >= blocks->name_bytes || kept->outline > blocks->outline_bytes ||
        outline_bytes(ret) > blocks->outline_bytes - kept->outline || kept->file >= d->n_files)
        return false;
    const void *const outline = blocks->outlines + kept->outline;
    ret->name = (char *)(uintptr_t)blocks->names + kept->name;
    ret->file = d->files[kept->file];
    if (ret->kind == ORL_SURFACE_POLYGON)
        ret->vertices = (struct orl_vec3 *)(uintptr_t)outline;
    else
        ret->round = outline;
    return true;
}

static void read_surfaces(struct orl_scene_keeping *k, struct orl_surface **ret_surfaces, size_t n)
{
    struct blocks blocks = {.records = NULL};
    if (!find_blocks(&k->stream, n, &blocks))
        return;
    *ret_surfaces = malloc((n + 1) * sizeof **ret_surfaces);
    if (!*ret_surfaces) {
        orl_stream_fail(&k->stream, ORL_ERR_NOMEM);
        return;
    }
    for (size_t i = 0; i < n && k->stream.code == 0; i++)
        if (!fill_surface(k->d, &blocks.records[i], &blocks, &(*ret_surfaces)[i]))
            orl_stream_fail(&k->stream, ORL_ERR_CORRUPT);
}

/* ---- Entry points ---------------------------------------------------------------------------- */

void orl_keep_surfaces(struct orl_scene_keeping *k, struct orl_surface **surfaces, size_t *n)
{
    orl_stream_value(&k->stream, n);
    if (orl_stream_reads(&k->stream))
        read_surfaces(k, surfaces, *n);
    else
        write_surfaces(k, *surfaces, *n);
}

void orl_keep_opposed(struct orl_scene_keeping *k, struct orl_opposed **opposed, size_t *n)
{
    orl_stream_value(&k->stream, n);
    orl_stream_array(&k->stream, opposed, *n, sizeof **opposed);
}
