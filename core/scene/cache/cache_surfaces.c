#include <stdlib.h>
#include <string.h>

#include "scene/cache/scene_cache_file.h"

enum { MOST_SLOTS = 3, MIXED = 2 };

/* Lists where a material refers to patterns; returns their number. */
static int list_patterns(struct orl_material *m, struct orl_pattern **ret_slots[MOST_SLOTS])
{
    int n = 0;
    ret_slots[n++] = &m->pattern;
    ret_slots[n++] = &m->texture;
    if (orl_material_is_reflector(m))
        ret_slots[n++] = &m->as.reflector.roughness_pattern;
    if (m->kind == ORL_MATERIAL_GLAZING)
        ret_slots[n++] = &m->as.glazing.angles;
    if (m->kind == ORL_MATERIAL_PRISM)
        ret_slots[n++] = &m->as.prism.rays;
    if (m->kind == ORL_MATERIAL_FUNCTION_LOBES)
        ret_slots[n++] = &m->as.function_lobes.functions;
    if (m->kind == ORL_MATERIAL_MIXTURE)
        ret_slots[n++] = &m->as.mixture.share;
    return n;
}

static void clear_pointers(struct orl_material *m)
{
    struct orl_pattern **slots[MOST_SLOTS];
    const int n = list_patterns(m, slots);
    for (int i = 0; i < n; i++)
        *slots[i] = NULL;
    m->name = NULL;
    if (m->kind == ORL_MATERIAL_BSDF)
        m->as.bsdf_surface.bsdf = NULL;
    if (m->kind == ORL_MATERIAL_MIXTURE)
        m->as.mixture.mixed = NULL;
    if (m->kind == ORL_MATERIAL_ANTIMATTER)
        m->as.antimatter.cut = NULL;
}

/* Writes or reads the struct without its pointers. */
static void pass_image(struct orl_serializer *serializer, struct orl_material *m)
{
    struct orl_material image = *m;
    clear_pointers(&image);
    orl_serialize_value(serializer, &image);
    if (!orl_serializer_reads(serializer))
        return;
    if ((unsigned)image.kind >= ORL_MATERIAL_KINDS)
        orl_serializer_fail(serializer, ORL_ERR_CORRUPT);
    else
        *m = image;
}

/* Loads the BSDF from the scene's file. */
static void load_bsdf(struct orl_scene_cache_stream *k, struct orl_bsdf_surface *surface)
{
    struct orl_bsdf *bsdf = NULL;
    int code = surface->file < k->sources.count ? 0 : ORL_ERR_CORRUPT;
    if (code == 0)
        code = orl_sources_bsdf(&k->sources, surface->file, &bsdf, k->err);
    if (code == 0)
        surface->bsdf = orl_bsdf_ref(bsdf);
    else
        orl_serializer_fail(&k->serializer, code);
}

/* Passes one material without the two that it mixes. */
static void pass_material(struct orl_scene_cache_stream *k, struct orl_material *m)
{
    struct orl_pattern **slots[MOST_SLOTS];
    struct orl_serializer *const serializer = &k->serializer;
    const bool reads = orl_serializer_reads(serializer);
    pass_image(serializer, m);
    const int n = list_patterns(m, slots);
    for (int i = 0; i < n; i++)
        orl_cache_pattern(k, slots[i]);
    orl_serialize_text(serializer, k->d->arena, (const char **)&m->name);
    if (m->kind == ORL_MATERIAL_ANTIMATTER) {
        struct orl_antimatter *const antimatter = &m->as.antimatter;
        orl_serialize_arena_array(serializer, k->d->arena, &antimatter->cut, antimatter->n_cut,
                                  sizeof *antimatter->cut);
    }
    if (reads && m->kind == ORL_MATERIAL_BSDF && serializer->code == 0)
        load_bsdf(k, &m->as.bsdf_surface);
}

static struct orl_material *room_for_mixed(struct orl_scene_cache_stream *k)
{
    struct orl_material *const two =
        orl_arena_alloc(k->d->arena, MIXED * sizeof(struct orl_material));
    if (!two)
        orl_serializer_fail(&k->serializer, ORL_ERR_NOMEM);
    else
        two[0] = two[1] = (struct orl_material){.kind = ORL_MATERIAL_VOID};
    return two;
}

/* Passes a material and, recursively, those it mixes; the parser bounds the depth. */
static void pass_with_mixed(struct orl_scene_cache_stream *k, struct orl_material *m)
{
    pass_material(k, m);
    if (m->kind != ORL_MATERIAL_MIXTURE || k->serializer.code < 0)
        return;
    struct orl_material *const two =
        orl_serializer_reads(&k->serializer)
            ? room_for_mixed(k)
            : (struct orl_material *)(uintptr_t)orl_mixture_of(m)->mixed;
    if (!two)
        return;
    for (int i = 0; i < MIXED; i++)
        pass_with_mixed(k, &two[i]);
    if (orl_serializer_reads(&k->serializer))
        m->as.mixture.mixed = two;
}

void orl_cache_materials(struct orl_scene_cache_stream *k)
{
    struct orl_parsed_scene *const d = k->d;
    size_t n = d->n_materials;
    orl_serialize_value(&k->serializer, &n);
    orl_serializer_alloc(&k->serializer, &d->materials, n, sizeof *d->materials);
    for (size_t i = 0; i < n && k->serializer.code == 0; i++) {
        if (orl_serializer_reads(&k->serializer))
            d->n_materials = i + 1;
        pass_with_mixed(k, &d->materials[i]);
    }
}

/* A surface in the file; name and outline are offsets into the blocks of all names and outlines. */
struct cached_surface {
    struct orl_vec3 normal;
    uint64_t name, outline;
    uint32_t material, modifier_order, n_vertices, file;
    int32_t line;
    uint8_t kind, none; /* none: padding, 0 */
    bool has_uv, has_normals;
};

static size_t outline_bytes(const struct orl_surface *s)
{
    const size_t corner = sizeof(struct orl_vec3) + (s->has_uv ? 2 * sizeof(double) : 0) +
                          (s->has_normals ? sizeof(struct orl_vec3) : 0);
    return s->kind == ORL_SURFACE_POLYGON ? s->n_vertices * corner : sizeof *s->quadric;
}

/* ---- Writing --------------------------------------------------------------------------------- */

/* Returns the index of a file's name. Surfaces of a file follow each other: *at is the previous
 * surface's index. */
static uint32_t file_of(const struct orl_parsed_scene *d, const char *file, uint32_t *at)
{
    for (size_t tried = 0; tried < d->n_files; tried++) {
        if (d->files[*at] == file)
            break;
        *at = (*at + 1) % (uint32_t)d->n_files;
    }
    return *at;
}

static void write_records(struct orl_scene_cache_stream *k, const struct orl_surface *surfaces,
                          size_t n)
{
    uint64_t names = 0, outlines = 0;
    uint32_t file = 0;
    for (size_t i = 0; i < n; i++) {
        const struct orl_surface *const s = &surfaces[i];
        struct cached_surface cached = {.normal = s->normal,
                                        .name = names,
                                        .outline = outlines,
                                        .material = s->material,
                                        .modifier_order = s->modifier_order,
                                        .n_vertices = s->n_vertices,
                                        .file = file_of(k->d, s->file, &file),
                                        .line = s->line,
                                        .kind = (uint8_t)s->kind,
                                        .has_uv = s->has_uv,
                                        .has_normals = s->has_normals};
        orl_serialize_in_place(&k->serializer, &cached, sizeof cached);
        names += strlen(s->name) + 1;
        outlines += outline_bytes(s);
    }
    orl_serialize_value(&k->serializer, &names);
    orl_serialize_value(&k->serializer, &outlines);
}

static void write_surfaces(struct orl_scene_cache_stream *k, const struct orl_surface *surfaces,
                           size_t n)
{
    write_records(k, surfaces, n);
    orl_serialize_in_place(&k->serializer, NULL, 0);
    for (size_t i = 0; i < n; i++)
        orl_serialize_bytes(&k->serializer,
                            surfaces[i].kind == ORL_SURFACE_POLYGON
                                ? (void *)surfaces[i].vertices
                                : (void *)(uintptr_t)surfaces[i].quadric,
                            outline_bytes(&surfaces[i]));
    for (size_t i = 0; i < n; i++)
        orl_serialize_bytes(&k->serializer, surfaces[i].name, strlen(surfaces[i].name) + 1);
}

/* ---- Reading --------------------------------------------------------------------------------- */

/* The blocks of the file that surfaces refer to. */
struct blocks {
    const struct cached_surface *records;
    const char *names, *outlines;
    uint64_t name_bytes, outline_bytes;
};

static bool find_blocks(struct orl_serializer *serializer, size_t n, struct blocks *ret)
{
    if (n > (size_t)(serializer->end - serializer->at) / sizeof *ret->records)
        orl_serializer_fail(serializer, ORL_ERR_CORRUPT);
    else
        ret->records = orl_serialize_in_place(serializer, NULL, n * sizeof *ret->records);
    orl_serialize_value(serializer, &ret->name_bytes);
    orl_serialize_value(serializer, &ret->outline_bytes);
    ret->outlines = orl_serialize_in_place(serializer, NULL, ret->outline_bytes);
    if (serializer->code == 0 && ret->name_bytes <= (size_t)(serializer->end - serializer->at)) {
        ret->names = serializer->at;
        serializer->at += ret->name_bytes;
    } else {
        orl_serializer_fail(serializer, ORL_ERR_CORRUPT);
    }
    return serializer->code == 0;
}

static bool fill_surface(const struct orl_parsed_scene *d, const struct cached_surface *cached,
                         const struct blocks *blocks, struct orl_surface *ret)
{
    *ret = (struct orl_surface){.kind = (enum orl_surface_kind)cached->kind,
                                .has_uv = cached->has_uv,
                                .has_normals = cached->has_normals,
                                .material = cached->material,
                                .modifier_order = cached->modifier_order,
                                .n_vertices = cached->n_vertices,
                                .line = cached->line,
                                .normal = cached->normal};
    if (cached->name >= blocks->name_bytes || cached->outline > blocks->outline_bytes ||
        outline_bytes(ret) > blocks->outline_bytes - cached->outline || cached->file >= d->n_files)
        return false;
    const void *const outline = blocks->outlines + cached->outline;
    ret->name = (char *)(uintptr_t)blocks->names + cached->name;
    ret->file = d->files[cached->file];
    if (ret->kind == ORL_SURFACE_POLYGON)
        ret->vertices = (struct orl_vec3 *)(uintptr_t)outline;
    else
        ret->quadric = outline;
    return true;
}

static void read_surfaces(struct orl_scene_cache_stream *k, struct orl_surface **ret_surfaces,
                          size_t n)
{
    struct blocks blocks = {.records = NULL};
    if (!find_blocks(&k->serializer, n, &blocks))
        return;
    *ret_surfaces = malloc((n + 1) * sizeof **ret_surfaces);
    if (!*ret_surfaces) {
        orl_serializer_fail(&k->serializer, ORL_ERR_NOMEM);
        return;
    }
    for (size_t i = 0; i < n && k->serializer.code == 0; i++)
        if (!fill_surface(k->d, &blocks.records[i], &blocks, &(*ret_surfaces)[i]))
            orl_serializer_fail(&k->serializer, ORL_ERR_CORRUPT);
}

/* ---- Entry points ---------------------------------------------------------------------------- */

void orl_cache_surfaces(struct orl_scene_cache_stream *k, struct orl_surface **surfaces, size_t *n)
{
    orl_serialize_value(&k->serializer, n);
    if (orl_serializer_reads(&k->serializer))
        read_surfaces(k, surfaces, *n);
    else
        write_surfaces(k, *surfaces, *n);
}

void orl_cache_opposed(struct orl_scene_cache_stream *k, struct orl_opposed_pair **opposed,
                       size_t *n)
{
    orl_serialize_value(&k->serializer, n);
    orl_serialize_array(&k->serializer, opposed, *n, sizeof **opposed);
}
