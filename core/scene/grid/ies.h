/*
 * Luminaires as manufacturers measure them: files of ANSI/IES LM-63, of 1986, 1991, 1995, 2002 and
 * 2019, photometry of types C and B, with what the lamp gives when the luminaire is tilted (TILT=).
 *
 * Type C: vertical angles are from straight down, horizontal ones about that, from the luminaire's
 * length (x) towards its width (y). Bytes may be anybody's: counts are bounded by the file's own
 * length. References: ANSI/IES LM-63-19 and those before it.
 */
#ifndef ORL_SCENE_GRID_IES_H
#define ORL_SCENE_GRID_IES_H

#include <stdbool.h>

#include "scene/grid/grid.h"

/* What a lamp gives by how far its luminaire is turned from hanging straight: degrees, rising, and
 * the share of what it gives then. However the lamp lies in its luminaire (LM-63's geometries 1 to
 * 3), that is the angle. */
struct orl_ies_tilt {
    uint32_t n; /* 0: the same at all angles */
    double *angles, *factors;
};

struct orl_ies {
    int year;                     /* 1986, 1995 (a horizontal cylinder has a sign), 2002 */
    bool type_b;                  /* else C */
    double factor;                /* on all numbers, for candela */
    double length, width, height; /* of the luminous opening, metres; signs tell its shape */
    struct orl_ies_tilt tilt;
    char tilt_file[128]; /* where that is, if not in the file itself; or "" */
    char geometry[128];  /* of the luminaire: what [LUMINOUSGEOMETRY] names, a file of MGF; or "" */
    uint32_t n_vertical, n_horizontal;
    double *vertical, *horizontal; /* degrees, rising */
    float *candela;                /* without the factor: [horizontal][vertical] */
};

/* Whether the text is of such a file: it has a line that begins with "TILT=". */
bool orl_ies_is(const char *text, size_t size);

/* ORL_ERR_SYNTAX, _RANGE, _UNSUPPORTED, with file and line; _NOMEM. orl_ies_done in the end of one
 * that was read. Of what TILT= and [LUMINOUSGEOMETRY] name only the name is taken. */
int orl_ies_read(const char *name, const char *text, size_t size, struct orl_ies *ret_ies,
                 struct orl_error *err);
void orl_ies_done(struct orl_ies *ies); /* also of one that is all zero */

/* What the file has that TILT= names, into one that was read. */
int orl_ies_read_tilt(const char *name, const char *text, size_t size, struct orl_ies *ies,
                      struct orl_error *err);

/* The next words of the file's head that may name its lamp: what follows [LAMP] or [LAMPCAT], or in
 * files of 1986 each line. at: the text, at first. False: there are no more. */
bool orl_ies_next_lamp(const char **at, const char *text, size_t size, const char **ret_words,
                       size_t *ret_length);

/* Returns true if the vertical angles begin and end where LM-63 allows it: straight down, at the
 * horizon, straight up. */
bool orl_ies_is_whole(const struct orl_ies *ies);

/* Returns true if the horizontal angles go on to 90, 180 or 360 degrees; of type B, to 90. */
bool orl_ies_has_all_planes(const struct orl_ies *ies);

/* Its intensities as a data file has them, W/sr without the factor: by horizontal angle, if there
 * are several, then by vertical one. Beyond the vertical angles of the file, and of type B beyond
 * its horizontal ones, they are 0. Of type C the last plane counts for those that are missing, and
 * all of the way round the first one at 360 degrees. Takes its arrays. */
int orl_ies_grid(struct orl_ies *ies, struct orl_grid **ret_grid, struct orl_error *err);

#endif
