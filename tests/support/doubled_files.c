/* The rows for other kinds of files. */
#include "fixtures/bsdf_make.h"
#include "support/doubled.h"
#include "support/zip.h"

/* ---- BSDFs ----------------------------------------------------------------------------------- */

static void write_bsdf(FILE *f, const char *structure, const char *basis, size_t n,
                       const char *value, const char *open, const char *end)
{
    make_head(f, structure);
    make_block_head(f, "Visible", "Transmission Front", basis);
    fputs(open, f);
    for (size_t i = 0; i < n; i++)
        fputs(value, f);
    fputs(end, f);
    make_block_tail(f);
    make_tail(f);
}
/* Writes a tree of three levels; n of the 256 cells of the second level are split once more. */
static void write_leaves(FILE *f, size_t n)
{
    make_head(f, "TensorTree4");
    make_block_head(f, "Visible", "Transmission Front", NULL);
    fputs("{", f);
    for (size_t i = 0; i < 16; i++) {
        fputs("{", f);
        for (size_t k = 0; k < 16; k++) {
            if (i * 16 + k >= n) {
                fputs("{.1}", f);
                continue;
            }
            fputs("{", f);
            for (size_t j = 0; j < 16; j++)
                fprintf(f, "{.%zu}", i + k + j + 1);
            fputs("}", f);
        }
        fputs("}", f);
    }
    fputs("}", f);
    make_block_tail(f);
    make_tail(f);
}
static void write_data_blanks(FILE *f, size_t n)
{
    write_bsdf(f, "TensorTree4", NULL, n, "              \n", "{.1", "}");
}
static void write_data_comments(FILE *f, size_t n)
{
    write_bsdf(f, "TensorTree4", NULL, n, "<!-- x -->", "{.1", "}");
}
static void write_xml_comment(FILE *f, size_t n)
{
    write_bsdf(f, "TensorTree4", NULL, n, "comment ", "{.1}<!--", "-->");
}
static void write_xml_references(FILE *f, size_t n)
{
    write_bsdf(f, "TensorTree4", NULL, n, "&#32;", "{.1", "}");
}
static void write_klems(FILE *f, size_t n)
{
    make_head(f, "Columns");
    for (size_t i = 0; i < n;
         i++) { /* only the last is visible; the others have another wavelength */
        make_block_head(f, i + 1 < n ? "NIR" : "Visible", "Transmission Front",
                        "LBNL/Klems Quarter");
        for (int k = 0; k < 41 * 41; k++)
            fputs(".01, ", f);
        make_block_tail(f);
    }
    make_tail(f);
}
static void write_unknown_elements(FILE *f, size_t n)
{
    fputs("<WindowElement><Optical><Layer><DataDefinition><IncidentDataStructure>TensorTree4"
          "</IncidentDataStructure></DataDefinition>",
          f);
    for (size_t i = 0; i < n; i++)
        fprintf(f, "<e%zu>%zu</e%zu><!-- %zu -->", i, i, i, i);
    make_block_head(f, "Visible", "Transmission Front", NULL);
    fputs("{.1}", f);
    make_block_tail(f);
    make_tail(f);
}
static void write_attributes(FILE *f, size_t n)
{
    fputs("<WindowElement", f);
    for (size_t i = 0; i < n; i++)
        fprintf(f, " a%zu='%zu'", i, i);
    fputs("><Optical><Layer><DataDefinition><IncidentDataStructure>TensorTree4"
          "</IncidentDataStructure></DataDefinition>",
          f);
    make_block_head(f, "Visible", "Transmission Front", NULL);
    fputs("{.1}", f);
    make_block_tail(f);
    make_tail(f);
}
static void write_name(FILE *f, size_t n)
{
    fputs("<WindowElement><Optical><Layer><Material><Name>", f);
    for (size_t i = 0; i < n; i++)
        fputs("a name &amp; ", f);
    fputs("</Name></Material><DataDefinition><IncidentDataStructure>TensorTree4"
          "</IncidentDataStructure></DataDefinition>",
          f);
    make_block_head(f, "Visible", "Transmission Front", NULL);
    fputs("{.1}", f);
    make_block_tail(f);
    make_tail(f);
}

/* ---- Sensors, weather, documents ------------------------------------------------------------- */

static void write_sensors(FILE *f, size_t n)
{
    for (size_t i = 0; i < n; i++)
        fprintf(f, "%zu 1 .8 0 0 1\n", i);
}
static void write_sensor_blanks(FILE *f, size_t n)
{
    fputs("0 1 .8 0 0 1\n", f);
    for (size_t i = 0; i < n; i++)
        fputs("    \n", f);
}
static void write_views(FILE *f, size_t n)
{
    for (size_t i = 0; i < n; i++)
        fprintf(f, "view= v%zu -vtv -vp %zu 1 1.5 -vd 0 1 0 -vu 0 0 1\n", i, i);
}
static void write_view_blanks(FILE *f, size_t n)
{
    fputs("-vtv\n", f);
    for (size_t i = 0; i < n; i++)
        fputs("    \n", f);
}
/* Writes one line, too long for a view. */
static void write_view_line(FILE *f, size_t n)
{
    fputs("-vtv\n-vtv", f);
    for (size_t i = 0; i < n; i++)
        fputs(" -vp 1 1 1", f);
}
static void write_wea(FILE *f, size_t n)
{
    fputs("place x\nlatitude 38\nlongitude -27\ntime_zone -30\nsite_elevation 25\n"
          "weather_data_file_units 1\n",
          f);
    for (size_t i = 0; i < n; i++)
        fprintf(f, "%zu %zu %zu.5 %zu 100\n", i / 672 % 12 + 1, i / 24 % 28 + 1, i % 24, i % 900);
}
static void write_epw(FILE *f, size_t n)
{
    fputs("LOCATION,Oriel Test,-,TST,made up,000000,38.42,27.14,2.0,25.0\nDESIGN CONDITIONS,0\n"
          "TYPICAL/EXTREME PERIODS,0\nGROUND TEMPERATURES,0\n"
          "HOLIDAYS/DAYLIGHT SAVINGS,No,0,0,0\nCOMMENTS 1,made up\nCOMMENTS 2,\n"
          "DATA PERIODS,1,1,Data,Sunday,1/1,12/31\n",
          f);
    for (size_t i = 0; i < n; i++)
        fprintf(f,
                "2020,%zu,%zu,%zu,0,none,15.0,7.0,60,101300,9999,9999,300,9999,%zu,90,999999,"
                "999999,999999,9999,0,0.0,5,5,9999,99999,9,999999999,0,0.0000,0,88,0.000,0,0\n",
                i / 672 % 12 + 1, i / 24 % 28 + 1, i % 24 + 1, i % 900);
}

#define JOB_HEAD "{\"kind\": \"render\", \"scene\": {\"files\": [\"a.rad\"]}"
#define LIST(name, member, format, end)                                                            \
    static void name(FILE *f, size_t n)                                                            \
    {                                                                                              \
        fputs(JOB_HEAD ", \"" member "\": [", f);                                                  \
        for (size_t i = 0; i < n; i++) {                                                           \
            fputs(i > 0 ? ",\n" : "", f);                                                          \
            fprintf(f, format, i);                                                                 \
        }                                                                                          \
        fputs("]" end, f);                                                                         \
    }
#define SENSOR ", \"sensors\": [[0, 0, 1, 0, 0, 1]]}"
LIST(write_job_sensors, "sensors", "[%zu, 1, 0.8, 0, 0, 1]", "}")
LIST(write_job_views, "views",
     "{\"name\": \"v%zu\", \"view\": \"-vtv -vp 1 2 1 -vd 0 1 0\", \"width\": 8, \"height\": 8}",
     "}")
LIST(write_job_skies, "skies",
     "{\"name\": \"s%zu\", \"cie\": {\"type\": \"overcast\", \"diffuse_horizontal_lx\": 1000}}",
     SENSOR)
static void write_job_files(FILE *f, size_t n)
{
    fputs("{\"kind\": \"render\", \"scene\": {\"files\": [", f);
    for (size_t i = 0; i < n; i++)
        fprintf(f, "%s\"a%zu.rad\"", i > 0 ? ", " : "", i);
    fputs("]}" SENSOR, f);
}
static void write_job_blanks(FILE *f, size_t n)
{
    fprintf(f, JOB_HEAD "%*s" SENSOR, (int)n, "");
}
static void write_job_hours(FILE *f, size_t n)
{
    fprintf(f,
            JOB_HEAD ", \"skies\": {\"weather\": {\"file\": \"a.epw\"}, \"from\": {\"month\": 3, "
                     "\"day\": 1, \"hour\": 0.5}, \"to\": {\"month\": 3, \"day\": %zu, \"hour\": "
                     "23.5}, \"step_h\": 1}" SENSOR,
            n);
}
/* Writes members that are refused only after they are read. */
static void write_members(FILE *f, size_t n)
{
    fputs(JOB_HEAD, f);
    for (size_t i = 0; i < n; i++)
        fprintf(f, ", \"m%zu\": %zu", i, i);
    fputs(SENSOR, f);
}
static void write_study(FILE *f, size_t n)
{
    fputs("{\"kind\": \"study\", \"scene\": {\"files\": [\"a.rad\"]}, \"sensors\": "
          "[[0,0,1,0,0,1]], \"techniques\": [\"backward\"], \"pixel_samples\": [1, 2], "
          "\"repeats\": 2, \"reference\": {\"samples\": 1024}, \"points\": [",
          f);
    for (size_t i = 0; i < n; i++)
        fprintf(f, "%s{\"name\": \"x%zu\", \"seconds\": 1, \"rms\": 1}", i > 0 ? ", " : "", i);
    fputs("]}", f);
}

static void write_panel_files(FILE *f, size_t n)
{
    fputs("{\"kind\": \"bsdf_make\", \"scene\": {\"files\": [", f);
    for (size_t i = 0; i < n; i++)
        fprintf(f, "%s\"a%zu.rad\"", i > 0 ? ", " : "", i);
    fputs("]}, \"cell\": {\"x\": [0, 1], \"y\": [0, 1]}}", f);
}

/* ---- Years ----------------------------------------------------------------------------------- */

static void write_use(FILE *f, size_t n)
{
    for (size_t i = 0; i < n; i++)
        fputs(i % 3 > 0 ? "0.95\n" : "0\n", f);
}
static void write_use_times(FILE *f, size_t n)
{
    for (size_t i = 0; i < n; i++) /* as many minutes as January has */
        fprintf(f, "1,%zu,%.5f,1\n", i / 1440 + 1, (double)(i % 1440) / 60 + 1.0 / 120);
}
static void write_use_blanks(FILE *f, size_t n)
{
    for (size_t i = 0; i < n; i++)
        fputs(" \n# use\n", f);
}
static void write_use_line(FILE *f, size_t n)
{
    fprintf(f, "1%*s\n", (int)n, "");
}
static void write_use_number(FILE *f, size_t n)
{
    fputs("0.", f);
    for (size_t i = 0; i < n; i++)
        fputs("0123456789", f);
}

static void write_schedule(FILE *f, size_t n)
{
    fputs("month,\"south\"\n", f);
    for (size_t i = 0; i < n; i++)
        fputs(i % 3 > 0 ? "1, \"open\"\n# use\n" : "1,1\n", f);
}
static void write_schedule_columns(FILE *f, size_t n)
{
    for (int row = 0; row < 2; row++) {
        for (size_t i = 0; i < n; i++)
            fputs("\"1\", ", f);
        fputs(row == 0 ? "south\n" : "shut\n", f);
    }
}

static void write_matrix(FILE *f, size_t n)
{
    fputs("#?RADIANCE\nNCOLS=2\nFORMAT=ascii\n\n", f);
    for (size_t i = 0; i < n; i++)
        fputs("1.5 2e-1 3\t4 5 6\n", f);
}
static void write_matrix_header(FILE *f, size_t n)
{
    fputs("#?RADIANCE\n", f);
    for (size_t i = 0; i < n; i++)
        fputs("EXPOSURE=1\nrcontrib -I+ -ab 3\n", f);
    fprintf(f, "NCOLS=1 %*s\nFORMAT=%*sascii\n\n1 2 3\n", (int)n, "", (int)n, "");
}

#define YEAR_HEAD "{\"kind\": \"annual\", \"weather\": \"a.epw\", \"scene\": {\"files\": [\"a.rad\""
#define YEAR_GRID "{\"name\": \"g%zu\", \"area\": 1, \"sensors\": [[%zu, 1, 0.8, 0, 0, 1]]}"
static void write_year(FILE *f, size_t files, size_t grids, const char *rest)
{
    fputs(YEAR_HEAD, f);
    for (size_t i = 1; i < files; i++)
        fprintf(f, ", \"a%zu.rad\"", i);
    fputs("]}, \"grids\": [", f);
    for (size_t i = 0; i < grids; i++)
        fprintf(f, "%s" YEAR_GRID, i > 0 ? ", " : "", i, i);
    fprintf(f, "]%s", rest);
}
static void write_year_files(FILE *f, size_t n)
{
    write_year(f, n, 1, "}");
}
static void write_year_grids(FILE *f, size_t n)
{
    write_year(f, 1, n, "}");
}
static void write_year_grids_of_files(FILE *f, size_t n)
{
    write_year(f, n, n, "}");
}
static void write_year_sensors(FILE *f, size_t n)
{
    fputs(YEAR_HEAD "]}, \"sensors\": [[0, 1, 0.8, 0, 0, 1]", f);
    for (size_t i = 1; i < n; i++)
        fprintf(f, ", [%zu, 1, 0.8, 0, 0, 1]", i);
    fputs("]}", f);
}
static void write_year_words(FILE *f, const char *member, const char *word, size_t n)
{
    write_year(f, 1, 1, "");
    fprintf(f, ", \"%s\": [\"%s\"", member, word);
    for (size_t i = 1; i < n; i++)
        fprintf(f, ", \"%s\"", word);
    fputs("]}", f);
}
static void write_year_targets(FILE *f, size_t n)
{
    write_year_words(f, "targets", "least UDI100-3000 in daylight hours of a grid >= 50 %", n);
}
static void write_year_metrics(FILE *f, size_t n)
{
    write_year_words(f, "metrics", "direct_hours1000 over the year", n);
}
static void write_year_rules(FILE *f, size_t n)
{
    write_year_words(f, "rules", "EN 17037", n);
}
#define YEAR_SHADES                                                                                \
    ", \"shades\": [{\"name\": \"g\", \"windows\": [\"w\"], \"states\": [{\"name\": \"a\"}"
static void write_year_schedule(FILE *f, size_t n)
{
    write_year(f, 1, 1, YEAR_SHADES "], \"schedule\": [0");
    for (size_t i = 1; i < n; i++)
        fputs(", 0", f);
    fputs("]}]}", f);
}
static void write_year_states(FILE *f, size_t n)
{
    write_year(f, 1, 1, YEAR_SHADES);
    for (size_t i = 1; i < n; i++)
        fprintf(f, ", {\"name\": \"b%zu\", \"files\": [\"f%zu.rad\"]}", i, i);
    fputs("]}]}", f);
}
static void write_year_spans(FILE *f, size_t n)
{
    write_year(f, 1, 1, YEAR_SHADES "], \"rules\": [{\"state\": \"a\"}");
    for (size_t i = 1; i < n; i++)
        fputs(", {\"from\": 9, \"state\": \"a\"}", f);
    fputs("]}]}", f);
}

/* ---- Zips ------------------------------------------------------------------------------------ */

static void write_zip(FILE *f, size_t n)
{
    struct zip_entry *entries = calloc(n, sizeof *entries);
    char(*names)[32] = calloc(n, sizeof *names), *archive;
    size_t size;
    for (size_t i = 0; entries && names && i < n; i++) {
        snprintf(names[i], sizeof names[i], "part%zu.rad", i);
        entries[i] = (struct zip_entry){.name = names[i], .data = "# x\n", .size = 4};
    }
    archive = zip_make(entries, n, &size);
    fwrite(archive, 1, size, f);
    free(archive);
    free(names);
    free(entries);
}
static void write_zip_of_one(FILE *f, size_t n)
{
    size_t size;
    char *archive = zip_make_bomb("a.rad", n, &size);
    fwrite(archive, 1, size, f);
    free(archive);
}

/* ---- Measurements ---------------------------------------------------------------------------- */

static void write_measured(FILE *f, size_t n)
{
    fputs("#format: theta phi DSF\n#incident_angle 30 180\n", f);
    for (size_t i = 0; i < n; i++)
        fprintf(f, "%zu.5 %zu 0.1\n", i % 85, i % 360);
}
static void write_measured_header(FILE *f, size_t n)
{
    for (size_t i = 0; i < n; i++)
        fprintf(f, "#word%zu  of the instrument's own\n", i);
    write_measured(f, 1);
}
static void write_measured_line(FILE *f, size_t n)
{
    write_measured(f, 1);
    for (size_t i = 0; i < n; i++)
        fputs("  \t", f);
}
static void write_measured_csv(FILE *f, size_t n)
{
    fputs("theta_in,phi_in,theta_out,phi_out,bsdf\n", f);
    for (size_t i = 0; i < n; i++)
        fprintf(f, "%zu, 180, %zu.5, %zu, 0.1\n", i % 80, i % 85, i % 360);
}

/* ---- The table ------------------------------------------------------------------------------- */

#define KIND(name, kind, n)                                                                        \
    {                                                                                              \
#name, DOUBLED_##kind, n, write_##name, 0                                                  \
    }
const struct doubled doubled_files[] = {
    KIND(leaves, BSDF, 120),
    KIND(data_blanks, BSDF, 30000),
    KIND(data_comments, BSDF, 5000),
    KIND(xml_comment, BSDF, 20000),
    KIND(xml_references, BSDF, 5000),
    KIND(klems, BSDF, 3),
    KIND(unknown_elements, BSDF, 2000),
    KIND(attributes, BSDF, 1000),
    KIND(name, BSDF, 3000),
    KIND(sensors, SENSORS, 2000),
    KIND(sensor_blanks, SENSORS, 20000),
    KIND(views, VIEWS, 2000),
    KIND(view_blanks, VIEWS, 20000),
    KIND(view_line, VIEWS, 20000),
    KIND(wea, WEATHER, 1000),
    KIND(epw, WEATHER, 500),
    KIND(job_sensors, JOB, 300),
    KIND(job_views, JOB, 100),
    KIND(job_skies, JOB, 100),
    KIND(job_files, JOB, 200),
    KIND(job_blanks, JOB, 20000),
    KIND(job_hours, JOB, 14),
    KIND(members, JOB, 500),
    KIND(study, STUDY, 30),
    KIND(panel_files, PANEL, 200),
    KIND(use, OCCUPANCY, 5000),
    KIND(use_times, OCCUPANCY, 5000),
    KIND(use_blanks, OCCUPANCY, 5000),
    KIND(use_line, OCCUPANCY, 50000),
    KIND(use_number, OCCUPANCY, 5000),
    KIND(schedule, SCHEDULE, 3000),
    KIND(schedule_columns, SCHEDULE, 5000),
    KIND(measured, MEASURED, 3000),
    KIND(measured_header, MEASURED, 3000),
    KIND(measured_line, MEASURED, 10000),
    KIND(measured_csv, MEASURED, 3000),
    KIND(matrix, MATRIX, 2000),
    KIND(matrix_header, MATRIX, 3000),
    KIND(year_files, YEAR, 200),
    KIND(year_grids, YEAR, 200),
    KIND(year_grids_of_files, YEAR, 200),
    KIND(year_sensors, YEAR, 300),
    KIND(year_targets, YEAR, 100),
    KIND(year_metrics, YEAR, 16),
    KIND(year_rules, YEAR, 16),
    KIND(year_schedule, YEAR, 2000),
    KIND(year_states, YEAR, 16),
    KIND(year_spans, YEAR, 100),
    KIND(zip, ZIP, 50),
    KIND(zip_of_one, ZIP, 100000),
};
const size_t doubled_n_files = sizeof doubled_files / sizeof *doubled_files;
