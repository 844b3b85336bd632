/*
 * Markers of replmarks: polygons of a modifier that stand for an object, placed where they are. A
 * marker is a right triangle: its longest side is passed over, the next is the object's x axis, the
 * third its y axis, where these two meet its origin. References: replmarks(1) of Radiance; numbers
 * are rounded as it prints them.
 */
#ifndef ORL_SCENE_PARSE_MARKERS_H
#define ORL_SCENE_PARSE_MARKERS_H

#include "scene/parse/parser.h"

enum { ORL_MARKERS_MAX = 128 };

struct orl_marker {
    const char *modifier;    /* of polygons that are markers */
    const char *object;      /* a scene file, or what is an instance or a mesh */
    const char *compiled;    /* -i: "instance", -I: "mesh"; NULL: a scene file */
    const char *replacement; /* -m: the objects' modifier, or NULL */
    double scale;            /* -s: of the object for an x axis of length 1; 0: as it is */
};

struct orl_markers {
    struct orl_marker items[ORL_MARKERS_MAX];
    size_t n;
    bool expand;                   /* markers that commands write are replaced too (-e) */
    const struct orl_scope *scope; /* where objects go: that of the command */
    /* Reads the object of the marker at hand. */
    int (*replace)(struct orl_parser *parser, const struct orl_scope *scope,
                   const struct orl_marker *marker, struct orl_error *err);
};

/* Reads the words behind "replmarks"; ret_used says how many came before the first file. */
int orl_markers_read(struct orl_markers *markers, const char *const *words, size_t count,
                     size_t *ret_used, struct orl_error *err);

/* Whether the primitive at hand is one, in a scope that has markers; which. */
const struct orl_marker *orl_marker_find(const struct orl_parser *parser,
                                         const struct orl_scope *scope);

/* Where the marker at hand puts its object, within the scope of the command. */
int orl_marker_place(struct orl_parser *parser, const struct orl_scope *scope, double scale,
                     struct orl_xform *ret_xform, struct orl_error *err);

#endif
