/* Modifiers by name, refused content, and refused definitions. */
#include "scene/parse/symbols.h"

#include <sodium.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/error.h>

#include "base/memory/memory.h"
#include "scene/parse/parser.h"

/* Refusals are of one kind if they have the same type or command, and the same reason. */
void orl_refusals_add(struct orl_refusals *refusals, const struct orl_error *err)
{
    struct orl_refusal refusal = {.count = 1, .first = *err};
    const bool command = err->primitive[0] == '!';
    const char *const word = err->primitive + command + strspn(err->primitive + command, " \t");
    const size_t length = strcspn(word, " ");
    snprintf(refusal.kind, sizeof refusal.kind, "%s%.*s", command ? "!" : "",
             (int)(length < 38 ? length : 38), word);
    for (size_t i = 0; i < refusals->n; i++) {
        struct orl_refusal *known = &refusals->kinds[i];
        if (strcmp(known->kind, refusal.kind) == 0 &&
            strcmp(known->first.message, err->message) == 0) {
            known->count++;
            return;
        }
    }
    if (refusals->n < ORL_REFUSALS_MAX)
        refusals->kinds[refusals->n++] = refusal;
    else
        refusals->others++;
}

/* A text of bounded length that ends in dots if it was cut. */
struct list {
    char text[ORL_ERROR_TEXT_MAX - 16]; /* leaves room for a few words before it */
    size_t length;
};

static void append_item(struct list *list, const char *separator, const char *item)
{
    const size_t room = sizeof list->text - list->length;
    const int n =
        snprintf(list->text + list->length, room, "%s%s", list->length > 0 ? separator : "", item);
    if (n > 0 && (size_t)n < room - 4) {
        list->length += (size_t)n;
        return;
    }
    snprintf(list->text + list->length, 4, "...");
    list->length = sizeof list->text; /* marks the list as full */
}

static void list_kind(struct list *list, const struct orl_refusal *refusal)
{
    char item[ORL_ERROR_TEXT_MAX];
    if (list->length == sizeof list->text)
        return;
    snprintf(item, sizeof item, "%llu x %s (first at %.80s:%d)", (unsigned long long)refusal->count,
             refusal->kind, refusal->first.file, refusal->first.line);
    append_item(list, ", ", item);
}

static void list_hint(struct list *list, const struct orl_refusals *refusals, size_t i)
{
    char item[ORL_ERROR_TEXT_MAX];
    const struct orl_error *first = &refusals->kinds[i].first;
    bool said = first->hint[0] == '\0' || list->length == sizeof list->text;
    for (size_t k = 0; k < i && !said; k++)
        said = strcmp(refusals->kinds[k].first.hint, first->hint) == 0;
    if (said)
        return;
    snprintf(item, sizeof item, "%s: %.400s", refusals->kinds[i].kind, first->hint);
    append_item(list, "; ", item);
}

int orl_refusals_report(const struct orl_refusals *refusals, struct orl_error *err)
{
    const struct orl_refusal *first = &refusals->kinds[0];
    struct list kinds = {.length = 0}, hints = {.length = 0};
    if (refusals->n == 1 && first->count == 1) {
        *err = first->first;
        return ORL_ERR_UNSUPPORTED;
    }
    for (size_t i = 0; i < refusals->n; i++) {
        list_kind(&kinds, &refusals->kinds[i]);
        list_hint(&hints, refusals, i);
    }
    if (refusals->others > 0 && kinds.length < sizeof kinds.text)
        append_item(&kinds, ", ", "and others");
    if (refusals->n == 1)
        orl_error_set(err, ORL_ERR_UNSUPPORTED, "%.400s; there are %llu of them",
                      first->first.message, (unsigned long long)first->count);
    else
        orl_error_set(err, ORL_ERR_UNSUPPORTED, "not simulated: %s", kinds.text);
    orl_error_at(err, first->first.file, first->first.line, first->first.primitive);
    if (hints.text[0] != '\0')
        orl_error_hint(err, "%s", hints.text);
    return ORL_ERR_UNSUPPORTED;
}

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

/* SipHash with a random key per table, so that input cannot force collisions. The position of a
 * name does not affect results. */
static uint64_t hash_name(const struct orl_symbols *symbols, const char *name)
{
    uint64_t h;
    unsigned char bytes[crypto_shorthash_BYTES];
    crypto_shorthash(bytes, (const unsigned char *)name, strlen(name), symbols->key);
    memcpy(&h, bytes, sizeof h);
    return h;
}

/* Returns the slot that holds name, or the free one where it belongs. n_slots is a power of two. */
static struct orl_symbol *slot_of(const struct orl_symbols *symbols, struct orl_symbol *slots,
                                  size_t n_slots, const char *name)
{
    size_t i = (size_t)hash_name(symbols, name) & (n_slots - 1);
    while (slots[i].name && strcmp(slots[i].name, name) != 0)
        i = (i + 1) & (n_slots - 1);
    return slots + i;
}

const struct orl_symbol *orl_symbols_find(const struct orl_symbols *symbols, const char *name)
{
    if (symbols->n_slots == 0)
        return NULL;
    const struct orl_symbol *const slot = slot_of(symbols, symbols->slots, symbols->n_slots, name);
    return slot->name ? slot : NULL;
}

static int grow_table(struct orl_symbols *symbols)
{
    const size_t n_slots = symbols->n_slots ? 2 * symbols->n_slots : 256;
    struct orl_symbol *slots = calloc(n_slots, sizeof *slots);
    if (!slots)
        return ORL_ERR_NOMEM;
    if (symbols->n_slots == 0)
        randombytes_buf(symbols->key, sizeof symbols->key);
    for (size_t i = 0; i < symbols->n_slots; i++)
        if (symbols->slots[i].name)
            *slot_of(symbols, slots, n_slots, symbols->slots[i].name) = symbols->slots[i];
    free(symbols->slots);
    symbols->slots = slots;
    symbols->n_slots = n_slots;
    return 0;
}

int orl_symbols_set(struct orl_symbols *symbols, struct orl_symbol symbol)
{
    if (2 * symbols->n_used >= symbols->n_slots && grow_table(symbols) < 0)
        return ORL_ERR_NOMEM;
    struct orl_symbol *slot = slot_of(symbols, symbols->slots, symbols->n_slots, symbol.name);
    symbols->n_used += slot->name ? 0 : 1;
    *slot = symbol;
    slot->order = ++symbols->n_set;
    return 0;
}

void orl_symbols_done(struct orl_symbols *symbols)
{
    free(symbols->slots);
    memset(symbols, 0, sizeof *symbols);
}
