/*
 * Luminaires: converts IES files (grid/ies.h) as Radiance's ies2rad does. The result is a light
 * whose radiance varies with direction, on a box, disc, cylinder or sphere of the luminous
 * opening's size about the origin; down is -z. The lamp's colour and depreciation come from the
 * table lamp.tab (lamp_table.h), among the scene's files or in the user's library. The words that
 * the file has for its lamp select the entry; without a table or such words the lamp is white. The
 * MGF file that [LUMINOUSGEOMETRY] names, next to the IES file, is placed within an illum.
 */
#ifndef ORL_SCENE_PARSE_LUMINAIRE_LUMINAIRES_H
#define ORL_SCENE_PARSE_LUMINAIRE_LUMINAIRES_H

#include "scene/generate/generate.h"
#include "scene/parse/parser.h"

/* ies2rad [-m FACTOR] [-c R G B] [-i RADIUS] [-dUNIT[/N]] [-o NAME] [-s] [-f TABLE] [-t LAMP]
 * [-u LAMP] FILE.ies */
int orl_parser_ies2rad(struct orl_parser *parser, const struct orl_scope *scope,
                       const char *const *words, size_t count, struct orl_text *text,
                       struct orl_error *err);

/* Writes an IES file that is itself a part of the scene, in metres; scope: the file's. */
int orl_luminaire_write(struct orl_parser *parser, const struct orl_scope *scope,
                        const struct orl_file *file, struct orl_text *text, struct orl_error *err);

#endif
