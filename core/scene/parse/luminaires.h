/*
 * Luminaires: IES files (grid/ies.h) as what Radiance's ies2rad writes of them, a light whose
 * brightness is by direction, on the luminous opening's box, disc, cylinder or sphere about the
 * origin, down being -z. Lamps are white: the colours and depreciations of ies2rad's table of lamps
 * are not known here.
 */
#ifndef ORL_SCENE_PARSE_LUMINAIRES_H
#define ORL_SCENE_PARSE_LUMINAIRES_H

#include "scene/generate/generate.h"
#include "scene/parse/parser.h"

/* ies2rad [-m FACTOR] [-c R G B] [-i RADIUS] [-dUNIT[/N]] [-o NAME] [-s] [-t default] FILE.ies */
int orl_parser_ies2rad(struct orl_parser *parser, const struct orl_scope *scope,
                       const char *const *words, size_t count, struct orl_text *text,
                       struct orl_error *err);

/* An IES file that is a part of the scene by itself, in metres: the file of that scope. */
int orl_luminaire_write(const struct orl_scope *scope, const struct orl_file *file,
                        struct orl_text *text, struct orl_error *err);

#endif
