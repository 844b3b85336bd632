/*
 * Commands with a source of their own: replmarks (markers.c), pkgBSDF and mgf2rad (pkgbsdf.c).
 */
#ifndef ORL_SCENE_PARSE_COMMAND_COMMANDS_H
#define ORL_SCENE_PARSE_COMMAND_COMMANDS_H

#include "scene/generate/mgf/mgf.h"
#include "scene/parse/parser.h"

/*
 * Markers of replmarks: polygons of a given modifier that are replaced by an object placed at them.
 * A marker is a right triangle: its longest side is ignored, the next is the object's x axis, the
 * third its y axis, and these two meet at its origin. Reference: replmarks(1) of Radiance; numbers
 * are rounded as it prints them.
 */

enum { ORL_MARKERS_MAX = 128 };

struct orl_marker {
    const char *modifier;    /* modifier of the polygons that are markers */
    const char *object;      /* a scene file, or the file of an instance or a mesh */
    const char *compiled;    /* -i: "instance", -I: "mesh"; NULL: a scene file */
    const char *replacement; /* -m: the objects' modifier, or NULL */
    double scale; /* -s: scale of the object per unit length of the x axis; 0: unscaled */
};

struct orl_markers {
    struct orl_marker items[ORL_MARKERS_MAX];
    size_t n;
    bool expand;                   /* -e: markers in the output of commands are replaced too */
    const struct orl_scope *scope; /* scope of objects: the command's */
    /* Reads the object of the current marker. */
    int (*replace)(struct orl_parser *parser, const struct orl_scope *scope,
                   const struct orl_marker *marker, struct orl_error *err);
};

/* Reads the words behind "replmarks"; *ret_used: number of words before the first file. */
int orl_markers_read(struct orl_markers *markers, const char *const *words, size_t count,
                     size_t *ret_used, struct orl_error *err);

/* Returns the marker that the current primitive is, or NULL; scope: has markers. */
const struct orl_marker *orl_marker_find(const struct orl_parser *parser,
                                         const struct orl_scope *scope);

/* Returns the object's transform at the current marker, within the scope of the command. */
int orl_marker_place(struct orl_parser *parser, const struct orl_scope *scope, double scale,
                     struct orl_xform *ret_xform, struct orl_error *err);

/*
 * Geometry that comes with BSDF files: the command pkgBSDF -s FILE.xml, which puts proxy faces of
 * the BSDF's size in front of and behind its MGF geometry; and mgf2rad, for MGF files. Both write
 * scene text, which is then read.
 */

/* pkgBSDF -s [-i] FILE.xml. -i has no effect, because the geometry becomes part of the scene. */
int orl_parser_pkgbsdf(struct orl_parser *parser, const struct orl_scope *scope,
                       const char *const *words, size_t count, struct orl_text *text,
                       struct orl_error *err);

/* Converts an MGF file that text in the scope names, and the files that it includes.
 * mgf: units and lamps. */
int orl_parser_mgf(struct orl_parser *parser, const struct orl_scope *scope, const char *name,
                   const struct orl_mgf *mgf, struct orl_text *text, struct orl_error *err);

/* mgf2rad [-s] [-g RADIUS] [-e FACTOR] FILE. Spectra (-s) are converted to RGB. */
int orl_parser_mgf2rad(struct orl_parser *parser, const struct orl_scope *scope,
                       const char *const *words, size_t count, struct orl_text *text,
                       struct orl_error *err);

#endif
