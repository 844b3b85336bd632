/* oriel-lcp: writes the BSDF of a laser cut panel as a tensor tree in WINDOW-schema XML. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lcp.h"

static const char usage[] =
    "usage: oriel-lcp [options] -o FILE\n"
    "Simulates a laser cut panel (PMMA, n = 1.491, thickness / cut distance = 1.5) and writes its\n"
    "BSDF as a TensorTree4.\n"
    "  -o FILE           where to write the XML; - is standard output\n"
    "  --resolution N    2^N directions per axis, N = 2 to 7 (6)\n"
    "  --rays N          rays per incident direction (16384)\n"
    "  --seed S          the same seed gives the same file (1)\n"
    "  --blur DEG        root mean square angle of scattering by the cuts (0.6)\n"
    "  --tolerance T     of merging even cells; 0 merges only equal ones (0.5)\n";

static void write_header(FILE *out)
{
    fputs("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
          "<WindowElement xmlns=\"http://windows.lbl.gov\" "
          "xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" "
          "xsi:schemaLocation=\"http://windows.lbl.gov/BSDF-v1.4.xsd\">\n"
          "<WindowElementType>System</WindowElementType>\n"
          "<FileType>BSDF</FileType>\n"
          "<Optical>\n<Layer>\n"
          "<Material>\n"
          "<Name>Laser cut panel</Name>\n<Manufacturer>simulated</Manufacturer>\n"
          "<DeviceType>Other</DeviceType>\n"
          "<Thickness unit=\"meter\">0.006</Thickness>\n"
          "<Width unit=\"meter\">1</Width>\n<Height unit=\"meter\">1</Height>\n"
          "</Material>\n"
          "<DataDefinition>\n"
          "<IncidentDataStructure>TensorTree4</IncidentDataStructure>\n"
          "</DataDefinition>\n",
          out);
}

static void write_component(FILE *out, const char *direction, const char *type,
                            const struct lcp_settings *settings, const struct lcp_tensor *tensor)
{
    fprintf(out,
            "<WavelengthData>\n<LayerNumber>System</LayerNumber>\n"
            "<Wavelength unit=\"Integral\">Visible</Wavelength>\n"
            "<SourceSpectrum>CIE Illuminant D65 1nm.ssp</SourceSpectrum>\n"
            "<DetectorSpectrum>ASTM E308 1931 Y.dsp</DetectorSpectrum>\n"
            "<WavelengthDataBlock>\n"
            "<WavelengthDataDirection>%s</WavelengthDataDirection>\n"
            "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>\n"
            "<ScatteringDataType>%s</ScatteringDataType>\n<ScatteringData>\n",
            direction, type);
    lcp_write_tree(out, settings, tensor);
    fputs("</ScatteringData>\n</WavelengthDataBlock>\n</WavelengthData>\n", out);
}

/* The panel is the same from both sides: so is its reflection, and transmission is reciprocal. */
static int write_file(const char *path, const struct lcp_settings *settings,
                      const struct lcp_tensor *transmission, const struct lcp_tensor *reflection)
{
    const int standard = !strcmp(path, "-");
    FILE *out = standard ? stdout : fopen(path, "w");
    int failed;
    if (!out) {
        fprintf(stderr, "oriel-lcp: %s: %s\n", path, strerror(errno));
        return -1;
    }
    write_header(out);
    write_component(out, "Transmission Back", "BTDF", settings, transmission);
    write_component(out, "Reflection Front", "BRDF", settings, reflection);
    write_component(out, "Reflection Back", "BRDF", settings, reflection);
    fputs("</Layer>\n</Optical>\n</WindowElement>\n", out);
    failed = fflush(out) != 0 || ferror(out);
    if (!standard && fclose(out) != 0)
        failed = 1;
    if (failed)
        fprintf(stderr, "oriel-lcp: %s: cannot write: %s\n", path, strerror(errno));
    return failed ? -1 : 0;
}

/* A number within its bounds. */
static int read_number(const char *option, const char *text, double low, double high, double *ret)
{
    char *end = NULL;
    const double value = text ? strtod(text, &end) : NAN;
    if (!text || end == text || *end || !(value >= low && value <= high)) {
        fprintf(stderr, "oriel-lcp: %s wants a number from %g to %g\n", option, low, high);
        return -1;
    }
    *ret = value;
    return 0;
}

static int read_options(int argc, char **argv, struct lcp_settings *s, const char **ret_path)
{
    for (int i = 1; i < argc; i += 2) {
        const char *option = argv[i], *text = i + 1 < argc ? argv[i + 1] : NULL;
        double value = 0;
        int code = 0;
        if (!strcmp(option, "-o") && text) {
            *ret_path = text;
        } else if (!strcmp(option, "--resolution")) {
            code = read_number(option, text, 2, 7, &value);
            s->levels = (unsigned)value;
        } else if (!strcmp(option, "--rays")) {
            code = read_number(option, text, 1, 1e9, &value);
            s->rays = (uint32_t)value;
        } else if (!strcmp(option, "--seed")) {
            code = read_number(option, text, 0, 9e15, &value);
            s->seed = (uint64_t)value;
        } else if (!strcmp(option, "--blur")) {
            code = read_number(option, text, 0, 45, &s->blur_deg);
        } else if (!strcmp(option, "--tolerance")) {
            code = read_number(option, text, 0, 1e6, &s->tolerance);
        } else {
            code = -1;
        }
        if (code < 0)
            return -1;
    }
    return *ret_path ? 0 : -1;
}

int main(int argc, char **argv)
{
    struct lcp_settings settings = {.levels = 6,
                                    .rays = 16384,
                                    .seed = 1,
                                    .index = 1.491,
                                    .aspect = 1.5,
                                    .absorption = 0.01,
                                    .blur_deg = 0.6,
                                    .tolerance = 0.5};
    struct lcp_tensor transmission = {NULL, 0, 0}, reflection = {NULL, 0, 0};
    const char *path = NULL;
    int code;
    if (argc == 2 && !strcmp(argv[1], "--help")) {
        fputs(usage, stdout);
        return 0;
    }
    if (read_options(argc, argv, &settings, &path) < 0) {
        fputs(usage, stderr);
        return 2;
    }
    code = lcp_trace(&settings, &transmission, &reflection);
    if (code < 0)
        fputs("oriel-lcp: out of memory\n", stderr);
    else
        code = write_file(path, &settings, &transmission, &reflection);
    free(transmission.cells);
    free(reflection.cells);
    return code < 0 ? 1 : 0;
}
