/*
 * A view under several skies, for comparison: its pictures in one common exposure, side by side on
 * a contact sheet, and one after the other as an animation.
 *
 * Input is the radiances of the pictures (Radiance HDR), all of one size. Common exposure means
 * that a luminance has the same brightness in every picture, under the view's tone mapping. For
 * ORL_TONE_HUMAN, the histograms of all pictures are merged (render/picture/tonemap_ward_larson.h).
 * Black pictures, as before dawn, do not affect the exposure; they are shown black, in their place.
 * If the first picture is all black, programs without animation support show the brightest one
 * instead.
 */
#ifndef ORIEL_JOB_SEQUENCE_H
#define ORIEL_JOB_SEQUENCE_H

#include <stdatomic.h>
#include <stdint.h>

#include <oriel/base/files.h>
#include <oriel/job/picture.h>

/* Settings of a job; zero is the default of each. */
struct orl_sequence_request {
    bool asked;
    double frame_s;   /* seconds per picture in the animation; 0: 0.5 */
    uint32_t columns; /* columns of the sheet; 0: chosen to make it about square */
    /* Width of a picture on the sheet; 0: 240. Pictures are never enlarged, and are all reduced
     * further if the sheet would exceed the pixel limit of a picture. */
    uint32_t width_px;
};

enum { ORL_SEQUENCE_LINES = 2, ORL_SEQUENCE_TEXT = 64 };

struct orl_sequence_frame {
    const char *picture;                               /* name of the HDR for files */
    const char *shown;                                 /* path of the PNG to write */
    char lines[ORL_SEQUENCE_LINES][ORL_SEQUENCE_TEXT]; /* caption */
};

struct orl_sequence {
    const struct orl_files *files; /* borrowed, as are all pointers here */
    const struct orl_display *display;
    const struct orl_sequence_request *how;
    const struct orl_sequence_frame *frames;
    size_t n_frames;               /* 1 or more */
    const char *title;             /* heading of the sheet */
    const char *sheet, *animation; /* paths of both PNGs */
    const atomic_bool *cancel;     /* polled per picture; NULL: never */
};

/* Writes all files, each whole or absent. Returns ORL_ERR_RANGE (pictures differ in size),
 * ORL_ERR_CANCELLED, _IO, _NOMEM, or the error of reading a picture. */
int orl_sequence_write(const struct orl_sequence *sequence, struct orl_error *err);

#endif
