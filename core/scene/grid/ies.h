/*
 * Measured luminaires: files of ANSI/IES LM-63, editions of 1986, 1991, 1995, 2002 and 2019,
 * photometry of types C and B, with the lamp's tilt factors (TILT=).
 *
 * Type C: vertical angles are measured from straight down, horizontal ones about that axis, from
 * the luminaire's length (x) towards its width (y). Input is untrusted: counts are bounded by the
 * file's length.
 * References: ANSI/IES LM-63-19 and earlier editions.
 */
#ifndef ORL_SCENE_GRID_IES_H
#define ORL_SCENE_GRID_IES_H

#include <stdbool.h>

#include "scene/grid/grid.h"

/* The lamp's output as a fraction of its nominal output, by the angle between the luminaire's axis
 * and the vertical; degrees, rising. This angle holds for all lamp geometries of LM-63 (1 to 3). */
struct orl_ies_tilt {
    uint32_t n; /* 0: no dependence on the angle */
    double *angles, *factors;
};

enum { ORL_IES_NAME = 128 }; /* bytes of a file's name */

struct orl_ies {
    int year;                     /* 1986, 1995 (a horizontal cylinder has a sign), 2002 */
    bool type_b;                  /* else C */
    double factor;                /* multiplies all intensities, to get candela */
    double length, width, height; /* luminous opening, metres; the signs encode its shape */
    struct orl_ies_tilt tilt;
    char tilt_file[ORL_IES_NAME]; /* file of the tilt table if it is not in this file; or "" */
    char geometry[ORL_IES_NAME];  /* name of the luminaire's MGF file from [LUMINOUSGEOMETRY]; or ""
                                   */
    uint32_t n_vertical, n_horizontal;
    double *vertical, *horizontal; /* degrees, rising */
    float *candela;                /* without the factor: [horizontal][vertical] */
};

/* Returns true if the text is an IES file: a line begins with "TILT=". */
bool orl_ies_detect(const char *text, size_t size);

/* Reads a file. Returns 0; ORL_ERR_SYNTAX, _RANGE or _UNSUPPORTED, with file and line; or
 * ORL_ERR_NOMEM. The caller passes a result to orl_ies_done. The files that TILT= and
 * [LUMINOUSGEOMETRY] name are not opened. */
int orl_ies_read(const char *name, const char *text, size_t size, struct orl_ies *ret_ies,
                 struct orl_error *err);
void orl_ies_done(struct orl_ies *ies); /* accepts a struct of zeros */

/* Reads the tilt table from the file that TILT= names, into a luminaire that was read. */
int orl_ies_read_tilt(const char *name, const char *text, size_t size, struct orl_ies *ies,
                      struct orl_error *err);

/* Finds the next words in the file's head that may name its lamp: those behind [LAMP] or [LAMPCAT],
 * or each line in files of 1986. *at: initially the text. Returns false at the end. */
bool orl_ies_next_lamp(const char **at, const char *text, size_t size, const char **ret_words,
                       size_t *ret_length);

/* Returns true if the vertical angles begin and end where LM-63 allows it: straight down, at the
 * horizon, straight up. */
bool orl_ies_is_complete(const struct orl_ies *ies);

/* Returns true if the horizontal angles reach 90, 180 or 360 degrees; for type B, 90. */
bool orl_ies_has_all_planes(const struct orl_ies *ies);

/* Returns the intensities as a grid, W/sr without the factor: by horizontal angle, if there are
 * several, then by vertical angle. They are 0 beyond the vertical angles of the file, and for type
 * B beyond its horizontal ones. For type C the last plane stands for missing ones; if the planes go
 * all the way round, the first plane repeats at 360 degrees. Takes the luminaire's arrays. */
int orl_ies_grid(struct orl_ies *ies, struct orl_grid **ret_grid, struct orl_error *err);

#endif
