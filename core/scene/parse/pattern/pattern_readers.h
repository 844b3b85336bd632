/*
 * Readers of patterns: their functions and grids, spectra, texts. Internal to this folder.
 */
#ifndef ORL_SCENE_PARSE_PATTERN_PATTERN_READERS_H
#define ORL_SCENE_PARSE_PATTERN_PATTERN_READERS_H

#include "scene/material/patterns/pattern.h"
#include "scene/parse/parser.h"

#define ORL_SCENE_GRID_VALUES (64UL << 20) /* limit of all pictures and data files of a scene */

/* Positions of the primitive's strings. */
struct orl_pattern_strings {
    size_t functions; /* index of the first function, or without grids of the first expression */
    size_t file;      /* index of the function file; with grids the coordinates follow it */
    size_t n;         /* number of expressions or coordinates */
    bool spectral;    /* the function takes the wavelength: orl_spectrum_of */
};

/* Sets the pattern's frame, functions and inputs. */
int orl_pattern_compile(struct orl_parser *parser, const struct orl_scope *scope,
                        struct orl_pattern *pattern, const struct orl_xform *to_world,
                        const struct orl_pattern_strings *strings, struct orl_error *err);

/* Returns the grid of a file, which is read at first use. The parsed scene owns it. */
int orl_pattern_grid(struct orl_parser *parser, const struct orl_scope *scope, const char *name,
                     bool picture, const struct orl_grid **ret_grid, struct orl_error *err);

/*
 * Spectra among the patterns: spectrum, specfile, specfunc, specdata, converted by the standard
 * observer (material/patterns/observer.h). Radiance's renderer does the same unless it is set to
 * more than three channels.
 *
 * A sample is the mean of its band, which reaches half way to its neighbours, and as far beyond the
 * first and the last; outside the spectrum is 0. For a specfile with uneven wavelengths, which
 * Radiance reads wrongly, values between are linear. Functions are sampled every 5 nm.
 */

/* Reads a spectrum or, with a grid, a specfile: makes the pattern a constant. */
int orl_spectrum_read(struct orl_parser *parser, const struct orl_scope *scope,
                      struct orl_pattern *pattern, struct orl_error *err);

/* Sets the bands of a pattern whose programs are compiled: from its data's last axis, or from the
 * primitive's first two numbers. */
int orl_spectrum_bands(struct orl_parser *parser, const struct orl_scope *scope,
                       struct orl_pattern *pattern, struct orl_error *err);

/*
 * Texts among the patterns and mixtures: brighttext, colortext, mixtext
 * (material/patterns/pattern.h).
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

/* Makes the pattern a text. first: index of the string that names the font. */
int orl_lettering_read(struct orl_parser *parser, const struct orl_scope *scope,
                       struct orl_pattern *pattern, size_t first, struct orl_error *err);

#endif
