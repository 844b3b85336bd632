#include "light/daylight/weather.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>
#include <oriel/base/scanner.h>

#include "base/memory/memory.h"
#include "base/text/words.h"

struct reader {
    struct orl_scanner scanner;
    struct orl_weather weather;
    size_t room;
    int year;                  /* year of the rows to read; 0: all */
    int first_year, last_year; /* first and last year of the file's rows; 0: rows have no year */
    bool has_rows;             /* the file has rows, of any year */
    int first_date;            /* date in the EPW's header: days since 1 January */
    /* EPW: rows an hour, and index of the last row within its hour */
    int an_hour, n_of_hour;
    struct orl_weather_row last;
    short years[12][31][24]; /* years of rows by month, day and hour; 0: none */
    struct orl_error *err;
};

static int fail_at_line(struct reader *reader, int code, const char *what)
{
    return orl_scanner_fail(&reader->scanner, code, reader->err, "%s", what);
}

/* ---- Lines and fields ------------------------------------------------------------------------ */

/* Returns the next line that is not blank. */
static bool next_line(struct reader *reader, struct orl_slice *ret_line)
{
    do {
        if (!orl_scanner_line(&reader->scanner, ret_line))
            return false;
        *ret_line = orl_slice_trim(*ret_line);
    } while (ret_line->length == 0);
    return true;
}

static int read_number(struct reader *reader, struct orl_slice field, const char *what, double low,
                       double high, double *ret_value)
{
    double value = 0;
    const int code = orl_scanner_number(&reader->scanner, field, what, &value, reader->err);
    if (code < 0)
        return code;
    if (!(value >= low && value <= high))
        return orl_scanner_fail(&reader->scanner, ORL_ERR_RANGE, reader->err,
                                "%s is %g; it must lie between %g and %g", what, value, low, high);
    *ret_value = value;
    return 0;
}

struct number {
    struct orl_slice field;
    const char *what;
    double low, high, *ret_value;
};

static int read_numbers(struct reader *reader, const struct number *numbers, size_t count)
{
    int code = 0;
    for (const struct number *n = numbers; n < numbers + count && code == 0; n++)
        code = read_number(reader, n->field, n->what, n->low, n->high, n->ret_value);
    return code;
}

/* ---- Rows ------------------------------------------------------------------------------------ */

static const double missing = 9999; /* marks missing values in both formats */
/* Values at or below this are missing: some files use -999. Instruments may read below 0 at
 * night, but only by a few W/m2. */
static const double missing_below = -90;

/* Reads month, day, hour, direct and diffuse from five fields; the hour stays as in the file. */
static int read_row(struct reader *reader, const struct orl_slice fields[5], double first_hour,
                    double last_hour, struct orl_weather_row *ret_row)
{
    static const signed char days[12] = {31, 29, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    double month = 0, day = 0;
    struct orl_weather_row row = {.line = reader->scanner.line, .global = NAN};
    int code = read_number(reader, fields[0], "the month", 1, 12, &month);
    const struct number numbers[] = {
        {fields[1], "the day", 1, code < 0 ? 0 : days[(int)month - 1], &day},
        {fields[2], "the hour", first_hour, last_hour, &row.hour},
        {fields[3], "direct light", -1e6, 1e6, &row.direct},
        {fields[4], "diffuse light", -1e6, 1e6, &row.diffuse}};
    if (code == 0)
        code = read_numbers(reader, numbers, 4);
    if (code < 0)
        return code;
    if (month != floor(month) || day != floor(day))
        return fail_at_line(reader, ORL_ERR_SYNTAX, "month and day must be whole numbers");
    row.month = (int)month;
    row.day = (int)day;
    if (reader->weather.units == ORL_WEATHER_NORMAL_LX) /* lux may exceed 9999 */
        row.missing = row.direct >= 100 * missing || row.diffuse >= 100 * missing;
    else
        row.missing = row.direct >= missing || row.diffuse >= missing;
    row.missing = row.missing || row.direct <= missing_below || row.diffuse <= missing_below;
    *ret_row = row;
    return 0;
}

/* Returns the global irradiance, which is used for checks only; NaN if the field has no value. */
static double global_of(struct orl_slice field)
{
    double value = 0;
    if (orl_number_read(field.text, field.length, &value) != ORL_NUMBER_OK || !(value >= 0) ||
        value >= missing)
        return NAN;
    return value;
}

static int keep_row(struct reader *reader, const struct orl_weather_row *row)
{
    struct orl_weather *weather = &reader->weather;
    if (weather->n_rows >= ORL_LIMIT_WEATHER_ROWS)
        return fail_at_line(reader, ORL_ERR_LIMIT,
                            "the file has more rows than a year has minutes");
    if (!orl_array_reserve(&weather->rows, &reader->room, weather->n_rows, sizeof *weather->rows))
        return fail_at_line(reader, ORL_ERR_NOMEM, "out of memory");
    weather->rows[weather->n_rows++] = *row;
    return 0;
}

/* Takes up to n cells off an EPW's line; returns their number. */
static int take_cells(struct orl_slice *line, struct orl_slice *ret_cells, int n)
{
    int i = 0;
    while (i < n && orl_slice_take_cell(line, ',', &ret_cells[i]))
        i++;
    return i;
}

/* ---- EPW ------------------------------------------------------------------------------------- */

enum { EPW_FIELDS_READ = 16, EPW_FIELDS = 35, EPW_HEADER_LINES = 8 };

/* Line format: LOCATION,city,state,country,source,WMO,latitude,longitude,time zone,elevation */
static int read_location(struct reader *reader, struct orl_slice line)
{
    struct orl_weather *weather = &reader->weather;
    struct orl_slice fields[9] = {0};
    if (take_cells(&line, fields, 9) < 9)
        return fail_at_line(reader, ORL_ERR_SYNTAX, "LOCATION ends before the time zone");
    const struct number numbers[] = {
        {fields[6], "the latitude", -90, 90, &weather->latitude_deg},
        {fields[7], "the longitude", -180, 180, &weather->longitude_deg},
        {fields[8], "the time zone", -14, 14, &weather->time_zone_h}};
    return read_numbers(reader, numbers, 3);
}

/* Returns the index of the name that the field begins with, or n. */
static int find_name(struct orl_slice field, const char *const *names, int n)
{
    int i = 0;
    while (i < n && !orl_slice_begins_nocase(field, names[i]))
        i++;
    return i;
}

/* Reads a date of the header: "7/ 1", or "1-Jul" and "Jul-01" as spreadsheets rewrite it.
 * Returns the days since 1 January, or -1. */
static int days_of_date(struct orl_slice date)
{
    static const char *const names[] = {"jan", "feb", "mar", "apr", "may", "jun",
                                        "jul", "aug", "sep", "oct", "nov", "dec"};
    enum { MONTHS = sizeof names / sizeof *names };
    const bool dashed = date.text && memchr(date.text, '-', date.length);
    struct orl_slice parts[2] = {{NULL, 0}};
    double month = 0, day = 0;
    if (!orl_slice_take_cell(&date, dashed ? '-' : '/', &parts[0]) ||
        !orl_slice_take_cell(&date, dashed ? '-' : '/', &parts[1]))
        return -1;
    const int by_name = dashed ? (find_name(parts[0], names, MONTHS) < MONTHS ? 0 : 1) : 0;
    if (dashed)
        month = find_name(parts[by_name], names, MONTHS) + 1;
    else if (orl_number_read(parts[0].text, parts[0].length, &month) != ORL_NUMBER_OK)
        return -1;
    const struct orl_slice other = parts[1 - by_name];
    if (orl_number_read(other.text, other.length, &day) != ORL_NUMBER_OK || !(month >= 1) ||
        month > MONTHS || !(day >= 1) || day > 31)
        return -1;
    return orl_weather_days_before((int)month, (int)day, false);
}

/* Returns the weekday of 1 January from that of another date, in a year of 365 days; -1 if
 * either cannot be read. *ret_days: the days between the two. */
static int weekday_of_new_year(struct orl_slice name, struct orl_slice date, int *ret_days)
{
    static const char *const names[] = {"mon", "tue", "wed", "thu", "fri", "sat", "sun"};
    const int weekday = find_name(name, names, 7), days = days_of_date(date);
    if (weekday == 7 || days < 0)
        return -1;
    *ret_days = days;
    return (weekday + 7 * 53 - days) % 7;
}

/* Line format: DATA PERIODS,how many,records an hour,name,weekday of the first date,first
 * date,last date */
static int read_periods(struct reader *reader, struct orl_slice line)
{
    struct orl_slice cells[6] = {0};
    double an_hour = 0;
    const int n = take_cells(&line, cells, 6);
    if (n < 3)
        return fail_at_line(reader, ORL_ERR_SYNTAX,
                            "DATA PERIODS ends before the number of records per hour");
    if (n == 6)
        reader->weather.first_weekday =
            weekday_of_new_year(cells[4], cells[5], &reader->first_date);
    const int code =
        read_number(reader, cells[2], "the number of records per hour", 1, 60, &an_hour);
    if (code == 0 && an_hour != floor(an_hour))
        return fail_at_line(reader, ORL_ERR_RANGE,
                            "the number of records per hour is not a whole number");
    if (code == 0 && fmod(60, an_hour) != 0)
        return fail_at_line(reader, ORL_ERR_RANGE, "the number of records per hour must divide 60");
    reader->an_hour = code == 0 ? (int)an_hour : 1;
    return code;
}

/* Replaces the row's hour by the middle of its interval. Rows of an hour are consecutive. Their
 * minutes are ignored, as in EnergyPlus: files give the beginning of an interval, its end, or
 * nothing. */
static int set_row_middle(struct reader *reader, struct orl_weather_row *row)
{
    const struct orl_weather_row *last = &reader->last;
    const bool same = last->year == row->year && last->month == row->month &&
                      last->day == row->day && last->hour == row->hour;
    reader->n_of_hour = same && reader->an_hour > 1 ? reader->n_of_hour + 1 : 0;
    reader->last = *row;
    row->hour += (reader->n_of_hour + 0.5) / reader->an_hour - 1;
    if (reader->n_of_hour < reader->an_hour)
        return 0;
    return orl_scanner_fail(&reader->scanner, ORL_ERR_RANGE, reader->err,
                            "the hour has more than the %d rows that DATA PERIODS states",
                            reader->an_hour);
}

/* Returns the year. Files of no particular year leave the field empty or write 0. */
static int year_of(struct orl_slice field)
{
    double year = 0;
    if (orl_number_read(field.text, field.length, &year) != ORL_NUMBER_OK || !(year > 0) ||
        year > 9999)
        return 0;
    return (int)year;
}

/* Refuses a second year for the same month, day and hour if no year is chosen. */
static int check_year(struct reader *reader, const struct orl_weather_row *row)
{
    short *year = &reader->years[row->month - 1][row->day - 1][(int)row->hour % 24];
    if (reader->year == 0 && *year != 0 && row->year != 0 && *year != row->year) {
        orl_error_set(reader->err, ORL_ERR_RANGE,
                      "the file has rows of %d and of %d for month %d, day %d, hour %g", *year,
                      row->year, row->month, row->day, row->hour);
        orl_error_at(reader->err, reader->scanner.name, reader->scanner.line, NULL);
        orl_error_hint(reader->err, "choose one with \"year\", for example \"year\": %d", *year);
        return ORL_ERR_RANGE;
    }
    if (row->year == 0)
        return 0;
    *year = (short)row->year;
    if (reader->first_year == 0 || row->year < reader->first_year)
        reader->first_year = row->year;
    if (row->year > reader->last_year)
        reader->last_year = row->year;
    return 0;
}

/* Checks that the row has at most the 35 fields of the format: decimal commas make more. */
static int check_fields(struct reader *reader, struct orl_slice rest)
{
    int n = EPW_FIELDS_READ;
    for (size_t i = 0; i < rest.length; i++) {
        n += rest.text[i] == ',';
        if (n >= EPW_FIELDS && rest.text[i] != ',') {
            fail_at_line(reader, ORL_ERR_SYNTAX,
                         "the row has more than the 35 fields of an EPW file");
            orl_error_hint(reader->err, "decimal commas may cause this: write 21.5, not 21,5");
            return ORL_ERR_SYNTAX;
        }
    }
    return 0;
}

static int read_epw_row(struct reader *reader, struct orl_slice line)
{
    struct orl_slice fields[EPW_FIELDS_READ] = {0};
    struct orl_weather_row row = {.hour = 0};
    int code;
    if (take_cells(&line, fields, EPW_FIELDS_READ) < EPW_FIELDS_READ)
        return fail_at_line(
            reader, ORL_ERR_SYNTAX,
            "the row ends before the diffuse horizontal irradiance, its 16th field");
    code = check_fields(reader, line);
    if (code < 0)
        return code;
    const struct orl_slice five[5] = {fields[1], fields[2], fields[3], fields[14], fields[15]};
    code = read_row(reader, five, 1, 24, &row);
    double hour = 1;
    if (code < 0 && orl_number_read(fields[3].text, fields[3].length, &hour) == ORL_NUMBER_OK &&
        hour == 0)
        orl_error_hint(reader->err, "rows of an EPW file have hours from 1 to 24, the ends of "
                                    "their intervals: add 1 to the hours");
    if (code < 0)
        return code;
    row.year = year_of(fields[0]);
    row.global = global_of(fields[13]);
    reader->has_rows = true;
    code = check_year(reader, &row);
    if (code == 0)
        code = set_row_middle(reader, &row);
    if (code < 0 || (reader->year != 0 && row.year != reader->year))
        return code;
    return keep_row(reader, &row);
}

static int read_epw(struct reader *reader, struct orl_slice line)
{
    int code = read_location(reader, line), lines = 1;
    reader->weather.units = ORL_WEATHER_NORMAL_W;
    while (code == 0 && !orl_slice_begins_nocase(line, "DATA PERIODS,")) {
        if (lines++ == EPW_HEADER_LINES || !next_line(reader, &line))
            return fail_at_line(reader, ORL_ERR_SYNTAX, "the header has no line DATA PERIODS");
    }
    if (code == 0)
        code = read_periods(reader, line);
    while (code == 0 && next_line(reader, &line))
        code = read_epw_row(reader, line);
    return code;
}

/* ---- WEA ------------------------------------------------------------------------------------- */

enum { WEA_LATITUDE, WEA_LONGITUDE, WEA_TIME_ZONE, WEA_ELEVATION, WEA_UNITS, WEA_KEYS };

static int read_wea_header(struct reader *reader)
{
    static const struct {
        const char *key;
        double low, high;
    } keys[WEA_KEYS] = {{"latitude", -90, 90},
                        {"longitude", -180, 180},
                        {"time_zone", -210, 210},
                        {"site_elevation", -1000, 10000},
                        {"weather_data_file_units", 1, 3}};
    double values[WEA_KEYS] = {0};
    for (int i = 0; i < WEA_KEYS; i++) {
        struct orl_slice line, value;
        int code;
        if (!next_line(reader, &line) || !orl_slice_begins_nocase(line, keys[i].key))
            return orl_scanner_fail(&reader->scanner, ORL_ERR_SYNTAX, reader->err,
                                    "expected '%s' and its value here", keys[i].key);
        value =
            (struct orl_slice){line.text + strlen(keys[i].key), line.length - strlen(keys[i].key)};
        code = read_number(reader, orl_slice_trim(value), keys[i].key, keys[i].low, keys[i].high,
                           &values[i]);
        if (code < 0)
            return code;
    }
    if (values[WEA_UNITS] != floor(values[WEA_UNITS]))
        return fail_at_line(reader, ORL_ERR_RANGE, "weather_data_file_units must be 1, 2 or 3");
    reader->weather.latitude_deg = values[WEA_LATITUDE];
    reader->weather.longitude_deg = -values[WEA_LONGITUDE];
    reader->weather.time_zone_h = -values[WEA_TIME_ZONE] / 15.0;
    reader->weather.units = (enum orl_weather_units)values[WEA_UNITS];
    return 0;
}

static int read_wea_row(struct reader *reader, struct orl_slice line)
{
    struct orl_slice fields[5] = {0};
    struct orl_weather_row row = {.hour = 0};
    int code;
    for (int i = 0; i < 5; i++) {
        fields[i] = orl_slice_take_word(&line);
        if (fields[i].length == 0)
            return fail_at_line(
                reader, ORL_ERR_SYNTAX,
                "a row has five values: month, day, hour, direct and diffuse light");
    }
    code = read_row(reader, fields, 0, 25, &row);
    return code < 0 ? code : keep_row(reader, &row);
}

static int read_wea(struct reader *reader)
{
    struct orl_slice line;
    int code = read_wea_header(reader);
    if (code == 0 && reader->year != 0) {
        fail_at_line(reader, ORL_ERR_INVALID,
                     "\"year\" is given, but rows of WEA files have no year");
        orl_error_hint(reader->err, "leave \"year\" out, or use the EPW file");
        return ORL_ERR_INVALID;
    }
    while (code == 0 && next_line(reader, &line))
        code = read_wea_row(reader, line);
    return code;
}

/* ---- Intervals ------------------------------------------------------------------------------- */

/* Returns the least time between successive rows of a day, at most an hour, because files may
 * omit nights. Times of 10-minute rows are rounded in files: returns the exact fraction of an
 * hour. */
static double find_interval(const struct orl_weather *weather)
{
    static const double rounded = 0.07; /* error of 0.016 h for 1/60 h */
    double least = 1;
    for (size_t i = 1; i < weather->n_rows; i++) {
        const struct orl_weather_row *a = &weather->rows[i - 1], *b = &weather->rows[i];
        const double step = b->hour - a->hour;
        if (a->month == b->month && a->day == b->day && step > 1e-6)
            least = fmin(least, step);
    }
    const double an_hour = round(fmin(60, 1 / least));
    return fabs(least * an_hour - 1) < rounded ? 1 / an_hour : least;
}

/* ---- Years ----------------------------------------------------------------------------------- */

/* Sets the weekday of 1 January. If the file continues over 31 December, the header's date is in
 * the year before. */
static void set_first_weekday(struct reader *reader)
{
    struct orl_weather *weather = &reader->weather;
    const int before = reader->year - 1;
    /* In the Gregorian calendar 1 January of year 1 was a Monday. */
    if (reader->year != 0 && reader->first_year != reader->last_year)
        weather->first_weekday = (365 * before + before / 4 - before / 100 + before / 400) % 7;
    if (weather->n_moved == 0 || weather->first_weekday < 0)
        return;
    const struct orl_weather_row *first = &weather->rows[weather->n_moved];
    const int days = orl_weather_days_before(first->month, first->day, false);
    const bool leap = first->month <= 2 && orl_weather_has_leap_day(weather);
    if (days > 0 && reader->first_date >= days)
        weather->first_weekday = (weather->first_weekday + 365 + leap) % 7;
}

static int refuse_year(struct reader *reader)
{
    if (reader->last_year == 0)
        return orl_error_set(
            reader->err, ORL_ERR_RANGE,
            "the file has no rows for %d: its rows have no year; leave \"year\" out", reader->year);
    return orl_error_set(reader->err, ORL_ERR_RANGE,
                         "the file has no rows for %d: its years are %d to %d", reader->year,
                         reader->first_year, reader->last_year);
}

/* ---- Entry points ---------------------------------------------------------------------------- */

/* Checks that there are rows, and sorts them. */
static int finish_rows(struct reader *reader)
{
    int code = 0;
    if (reader->weather.n_rows == 0 && reader->has_rows) {
        code = refuse_year(reader);
        orl_error_at(reader->err, reader->scanner.name, 0, NULL);
    } else if (reader->weather.n_rows == 0) {
        code = fail_at_line(reader, ORL_ERR_SYNTAX, "the weather file has no rows");
    } else {
        code = orl_weather_sort_rows(&reader->weather, reader->scanner.name, reader->err);
    }
    if (code < 0)
        return code;
    set_first_weekday(reader);
    reader->weather.interval_h = find_interval(&reader->weather);
    return 0;
}

/* Detects TMY2 files, which begin with a station's number, its city, state, time zone, and N or
 * S. */
static bool is_tmy2(struct orl_slice line)
{
    struct orl_slice word, last = {NULL, 0};
    double number = 0;
    bool first = true;
    while ((word = orl_slice_take_word(&line)).length > 0) {
        const bool is_number = orl_number_read(word.text, word.length, &number) == ORL_NUMBER_OK;
        if (first && !is_number)
            return false;
        if (!first && is_number && last.length == 1 && (*last.text == 'N' || *last.text == 'S'))
            return true;
        first = false;
        last = word;
    }
    return false;
}

static int refuse_head(struct reader *reader, struct orl_slice line)
{
    static const char convert[] = "use an EPW file of the site, or convert this file to EPW";
    fail_at_line(reader, ORL_ERR_SYNTAX,
                 "a weather file begins with LOCATION (EPW) or place (WEA)");
    if (orl_slice_begins_nocase(line, "LOCATION;"))
        orl_error_hint(reader->err, "this EPW file has semicolons: save it with commas between "
                                    "fields and with decimal points");
    else if (orl_slice_begins_nocase(line, "Latitude (decimal degrees)"))
        orl_error_hint(reader->err,
                       "this is a PVGIS table: PVGIS also offers the data as an EPW file");
    else if (orl_slice_begins_nocase(line, "Source,Location ID,"))
        orl_error_hint(reader->err, "this is an NSRDB table: %s", convert);
    else if (is_tmy2(line))
        orl_error_hint(reader->err, "this is a TMY2 file: %s", convert);
    else if (next_line(reader, &line) && orl_slice_begins_nocase(line, "Date (MM/DD/YYYY),"))
        orl_error_hint(reader->err, "this is a TMY3 table: %s", convert);
    else
        orl_error_hint(reader->err, "this file format is not supported: %s", convert);
    return ORL_ERR_SYNTAX;
}

int orl_weather_parse(const char *name, const char *text, size_t size, int year,
                      struct orl_weather *ret_weather, struct orl_error *err)
{
    struct orl_error local;
    struct reader reader = {
        .weather = {.first_weekday = -1}, .year = year, .err = err ? err : &local};
    struct orl_slice line = {NULL, 0};
    int code = orl_scanner_init(&reader.scanner, name, text, size, 0, reader.err);
    if (code < 0)
        return code;
    if (next_line(&reader, &line) && orl_slice_begins_nocase(line, "LOCATION,"))
        code = read_epw(&reader, line);
    else if (orl_slice_begins_nocase(line, "place"))
        code = read_wea(&reader);
    else
        code = refuse_head(&reader, line);
    if (code == 0)
        code = finish_rows(&reader);
    if (code < 0) {
        orl_weather_done(&reader.weather);
        return code;
    }
    *ret_weather = reader.weather;
    return 0;
}

void orl_weather_done(struct orl_weather *weather)
{
    if (!weather)
        return;
    free(weather->rows);
    memset(weather, 0, sizeof *weather);
}

const struct orl_weather_row *orl_weather_find(const struct orl_weather *weather, int month,
                                               int day, double hour)
{
    const struct orl_weather_row *best = NULL;
    double nearest = 0.5 + 1e-9;
    for (size_t i = 0; i < weather->n_rows; i++) {
        const struct orl_weather_row *row = &weather->rows[i];
        const double distance = fabs(row->hour - hour);
        if (row->month == month && row->day == day && distance <= nearest) {
            best = row;
            nearest = distance;
        }
    }
    return best;
}
