/*
 * Radiance scene files -> struct orl_description. The commands that they call are read natively
 * (commands.c); any other, and any primitive Oriel does not simulate, is an error with file, line
 * and primitive. No shell is ever started.
 */
#ifndef ORL_SCENE_PARSE_PARSE_H
#define ORL_SCENE_PARSE_PARSE_H

#include <oriel/files.h>

#include "scene/description.h"
#include "scene/parse/sources.h"

/*
 * Parses the named main files in order (names ending in .xml are resources, not scene text), and
 * whatever they refer to. Fills *ret_description, which the caller passes to
 * orl_description_done, or fails with the place in err.
 */
int orl_scene_parse(const char *const *names, size_t count, const struct orl_files *files,
                    struct orl_description *ret_description, struct orl_error *err);
/* The same, with BSDFs by a loader; NULL: none. */
int orl_scene_parse_with(const char *const *names, size_t count, const struct orl_files *files,
                         const struct orl_bsdf_loader *loader,
                         struct orl_description *ret_description, struct orl_error *err);
/* The same by sources of which some of the main files are open, in their order, and nothing else;
 * they and their arena are taken over, also on failure. apart: places of what has patterns are to
 * have surfaces of their own, for some will be given other materials (swap.h). */
int orl_scene_parse_begun(const char *const *names, size_t count, struct orl_sources *sources,
                          bool apart, struct orl_description *ret_description,
                          struct orl_error *err);

#endif
