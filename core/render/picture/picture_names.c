/* Names of picture formats and of their options. */
#include <oriel/job/picture.h>

#include <math.h>
#include <string.h>

#include <oriel/base/units.h>

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
