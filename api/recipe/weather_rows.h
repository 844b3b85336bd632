/* Rows of a weather file, EPW or WEA, as far as recipes use them. */
#ifndef ORL_API_RECIPE_WEATHER_ROWS_H
#define ORL_API_RECIPE_WEATHER_ROWS_H

#include <stddef.h>

#include <oriel/base/error.h>

struct orl_recipe_weather_row {
    int month, day;
    double hour;                              /* middle of the interval */
    double direct_normal, diffuse_horizontal; /* W/m2 */
};
struct orl_weather_rows {
    char place[64];
    double latitude_deg, longitude_deg, time_zone_h; /* north and east */
    struct orl_recipe_weather_row *rows;             /* owned */
    size_t count;
};

/* Reads the text of a file. name: for errors, which have the line. */
int orl_weather_rows_read(const char *name, const char *text, size_t size,
                          struct orl_weather_rows *ret_weather, struct orl_error *err);
void orl_weather_rows_done(struct orl_weather_rows *weather); /* zeros are fine */

/* Writes a WEA file of the same rows with constant irradiances. An owned text; NULL: out of
 * memory. */
char *orl_weather_rows_constant(const struct orl_weather_rows *weather, double direct_normal,
                                double diffuse_horizontal);

#endif
