/*
 * Luminaires as manufacturers measure them: files of ANSI/IES LM-63, of 1986, 1991, 1995, 2002 and
 * 2019, photometry of types C and B. What a lamp gives by its tilt (TILT= other than NONE) is
 * refused.
 *
 * Type C: vertical angles are from straight down, horizontal ones about that, from the luminaire's
 * length (x) towards its width (y). Bytes may be anybody's: counts are bounded by the file's own
 * length. References: ANSI/IES LM-63-19 and those before it.
 */
#ifndef ORL_SCENE_GRID_IES_H
#define ORL_SCENE_GRID_IES_H

#include <stdbool.h>

#include "scene/grid/grid.h"

struct orl_ies {
    int year;                     /* 1986, 1995 (a horizontal cylinder has a sign), 2002 */
    bool type_b;                  /* else C */
    double factor;                /* on all numbers, for candela */
    double length, width, height; /* of the luminous opening, metres; signs tell its shape */
    uint32_t n_vertical, n_horizontal;
    double *vertical, *horizontal; /* degrees, rising */
    float *candela;                /* without the factor: [horizontal][vertical] */
};

/* Whether the text is of such a file: it has a line that begins with "TILT=". */
bool orl_ies_is(const char *text, size_t size);

/* ORL_ERR_SYNTAX, _RANGE, _UNSUPPORTED, with file and line; _NOMEM. orl_ies_done in the end of one
 * that was read. */
int orl_ies_read(const char *name, const char *text, size_t size, struct orl_ies *ret_ies,
                 struct orl_error *err);
void orl_ies_done(struct orl_ies *ies); /* also of one that is all zero */

/* Its intensities as a data file has them, W/sr without the factor: by horizontal angle, if there
 * are several, then by vertical one. Takes its arrays. */
int orl_ies_grid(struct orl_ies *ies, struct orl_grid **ret_grid, struct orl_error *err);

#endif
