/*
 * The materials BSDF and aBSDF: file, up vector, diffuse additions. A BSDF's first string is its
 * thickness, which an aBSDF does not have; the other strings are equal.
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "scene/parse/material/material_readers.h"

static int read_bsdf_file(struct orl_parser *parser, const struct orl_scope *scope, size_t string,
                          struct orl_bsdf_surface *surface, struct orl_error *err)
{
    struct orl_bsdf *bsdf = NULL;
    size_t source = 0;
    char name[ORL_ERROR_NAME_MAX];
    int code = orl_sources_find(&parser->sources, scope->folder,
                                orl_primitive_string(&parser->primitive, string), &source, err);
    if (code < 0) {
        snprintf(name, sizeof name, "%.*s", (int)sizeof name - 1, err->message);
        orl_parser_fail(parser, scope, err, code, "its BSDF file is missing: %s", name);
        if (code == ORL_ERR_NOT_FOUND)
            orl_sources_hint(err);
        return code;
    }
    code = orl_sources_bsdf(&parser->sources, source, &bsdf, err);
    if (code < 0) {
        /* The loader may have set a place in the XML; only what is missing is added. */
        const bool has_place = err->file[0] != '\0';
        snprintf(name, sizeof name, "BSDF %.200s", parser->primitive.id);
        orl_error_at(err, has_place ? NULL : scope->file, has_place ? 0 : parser->primitive.line,
                     err->primitive[0] ? NULL : name);
        return code;
    }
    surface->bsdf = orl_bsdf_ref(bsdf);
    surface->file = (uint32_t)source;
    return 0;
}

static int read_bsdf_diffuse(struct orl_parser *parser, const struct orl_scope *scope,
                             struct orl_diffuse_parts *diffuse, struct orl_error *err)
{
    struct orl_rgb *const parts[3] = {&diffuse->front, &diffuse->back, &diffuse->through};
    const size_t n = parser->primitive.n_reals;
    int code = 0;
    if (n > 9 || n % 3 != 0)
        return orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX,
                               "a BSDF takes 0, 3, 6 or 9 number arguments, not %zu", n);
    for (size_t i = 0; i < 3 && 3 * i < n && code == 0; i++) {
        *parts[i] = orl_material_rgb(parser, 3 * i);
        code = orl_material_check_range(parser, scope, *parts[i], false, "diffuse part", err);
    }
    return code;
}

/* Warns if data and additions together may exceed an albedo of 1. */
static void warn_of_gain(struct orl_parser *parser, const struct orl_bsdf_surface *surface)
{
    const struct orl_diffuse_parts *const diffuse = &surface->diffuse;
    struct orl_bsdf_info info;
    const double through = orl_rgb_max(diffuse->through);
    const double added[2] = {orl_rgb_max(diffuse->back) + through,
                             orl_rgb_max(diffuse->front) + through};
    orl_bsdf_describe(surface->bsdf, &info);
    for (int front = 0; front < 2; front++)
        if (added[front] > 0 && fmin(1, info.max_albedo[front]) + added[front] > 1)
            orl_parser_warn(parser,
                            "BSDF %s: with its diffuse parts it scatters up to %.3f of the light "
                            "from its %s; values above 1 are rescaled to 1",
                            parser->primitive.id, fmin(1, info.max_albedo[front]) + added[front],
                            front ? "front" : "back");
}

/* Reads the thickness, if there is one, and the up vector. */
static int read_bsdf_numbers(struct orl_parser *parser, const struct orl_scope *scope, size_t file,
                             struct orl_bsdf_surface *surface, struct orl_error *err)
{
    struct orl_xform xform = orl_xform_identity;
    double up[3] = {0, 0, 0};
    int code = file == 0 ? 0 : orl_material_number(parser, scope, 0, &surface->thickness, err);
    for (size_t i = 0; i < 3 && code == 0; i++)
        code = orl_material_number(parser, scope, file + 1 + i, up + i, err);
    if (code == 0 && strcmp(orl_primitive_string(&parser->primitive, file + 4), ".") != 0)
        code = orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED,
                               "function files ('%.60s') are not supported here: write '.' instead",
                               orl_primitive_string(&parser->primitive, file + 4));
    if (code == 0)
        code = orl_parser_string_xform(parser, scope, file + 5, &xform, err);
    if (code < 0)
        return code;
    surface->thickness *= xform.scale;
    if (!isfinite(surface->thickness))
        return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE, "its thickness is too large");
    surface->up = orl_xform_vector(&xform, orl_v3(up[0], up[1], up[2]));
    if (!(orl_length(surface->up) > 0) || !isfinite(orl_length(surface->up)))
        return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE, "its up vector has no length");
    return 0;
}

int orl_material_read_bsdf(struct orl_parser *parser, const struct orl_scope *scope,
                           struct orl_material *material, struct orl_error *err)
{
    const struct orl_primitive *primitive = &parser->primitive;
    struct orl_bsdf_surface *const surface = &material->as.bsdf_surface;
    /* index of the string with the file */
    const size_t file = strcmp(primitive->type, "aBSDF") == 0 ? 0 : 1;
    int code;
    surface->peak = file == 0;
    if (primitive->n_strings < file + 5)
        return orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX,
                               "%s string arguments: %sfile, up x y z, and '.', not %zu",
                               file == 0 ? "an aBSDF takes five" : "a BSDF takes six",
                               file == 0 ? "" : "thickness, ", primitive->n_strings);
    code = read_bsdf_numbers(parser, scope, file, surface, err);
    if (code == 0)
        code = read_bsdf_diffuse(parser, scope, &surface->diffuse, err);
    if (code == 0)
        code = read_bsdf_file(parser, scope, file, surface, err);
    if (code == 0)
        warn_of_gain(parser, surface);
    return code;
}
