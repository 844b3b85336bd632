/*
 * A view under several skies, to be compared: its pictures in one common exposure, side by side on
 * a contact sheet, and one after the other as an animation.
 *
 * What is shown comes from the pictures' radiances (Radiance HDR), all of one size. In common means
 * that a luminance is as bright in every picture, by the tone that the view asks for: where that is
 * the eye's, the histograms of all of them are taken as one (render/picture/human.h).
 * What is black, as before dawn, counts for no exposure, and is shown black, in its place. Where
 * the first picture is all black, programs that know no animations show the brightest instead.
 */
#ifndef ORIEL_SEQUENCE_H
#define ORIEL_SEQUENCE_H

#include <stdatomic.h>
#include <stdint.h>

#include <oriel/files.h>
#include <oriel/picture.h>

/* What a job asks for; zero is the default of each. */
struct orl_sequence_request {
    bool asked;
    double frame_s;    /* how long the animation shows each; 0: 0.5 */
    uint32_t columns;  /* of the sheet; 0: what makes it about as wide as high */
    uint32_t width_px; /* of a picture on it; 0: 240. None is enlarged, and all are made smaller
                          where the sheet would have more pixels than a picture may */
};

enum { ORL_SEQUENCE_LINES = 2, ORL_SEQUENCE_TEXT = 64 };

struct orl_sequence_frame {
    const char *picture;                               /* the HDR's name, for files */
    const char *shown;                                 /* the path that it goes to as PNG */
    char lines[ORL_SEQUENCE_LINES][ORL_SEQUENCE_TEXT]; /* written below it */
};

struct orl_sequence {
    const struct orl_files *files; /* borrowed, as all here */
    const struct orl_display *display;
    const struct orl_sequence_request *how;
    const struct orl_sequence_frame *frames;
    size_t n_frames;               /* 1 or more */
    const char *title;             /* above the sheet */
    const char *sheet, *animation; /* the paths of both PNGs */
    const atomic_bool *cancel;     /* polled per picture; NULL: never */
};

/* Writes all of them, each whole or absent. ORL_ERR_RANGE: the pictures differ in size;
 * ORL_ERR_CANCELLED, _IO, _NOMEM, or what is wrong with a picture. */
int orl_sequence_write(const struct orl_sequence *sequence, struct orl_error *err);

#endif
