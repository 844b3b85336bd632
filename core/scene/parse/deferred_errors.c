#include "scene/parse/deferred_errors.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory/array.h"
#include "scene/parse/parser.h"

static const char *copy_text(struct orl_arena *arena, const char *text)
{
    return orl_arena_copy_text(arena, text, strlen(text));
}

int orl_deferred_add(struct orl_deferred_errors *deferred, const struct orl_error *err,
                     struct orl_arena *arena, uint32_t *ret_index)
{
    const struct orl_deferred_error item = {.file = copy_text(arena, err->file),
                                            .primitive = copy_text(arena, err->primitive),
                                            .message = copy_text(arena, err->message),
                                            .hint = copy_text(arena, err->hint),
                                            .code = err->code,
                                            .line = err->line};
    if (!item.file || !item.primitive || !item.message || !item.hint ||
        deferred->count >= UINT32_MAX ||
        !orl_array_reserve(&deferred->items, &deferred->room, deferred->count, sizeof item))
        return ORL_ERR_NOMEM;
    *ret_index = (uint32_t)deferred->count;
    deferred->items[deferred->count++] = item;
    return 0;
}

int orl_deferred_use(struct orl_deferred_errors *deferred, uint32_t index,
                     struct orl_refusals *refusals, struct orl_error *err)
{
    struct orl_deferred_error *item = &deferred->items[index];
    struct orl_error told;
    orl_error_set(&told, item->code, "%s", item->message);
    orl_error_at(&told, item->file, item->line, item->primitive);
    orl_error_hint(&told, "%s", item->hint);
    if (item->code != ORL_ERR_UNSUPPORTED) {
        if (err)
            *err = told;
        return item->code;
    }
    if (!item->used)
        orl_refusals_add(refusals, &told);
    item->used = true;
    return 0;
}

const struct orl_deferred_error *orl_deferred_unused(const struct orl_deferred_errors *deferred,
                                                     size_t *ret_count)
{
    const struct orl_deferred_error *first = NULL;
    *ret_count = 0;
    for (size_t i = 0; i < deferred->count; i++) {
        if (deferred->items[i].used)
            continue;
        first = first ? first : &deferred->items[i];
        ++*ret_count;
    }
    return first;
}

void orl_deferred_done(struct orl_deferred_errors *deferred)
{
    free(deferred->items);
    memset(deferred, 0, sizeof *deferred);
}
