#include "options/document_options.h"

#include <string.h>

void orl_member_options_fill(struct orl_member_options *member_options,
                             struct orl_option *ret_options)
{
    for (size_t i = 0; i < member_options->count; i++)
        ret_options[i] = (struct orl_option){.name = member_options->items[i].name,
                                             .metavar = member_options->items[i].metavar,
                                             .help = member_options->items[i].help,
                                             .value = &member_options->texts[i]};
}

static json_t *value_of(const char *text, bool is_text)
{
    json_t *value = is_text ? NULL : json_loads(text, JSON_DECODE_ANY, NULL);

    return value ? value : json_string(text);
}

int orl_member_options_apply(const struct orl_member_options *member_options, json_t *doc)
{
    int failed = 0;

    for (size_t i = 0; i < member_options->count && !failed; i++)
        if (member_options->texts[i])
            failed = json_object_set_new(
                doc, member_options->items[i].name,
                value_of(member_options->texts[i], member_options->items[i].is_text));
    return failed;
}

bool orl_member_options_any(const struct orl_member_options *member_options)
{
    bool any = false;

    for (size_t i = 0; i < member_options->count; i++)
        any = any || member_options->texts[i];
    return any;
}

bool orl_is_document_name(const char *operand)
{
    static const char ending[] = ".json";
    const size_t length = strlen(operand), tail = strlen(ending);

    return length > tail && strcmp(operand + length - tail, ending) == 0;
}
