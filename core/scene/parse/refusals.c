#include "scene/parse/refusals.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

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
