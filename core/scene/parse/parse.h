/*
 * Radiance scene files -> struct orl_parsed_scene. The commands that they call are executed
 * natively (commands.c); any other, and any primitive that Oriel does not support, is an error with
 * file, line and primitive. No shell is ever started.
 */
#ifndef ORL_SCENE_PARSE_PARSE_H
#define ORL_SCENE_PARSE_PARSE_H

#include <oriel/base/files.h>

#include "scene/parse/sources.h"
#include "scene/parsed_scene.h"

/*
 * Parses the named main files in order (names ending in .xml are resources, not scene text), and
 * all files they refer to. Fills *ret_description, which the caller passes to
 * orl_parsed_scene_done, or fails with the place in err.
 */
int orl_scene_parse(const char *const *names, size_t count, const struct orl_files *files,
                    struct orl_parsed_scene *ret_parsed_scene, struct orl_error *err);
/* orl_scene_parse with a loader of BSDFs; NULL: none. */
int orl_scene_parse_with(const char *const *names, size_t count, const struct orl_files *files,
                         const struct orl_bsdf_loader *loader,
                         struct orl_parsed_scene *ret_parsed_scene, struct orl_error *err);
/* orl_scene_parse_with on sources in which some of the main files are open, in their order, and
 * nothing else. Takes over sources and their arena, also on failure. apart: instances with patterns
 * get surfaces of their own, because some will get other materials (override.h). */
int orl_scene_parse_opened(const char *const *names, size_t count, struct orl_sources *sources,
                           bool apart, struct orl_parsed_scene *ret_parsed_scene,
                           struct orl_error *err);

#endif
