/* Pictures and data files of patterns, which must have values everywhere if they are accepted; and
 * luminaire tables. */
#include "fuzz/fuzz.h"
#include "scene/grid/grid.h"
#include "scene/parse/luminaire/luminaires.h"

static bool try_grid(int code, struct orl_grid *grid, const struct orl_error *err)
{
    static const double places[] = {-1e300, -2, -.1, 0, .4, 1, 3, 1e9};
    enum { N = sizeof places / sizeof *places };
    if (code < 0) {
        fuzz_check_error(code, err);
        return false;
    }
    FUZZ_PROMISE(grid->n_values > 0 && grid->n_values <= ORL_GRID_VALUES);
    for (size_t i = 0; i < N; i++) {
        double place[ORL_GRID_AXES], values[ORL_GRID_CHANNELS];
        for (size_t k = 0; k < ORL_GRID_AXES; k++)
            place[k] = places[(i + 3 * k) % N];
        orl_grid_at(grid, place, values);
    }
    orl_grid_free(grid);
    return true;
}

static bool try_lamps(const char *text, size_t size)
{
    static const char words[] = "2 x 35 W warm-white fluorescent";
    struct orl_lamp_table table = {"lamp.tab", text, size, ORL_LAMP_STEPS};
    struct orl_lamp_entry lamp;
    struct orl_error err = {0};
    const int code = orl_lamp_find(&table, words, sizeof words - 1, &lamp, &err);
    if (code < 0)
        fuzz_check_error(code, &err);
    FUZZ_PROMISE(code <= 0 || (lamp.share >= 0 && orl_rgb_max(lamp.color) < 1e12));
    return code > 0;
}

bool fuzz_grid(const uint8_t *data, size_t size)
{
    struct orl_error err = {0};
    struct orl_grid *grid = NULL;
    int code = orl_grid_read_picture("a.hdr", data, size, &grid, &err);
    const bool picture = try_grid(code, grid, &err);
    err = (struct orl_error){0};
    code = orl_grid_read_data("a.dat", (const char *)data, size, &grid, &err);
    const bool lamps = try_lamps((const char *)data, size);
    return try_grid(code, grid, &err) || picture || lamps;
}
