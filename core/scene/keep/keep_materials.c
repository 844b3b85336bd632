#include "scene/keep/keep_parts.h"

enum { PATTERNS = 7, MIXED = 2 };

static void list_patterns(struct orl_material *m, struct orl_pattern **ret_slots[PATTERNS])
{
    struct orl_pattern **const slots[PATTERNS] = {&m->rough, &m->pattern, &m->texture, &m->angles,
                                                  &m->ways,  &m->lobes,   &m->mix};
    for (int i = 0; i < PATTERNS; i++)
        ret_slots[i] = slots[i];
}

/* Writes or reads the struct without its pointers. */
static void pass_image(struct orl_stream *stream, struct orl_material *m, bool *has_bsdf)
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
    orl_stream_value(stream, &image);
    orl_stream_value(stream, has_bsdf);
    if (orl_stream_reads(stream))
        *m = image;
}

/* Loads the BSDF from the scene's file. */
static void load_bsdf(struct orl_scene_keeping *k, struct orl_material *m)
{
    struct orl_bsdf *bsdf = NULL;
    int code = m->bsdf_file < k->sources.count ? 0 : ORL_ERR_CORRUPT;
    if (code == 0)
        code = orl_sources_bsdf(&k->sources, m->bsdf_file, &bsdf, k->err);
    if (code == 0)
        m->bsdf = orl_bsdf_ref(bsdf);
    else
        orl_stream_fail(&k->stream, code);
}

/* Passes one material without the two that it mixes. */
static void pass_material(struct orl_scene_keeping *k, struct orl_material *m)
{
    struct orl_pattern **slots[PATTERNS];
    struct orl_stream *const stream = &k->stream;
    const bool reads = orl_stream_reads(stream);
    bool has_bsdf;
    pass_image(stream, m, &has_bsdf);
    list_patterns(m, slots);
    for (int i = 0; i < PATTERNS; i++)
        orl_keep_pattern(k, slots[i]);
    orl_stream_text(stream, k->d->arena, (const char **)&m->name);
    orl_stream_kept(stream, k->d->arena, &m->cut, m->n_cut, sizeof *m->cut);
    if (reads && has_bsdf && stream->code == 0)
        load_bsdf(k, m);
}

static struct orl_material *room_for_mixed(struct orl_scene_keeping *k)
{
    struct orl_material *const two =
        orl_arena_take(k->d->arena, MIXED * sizeof(struct orl_material));
    if (!two)
        orl_stream_fail(&k->stream, ORL_ERR_NOMEM);
    else
        two[0] = two[1] = (struct orl_material){.kind = ORL_MATERIAL_VOID};
    return two;
}

/* Passes a material and, recursively, those it mixes; the parser bounds the depth. */
static void pass_with_mixed(struct orl_scene_keeping *k, struct orl_material *m)
{
    bool mixes = m->mixed != NULL;
    pass_material(k, m);
    orl_stream_value(&k->stream, &mixes);
    if (!mixes || k->stream.code < 0)
        return;
    struct orl_material *const two = orl_stream_reads(&k->stream)
                                         ? room_for_mixed(k)
                                         : (struct orl_material *)(uintptr_t)m->mixed;
    if (!two)
        return;
    for (int i = 0; i < MIXED; i++)
        pass_with_mixed(k, &two[i]);
    if (orl_stream_reads(&k->stream))
        m->mixed = two;
}

void orl_keep_materials(struct orl_scene_keeping *k)
{
    struct orl_description *const d = k->d;
    size_t n = d->n_materials;
    orl_stream_value(&k->stream, &n);
    orl_stream_room(&k->stream, &d->materials, n, sizeof *d->materials);
    for (size_t i = 0; i < n && k->stream.code == 0; i++) {
        if (orl_stream_reads(&k->stream))
            d->n_materials = i + 1;
        pass_with_mixed(k, &d->materials[i]);
    }
}
