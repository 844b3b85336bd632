/* antimatter: its strings name the materials that it cuts (geometry/antimatter/antimatter.h). */
#include <string.h>

#include <oriel/base/limits.h>

#include "scene/parse/material/material_readers.h"

/* Returns true for opaque materials that do not emit. Others cannot be cut, because windows and
 * lights are sampled by area. */
static bool is_cuttable(const struct orl_material *m)
{
    switch (m->kind) {
    case ORL_MATERIAL_PLASTIC:
    case ORL_MATERIAL_METAL:
    case ORL_MATERIAL_ASHIKHMIN:
        return true;
    case ORL_MATERIAL_MIXTURE:
        return is_cuttable(&orl_mixture_of(m)->mixed[0]) &&
               is_cuttable(&orl_mixture_of(m)->mixed[1]);
    default:
        return false;
    }
}

/* Finds the material that one of its strings names. */
static int find_cut(struct orl_parser *parser, const struct orl_scope *scope, size_t i,
                    uint32_t *ret_index, struct orl_error *err)
{
    const char *const name = orl_primitive_string(&parser->primitive, i);
    const struct orl_symbol *const symbol = orl_symbols_find(&parser->symbols, name);
    if (!symbol)
        return orl_parser_fail(parser, scope, err, ORL_ERR_NOT_FOUND,
                               "'%.200s', which it cuts, is not defined before it", name);
    if (symbol->kind == ORL_SYMBOL_MATERIAL &&
        is_cuttable(&parser->out->materials[symbol->index])) {
        *ret_index = symbol->index;
        return 0;
    }
    orl_parser_fail(
        parser, scope, err, ORL_ERR_UNSUPPORTED,
        "antimatter can cut only plastic, metal, ashik2 and mixtures of these, not '%.200s'", name);
    orl_error_hint(err, "cut the hole into the polygons of that material");
    return ORL_ERR_UNSUPPORTED;
}

int orl_material_read_antimatter(struct orl_parser *parser, const struct orl_scope *scope,
                                 struct orl_material *material, struct orl_error *err)
{
    const size_t n = parser->primitive.n_strings;
    int code = orl_parser_expect(parser, scope, n, 0, err);
    if (code < 0)
        return code;
    if (n < 1 || n > ORL_LIMIT_CUT)
        return orl_parser_fail(
            parser, scope, err, ORL_ERR_SYNTAX,
            "antimatter takes the names of 1 to %u materials that it cuts, not %zu", ORL_LIMIT_CUT,
            n);
    uint32_t *const cut = orl_arena_alloc(parser->out->arena, n * sizeof *cut);
    if (!cut)
        return orl_parser_fail(parser, scope, err, ORL_ERR_NOMEM, "out of memory");
    struct orl_antimatter *const antimatter = &material->as.antimatter;
    *antimatter = (struct orl_antimatter){.cut = cut, .lining = -1};
    for (size_t i = 0; i < n && code == 0; i++) {
        if (strcmp(orl_primitive_string(&parser->primitive, i), "void") == 0)
            continue;
        code = find_cut(parser, scope, i, &cut[antimatter->n_cut], err);
        if (code == 0 && i == 0)
            antimatter->lining = (int32_t)cut[0];
        antimatter->n_cut += code == 0;
    }
    return code;
}
