/*
 * Tables of lamps, as Radiance's lamp.tab(5): the colour of a lamp that some words name, and its
 * lumen depreciation at half its life. A line is a pattern between two equal characters, in which .
 * * [] ^ $ \< \> have grep's meaning and letters (except in []) match both cases; then "x y share",
 * or "(words)", which refer to an earlier entry, at most 32 times. The first line whose pattern
 * occurs in the words counts.
 *
 * Tables are untrusted: a search gives up after a number of steps.
 */
#ifndef ORL_SCENE_PARSE_LUMINAIRE_LAMP_TABLE_H
#define ORL_SCENE_PARSE_LUMINAIRE_LAMP_TABLE_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/base/error.h>
#include <oriel/base/vec.h>

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
