/*
 * Geometry that comes with BSDF files: the command pkgBSDF -s FILE.xml, which puts the panel's
 * faces, of the size that the file gives, before and behind what it holds in MGF; and mgf2rad, for
 * files of MGF themselves. Both are written as scene text and read as such.
 */
#ifndef ORL_SCENE_PARSE_PACKAGES_H
#define ORL_SCENE_PARSE_PACKAGES_H

#include "scene/generate/mgf.h"
#include "scene/parse/parser.h"

/* pkgBSDF -s [-i] FILE.xml: -i makes no difference, as geometry stands in the scene itself. */
int orl_parser_package(struct orl_parser *parser, const struct orl_scope *scope,
                       const char *const *words, size_t count, struct orl_text *text,
                       struct orl_error *err);

/* Geometry of a file of MGF that text in the scope names, and of those that it includes in turn.
 * mgf: units and lamps. */
int orl_parser_mgf(struct orl_parser *parser, const struct orl_scope *scope, const char *name,
                   const struct orl_mgf *mgf, struct orl_text *text, struct orl_error *err);

/* mgf2rad [-s] [-g RADIUS] [-e FACTOR] FILE: spectra (-s) are RGB all the same. */
int orl_parser_mgf2rad(struct orl_parser *parser, const struct orl_scope *scope,
                       const char *const *words, size_t count, struct orl_text *text,
                       struct orl_error *err);

#endif
