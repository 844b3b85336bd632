/*
 * Tables of lamps, as Radiance's lamp.tab(5) is one: what colour a lamp has that is named by some
 * words, and how much of its first light it has left when it is half spent. A line is a pattern
 * between two equal characters, in which . * [] ^ $ \< \> mean what they mean to grep and letters
 * (but those between []) are either case's; and then "x y share", or "(words)" that stand for an
 * entry before it, 32 times at the most. The first line counts whose pattern is in the words.
 *
 * Tables may be anybody's: a search gives up after so many steps.
 */
#ifndef ORL_SCENE_PARSE_LAMPS_H
#define ORL_SCENE_PARSE_LAMPS_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/error.h>
#include <oriel/vec.h>

struct orl_lamp_table {
    const char *name, *text; /* the text need not end in NUL */
    size_t size;
    long steps; /* left to all searches */
};

enum { ORL_LAMP_STEPS = 20000000 };

struct orl_lamp {
    double x, y, share;   /* CIE 1931; of its first light */
    struct orl_rgb color; /* of luminance share */
};

/* 1: found, 0: no line's pattern is in the words; ORL_ERR_SYNTAX, _RANGE, with the table's line (of
 * those up to the one that counts), _LIMIT. */
int orl_lamp_find(struct orl_lamp_table *table, const char *words, size_t length,
                  struct orl_lamp *ret_lamp, struct orl_error *err);

#endif
