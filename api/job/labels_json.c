#include "job/labels_json.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "json/decode.h"
#include "json/encode.h"

void orl_labels_done(struct orl_labels *labels)
{
    if (!labels)
        return;
    free(labels->name);
    free(labels->tags);
    *labels = (struct orl_labels){0};
}

/* Returns the number of characters, or most + 1 if text has a control character (including C1,
 * which terminals interpret) or one of others. jansson has already checked the UTF-8. */
static size_t count_characters(const char *text, const char *others, size_t most)
{
    size_t characters = 0;
    for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
        const bool c1 = c[0] == 0xc2 && c[1] < 0xa0;
        if (*c < 0x20 || *c == 0x7f || c1 || strchr(others, *c))
            return most + 1;
        characters += (*c & 0xc0) != 0x80;
    }
    return characters;
}

static bool is_label(const char *text, const char *others, size_t most)
{
    const size_t characters = count_characters(text, others, most);
    return characters >= 1 && characters <= most;
}

bool orl_label_is_tag(const char *text)
{
    return is_label(text, "\"\\,", ORL_LABEL_TAG);
}

bool orl_labels_have(const char *tags, const char *tag)
{
    char quoted[4 * ORL_LABEL_TAG + 3];
    snprintf(quoted, sizeof quoted, "\"%s\"", tag);
    return tags && strstr(tags, quoted);
}

static int read_name(const json_t *value, char **ret_name, struct orl_error *err)
{
    const char *name = json_string_value(value);
    if (!value)
        return 0;
    if (!name)
        return orl_json_wrong_type(value, "name", "a string", err);
    /* strdup would cut the name at a NUL inside. */
    if (strlen(name) != json_string_length(value) || !is_label(name, "", ORL_LABEL_NAME))
        return orl_json_fail(err, ORL_ERR_INVALID, "name",
                             "a name has 1 to %d characters, none of them control characters",
                             ORL_LABEL_NAME);
    *ret_name = strdup(name);
    return *ret_name ? 0 : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
}

static int check_tag(const json_t *tags, size_t at, struct orl_error *err)
{
    const json_t *value = json_array_get(tags, at);
    const char *tag = json_string_value(value);
    char path[ORL_JSON_PATH_MAX];
    snprintf(path, sizeof path, "tags[%zu]", at);
    if (!tag)
        return orl_json_wrong_type(value, path, "a string", err);
    if (strlen(tag) != json_string_length(value) || !orl_label_is_tag(tag))
        return orl_json_fail(err, ORL_ERR_INVALID, path,
                             "a tag has 1 to %d characters, none of them a control character, "
                             "quotation mark, backslash or comma",
                             ORL_LABEL_TAG);
    for (size_t i = 0; i < at; i++)
        if (strcmp(json_string_value(json_array_get(tags, i)), tag) == 0)
            return orl_json_fail(err, ORL_ERR_INVALID, path, "the tag is there already");
    return 0;
}

static int read_tags(const json_t *value, char **ret_tags, struct orl_error *err)
{
    int rc = value ? orl_json_array(value, "tags", ORL_LABEL_TAGS, err) : 0;
    for (size_t i = 0; i < json_array_size(value) && rc == 0; i++)
        rc = check_tag(value, i, err);
    if (rc || json_array_size(value) == 0)
        return rc;
    *ret_tags = orl_json_text(value, JSON_COMPACT);
    return *ret_tags ? 0 : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
}

int orl_labels_from_json(const json_t *doc, struct orl_labels *ret_labels, struct orl_error *err)
{
    struct orl_labels labels = {0};
    int rc = read_name(json_object_get(doc, "name"), &labels.name, err);
    if (rc == 0)
        rc = read_tags(json_object_get(doc, "tags"), &labels.tags, err);
    if (rc)
        orl_labels_done(&labels);
    else
        *ret_labels = labels;
    return rc;
}
