#include "document_options.h"

#include <string.h>

void orl_words_options(struct orl_choices *words, struct orl_option *ret_options)
{
    for (size_t i = 0; i < words->count; i++)
        ret_options[i] = (struct orl_option){.name = words->items[i].name,
                                             .metavar = words->items[i].metavar,
                                             .help = words->items[i].help,
                                             .value = &words->texts[i]};
}

static json_t *value_of(const char *text, bool is_text)
{
    json_t *value = is_text ? NULL : json_loads(text, JSON_DECODE_ANY, NULL);

    return value ? value : json_string(text);
}

int orl_words_into(const struct orl_choices *words, json_t *doc)
{
    int failed = 0;

    for (size_t i = 0; i < words->count && !failed; i++)
        if (words->texts[i])
            failed = json_object_set_new(doc, words->items[i].name,
                                         value_of(words->texts[i], words->items[i].is_text));
    return failed;
}

bool orl_words_any(const struct orl_choices *words)
{
    bool any = false;

    for (size_t i = 0; i < words->count; i++)
        any = any || words->texts[i];
    return any;
}

bool orl_names_document(const char *operand)
{
    static const char ending[] = ".json";
    const size_t length = strlen(operand), tail = strlen(ending);

    return length > tail && strcmp(operand + length - tail, ending) == 0;
}
