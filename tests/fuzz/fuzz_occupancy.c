/*
 * Occupancy files. The first byte chooses the year and which lines are appended, because the
 * fuzzer's inputs are too short to have a line per hour. The second byte is the number of the
 * input's lines that are not for an hour.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/annual/annual_metrics.h>

#include "fuzz/fuzz.h"
#include "metrics/annual/annual_figures.h"

enum { LEAP = 1, HALF_HOURS = 2, NUMBERS_FOLLOW = 4, TIMES_FOLLOW = 8, MOST_LINE = 32 };

/* Returns the input followed by a line for each hour that it lacks. */
static char *fill_up(const char *data, size_t size, unsigned how, uint32_t beside,
                     const struct orl_annual_steps *steps, size_t *ret_size)
{
    char *text = malloc(size + (size_t)steps->count * MOST_LINE), *at = text;
    uint32_t lines = 0;
    FUZZ_PROMISE(text != NULL);
    if (size > 0)
        at = mempcpy(at, data, size);
    for (size_t i = 0; i < size; i++)
        lines += data[i] == '\n';
    lines -= beside < lines ? beside : lines;
    for (; how & (NUMBERS_FOLLOW | TIMES_FOLLOW) && lines < steps->count; lines++) {
        const struct orl_calendar_day day = orl_calendar_day_of(steps, lines);
        if (how & TIMES_FOLLOW)
            at +=
                sprintf(at, "%d,%d,%.3f,", day.month, day.day, orl_calendar_hour_of(steps, lines));
        at = mempcpy(at, "0\n", 2);
    }
    *ret_size = (size_t)(at - text);
    /* A block of exactly the text's size lets AddressSanitizer detect reads past its end. */
    char *exact = malloc(*ret_size ? *ret_size : 1);
    FUZZ_PROMISE(exact != NULL);
    memcpy(exact, text, *ret_size);
    free(text);
    return exact;
}

bool fuzz_occupancy(const uint8_t *data, size_t size)
{
    const unsigned how = size > 1 ? data[0] : 0;
    const uint32_t hours = how & LEAP ? 8784 : 8760, per_hour = how & HALF_HOURS ? 2 : 1;
    const struct orl_annual_steps steps = {hours * per_hour, per_hour};
    struct orl_error err = {0};
    size_t length;
    if (size < 2)
        return false;
    char *text = fill_up((const char *)data + 2, size - 2, how, data[1], &steps, &length);
    unsigned char *marks = malloc(steps.count);
    FUZZ_PROMISE(marks != NULL);
    memset(marks, 7, steps.count);
    const int code = orl_occupancy_read("use.csv", text, length, &steps, marks, &err);
    if (code < 0)
        fuzz_check_error(code, &err);
    for (uint32_t i = 0; i < steps.count && code == 0; i++)
        FUZZ_PROMISE(marks[i] <= 1);
    free(marks);
    free(text);
    return code == 0;
}
