/*
 * WGMDfunc: a sum of other materials (material/mixture.c). Diffuse reflection is one-sided plastic,
 * specular reflection metal, transmission trans, each with the pattern and texture of its own
 * modifier, times its function. Roughness may be a function of the place. Reference: "The RADIANCE
 * Synthetic Imaging System", section 2.1.2.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "scene/material/patterns/pattern.h"
#include "scene/parse/material/material_readers.h"

/* Positions of the strings: those of transmission are TRANSMITTED behind those of reflection. */
enum {
    MODIFIER,
    VALUE,
    ROUGHNESS,
    TRANSMITTED = 4,
    EVENLY_THROUGH = 8,
    ANISOTROPY_AXIS = 9,
    FUNCTION_FILE = 12,
    STRINGS,
    REALS = 9
};

struct reading {
    struct orl_parser *parser;
    const struct orl_scope *scope;
    struct orl_error *err;
    struct orl_material_sum sum;
    struct orl_vec3 anisotropy_axis;
};

static const char *string_at(const struct reading *r, size_t i)
{
    return orl_primitive_string(&r->parser->primitive, i);
}

static bool is_number(const char *text, double *ret_number)
{
    char *end;
    *ret_number = strtod(text, &end);
    return end != text && *end == '\0' && isfinite(*ret_number);
}

/* ---- Modifiers and functions ------------------------------------------------------------------
 */

/* Gives the material the pattern and texture that the i-th string names. */
static int find_modifier(struct reading *r, size_t i, struct orl_material *ret)
{
    const char *const name = string_at(r, i);
    ret->pattern = ret->texture = NULL;
    if (strcmp(name, "void") == 0)
        return 0;
    if (strcmp(name, "inherit") == 0) {
        ret->pattern = r->sum.own.pattern;
        ret->texture = r->sum.own.texture;
        return 0;
    }
    const struct orl_symbol *const symbol = orl_symbols_find(&r->parser->symbols, name);
    if (!symbol || symbol->kind != ORL_SYMBOL_PATTERN)
        return orl_parser_fail(
            r->parser, r->scope, r->err, symbol ? ORL_ERR_UNSUPPORTED : ORL_ERR_NOT_FOUND,
            symbol ? "'%.200s', which modifies a part of it, is not a pattern that is simulated"
                   : "'%.200s', which modifies a part of it, is not defined",
            name);
    struct orl_pattern *const top = r->parser->out->patterns[symbol->index];
    struct orl_pattern *const other =
        top->other ? r->parser->out->patterns[top->other->index] : NULL;
    const bool texture = top->role == ORL_PATTERN_TEXTURE;
    ret->pattern = texture ? other : top;
    ret->texture = texture ? top : other;
    return 0;
}

/* Makes a primitive like the current one, but of that type, with these functions before its
 * function file. The numbers are borrowed. Returns false if out of memory. */
static bool derive_primitive(const struct orl_primitive *from, const char *type, const char *id,
                             const char *const *functions, size_t n, struct orl_primitive *ret)
{
    const char *words[3 + 3] = {from->modifier, type, id};
    const size_t n_words = 3 + n, rest = from->n_strings - FUNCTION_FILE;
    size_t room = 0, used = 0;
    for (size_t i = 0; i < n; i++)
        words[3 + i] = functions[i];
    for (size_t i = 0; i < n_words; i++)
        room += strlen(words[i]) + 1;
    for (size_t i = 0; i < rest; i++)
        room += strlen(orl_primitive_string(from, FUNCTION_FILE + i)) + 1;
    *ret = (struct orl_primitive){.n_strings = n + rest,
                                  .n_reals = from->n_reals,
                                  .reals = from->reals,
                                  .line = from->line,
                                  .text = malloc(room),
                                  .at = calloc(n_words + rest, sizeof *ret->at)};
    for (size_t i = 0; i < n_words + rest && ret->text && ret->at; i++) {
        const char *const word =
            i < n_words ? words[i] : orl_primitive_string(from, FUNCTION_FILE + i - n_words);
        ret->at[i] = used;
        memcpy(ret->text + used, word, strlen(word) + 1);
        used += strlen(word) + 1;
    }
    ret->modifier = from->modifier;
    ret->type = type;
    ret->id = id;
    return ret->text && ret->at;
}

/* Makes a pattern of these functions, over the material's own. */
static int make_pattern(struct reading *r, const char *type, const char *part,
                        const char *const *functions, size_t n, struct orl_material *over,
                        struct orl_pattern **ret_pattern)
{
    struct orl_parser *const parser = r->parser;
    const struct orl_primitive written = parser->primitive;
    struct orl_primitive derived;
    char id[ORL_ERROR_NAME_MAX];
    snprintf(id, sizeof id, "%.180s (%s)", written.id, part);
    int code = ORL_ERR_NOMEM;
    if (derive_primitive(&written, type, id, functions, n, &derived)) {
        parser->primitive = derived;
        code = orl_parser_pattern(parser, r->scope, over->pattern, over->texture, false, r->err);
        parser->primitive = written;
    }
    free(derived.text);
    free(derived.at);
    if (code < 0)
        return code == ORL_ERR_NOMEM ? orl_error_set(r->err, code, "out of memory") : code;
    *ret_pattern = parser->out->patterns[orl_symbols_find(&parser->symbols, id)->index];
    return 0;
}

/* Reads the share of a term of the light, which may be a function. */
static int read_share(struct reading *r, size_t first, struct orl_material *part, double *ret_share)
{
    const char *const text = string_at(r, first + VALUE);
    int code = find_modifier(r, first + MODIFIER, part);
    *ret_share = 1;
    if (code < 0)
        return code;
    if (!is_number(text, ret_share))
        return make_pattern(r, "brightfunc", first ? "transmitted" : "reflected", &text, 1, part,
                            &part->pattern);
    return orl_material_check_range(r->parser, r->scope, orl_gray(*ret_share), true, "share",
                                    r->err);
}

static int read_roughness(struct reading *r, size_t first, struct orl_material *part)
{
    const char *const functions[3] = {string_at(r, first + ROUGHNESS),
                                      string_at(r, first + ROUGHNESS + 1), "0"};
    struct orl_material nothing = {.kind = ORL_MATERIAL_VOID};
    struct orl_reflector *const reflector = &part->as.reflector;
    double *const roughness = reflector->roughness;
    reflector->anisotropy_axis = r->anisotropy_axis;
    if (!is_number(functions[0], &roughness[0]) || !is_number(functions[1], &roughness[1])) {
        roughness[0] = roughness[1] = 1;
        return make_pattern(r, "colorfunc", first ? "transmitted roughness" : "roughness",
                            functions, 3, &nothing, &reflector->roughness_pattern);
    }
    if (!(roughness[0] > 0 && roughness[1] > 0))
        roughness[0] = roughness[1] = 0;
    for (int i = 0; i < 2; i++)
        if (!(roughness[i] <= 1))
            return orl_parser_fail(r->parser, r->scope, r->err, ORL_ERR_RANGE,
                                   "its roughness %g is not from 0 to 1", roughness[i]);
    return 0;
}

/* Reads the direction of the anisotropy axis, which matters if a term is rough. */
static int read_anisotropy_axis(struct reading *r)
{
    struct orl_xform xform;
    double anisotropy_axis[3] = {0, 0, 0};
    int code = orl_parser_string_xform(r->parser, r->scope, STRINGS, &xform, r->err);
    for (size_t i = 0; i < 3 && code == 0; i++)
        code = orl_material_number(r->parser, r->scope, ANISOTROPY_AXIS + i, anisotropy_axis + i,
                                   r->err);
    if (code < 0)
        return code;
    r->anisotropy_axis = orl_xform_vector(
        &xform, orl_v3(anisotropy_axis[0], anisotropy_axis[1], anisotropy_axis[2]));
    if (!isfinite(orl_length(r->anisotropy_axis)))
        return orl_parser_fail(r->parser, r->scope, r->err, ORL_ERR_RANGE,
                               "its grain has no length");
    r->anisotropy_axis =
        orl_length(r->anisotropy_axis) > 0 ? orl_normalize(r->anisotropy_axis) : orl_v3(0, 0, 1);
    return 0;
}

/* ---- Parts ------------------------------------------------------------------------------------
 */

static int add_evenly_through(struct reading *r, struct orl_rgb color)
{
    struct orl_material modifier;
    const int code = find_modifier(r, EVENLY_THROUGH, &modifier);
    /* Textures do not affect transmission. */
    return code < 0 ? code : orl_material_sum_add_through(&r->sum, color, modifier.pattern);
}

/* Adds specular reflection or direct transmission, as a lobe if it is rough. */
static int add_directed(struct reading *r, size_t first)
{
    const bool through = first == TRANSMITTED;
    struct orl_material part =
        orl_material_sum_part(through ? ORL_MATERIAL_TRANS : ORL_MATERIAL_METAL, orl_gray(1));
    double share;
    int code = read_share(r, first, &part, &share);
    if (code < 0 || !(share > 0))
        return code;
    part.color = orl_gray(share);
    part.as.reflector.shares =
        through ? (struct orl_reflector_shares){0, 1, 1} : (struct orl_reflector_shares){1, 0, 0};
    code = read_roughness(r, first, &part);
    if (through)
        part.texture = NULL;
    return code < 0 ? code : orl_material_sum_add(&r->sum, &part);
}

/* All reflecting terms must share one normal, because mirror directions depend on it. */
static int find_texture(struct reading *r, const struct orl_material *m,
                        struct orl_pattern **texture, bool *found)
{
    const struct orl_material *const mixed = orl_material_mixed(m);
    if (mixed) {
        const int code = find_texture(r, &mixed[0], texture, found);
        return code < 0 ? code : find_texture(r, &mixed[1], texture, found);
    }
    if (m->kind == ORL_MATERIAL_TRANS)
        return 0;
    if (*found && *texture != m->texture) {
        orl_parser_fail(r->parser, r->scope, r->err, ORL_ERR_UNSUPPORTED,
                        "its parts have different textures: WGMDfunc is simulated only if all "
                        "reflected parts have the same texture, or none");
        orl_error_hint(r->err, "give them the same modifier ('inherit')");
        return ORL_ERR_UNSUPPORTED;
    }
    *texture = m->texture;
    *found = true;
    return 0;
}

int orl_material_read_wgmd(struct orl_parser *parser, const struct orl_scope *scope,
                           struct orl_material *material, struct orl_error *err)
{
    struct reading r = {.parser = parser,
                        .scope = scope,
                        .err = err,
                        .sum = {parser, scope, err, .own = *material}};
    bool found = false;
    struct orl_pattern *texture = NULL;
    if (parser->primitive.n_strings < STRINGS || parser->primitive.n_reals < REALS)
        return orl_parser_fail(parser, scope, err, ORL_ERR_SYNTAX,
                               "WGMDfunc takes modifier, value and two roughnesses of reflection, "
                               "the same of transmission, a modifier, three numbers of the grain, "
                               "a function file ('.': none), and nine numbers");
    int code = read_anisotropy_axis(&r);
    if (code == 0)
        code = orl_material_sum_add_reflected(&r.sum, orl_material_rgb(parser, 0),
                                              orl_material_rgb(parser, 3));
    if (code == 0)
        code = add_evenly_through(&r, orl_material_rgb(parser, 6));
    if (code == 0)
        code = add_directed(&r, 0);
    if (code == 0)
        code = add_directed(&r, TRANSMITTED);
    const struct orl_material whole = orl_material_sum_result(&r.sum);
    if (code == 0)
        code = find_texture(&r, &whole, &texture, &found);
    if (code < 0)
        return code;
    *material = whole;
    material->texture = texture;
    return 0;
}
