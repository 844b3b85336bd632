/* Warnings of a description. A file apart from parsed_scene.c because patterns add warnings, and a
 * description frees patterns. */
#include <stdlib.h>
#include <string.h>

#include "base/memory/arena.h"
#include "scene/parsed_scene.h"

void orl_parsed_scene_warn(struct orl_parsed_scene *parsed_scene, const char *text)
{
    char *copy = orl_arena_copy_text(parsed_scene->arena, text, strlen(text));
    char **grown = realloc(parsed_scene->warnings,
                           (parsed_scene->n_warnings + 1) * sizeof *parsed_scene->warnings);
    if (grown)
        parsed_scene->warnings = grown;
    if (grown && copy)
        grown[parsed_scene->n_warnings++] = copy;
}
