/* The table of materials while a scene is read; copies of materials with a mesh's corner normals.
 * */
#include <stdlib.h>
#include <string.h>

#include "base/memory/memory.h"
#include "scene/material/patterns/pattern.h"
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
           same_rgb(a->extinction, b->extinction) && same_rgb(a->scattering, b->scattering) &&
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

/*
 * Materials of meshes with corner normals: each gets a copy with the same name, whose texture these
 * normals are, over its own textures.
 */

/* Returns true if shading depends on the normal; lights, skies, BSDFs and absorbers do not. */
static bool is_turned(const struct orl_material *material)
{
    switch (material->kind) {
    case ORL_MATERIAL_PLASTIC:
    case ORL_MATERIAL_METAL:
    case ORL_MATERIAL_TRANS:
    case ORL_MATERIAL_ASHIKHMIN:
    case ORL_MATERIAL_GLASS:
    case ORL_MATERIAL_DIELECTRIC:
    case ORL_MATERIAL_MIRROR:
    case ORL_MATERIAL_MIXTURE:
        return true;
    default:
        return false;
    }
}

/* Gives the mixed materials the mixture's texture. */
static int turn_mixed(struct orl_parser *parser, struct orl_material *material)
{
    if (!material->mixed)
        return 0;
    struct orl_material *const both = orl_arena_alloc(parser->out->arena, 2 * sizeof *both);
    if (!both)
        return ORL_ERR_NOMEM;
    for (int i = 0; i < 2; i++) {
        both[i] = material->mixed[i];
        both[i].texture = material->texture;
        if (turn_mixed(parser, &both[i]) < 0)
            return ORL_ERR_NOMEM;
    }
    material->mixed = both;
    return 0;
}

static int add_twin(struct orl_parser *parser, uint32_t material, uint32_t *ret_index)
{
    struct orl_material twin = parser->out->materials[material];
    struct orl_pattern *const texture = calloc(1, sizeof *texture);
    if (!texture)
        return ORL_ERR_NOMEM;
    *texture = (struct orl_pattern){.name = "mesh normals",
                                    .file = "",
                                    .texture = true,
                                    .smooth = true,
                                    .under = twin.texture,
                                    .steps = 1};
    int code = orl_parser_add_pattern(parser, texture);
    if (code < 0)
        return code;
    twin.texture = texture;
    twin.copy_of = orl_material_origin(&twin, material) + 1;
    code = turn_mixed(parser, &twin);
    if (code < 0)
        return code;
    return orl_parser_add_material(parser, twin.name, &twin, ret_index);
}

/* Grows the table to the number of materials; new entries are empty. */
static int make_room(struct orl_parser *parser)
{
    const size_t n = parser->out->n_materials;
    if (n <= parser->n_smooth)
        return 0;
    uint32_t *const grown = realloc(parser->smooth, 2 * n * sizeof *grown);
    if (!grown)
        return ORL_ERR_NOMEM;
    for (size_t i = parser->n_smooth; i < 2 * n; i++)
        grown[i] = UINT32_MAX;
    parser->smooth = grown;
    parser->n_smooth = 2 * n;
    return 0;
}

int orl_parser_smooth(struct orl_parser *parser, uint32_t material, uint32_t *ret_index)
{
    *ret_index = material;
    if (!is_turned(&parser->out->materials[material]))
        return 0;
    if (make_room(parser) < 0)
        return ORL_ERR_NOMEM;
    if (parser->smooth[material] == UINT32_MAX) {
        const int code = add_twin(parser, material, &parser->smooth[material]);
        if (code < 0)
            return code;
    }
    *ret_index = parser->smooth[material];
    return 0;
}
