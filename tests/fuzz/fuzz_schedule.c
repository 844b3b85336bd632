/* Tables of shade states. The first byte is the number of states, the second is set if the states
 * have names. */
#include <stdlib.h>
#include <string.h>

#include <oriel/annual/annual_report.h>

#include "fuzz/fuzz.h"

enum { MOST_STATES = 4 };

static const char *const names[MOST_STATES] = {"open", "half shut", "shut", "7"};

static struct orl_window_group make_group(size_t n_states, bool named)
{
    struct orl_window_group group = {.name = strdup("south"),
                                     .schedule_file = strdup("shades.csv")};
    group.states = calloc(n_states, sizeof *group.states);
    FUZZ_PROMISE(group.name && group.schedule_file && group.states);
    group.n_states = (uint32_t)n_states;
    for (size_t i = 0; i < n_states && named; i++) {
        group.states[i].name = strdup(names[i]);
        FUZZ_PROMISE(group.states[i].name != NULL);
    }
    return group;
}

bool fuzz_schedule(const uint8_t *data, size_t size)
{
    static const char *const file_names[] = {"shades.csv"};
    struct orl_error err = {0};
    if (size < 2)
        return false;
    char *exact = malloc(size - 2 ? size - 2 : 1);
    FUZZ_PROMISE(exact != NULL);
    memcpy(exact, data + 2, size - 2);
    const struct orl_file file = {.data = exact, .size = size - 2};
    struct orl_memory_files memory = {file_names, &file, 1};
    const struct orl_files files = orl_files_from_memory(&memory);
    struct orl_window_group group = make_group(1 + data[0] % MOST_STATES, data[1] & 1);
    struct orl_annual_request request = {.groups = &group, .n_groups = 1};
    const int code = orl_annual_schedules_read(&request, &files, &err);
    if (code < 0) {
        fuzz_check_error(code, &err);
        FUZZ_PROMISE(strcmp(err.file, "shades.csv") == 0);
    }
    for (size_t i = 0; i < group.n_series && code == 0; i++)
        FUZZ_PROMISE(group.series[i] < group.n_states);
    orl_window_group_done(&group);
    free(exact);
    return code == 0;
}
