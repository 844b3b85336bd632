/* Materials defined by functions (material/function_brdf/function_brdf.h): prism1 and prism2;
 * plasfunc, metfunc, transfunc, plasdata, metdata and transdata. */
#include <string.h>

#include "scene/parse/material/material_readers.h"

int orl_material_read_prism(struct orl_parser *parser, const struct orl_scope *scope,
                            struct orl_material *material, struct orl_error *err)
{
    return orl_parser_function_brdf(parser, scope, ORL_FUNCTION_BRDF_PRISM, &material->prism_rays,
                                    err);
}

int orl_material_read_function_lobes(struct orl_parser *parser, const struct orl_scope *scope,
                                     struct orl_material *material, struct orl_error *err)
{
    const char *const type = parser->primitive.type;
    const double *const r = parser->primitive.reals;
    const bool trans = strncmp(type, "trans", 5) == 0;
    const size_t least = trans ? 6 : 4;
    if (parser->primitive.n_reals < least)
        return orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX,
                               "%s takes %zu numbers, and those that its function asks for; here "
                               "are %zu",
                               type, least, parser->primitive.n_reals);
    material->color = orl_material_rgb(parser, 0);
    material->specular = r[3];
    material->transmitted = trans ? r[4] : 0;
    material->transmitted_specular = trans ? r[5] : 0;
    material->tints_lobes = strncmp(type, "met", 3) == 0;
    const int code = orl_material_check_reflector(parser, scope, material, err);
    return code < 0 ? code
                    : orl_parser_function_brdf(parser, scope, ORL_FUNCTION_BRDF_LOBES,
                                               &material->lobes, err);
}
