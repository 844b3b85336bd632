#include "scene/parse/mesh/mesh_formats.h"

#include <stdlib.h>
#include <string.h>

#include <oriel/base/scanner.h>

#include "base/memory/memory.h"

enum qualifier { OF_MATERIAL, OF_MAP, OF_GROUP, OF_OBJECT, OF_FACE, QUALIFIERS };
static const char *const qualifiers[QUALIFIERS] = {"Material", "Map", "Group", "Object", "Face"};

enum { MOST_RULES = 10000 };

/* A condition on a name, or on integers from low to high. */
struct condition {
    bool asked, is_range;
    char name[ORL_WAVEFRONT_NAME];
    long long low, high;
};

struct rule {
    char material[ORL_WAVEFRONT_NAME];
    struct condition conditions[QUALIFIERS];
};

struct orl_material_rules {
    struct rule *rules;
    size_t count, room;
};

/* ---- Reading --------------------------------------------------------------------------------- */

static int fail(const struct orl_scanner *r, const char *what, struct orl_error *err)
{
    return orl_scanner_fail(r, ORL_ERR_SYNTAX, err, "%s", what);
}

/* Returns the next character that is not blank and not in a comment; NUL at the end. */
static char peek(struct orl_scanner *r)
{
    for (r->fresh = false; r->at < r->end;) {
        if (orl_byte_kind_of(*r->at) == ORL_BYTE_BLANK)
            r->at++;
        else if (*r->at == '#')
            r->at = orl_line_end(r->at, r->end);
        else if (orl_byte_kind_of(*r->at) == ORL_BYTE_WORD)
            return *r->at;
        else
            orl_scanner_next_line(r);
    }
    return '\0';
}

/* Consumes the character if it is the next one. */
static bool take_character(struct orl_scanner *r, char wanted)
{
    if (peek(r) != wanted || r->at == r->end)
        return false;
    r->at++;
    return true;
}

/* Reads a word, or a quoted string. */
static bool take_name(struct orl_scanner *r, char ret_name[ORL_WAVEFRONT_NAME])
{
    const bool quoted = take_character(r, '"');
    size_t length = 0;
    if (!quoted)
        peek(r);
    for (; r->at < r->end && length + 1 < ORL_WAVEFRONT_NAME; r->at++) {
        const char c = *r->at;
        if (quoted ? c == '"' || orl_byte_kind_of(c) == ORL_BYTE_LINE_END
                   : orl_byte_kind_of(c) != ORL_BYTE_WORD || strchr("();\"[]:", c))
            break;
        ret_name[length++] = c;
    }
    ret_name[length] = '\0';
    return quoted ? r->at < r->end && *r->at++ == '"' : length > 0;
}

static bool take_whole(struct orl_scanner *r, long long *ret_number)
{
    char text[ORL_WAVEFRONT_NAME], *end;
    if (!take_name(r, text))
        return false;
    *ret_number = strtoll(text, &end, 10);
    return *end == '\0';
}

static int read_condition(struct orl_scanner *r, struct rule *rule, struct orl_error *err)
{
    char name[ORL_WAVEFRONT_NAME];
    int q = 0;
    if (!take_name(r, name))
        return fail(r, "a condition must be like (Group \"name\") or (Face [1:20])", err);
    while (q < QUALIFIERS && strcmp(qualifiers[q], name) != 0)
        q++;
    if (q == QUALIFIERS)
        return fail(r, "a condition must begin with Material, Map, Group, Object or Face", err);
    struct condition *c = &rule->conditions[q];
    if (c->asked)
        return fail(r, "a rule has two conditions of the same kind", err);
    c->asked = true;
    c->is_range = take_character(r, '[');
    if (c->is_range && (!take_whole(r, &c->low) || !take_character(r, ':') ||
                        !take_whole(r, &c->high) || !take_character(r, ']')))
        return fail(r, "a range must be like [1:20]", err);
    if (!c->is_range && !take_name(r, c->name))
        return fail(r, "a condition needs a name or a range", err);
    return take_character(r, ')') ? 0 : fail(r, "a condition must end with ')'", err);
}

static int read_rule(struct orl_scanner *r, struct rule *rule, struct orl_error *err)
{
    int code = 0;
    *rule = (struct rule){.material = ""};
    if (!take_name(r, rule->material))
        return fail(r, "a rule must begin with a material", err);
    while (code == 0 && take_character(r, '('))
        code = read_condition(r, rule, err);
    if (code == 0 && !take_character(r, ';'))
        code = fail(r, "a rule must end with ';'", err);
    return code;
}

static int add_rule(struct orl_material_rules *rules, struct orl_scanner *r, struct orl_error *err)
{
    if (rules->count == MOST_RULES)
        return fail(r, "there are more than 10000 rules", err);
    if (!orl_array_reserve(&rules->rules, &rules->room, rules->count, sizeof *rules->rules))
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    return read_rule(r, &rules->rules[rules->count++], err);
}

int orl_material_rules_read(const char *file, const char *text, size_t size,
                            struct orl_material_rules **ret_rules, struct orl_error *err)
{
    struct orl_scanner r;
    struct orl_material_rules *rules = calloc(1, sizeof *rules);
    if (!rules)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    int code = orl_scanner_init(&r, file, text, size, 0, err);
    while (code == 0 && peek(&r))
        code = add_rule(rules, &r, err);
    if (code < 0)
        orl_material_rules_free(rules);
    else
        *ret_rules = rules;
    return code;
}

void orl_material_rules_free(struct orl_material_rules *rules)
{
    if (!rules)
        return;
    free(rules->rules);
    free(rules);
}

/* ---- Use ------------------------------------------------------------------------------------- */

static bool in_range(const struct condition *c, const char *name)
{
    char *end;
    const long long number = strtoll(name, &end, 10);
    return end != name && *end == '\0' && number >= c->low && number <= c->high;
}

static bool suits(const struct condition *c, const char *name)
{
    return c->is_range ? in_range(c, name) : strcmp(c->name, name) == 0;
}

static bool suits_face(const struct condition *c, uint64_t number)
{
    char *end;
    const long long one = c->is_range ? 0 : strtoll(c->name, &end, 10);
    return c->is_range ? (long long)number >= c->low && (long long)number <= c->high
                       : (long long)number == one;
}

static bool suits_group(const struct condition *c, const struct orl_wavefront_face *face)
{
    for (size_t i = 0; i < face->n_groups; i++)
        if (suits(c, face->groups[i]))
            return true;
    return false;
}

static bool rule_matches(const struct rule *rule, const struct orl_wavefront_face *face)
{
    const struct condition *c = rule->conditions;
    return (!c[OF_MATERIAL].asked || suits(&c[OF_MATERIAL], face->material)) &&
           (!c[OF_MAP].asked || suits(&c[OF_MAP], face->map)) &&
           (!c[OF_OBJECT].asked || suits(&c[OF_OBJECT], face->object)) &&
           (!c[OF_FACE].asked || suits_face(&c[OF_FACE], face->number)) &&
           (!c[OF_GROUP].asked || suits_group(&c[OF_GROUP], face));
}

const char *orl_material_rules_choose(const struct orl_material_rules *rules,
                                      const struct orl_wavefront_face *face)
{
    for (size_t i = rules->count; i-- > 0;)
        if (rule_matches(&rules->rules[i], face))
            return strcmp(rules->rules[i].material, "void") == 0 ? NULL : rules->rules[i].material;
    return NULL;
}
