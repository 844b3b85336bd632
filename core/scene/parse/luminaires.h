/*
 * Luminaires: IES files (grid/ies.h) as what Radiance's ies2rad writes of them, a light whose
 * brightness is by direction, on the luminous opening's box, disc, cylinder or sphere about the
 * origin, down being -z. Colour and depreciation of their lamps are those of the table (lamps.h)
 * that lamp.tab is, among the scene's files or in the user's library, by the words that the file
 * has for its lamp; without one, or such words, they are white. What [LUMINOUSGEOMETRY] names, in
 * MGF beside the file, stands within an illum.
 */
#ifndef ORL_SCENE_PARSE_LUMINAIRES_H
#define ORL_SCENE_PARSE_LUMINAIRES_H

#include "scene/generate/generate.h"
#include "scene/parse/parser.h"

/* ies2rad [-m FACTOR] [-c R G B] [-i RADIUS] [-dUNIT[/N]] [-o NAME] [-s] [-f TABLE] [-t LAMP]
 * [-u LAMP] FILE.ies */
int orl_parser_ies2rad(struct orl_parser *parser, const struct orl_scope *scope,
                       const char *const *words, size_t count, struct orl_text *text,
                       struct orl_error *err);

/* An IES file that is a part of the scene by itself, in metres: the file of that scope. */
int orl_luminaire_write(struct orl_parser *parser, const struct orl_scope *scope,
                        const struct orl_file *file, struct orl_text *text, struct orl_error *err);

#endif
