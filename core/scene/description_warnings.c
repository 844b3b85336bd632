/* What is to be said about a scene; apart from the rest of description.h, for patterns say such
 * things and a description frees patterns. */
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
