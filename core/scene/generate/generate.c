/* Functions that generators share: words are read, scene text is written. */
#include "scene/generate/generate.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory/memory.h"
#include "base/text/words.h"

void orl_text_done(struct orl_text *text)
{
    free(text->data);
    memset(text, 0, sizeof *text);
}

static bool make_room(struct orl_text *text, size_t more)
{
    return orl_array_reserve_more(&text->data, &text->room, text->size, more, 1);
}

/* Prints into the usual room first; grows it if the text is longer. */
void orl_text_add(struct orl_text *text, const char *format, ...)
{
    enum { USUAL = 512 };
    va_list args;
    if (text->size >= text->next_poll) {
        text->failed |= orl_is_cancelled(text->cancel);
        text->next_poll = text->size + ORL_TEXT_POLL;
    }
    if (text->failed || !make_room(text, USUAL)) {
        text->failed = true;
        return;
    }
    va_start(args, format);
    const int length = vsnprintf(text->data + text->size, USUAL, format, args);
    va_end(args);
    if (length >= USUAL && make_room(text, (size_t)length + 1)) {
        va_start(args, format);
        vsnprintf(text->data + text->size, (size_t)length + 1, format, args);
        va_end(args);
    } else if (length < 0 || length >= USUAL) {
        text->data[text->size] = '\0';
        text->failed = true;
        return;
    }
    text->size += (size_t)length;
}

void orl_text_warn(struct orl_text *text, const char *format, ...)
{
    va_list args;
    size_t used = strlen(text->warnings);
    if (used > 0 && used + 3 < sizeof text->warnings) {
        memcpy(text->warnings + used, "; ", 3);
        used += 2;
    }
    va_start(args, format);
    vsnprintf(text->warnings + used, sizeof text->warnings - used, format, args);
    va_end(args);
}

/* Reads the word behind an option, a number. */
static int take_number(struct orl_words *words, const char *option, const char **ret_word,
                       struct orl_error *err)
{
    if (words->left == 0)
        return orl_error_set(err, ORL_ERR_SYNTAX, "%s: '%.40s' needs a number after it",
                             words->program, option);
    *ret_word = orl_words_take(words);
    return 0;
}

int orl_words_number(struct orl_words *words, const char *option, double *ret_value,
                     struct orl_error *err)
{
    const char *word = "";
    const int code = take_number(words, option, &word, err);
    if (code < 0)
        return code;
    const enum orl_number_fault fault = orl_number_read(word, strlen(word), ret_value);
    if (fault == ORL_NUMBER_OK)
        return 0;
    return orl_error_set(err, fault == ORL_NUMBER_INFINITE ? ORL_ERR_RANGE : ORL_ERR_SYNTAX,
                         "%s: '%.40s' for %.40s is not a finite number", words->program, word,
                         option);
}

int orl_words_int(struct orl_words *words, const char *option, int low, int high, int *ret_value,
                  struct orl_error *err)
{
    const char *word = "";
    int value = 0;
    const int code = take_number(words, option, &word, err);
    if (code < 0)
        return code;
    if (orl_number_read_int(word, strlen(word), &value) != ORL_NUMBER_OK)
        return orl_error_set(err, ORL_ERR_SYNTAX, "%s: '%.40s' for %.40s is not a whole number",
                             words->program, word, option);
    if (value < low || value > high)
        return orl_error_set(err, ORL_ERR_RANGE, "%s: %.40s is %d, and must be %d to %d",
                             words->program, option, value, low, high);
    *ret_value = value;
    return 0;
}

int orl_words_angle(struct orl_words *words, const char *option, double *ret_rad,
                    struct orl_error *err)
{
    double degrees = 0;
    const int code = orl_words_number(words, option, &degrees, err);
    if (code == 0)
        *ret_rad = degrees * ORL_DEG_TO_RAD;
    return code;
}

int orl_words_point(struct orl_words *words, const char *option, struct orl_vec3 *ret_point,
                    struct orl_error *err)
{
    double *const coordinates[] = {&ret_point->x, &ret_point->y, &ret_point->z};
    int code = 0;
    for (int i = 0; i < 3 && code == 0; i++)
        code = orl_words_number(words, option, coordinates[i], err);
    return code;
}

int orl_words_refuse(const struct orl_words *words, const char *option, struct orl_error *err)
{
    return orl_error_set(err, ORL_ERR_SYNTAX, "%s: '%.40s' is not an option", words->program,
                         option);
}

int orl_words_field(struct orl_words *words, const char *option,
                    const struct orl_words_field *fields, size_t n, struct orl_error *err)
{
    for (size_t i = 0; i < n; i++)
        if (fields[i].letter == option[1])
            return (fields[i].is_angle ? orl_words_angle : orl_words_number)(words, option,
                                                                             fields[i].value, err);
    return orl_words_refuse(words, option, err);
}

int orl_words_when(struct orl_words *words, struct orl_sun_position *ret_sun,
                   struct orl_moment *ret_moment, const char **ret_hour, struct orl_error *err)
{
    int code;
    if (words->left < 3)
        return orl_error_set(err, ORL_ERR_SYNTAX,
                             "%s needs month, day and hour, or -ang altitude azimuth",
                             words->program);
    *ret_hour = NULL;
    if (strcmp(words->at[0], "-ang") == 0) {
        orl_words_take(words);
        code = orl_words_angle(words, "-ang", &ret_sun->altitude_rad, err);
        return code < 0 ? code : orl_words_angle(words, "-ang", &ret_sun->azimuth_rad, err);
    }
    code = orl_words_int(words, "the month", 1, 12, &ret_moment->month, err);
    code = code < 0 ? code : orl_words_int(words, "the day", 1, 31, &ret_moment->day, err);
    *ret_hour = orl_words_take(words);
    return code;
}
