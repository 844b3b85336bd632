/* Named and current items of MGF; conversion of words to numbers. */
#include "scene/generate/mgf/mgf_context.h"

#include <search.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text/words.h"

/* ---- Words ----------------------------------------------------------------------------------- */

void orl_mgf_fail(struct orl_mgf_reader *r, int code, const char *format, ...)
{
    char entity[80];
    va_list args;
    if (r->code)
        return;
    va_start(args, format);
    r->code = orl_error_vset(r->err, code, format, args);
    va_end(args);
    snprintf(entity, sizeof entity, "MGF's %.60s", r->n_words > 0 ? r->words[0] : "end");
    orl_error_at(r->err, r->texts[r->n_texts - 1].text.file, r->line, entity);
}

void orl_mgf_expect_words(struct orl_mgf_reader *r, size_t least, size_t most)
{
    const size_t n = r->n_words - 1;
    if (n > most)
        orl_mgf_fail(r, ORL_ERR_SYNTAX, "it takes at most %zu words, not %zu", most, n);
    else if (n < least)
        orl_mgf_fail(r, ORL_ERR_SYNTAX, "it takes %zu words%s, not %zu", least,
                     most > least ? " or more" : "", n);
}

double orl_mgf_number(struct orl_mgf_reader *r, size_t i)
{
    double value = 0;
    const char *const word = i < r->n_words ? r->words[i] : "";
    const struct orl_slice span = {word, strlen(word)};
    if (orl_number_read(span.text, span.length, &value) != ORL_NUMBER_OK)
        orl_mgf_fail(r, ORL_ERR_SYNTAX,
                     orl_slice_is_decimal_comma(span)
                         ? "%.60s: a decimal comma; write it with a point"
                         : "'%.60s' is not a number",
                     word);
    return value;
}

/* ---- Names ----------------------------------------------------------------------------------- */

#define GRAY                                                                                       \
    {                                                                                              \
        1. / 3, 1. / 3                                                                             \
    }
#define NOTHING                                                                                    \
    {                                                                                              \
        .color = GRAY                                                                              \
    }
static const struct orl_mgf_item defaults[ORL_MGF_KINDS] = {
    [ORL_MGF_COLOR] = {.is.color = GRAY},
    [ORL_MGF_MATERIAL] = {.is.material = {NOTHING, NOTHING, NOTHING, NOTHING, NOTHING, .index = 1}},
    [ORL_MGF_VERTEX] = {.is.vertex = {{0}, {0}}},
};
static char no_name[] = "";

static int compare_names(const void *a, const void *b)
{
    return strcmp(((const struct orl_mgf_item *)a)->name, ((const struct orl_mgf_item *)b)->name);
}

static void free_item(void *node)
{
    struct orl_mgf_item *item = node;
    free(item->name);
    free(item);
}

void orl_mgf_context_init(struct orl_mgf_reader *r)
{
    for (int kind = 0; kind < ORL_MGF_KINDS; kind++) {
        r->nameless[kind] = defaults[kind];
        r->nameless[kind].name = no_name;
        r->current[kind] = &r->nameless[kind];
    }
}

void orl_mgf_context_done(struct orl_mgf_reader *r)
{
    for (int kind = 0; kind < ORL_MGF_KINDS; kind++)
        tdestroy(r->named[kind], free_item);
}

static struct orl_mgf_item *look_up(struct orl_mgf_reader *r, enum orl_mgf_kind kind, char *name)
{
    const struct orl_mgf_item key = {.name = name};
    struct orl_mgf_item *const *found = tfind(&key, &r->named[kind], compare_names);
    return found ? *found : NULL;
}

const struct orl_mgf_item *orl_mgf_find(struct orl_mgf_reader *r, enum orl_mgf_kind kind,
                                        const char *name)
{
    static const char *const kinds[ORL_MGF_KINDS] = {"colour", "material", "vertex"};
    const struct orl_mgf_item *const item = look_up(r, kind, (char *)name);
    if (!item)
        orl_mgf_fail(r, ORL_ERR_SYNTAX, "the %s '%.60s' has not been defined", kinds[kind], name);
    return item ? item : &defaults[kind];
}

/* Returns the item of that name, created if there is none. */
static struct orl_mgf_item *find_or_add(struct orl_mgf_reader *r, enum orl_mgf_kind kind,
                                        char *name)
{
    struct orl_mgf_item *item = look_up(r, kind, name);
    if (item)
        return item;
    item = calloc(1, sizeof *item);
    if (item)
        item->name = strdup(name);
    if (!item || !item->name || !tsearch(item, &r->named[kind], compare_names)) {
        if (item)
            free_item(item);
        orl_mgf_fail(r, ORL_ERR_NOMEM, "out of memory");
        return NULL;
    }
    return item;
}

void orl_mgf_context(struct orl_mgf_reader *r, enum orl_mgf_kind kind)
{
    const struct orl_mgf_item *from = &defaults[kind];
    struct orl_mgf_item *item = &r->nameless[kind];
    if (r->n_words > 2 && strcmp(r->words[2], "=") != 0)
        orl_mgf_fail(r, ORL_ERR_SYNTAX, "'%.60s' is found where '=' is expected", r->words[2]);
    if (r->n_words > 3)
        from = orl_mgf_find(r, kind, r->words[3]);
    if (r->n_words == 2)
        item = (struct orl_mgf_item *)orl_mgf_find(r, kind, r->words[1]);
    else if (r->n_words > 2 && !r->code)
        item = find_or_add(r, kind, (char *)r->words[1]);
    if (r->code)
        return;
    if (r->n_words != 2) {
        item->is = from->is;
        if (kind == ORL_MGF_MATERIAL)
            item->is.material.written = false;
    }
    r->current[kind] = item;
}
