/*
 * Generators that scene files call: what they share, and the skies gensky and gendaylit (solids and
 * curved surfaces: solid/solids.h). Each reads the words of its command and writes the scene text
 * of Radiance's program of that name. The printed digits are equal, so a command and its output
 * mean the same scene. The text is then parsed like any other.
 *
 * Errors: ORL_ERR_SYNTAX for invalid words, _RANGE for numbers out of range, _UNSUPPORTED for
 * options that Oriel does not support.
 */
#ifndef ORL_SCENE_GENERATE_GENERATE_H
#define ORL_SCENE_GENERATE_GENERATE_H

#include <stdbool.h>
#include <stddef.h>

#include <oriel/base/error.h>
#include <oriel/base/thread_pool.h>

#include "scene/generate/sky/sun.h"
#include "scene/parsed_scene.h"

/* Scene text being written, with its warnings. */
struct orl_text {
    char *data;
    size_t size, room;
    bool failed;               /* out of memory, or cancelled: data is incomplete */
    bool object;               /* the text is an OBJ file */
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
int orl_gensky(const char *const *words, size_t count, struct orl_text *text,
               struct orl_error *err);
int orl_gendaylit(const char *const *words, size_t count, struct orl_text *text,
                  struct orl_error *err);

/*
 * Returns the sky of the same words in full precision instead of printed digits. Radiances are
 * W/sr/m2 per channel. text gets only warnings, without those about the site's longitude.
 * sun_override: the sun's position, which overrides the words; NULL: as the programs compute it
 * from the words. With sun_override, only the day of the year is used of the words' time.
 */
struct orl_sky_numbers {
    struct orl_sky pattern; /* sky and ground, as skybright's arguments */
    bool black;             /* nothing emits; a warning says why, except with no_gradation */
    /* black because the model diverges; the pattern lacks its gradation from zenith to horizon and
     * has an arbitrary brightness */
    bool no_gradation;
    bool has_sun;        /* a sun is written, possibly of radiance 0 */
    struct orl_vec3 sun; /* towards its centre; at most 87 degrees high, as in the programs */
    /* towards its centre, without that limit, which only the pattern needs */
    struct orl_vec3 true_sun;
    double sun_radiance;  /* 0 without a sun */
    double sun_measured;  /* radiance from the input; gendaylit omits a faint sun */
    double sun_angle_deg; /* full angle of the disc */
    double diffuse;       /* W/m2 of the pattern's upper half by the input; -1: not given */
    bool by_clock;        /* the sun's position came from standard time at the site */
    struct orl_location site;
};
int orl_gendaylit_numbers(const char *const *words, size_t count,
                          const struct orl_sun_position *sun_override, struct orl_text *text,
                          struct orl_sky_numbers *ret_numbers, struct orl_error *err);
int orl_gensky_numbers(const char *const *words, size_t count,
                       const struct orl_sun_position *sun_override, struct orl_text *text,
                       struct orl_sky_numbers *ret_numbers, struct orl_error *err);

/* ---- Shared by the generators ---------------------------------------------------------------- */

/* The unread words of a command. */
struct orl_words {
    const char *program;
    const char *const *at;
    size_t left;
};

/* Reads the number (or integer) that follows option. */
int orl_words_number(struct orl_words *words, const char *option, double *ret_value,
                     struct orl_error *err);
int orl_words_int(struct orl_words *words, const char *option, int low, int high, int *ret_value,
                  struct orl_error *err);

/* Reads an angle in degrees, and returns radians. */
int orl_words_angle(struct orl_words *words, const char *option, double *ret_rad,
                    struct orl_error *err);
int orl_words_point(struct orl_words *words, const char *option, struct orl_vec3 *ret_point,
                    struct orl_error *err);

/* Takes the next word; there is one. */
static inline const char *orl_words_take(struct orl_words *words)
{
    words->left--;
    return *words->at++;
}

/* A number that an option of one letter sets; an angle is in degrees, and stored in radians. */
struct orl_words_field {
    char letter;
    bool is_angle;
    double *value;
};

/* Reads the number behind such an option; fails if no field has its letter. */
int orl_words_field(struct orl_words *words, const char *option,
                    const struct orl_words_field *fields, size_t n, struct orl_error *err);

/* Fails because the program has no such option. */
int orl_words_refuse(const struct orl_words *words, const char *option, struct orl_error *err);

/* Reads the time at the front: "-ang altitude azimuth", or month, day and an hour, which is
 * returned as a word. *ret_hour is NULL if the sun's position is given. */
int orl_words_when(struct orl_words *words, struct orl_sun_position *ret_sun,
                   struct orl_moment *ret_moment, const char **ret_hour, struct orl_error *err);

/*
 * Splits a '!' line into words and pipeline stages, by a shell's rules for plain words: blanks
 * separate, quotes join, a backslash keeps the next character. Anything that would need a shell
 * (redirection, ';', '&', '$', '`', wildcards) is refused: no program is ever started. In the
 * arguments of generators (gen...) '*' is multiplication, not a wildcard.
 */

enum { ORL_COMMAND_STAGES = 6 };

/* Stage s has words[start[s]] up to, not including, words[start[s + 1]]. */
struct orl_command {
    char **words;
    size_t n_words;
    size_t start[ORL_COMMAND_STAGES + 1];
    size_t n_stages;
    char *text; /* storage of the words, each NUL-terminated */
};

/* Fills command, which the caller passes to orl_command_done. Returns 0, ORL_ERR_SYNTAX,
 * _UNSUPPORTED or _LIMIT. */
int orl_command_split(struct orl_command *command, const char *line, struct orl_error *err);
void orl_command_done(struct orl_command *command);

#endif
