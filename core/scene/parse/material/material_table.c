/* The table of materials while a scene is read; copies of materials with a mesh's corner normals.
 * */
#include <stdlib.h>
#include <string.h>

#include "base/memory/memory.h"
#include "scene/material/patterns/pattern.h"
#include "scene/parse/parser.h"

int orl_parser_add_material(struct orl_parser *parser, const char *name,
                            struct orl_material *material, uint32_t *ret_index)
{
    struct orl_parsed_scene *out = parser->out;
    material->name = orl_arena_copy_text(out->arena, name, strlen(name));
    if (!material->name || out->n_materials >= UINT32_MAX ||
        !orl_array_reserve(&out->materials, &parser->materials_room, out->n_materials,
                           sizeof *out->materials)) {
        orl_bsdf_unref(orl_material_bsdf(material));
        return ORL_ERR_NOMEM;
    }
    *ret_index = (uint32_t)out->n_materials;
    out->materials[out->n_materials++] = *material;
    return 0;
}

int orl_parser_void(struct orl_parser *parser, uint32_t *ret_index)
{
    struct orl_material nothing = {.kind = ORL_MATERIAL_VOID, .sky = -1};
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
    const struct orl_material *const mixed = orl_material_mixed(material);
    if (!mixed)
        return 0;
    struct orl_material *const both = orl_arena_alloc(parser->out->arena, 2 * sizeof *both);
    if (!both)
        return ORL_ERR_NOMEM;
    for (int i = 0; i < 2; i++) {
        both[i] = mixed[i];
        both[i].texture = material->texture;
        if (turn_mixed(parser, &both[i]) < 0)
            return ORL_ERR_NOMEM;
    }
    material->as.mixture.mixed = both;
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
                                    .source = ORL_PATTERN_MESH_NORMALS,
                                    .role = ORL_PATTERN_TEXTURE,
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
