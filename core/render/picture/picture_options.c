/* Names of picture formats, tones and palettes, and the palettes' colours (oriel/job/picture.h). */
#include <math.h>
#include <string.h>

#include <oriel/base/vec.h>
#include <oriel/job/picture.h>

static const struct {
    const char *name, *ending;
    bool format; /* true if users may request it by name */
} pictures[ORL_PICTURES] = {[ORL_PICTURE_HDR] = {"hdr", "hdr", true},
                            [ORL_PICTURE_PNG] = {"png", "png", true},
                            [ORL_PICTURE_PNG16] = {"png16", "16.png", true},
                            [ORL_PICTURE_EXR] = {"exr", "exr", true},
                            [ORL_PICTURE_EXR_FLOAT] = {"exr_float", "float.exr", true},
                            [ORL_PICTURE_FALSE] = {"false_color", "false.png", false},
                            [ORL_PICTURE_LINES] = {"lines", "lines.png", false},
                            [ORL_PICTURE_BANDS] = {"bands", "bands.png", false},
                            [ORL_PICTURE_ERROR_HDR] = {"error_hdr", "error.hdr", false},
                            [ORL_PICTURE_ERROR_PNG] = {"error_png", "error.png", false}};

const char *orl_picture_name(enum orl_picture picture)
{
    return pictures[picture].name;
}

const char *orl_picture_ending(enum orl_picture picture)
{
    return pictures[picture].ending;
}

bool orl_picture_format(const char *name, enum orl_picture *ret_picture)
{
    for (int i = 0; i < ORL_PICTURES; i++)
        if (pictures[i].format && strcmp(pictures[i].name, name) == 0) {
            *ret_picture = (enum orl_picture)i;
            return true;
        }
    return false;
}

const char *orl_tone_name(enum orl_tone tone)
{
    static const char *const names[ORL_TONES] = {"human", "linear", "exposure"};
    return names[tone];
}

double orl_exposure_of_ev(double ev)
{
    return ORL_EFFICACY_LM_PER_W / (1.2 * exp2(ev));
}

const char *orl_palette_name(enum orl_palette palette)
{
    static const char *const names[ORL_PALETTES] = {"even", "def", "spec", "pm3d", "hot", "eco"};
    return names[palette];
}

static double clip(double x)
{
    return fmin(fmax(x, 0), 1);
}

static void even(double share, unsigned char ret_srgb[3])
{
    static const unsigned char points[][3] = {
        {28, 18, 107},  {10, 44, 115},   {12, 65, 114},  {14, 84, 115}, {17, 103, 119},
        {20, 122, 121}, {23, 141, 117},  {28, 161, 106}, {69, 179, 96}, {119, 194, 94},
        {162, 208, 95}, {204, 220, 101}, {245, 232, 112}};
    enum { LAST = sizeof points / sizeof *points - 1 };
    const double at = LAST * clip(share);
    const int low = at < LAST ? (int)at : LAST - 1;
    for (int c = 0; c < 3; c++)
        ret_srgb[c] = (unsigned char)lrint(points[low][c] +
                                           (at - low) * (points[low + 1][c] - points[low][c]));
}

/* The default palette of falsecolor: linear values at 23 evenly spaced points. */
static void tabled(double x, double ret[3])
{
    static const double points[][3] = {
        {0.18848, 0.0009766, 0.2666},   {0.05468, 2.355e-5, 0.36387},
        {0.001035, 0.0008966, 0.47704}, {8.311e-8, 0.0265, 0.51314},
        {7.45e-6, 0.12568, 0.53638},    {0.0004391, 0.28658, 0.51937},
        {0.001367, 0.42471, 0.40851},   {0.003076, 0.47395, 0.17028},
        {0.013764, 0.44027, 0.053142},  {0.061708, 0.36719, 0.051941},
        {0.17394, 0.26298, 0.085641},   {0.28812, 0.17253, 0.098814},
        {0.32997, 0.12068, 0.083244},   {0.35527, 0.073166, 0.060729},
        {0.37255, 0.03761, 0.039108},   {0.39212, 0.016124, 0.023154},
        {0.4364, 0.0047737, 0.012845},  {0.61028, 6.831e-6, 0.0051847},
        {0.77573, 0.008036, 0.0016918}, {0.90874, 0.10081, 2.433e-5},
        {1, 0.31068, 1.213e-5},         {1, 0.64478, 0.0066594},
        {0.9863, 0.9707, 0.02539}};
    enum { LAST = sizeof points / sizeof *points - 1 };
    const double at = LAST * x;
    const int low = at < LAST ? (int)at : LAST - 1;
    for (int c = 0; c < 3; c++)
        ret[c] = points[low][c] + (at - low) * (points[low + 1][c] - points[low][c]);
}

/* Computes displayed values, 0 to 1, before clipping. */
static void by_formula(enum orl_palette palette, double x, double ret[3])
{
    static const double gamma = 2.2;
    switch (palette) {
    case ORL_PALETTE_SPEC:
        ret[0] = pow(clip(1.6 * x - 0.6), 1 / gamma);
        ret[1] = pow(clip(x > 0.375 ? 1.6 - 1.6 * x : 8.0 / 3 * x), 1 / gamma);
        ret[2] = pow(clip(1 - 8.0 / 3 * x), 1 / gamma);
        break;
    case ORL_PALETTE_PM3D:
        ret[0] = sqrt(x);
        ret[1] = x * x * x;
        ret[2] = sin(2 * ORL_PI * x);
        break;
    case ORL_PALETTE_HOT:
        for (int c = 0; c < 3; c++)
            ret[c] = 3 * x - c;
        break;
    case ORL_PALETTE_ECO:
        ret[0] = 2 * x;
        ret[1] = 2 * (x - 0.5);
        ret[2] = 2 * (0.5 - x);
        break;
    default:
        tabled(x, ret);
        for (int c = 0; c < 3; c++)
            ret[c] = pow(ret[c], 1 / gamma);
        break;
    }
}

void orl_palette_color(enum orl_palette palette, double share, unsigned char ret_srgb[3])
{
    double shown[3];
    if (palette == ORL_PALETTE_EVEN) {
        even(share, ret_srgb);
        return;
    }
    by_formula(palette, clip(share), shown);
    for (int c = 0; c < 3; c++)
        ret_srgb[c] = (unsigned char)lrint(255 * clip(shown[c]));
}
