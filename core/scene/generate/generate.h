/*
 * The generators that scene files call: genbox, gensky and gendaylit. Each reads the words of its
 * command and writes the scene text that Radiance's program of that name writes, with the same
 * numbers to the printed digit, so that a scene means the same whether a command or its output
 * stands in it. Text is then parsed like any other.
 *
 * Errors: ORL_ERR_SYNTAX for words that make no sense, _RANGE for numbers out of range,
 * _UNSUPPORTED for options that Oriel has no use for.
 */
#ifndef ORL_SCENE_GENERATE_GENERATE_H
#define ORL_SCENE_GENERATE_GENERATE_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/crew.h>
#include <oriel/error.h>

#include "scene/description.h"
#include "scene/generate/sun.h"

/* Scene text in the making, and what is to be said about it. */
struct orl_text {
    char *data;
    size_t size, room;
    bool failed;               /* out of memory, or cancelled: data is short */
    bool object;               /* an OBJ file's, instead of a scene's */
    char warnings[512];        /* sentences joined by "; ", or "" */
    const atomic_bool *cancel; /* polled each ORL_TEXT_POLL bytes; or NULL */
    size_t next_poll;
};
enum { ORL_TEXT_POLL = 64 << 10 };

void orl_text_done(struct orl_text *text);
void orl_text_add(struct orl_text *text, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
void orl_text_warn(struct orl_text *text, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* words[0] is the command's name. */
int orl_genbox(const char *const *words, size_t count, struct orl_text *text,
               struct orl_error *err);
int orl_gensky(const char *const *words, size_t count, struct orl_text *text,
               struct orl_error *err);
int orl_gendaylit(const char *const *words, size_t count, struct orl_text *text,
                  struct orl_error *err);

/*
 * The sky that the same words stand for, in full precision instead of printed digits. Radiances are
 * W/sr/m2 per channel. text gets the warnings only; what the site's longitude suggests is not among
 * them. placed is where the sun stands, whatever place the words give it; NULL: by the words, as
 * the programs place it. Only the day of the year is taken from the words' time then.
 */
struct orl_sky_numbers {
    struct orl_sky pattern; /* sky and ground, as skybright's arguments */
    bool black;             /* nothing shines; said in the warnings, but for the next case */
    bool no_gradation;      /* black since the model has no answer; the pattern is one without its
                               change from zenith to horizon, of no particular brightness */
    bool has_sun;           /* one is to be written, be it of radiance 0 */
    struct orl_vec3 sun; /* towards its centre; at most 87 degrees high, as the programs have it */
    struct orl_vec3 true_sun; /* the same without that bound, which only the pattern needs */
    double sun_radiance;      /* 0 without a sun */
    double sun_measured;  /* the radiance that the input asks for: gendaylit drops a faint sun */
    double sun_angle_deg; /* the whole disc's */
    double diffuse;       /* W/m2 that the pattern's upper half is meant to give; -1: not given */
    bool by_clock;        /* the sun was placed by standard time at the site */
    struct orl_location site;
};
int orl_gendaylit_numbers(const char *const *words, size_t count,
                          const struct orl_sun_position *placed, struct orl_text *text,
                          struct orl_sky_numbers *ret_numbers, struct orl_error *err);
int orl_gensky_numbers(const char *const *words, size_t count,
                       const struct orl_sun_position *placed, struct orl_text *text,
                       struct orl_sky_numbers *ret_numbers, struct orl_error *err);

/* ---- What the generators share --------------------------------------------------------------- */

/* The words of a command, read one after the other. */
struct orl_words {
    const char *program;
    const char *const *at;
    size_t left;
};

/* The number that follows option, or the whole number. */
int orl_words_number(struct orl_words *words, const char *option, double *ret_value,
                     struct orl_error *err);
int orl_words_int(struct orl_words *words, const char *option, int low, int high, int *ret_value,
                  struct orl_error *err);

/* An angle in degrees, into radians. */
int orl_words_angle(struct orl_words *words, const char *option, double *ret_rad,
                    struct orl_error *err);

/* "-ang altitude azimuth" at the front: ret_given says whether it was there. */
int orl_words_sun(struct orl_words *words, struct orl_sun_position *ret_sun, bool *ret_given,
                  struct orl_error *err);

/* The month and the day that follow. */
int orl_words_date(struct orl_words *words, struct orl_moment *moment, struct orl_error *err);

/* Warns when meridian and longitude are further apart than three hours: a sign is wrong, mostly. */
void orl_text_warn_site(struct orl_text *text, const char *program,
                        const struct orl_location *site);

#endif
