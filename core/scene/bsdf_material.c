/* The BSDF material: its file, its up vector, what it adds. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "scene/material_readers.h"

static int read_bsdf_file(struct orl_parser *parser, const struct orl_scope *scope,
                          struct orl_material *material, struct orl_error *err)
{
    struct orl_bsdf *bsdf = NULL;
    size_t source = 0;
    char name[ORL_ERROR_NAME_MAX];
    int code = orl_sources_find(&parser->sources, scope->folder,
                                orl_primitive_string(&parser->primitive, 1), &source, err);
    if (code < 0) {
        snprintf(name, sizeof name, "%.*s", (int)sizeof name - 1, err->message);
        return orl_parser_fail(parser, scope, err, code, "its BSDF file is missing: %s", name);
    }
    code = orl_sources_bsdf(&parser->sources, source, &bsdf, err);
    if (code < 0) {
        /* The place is in the XML; only what is not said yet is added. */
        const bool has_place = err->file[0] != '\0';
        snprintf(name, sizeof name, "BSDF %.200s", parser->primitive.id);
        orl_error_at(err, has_place ? NULL : scope->file, has_place ? 0 : parser->primitive.line,
                     err->primitive[0] ? NULL : name);
        return code;
    }
    material->bsdf = orl_bsdf_ref(bsdf);
    return 0;
}

static int read_bsdf_diffuse(struct orl_parser *parser, const struct orl_scope *scope,
                             struct orl_material *material, struct orl_error *err)
{
    struct orl_rgb *const parts[3] = {&material->front, &material->back, &material->through};
    const size_t n = parser->primitive.n_reals;
    int code = 0;
    if (n > 9 || n % 3 != 0)
        return orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX,
                               "a BSDF takes 0, 3, 6 or 9 number arguments, not %zu", n);
    for (size_t i = 0; i < 3 && 3 * i < n && code == 0; i++) {
        *parts[i] = orl_material_rgb(parser, 3 * i);
        code = orl_material_share(parser, scope, *parts[i], false, "diffuse part", err);
    }
    return code;
}

int orl_material_read_bsdf(struct orl_parser *parser, const struct orl_scope *scope,
                           struct orl_material *material, struct orl_error *err)
{
    const struct orl_primitive *primitive = &parser->primitive;
    struct orl_xform xform;
    double up[3] = {0, 0, 0};
    int code;
    if (primitive->n_strings < 6)
        return orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX,
                               "a BSDF takes six string arguments: thickness, file, up x y z, and "
                               "'.'; here are %zu",
                               primitive->n_strings);
    code = orl_material_number(parser, scope, 0, &material->thickness, err);
    for (size_t i = 0; i < 3 && code == 0; i++)
        code = orl_material_number(parser, scope, 2 + i, up + i, err);
    if (code == 0 && strcmp(orl_primitive_string(primitive, 5), ".") != 0)
        code = orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED,
                               "function files ('%.60s') are not read: '.' must stand there",
                               orl_primitive_string(primitive, 5));
    if (code == 0)
        code = orl_parser_string_xform(parser, scope, 6, &xform, err);
    if (code == 0 && material->thickness != 0)
        code = orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED,
                               "BSDFs with a thickness, which stand for other geometry, are not "
                               "supported yet");
    if (code < 0)
        return code;
    material->up = orl_xform_vector(&xform, orl_v3(up[0], up[1], up[2]));
    if (!(orl_length(material->up) > 0) || !isfinite(orl_length(material->up)))
        return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE, "its up vector has no length");
    code = read_bsdf_diffuse(parser, scope, material, err);
    return code == 0 ? read_bsdf_file(parser, scope, material, err) : code;
}
