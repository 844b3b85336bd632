/*
 * Texts among the patterns and mixtures: brighttext, colortext, mixtext (material/text.h). Internal
 * to this folder.
 *
 * Strings: of mixtext two materials; a font file, a text file; or '.' and words, which are one
 * line. Numbers: origin, right and down, the colours of letters and of what is around them (of
 * mixtext none), and, if it is not 0, how far letters are apart: they are then set by their widths,
 * negative simply, positive with words at even steps after indentations. Fonts are scene files:
 * Oriel has none of its own. A font file has, of each letter, its code, how many corners it has,
 * and these. Reference: "The RADIANCE Synthetic Imaging System", section 2.1.4; "Radiance File
 * Formats", fonts.
 */
#ifndef ORL_SCENE_PARSE_TEXTS_H
#define ORL_SCENE_PARSE_TEXTS_H

#include "scene/material/pattern.h"
#include "scene/parse/parser.h"

/* Fills in text, factor of letters, and around. first: the string that names the font. */
int orl_text_read(struct orl_parser *parser, const struct orl_scope *scope,
                  struct orl_pattern *pattern, size_t first, struct orl_error *err);

#endif
