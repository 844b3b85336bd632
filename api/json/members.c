#include "json/members.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *orl_json_path(const char *path, const char *member, char ret_path[ORL_JSON_PATH_MAX])
{
    snprintf(ret_path, ORL_JSON_PATH_MAX, "%.120s%s%.60s", path, *path ? "." : "", member);
    return ret_path;
}

static bool is_known(const char *name, const struct orl_json_member *members)
{
    for (; members->name; members++)
        if (strcmp(name, members->name) == 0)
            return true;
    return false;
}

static int unknown_member(const char *path, const char *name, const struct orl_json_member *members,
                          struct orl_error *err)
{
    char where[ORL_JSON_PATH_MAX], known[ORL_ERROR_TEXT_MAX] = "";
    size_t used = 0;
    for (; members->name && used < sizeof known; members++) {
        const int n =
            snprintf(known + used, sizeof known - used, "%s%s", used ? ", " : "", members->name);
        used += n > 0 ? (size_t)n : 0;
    }
    orl_json_fail(err, ORL_ERR_INVALID, orl_json_path(path, name, where),
                  "there is no such member");
    orl_error_hint(err, "Known here: %s", known);
    return ORL_ERR_INVALID;
}

static int decode_real(const json_t *value, const char *path, const struct orl_json_member *m,
                       struct orl_error *err)
{
    double real = 0;
    const int rc = orl_json_real(value, path, &real, err);
    if (rc)
        return rc;
    const bool bounded = m->least < m->most;
    if (bounded && (real < m->least || real > m->most || (m->above && real <= m->least) ||
                    (m->below && real >= m->most))) {
        if (m->bounds)
            return orl_json_fail(err, ORL_ERR_RANGE, path, "%s", m->bounds);
        return orl_json_fail(err, ORL_ERR_RANGE, path, "it is from %g to %g", m->least, m->most);
    }
    *m->real = real;
    return 0;
}

static int decode_whole(const json_t *value, const char *path, const struct orl_json_member *m,
                        struct orl_error *err)
{
    uint64_t whole = 0;
    const int rc = orl_json_whole(value, path, m->from, m->to, &whole, err);
    if (rc)
        return rc;
    if (m->whole)
        *m->whole = whole;
    else if (m->whole_32)
        *m->whole_32 = (uint32_t)whole;
    else
        *m->whole_int = (int)whole;
    return 0;
}

int orl_json_value(const json_t *value, const char *path, const struct orl_json_member *m,
                   struct orl_error *err)
{
    if (m->real)
        return decode_real(value, path, m, err);
    if (m->whole || m->whole_32 || m->whole_int)
        return decode_whole(value, path, m, err);
    if (m->flag)
        return orl_json_bool(value, path, m->flag, err);
    if (m->text)
        return orl_json_string(value, path, m->longest, m->text, err);
    if (m->word)
        return orl_json_word(value, path, m->words, m->word, err);
    if (m->members)
        return orl_json_members(value, path, m->members, err);
    if (m->list)
        return orl_json_list(value, path, m->list, err);
    return m->decode ? m->decode(value, path, m->into, err) : 0;
}

int orl_json_members(const json_t *value, const char *path, const struct orl_json_member *members,
                     struct orl_error *err)
{
    if (!json_is_object(value))
        return orl_json_wrong_type(value, *path ? path : "document", "an object", err);
    const char *name;
    json_t *member;
    /* json_object_foreach needs a non-const object but does not change it. */
    json_object_foreach((json_t *)(uintptr_t)value, name, member)
    {
        if (!is_known(name, members))
            return unknown_member(path, name, members, err);
    }
    int rc = 0;
    for (; members->name && rc == 0; members++) {
        char at[ORL_JSON_PATH_MAX];
        member = json_object_get(value, members->name);
        if (member || members->required)
            rc = orl_json_value(member, orl_json_path(path, members->name, at), members, err);
    }
    return rc;
}

/* Decodes one element of an array. */
static int decode_element(const json_t *value, const char *path, size_t index,
                          orl_json_decoder *decode, void *into, struct orl_error *err)
{
    enum { ELEMENTS_A_POLL = 1024 };
    char at[ORL_JSON_PATH_MAX];
    const int rc = index % ELEMENTS_A_POLL == 0 ? orl_json_poll(err) : 0;
    if (rc)
        return rc;
    snprintf(at, sizeof at, "%.120s[%zu]", path, index);
    return decode(json_array_get(value, index), at, into, err);
}

int orl_json_each(const json_t *value, const char *path, size_t most, orl_json_decoder *each,
                  void *into, struct orl_error *err)
{
    int rc = orl_json_array(value, path, most, err);
    for (size_t i = 0; rc == 0 && i < json_array_size(value); i++)
        rc = decode_element(value, path, i, each, into, err);
    return rc;
}

int orl_json_list(const json_t *value, const char *path, const struct orl_json_list *list,
                  struct orl_error *err)
{
    const size_t count = json_array_size(value);
    int rc = orl_json_array(value, path, list->most, err);
    if (rc)
        return rc;
    if (count == 0 && list->empty)
        return orl_json_fail(err, ORL_ERR_INVALID, path, "%s", list->empty);
    char *items = calloc(count ? count : 1, list->size);
    if (!items)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu elements", count);
    memcpy(list->items, &items, sizeof items);
    for (size_t i = 0; rc == 0 && i < count; i++) {
        *list->count = i + 1;
        rc = decode_element(value, path, i, list->each, items + i * list->size, err);
    }
    return rc;
}
