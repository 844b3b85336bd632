/* Warnings of a description. A file apart from description.c because patterns add warnings, and a
 * description frees patterns. */
#include <stdlib.h>
#include <string.h>

#include "base/arena.h"
#include "scene/description.h"

void orl_description_warn(struct orl_description *description, const char *text)
{
    char *copy = orl_arena_text(description->arena, text, strlen(text));
    char **grown = realloc(description->warnings,
                           (description->n_warnings + 1) * sizeof *description->warnings);
    if (grown)
        description->warnings = grown;
    if (grown && copy)
        grown[description->n_warnings++] = copy;
}
