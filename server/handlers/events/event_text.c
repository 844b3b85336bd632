#include "handlers/events/event_text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "json/encode.h"

struct orl_event_text *orl_event_text_new(const char *data, size_t size)
{
    struct orl_event_text *text = malloc(sizeof *text + size);
    if (!text)
        return NULL;
    text->refs = 1;
    text->size = size;
    memcpy(text->data, data, size);
    return text;
}

void orl_event_text_unref(struct orl_event_text *text)
{
    if (text && --text->refs == 0)
        free(text);
}

struct orl_event_text *orl_event_text_of(const char *id, const char *name, json_t *data)
{
    char *json = data ? orl_json_text(data, JSON_COMPACT | JSON_REAL_PRECISION(6)) : NULL;
    struct orl_event_text *text = NULL;
    char *line = NULL;
    const int size = json ? asprintf(&line, "id: %s\nevent: %s\ndata: %s\n\n", id, name, json) : -1;
    if (size > 0)
        text = orl_event_text_new(line, (size_t)size);
    if (size >= 0)
        free(line);
    free(json);
    json_decref(data);
    return text;
}
