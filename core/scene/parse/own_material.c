/* Materials whose doing functions say (material/own.h): prism1 and prism2. */
#include "scene/parse/material_readers.h"

int orl_material_read_prism(struct orl_parser *parser, const struct orl_scope *scope,
                            struct orl_material *material, struct orl_error *err)
{
    return orl_parser_own(parser, scope, ORL_OWN_WAYS, &material->ways, err);
}
