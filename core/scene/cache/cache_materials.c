#include "scene/cache/cache_stream.h"

enum { PATTERNS = 7, MIXED = 2 };

static void list_patterns(struct orl_material *m, struct orl_pattern **ret_slots[PATTERNS])
{
    struct orl_pattern **const slots[PATTERNS] = {
        &m->roughness_pattern, &m->pattern, &m->texture, &m->angles,
        &m->prism_rays,        &m->lobes,   &m->mix};
    for (int i = 0; i < PATTERNS; i++)
        ret_slots[i] = slots[i];
}

/* Writes or reads the struct without its pointers. */
static void pass_image(struct orl_serializer *serializer, struct orl_material *m, bool *has_bsdf)
{
    struct orl_pattern **slots[PATTERNS];
    struct orl_material image = *m;
    *has_bsdf = image.bsdf != NULL;
    image.name = NULL;
    image.bsdf = NULL;
    image.mixed = NULL;
    image.cut = NULL;
    list_patterns(&image, slots);
    for (int i = 0; i < PATTERNS; i++)
        *slots[i] = NULL;
    orl_serialize_value(serializer, &image);
    orl_serialize_value(serializer, has_bsdf);
    if (orl_serializer_reads(serializer))
        *m = image;
}

/* Loads the BSDF from the scene's file. */
static void load_bsdf(struct orl_scene_cache_stream *k, struct orl_material *m)
{
    struct orl_bsdf *bsdf = NULL;
    int code = m->bsdf_file < k->sources.count ? 0 : ORL_ERR_CORRUPT;
    if (code == 0)
        code = orl_sources_bsdf(&k->sources, m->bsdf_file, &bsdf, k->err);
    if (code == 0)
        m->bsdf = orl_bsdf_ref(bsdf);
    else
        orl_serializer_fail(&k->serializer, code);
}

/* Passes one material without the two that it mixes. */
static void pass_material(struct orl_scene_cache_stream *k, struct orl_material *m)
{
    struct orl_pattern **slots[PATTERNS];
    struct orl_serializer *const serializer = &k->serializer;
    const bool reads = orl_serializer_reads(serializer);
    bool has_bsdf;
    pass_image(serializer, m, &has_bsdf);
    list_patterns(m, slots);
    for (int i = 0; i < PATTERNS; i++)
        orl_cache_pattern(k, slots[i]);
    orl_serialize_text(serializer, k->d->arena, (const char **)&m->name);
    orl_serialize_arena_array(serializer, k->d->arena, &m->cut, m->n_cut, sizeof *m->cut);
    if (reads && has_bsdf && serializer->code == 0)
        load_bsdf(k, m);
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
    bool mixes = m->mixed != NULL;
    pass_material(k, m);
    orl_serialize_value(&k->serializer, &mixes);
    if (!mixes || k->serializer.code < 0)
        return;
    struct orl_material *const two = orl_serializer_reads(&k->serializer)
                                         ? room_for_mixed(k)
                                         : (struct orl_material *)(uintptr_t)m->mixed;
    if (!two)
        return;
    for (int i = 0; i < MIXED; i++)
        pass_with_mixed(k, &two[i]);
    if (orl_serializer_reads(&k->serializer))
        m->mixed = two;
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
