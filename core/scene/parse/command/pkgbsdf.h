/*
 * Geometry that comes with BSDF files: the command pkgBSDF -s FILE.xml, which puts proxy faces of
 * the panel's size in front of and behind its MGF geometry; and mgf2rad, for MGF files. Both write
 * scene text, which is then read.
 */
#ifndef ORL_SCENE_PARSE_COMMAND_PKGBSDF_H
#define ORL_SCENE_PARSE_COMMAND_PKGBSDF_H

#include "scene/generate/mgf/mgf.h"
#include "scene/parse/parser.h"

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
