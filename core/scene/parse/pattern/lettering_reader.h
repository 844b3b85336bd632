/*
 * Texts among the patterns and mixtures: brighttext, colortext, mixtext
 * (material/patterns/lettering.h). Internal to this folder.
 *
 * Strings: two materials (mixtext); a font file, a text file; or '.' and words, which are one line.
 * Numbers: origin, right and down; the colours of letters and of their surroundings (not for
 * mixtext); and the spacing of letters. If the spacing is not 0, letters are set by their widths:
 * negative simply, positive with words at even steps after indentations. Fonts are scene files:
 * Oriel has none of its own. A font file has, for each letter, its code, its number of corners, and
 * these.
 * References: "The RADIANCE Synthetic Imaging System", section 2.1.4; "Radiance File Formats",
 * fonts.
 */
#ifndef ORL_SCENE_PARSE_PATTERN_LETTERING_READER_H
#define ORL_SCENE_PARSE_PATTERN_LETTERING_READER_H

#include "scene/material/patterns/pattern.h"
#include "scene/parse/parser.h"

/* Sets text, factor (of letters) and around. first: index of the string that names the font. */
int orl_lettering_read(struct orl_parser *parser, const struct orl_scope *scope,
                       struct orl_pattern *pattern, size_t first, struct orl_error *err);

#endif
