/* The table of materials while a scene is read. */
#include <string.h>

#include "base/memory/array.h"
#include "scene/parse/parser.h"

static bool same_rgb(struct orl_rgb a, struct orl_rgb b)
{
    return a.r == b.r && a.g == b.g && a.b == b.b;
}

static bool same_vec3(struct orl_vec3 a, struct orl_vec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

static bool same_medium(struct orl_medium a, struct orl_medium b)
{
    return same_rgb(a.transmissivity, b.transmissivity) && a.ior == b.ior;
}

static bool same_reflector(const struct orl_material *a, const struct orl_material *b)
{
    return same_rgb(a->color, b->color) && a->specular == b->specular &&
           a->roughness[0] == b->roughness[0] && a->roughness[1] == b->roughness[1] &&
           a->roughness_pattern == b->roughness_pattern && a->diffuse_side == b->diffuse_side &&
           same_vec3(a->anisotropy_axis, b->anisotropy_axis) && same_rgb(a->gloss, b->gloss) &&
           a->power[0] == b->power[0] && a->power[1] == b->power[1] && a->angles == b->angles &&
           a->prism_rays == b->prism_rays && a->lobes == b->lobes &&
           a->transmitted == b->transmitted && a->transmitted_specular == b->transmitted_specular &&
           same_rgb(a->extinction, b->extinction) && same_rgb(a->scattered, b->scattered) &&
           a->asymmetry == b->asymmetry;
}

static bool same_clear(const struct orl_material *a, const struct orl_material *b)
{
    return same_rgb(a->transmissivity, b->transmissivity) && a->ior == b->ior &&
           same_medium(a->media[0], b->media[0]) && same_medium(a->media[1], b->media[1]);
}

static bool same_bsdf(const struct orl_material *a, const struct orl_material *b)
{
    return a->bsdf == b->bsdf && a->thickness == b->thickness && same_vec3(a->up, b->up) &&
           a->peak == b->peak && same_rgb(a->front, b->front) && same_rgb(a->back, b->back) &&
           same_rgb(a->through, b->through);
}

static bool same_light(const struct orl_material *a, const struct orl_material *b)
{
    return a->max_radius == b->max_radius && same_vec3(a->beam_axis, b->beam_axis) &&
           a->cos_cone == b->cos_cone && a->focus == b->focus && a->seen_as == b->seen_as &&
           a->sky == b->sky && a->pattern == b->pattern && a->texture == b->texture;
}

static bool same_antimatter(const struct orl_material *a, const struct orl_material *b)
{
    return a->n_cut == b->n_cut && a->lining == b->lining &&
           (a->n_cut == 0 || memcmp(a->cut, b->cut, a->n_cut * sizeof *a->cut) == 0);
}

/* Returns true if two materials of one name are equal: arrays read the same definitions again. */
bool orl_material_same(const struct orl_material *a, const struct orl_material *b)
{
    if (!a->mixed != !b->mixed)
        return false;
    for (int i = 0; i < 2 && a->mixed && b->mixed; i++)
        if (!orl_material_same(&a->mixed[i], &b->mixed[i]))
            return false;
    return a->kind == b->kind && a->mix == b->mix && same_reflector(a, b) && same_clear(a, b) &&
           same_bsdf(a, b) && same_light(a, b) && same_antimatter(a, b);
}

int orl_parser_add_material(struct orl_parser *parser, const char *name,
                            struct orl_material *material, uint32_t *ret_index)
{
    struct orl_parsed_scene *out = parser->out;
    material->name = orl_arena_copy_text(out->arena, name, strlen(name));
    if (!material->name || out->n_materials >= UINT32_MAX ||
        !orl_array_reserve(&out->materials, &parser->materials_room, out->n_materials,
                           sizeof *out->materials)) {
        orl_bsdf_unref(material->bsdf);
        return ORL_ERR_NOMEM;
    }
    *ret_index = (uint32_t)out->n_materials;
    out->materials[out->n_materials++] = *material;
    return 0;
}

int orl_parser_void(struct orl_parser *parser, uint32_t *ret_index)
{
    struct orl_material nothing = {
        .kind = ORL_MATERIAL_VOID, .seen_as = ORL_SEEN_AS_ITSELF, .sky = -1};
    if (parser->void_material < 0) {
        uint32_t index = 0;
        if (orl_parser_add_material(parser, "void", &nothing, &index) < 0)
            return ORL_ERR_NOMEM;
        parser->void_material = (int32_t)index;
    }
    *ret_index = (uint32_t)parser->void_material;
    return 0;
}
