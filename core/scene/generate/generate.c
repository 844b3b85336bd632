/* Functions that generators share: words are read, scene text is written. */
#include "scene/generate/generate.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text/words.h"

void orl_text_done(struct orl_text *text)
{
    free(text->data);
    memset(text, 0, sizeof *text);
}

static bool make_room(struct orl_text *text, size_t more)
{
    size_t room = text->room ? text->room : 1024;
    char *grown;
    while (room - text->size < more)
        room *= 2;
    if (room == text->room)
        return true;
    grown = realloc(text->data, room);
    if (!grown)
        return false;
    text->data = grown;
    text->room = room;
    return true;
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

static int take_word(struct orl_words *words, const char *option, const char **ret_word,
                     struct orl_error *err)
{
    if (words->left == 0)
        return orl_error_set(err, ORL_ERR_SYNTAX, "%s: '%.40s' needs a number after it",
                             words->program, option);
    *ret_word = *words->at++;
    words->left--;
    return 0;
}

int orl_words_number(struct orl_words *words, const char *option, double *ret_value,
                     struct orl_error *err)
{
    const char *word = "";
    enum orl_number_fault fault;
    int code = take_word(words, option, &word, err);
    if (code < 0)
        return code;
    fault = orl_number_read(word, strlen(word), ret_value);
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
    int value = 0, code = take_word(words, option, &word, err);
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

int orl_words_sun(struct orl_words *words, struct orl_sun_position *ret_sun, bool *ret_given,
                  struct orl_error *err)
{
    int code;
    if (words->left < 3)
        return orl_error_set(err, ORL_ERR_SYNTAX,
                             "%s needs month, day and hour, or -ang altitude azimuth",
                             words->program);
    *ret_given = strcmp(words->at[0], "-ang") == 0;
    if (!*ret_given)
        return 0;
    words->at++, words->left--;
    code = orl_words_angle(words, "-ang", &ret_sun->altitude_rad, err);
    return code < 0 ? code : orl_words_angle(words, "-ang", &ret_sun->azimuth_rad, err);
}

int orl_words_date(struct orl_words *words, struct orl_moment *moment, struct orl_error *err)
{
    const int code = orl_words_int(words, "the month", 1, 12, &moment->month, err);
    return code < 0 ? code : orl_words_int(words, "the day", 1, 31, &moment->day, err);
}
