/*
 * Luminaires: converts IES files (grid/ies.h) as Radiance's ies2rad does. The result is a light
 * whose radiance varies with direction, on a box, disc, cylinder or sphere of the luminous
 * opening's size about the origin; down is -z. The lamp's colour and depreciation come from the
 * table lamp.tab (see below), among the scene's files or in the user's library. The words that the
 * file has for its lamp select the entry; without a table or such words the lamp is white. The MGF
 * file that [LUMINOUSGEOMETRY] names, next to the IES file, is placed within an illum.
 */
#ifndef ORL_SCENE_PARSE_LUMINAIRE_LUMINAIRES_H
#define ORL_SCENE_PARSE_LUMINAIRE_LUMINAIRES_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/base/error.h>
#include <oriel/base/vec.h>

#include "scene/generate/generate.h"
#include "scene/grid/ies.h"
#include "scene/parse/parser.h"

/* ies2rad [-m FACTOR] [-c R G B] [-i RADIUS] [-dUNIT[/N]] [-o NAME] [-s] [-f TABLE] [-t LAMP]
 * [-u LAMP] FILE.ies */
int orl_parser_ies2rad(struct orl_parser *parser, const struct orl_scope *scope,
                       const char *const *words, size_t count, struct orl_text *text,
                       struct orl_error *err);

/* Writes an IES file that is itself a part of the scene, in metres; scope: the file's. */
int orl_luminaire_write(struct orl_parser *parser, const struct orl_scope *scope,
                        const struct orl_file *file, struct orl_text *text, struct orl_error *err);

/*
 * Tables of lamps, as Radiance's lamp.tab(5): the colour of a lamp that some words name, and its
 * lumen depreciation at half its life. A line is a pattern between two equal characters, in which .
 * * [] ^ $ \< \> have grep's meaning and letters (except in []) match both cases; then "x y share",
 * or "(words)", which refer to an earlier entry, at most 32 times. The first line whose pattern
 * occurs in the words counts.
 *
 * Tables are untrusted: a search gives up after a number of steps.
 */

struct orl_lamp_table {
    const char *name, *text; /* the text need not end in NUL */
    size_t size;
    long steps; /* left for all searches */
};

enum { ORL_LAMP_STEPS = 20000000 };

struct orl_lamp_entry {
    double x, y, share;   /* CIE 1931 x, y; share of the initial light */
    struct orl_rgb color; /* its luminance is the share */
};

/* Returns 1 if found, 0 if no line matches; ORL_ERR_SYNTAX or _RANGE with the table's line (among
 * those up to the match), or _LIMIT. */
int orl_lamp_find(struct orl_lamp_table *table, const char *words, size_t length,
                  struct orl_lamp_entry *ret_lamp, struct orl_error *err);

#endif
