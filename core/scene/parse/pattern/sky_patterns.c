/*
 * Sky patterns: brightfunc as gendaylit and gensky write it. Other patterns are read by patterns.c.
 * References: gendaylit(1), gensky(1), perezlum.cal and skybright.cal of Radiance.
 */
#include <math.h>
#include <string.h>

#include "base/memory/memory.h"
#include "scene/parse/parser.h"

static bool ends_with(const char *path, const char *name)
{
    return strcmp(basename(path), name) == 0;
}

/* Returns the index of the sun's direction in the arguments, or -1 for skies without one. */
static int sun_argument(const struct orl_sky *sky)
{
    if (sky->kind == ORL_SKY_PEREZ)
        return 7;
    return sky->n_args == 7 ? 4 : -1;
}

/*
 * Refuses arguments for which the radiance overflows or is NaN: exp(A4 / 0.01) at the horizon,
 * exp(A6 pi) opposite the sun. The Perez model itself stays below A4 = 0.32 and A6 = 1.9; large
 * negative values of both are harmless, and common.
 */
static int check_size(struct orl_parser *parser, const struct orl_scope *scope,
                      const struct orl_sky *sky, struct orl_error *err)
{
    const double most = 1e12, steepest = 1, sharpest = 30;
    const bool perez = sky->kind == ORL_SKY_PEREZ;
    for (int i = 0; i < sky->n_args; i++) {
        const double high = perez && i == 3 ? steepest : perez && i == 5 ? sharpest : most;
        if (!(sky->a[i] >= -most && sky->a[i] <= high))
            return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE,
                                   "its argument A%d, %g, makes a sky with infinite radiance",
                                   i + 1, sky->a[i]);
    }
    if (!perez && sky->n_args == 7 && sky->a[0] != 2 && sky->a[0] != 3 && sky->a[3] < 1 / most)
        return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE,
                               "its normalisation %g (the fourth number) is too small", sky->a[3]);
    return 0;
}

static int read_cie_type(struct orl_parser *parser, const struct orl_scope *scope,
                         const struct orl_sky *sky, struct orl_error *err)
{
    const double type = sky->a[0];
    const bool overcast = type == 2 || type == 3;
    if (!overcast && type != 1 && type != 4)
        return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE, "sky type %g is not 1, 2, 3 or 4",
                               type);
    if (!overcast && sky->n_args != 7)
        return orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX,
                               "a clear or intermediate sky takes 7 number arguments");
    if (!overcast && !(sky->a[3] > 0))
        return orl_parser_fail(parser, scope, err, ORL_ERR_RANGE,
                               "its normalisation %g (the fourth number) is not positive",
                               sky->a[3]);
    return 0;
}

bool orl_parser_is_sky(const struct orl_primitive *primitive)
{
    const char *file = primitive->n_strings > 1 ? orl_primitive_string(primitive, 1) : "";
    return strcmp(primitive->type, "brightfunc") == 0 &&
           (ends_with(file, "perezlum.cal") || ends_with(file, "skybright.cal"));
}

/* Reads the kind of pattern, and its arguments as written. */
static int read_pattern(struct orl_parser *parser, const struct orl_scope *scope,
                        struct orl_sky *sky, struct orl_error *err)
{
    const struct orl_primitive *primitive = &parser->primitive;
    const size_t n = primitive->n_reals;
    const char *variable = primitive->n_strings > 0 ? orl_primitive_string(primitive, 0) : "";
    const char *file = primitive->n_strings > 1 ? orl_primitive_string(primitive, 1) : "";
    const bool perez = strcmp(variable, "skybright") == 0 && ends_with(file, "perezlum.cal");
    const bool cie = (strcmp(variable, "skybr") == 0 || strcmp(variable, "skybright") == 0) &&
                     ends_with(file, "skybright.cal");
    if (!perez && !cie) {
        orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED,
                        "only the skies of gendaylit (skybright perezlum.cal) and gensky (skybr "
                        "skybright.cal) are supported, not '%.40s %.60s'",
                        variable, file);
        return ORL_ERR_UNSUPPORTED;
    }
    if (perez ? n != 10 : n != 3 && n != 7)
        return orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX,
                               "%s takes %s number arguments, not %zu", variable,
                               perez ? "10" : "3 or 7", n);
    sky->kind = perez ? ORL_SKY_PEREZ : ORL_SKY_CIE;
    sky->n_args = (int)n;
    memcpy(sky->a, primitive->reals, n * sizeof *sky->a);
    return cie ? read_cie_type(parser, scope, sky, err) : 0;
}

/* Rotates the sky with its scene; only about the vertical, because its formula depends on the
 * zenith. */
static int turn_sky(struct orl_parser *parser, const struct orl_scope *scope, struct orl_sky *sky,
                    struct orl_error *err)
{
    struct orl_xform xform;
    const int at = sun_argument(sky);
    const int code = orl_parser_string_xform(parser, scope, 2, &xform, err);
    if (code < 0)
        return code;
    const struct orl_vec3 up =
        orl_scale(orl_xform_vector(&xform, orl_v3(0, 0, 1)), 1.0 / xform.scale);
    if (!(up.z > 1.0 - 1e-9))
        return orl_parser_fail(parser, scope, err, ORL_ERR_UNSUPPORTED,
                               "a sky can be rotated only about the vertical");
    if (at < 0)
        return 0;
    const struct orl_vec3 sun =
        orl_xform_vector(&xform, orl_v3(sky->a[at], sky->a[at + 1], sky->a[at + 2]));
    sky->a[at] = sun.x / xform.scale;
    sky->a[at + 1] = sun.y / xform.scale;
    sky->a[at + 2] = sun.z / xform.scale;
    return 0;
}

static bool same_arguments(const struct orl_sky *a, const struct orl_sky *b)
{
    for (int i = 0; i < a->n_args; i++)
        if (a->a[i] != b->a[i])
            return false;
    return a->n_args == b->n_args;
}

int orl_parser_sky(struct orl_parser *parser, const struct orl_scope *scope, const char *name,
                   struct orl_error *err)
{
    struct orl_parsed_scene *out = parser->out;
    struct orl_sky sky = {0};
    struct orl_symbol symbol = {.kind = ORL_SYMBOL_SKY};
    const struct orl_symbol *old = orl_symbols_find(&parser->symbols, name);
    int code = read_pattern(parser, scope, &sky, err);
    if (code == 0)
        code = turn_sky(parser, scope, &sky, err);
    if (code == 0)
        code = check_size(parser, scope, &sky, err);
    if (code < 0)
        return code;
    if (old && old->kind == ORL_SYMBOL_SKY && out->skies[old->index].kind == sky.kind &&
        same_arguments(out->skies + old->index, &sky))
        return 0;
    symbol.name = orl_arena_copy_text(out->arena, name, strlen(name));
    symbol.index = (uint32_t)out->n_skies;
    if (!symbol.name || out->n_skies >= INT32_MAX ||
        !orl_array_reserve(&out->skies, &parser->skies_room, out->n_skies, sizeof *out->skies) ||
        orl_symbols_set(&parser->symbols, symbol) < 0)
        return orl_parser_fail(parser, scope, err, ORL_ERR_NOMEM, "out of memory");
    out->skies[out->n_skies++] = sky;
    return 0;
}
