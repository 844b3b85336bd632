/*
 * Verdicts of a BSDF's check, for users who will simulate with the file. A fault contradicts
 * physics or this program's interpretation of the file. A warning may be intended but should be
 * examined. A note is information.
 */
#include "bsdf/bsdf_internal.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

__attribute__((format(printf, 3, 4))) static void
say(struct orl_bsdf_check *c, enum orl_bsdf_level level, const char *format, ...)
{
    struct orl_bsdf_verdict *verdict = &c->verdicts[c->n_verdicts];
    va_list args;
    if (c->n_verdicts == ORL_BSDF_VERDICTS_MAX)
        return;
    c->n_verdicts++;
    verdict->level = level;
    va_start(args, format);
    vsnprintf(verdict->text, sizeof verdict->text, format, args);
    va_end(args);
    if (level > c->worst)
        c->worst = level;
}

static const char *side_name(int front)
{
    return front ? "inside" : "outside";
}

const char *orl_bsdf_level_name(enum orl_bsdf_level level)
{
    static const char *const names[] = {"ok", "note", "warning", "fault"};
    return names[level];
}

static void judge_components(struct orl_bsdf_check *c)
{
    static const char *const file_side[] = {"Front", "Back"};
    for (int front = 0; front < 2; front++) {
        if (!c->info.has[front][0])
            say(c, ORL_BSDF_NOTE,
                "There is no Reflection %s: the surface reflects no light on the %s.",
                file_side[front], side_name(front));
        if (c->info.dummy[front] != ORL_BSDF_NO_PLACEHOLDER)
            say(c, ORL_BSDF_NOTE,
                "Transmission %s holds no data but %s: it is ignored, and the other transmission "
                "is used in reverse.",
                file_side[front],
                c->info.dummy[front] == ORL_BSDF_PLACEHOLDER_ZERO
                    ? "all zeros"
                    : "a copy of the other, which is not its own reverse");
        else if (!c->info.has[front][1] && c->info.has[!front][1] &&
                 c->extremes[!front][1].mean > 0 && !(c->extremes[front][1].mean > 0))
            say(c, ORL_BSDF_WARNING,
                "There is no Transmission %s, and isotropic data cannot be reversed: no light from "
                "the %s is transmitted.",
                file_side[front], side_name(front));
        else if (!c->info.has[front][1] && c->info.has[!front][1])
            say(c, ORL_BSDF_NOTE,
                "There is no Transmission %s: the other transmission is used in reverse, by "
                "reciprocity.",
                file_side[front]);
    }
    if (!c->info.has[0][1] && !c->info.has[1][1])
        say(c, ORL_BSDF_NOTE, "There is no transmission: the surface is opaque.");
    if (c->extremes[0][1].most <= 0 && c->extremes[1][1].most <= 0 && c->extremes[0][0].most <= 0 &&
        c->extremes[1][0].most <= 0)
        say(c, ORL_BSDF_WARNING, "All values are zero: the surface is black from both sides.");
}

static void judge_values(struct orl_bsdf_check *c)
{
    if (c->info.colored)
        say(c, ORL_BSDF_OK, "The file has colour data and is simulated in colour.");
    if (c->info.color_left_out)
        say(c, ORL_BSDF_WARNING,
            "Colour is incomplete: %s must both be given with Visible, in the same cells. Parts "
            "without them are grey, with the right luminance.",
            strncmp(c->info.kind, "TensorTree", 10) ? "CIE-X and CIE-Z" : "CIE-u and CIE-v");
    if (c->info.out_of_gamut > 0)
        say(c, ORL_BSDF_NOTE,
            "%zu values have colours outside the RGB gamut; the nearest colour of the same "
            "luminance is used.",
            c->info.out_of_gamut);
    if (c->info.skipped_bytes > 0)
        say(c, ORL_BSDF_WARNING,
            "%zu bytes of text before the XML are ignored, possibly a program's message. Other "
            "programs may refuse the file.",
            c->info.skipped_bytes);
    if (c->info.clamped > 0)
        say(c, c->info.clamped * 1000 > c->info.values ? ORL_BSDF_WARNING : ORL_BSDF_NOTE,
            "%zu of %zu values are negative; they are read as zero.", c->info.clamped,
            c->info.values);
}

/*
 * Measured and computed data are noisy: a few per cent above 1 in some direction is common, and
 * harmless if the mean is below. Reflections filed on the wrong sides are found here as well.
 */
static void judge_energy(struct orl_bsdf_check *c)
{
    const double tolerance = 1e-3;
    const bool above = c->total[0].most > 1 + tolerance || c->total[1].most > 1 + tolerance;
    for (int front = 0; front < 2; front++) {
        const struct orl_bsdf_extremes *x = &c->total[front];
        if (x->most > 1 + tolerance)
            say(c, x->most > 1.05 || x->mean > 1 + tolerance ? ORL_BSDF_FAULT : ORL_BSDF_WARNING,
                "Energy is gained: for light from the %s, theta %.1f, phi %.1f degrees, R + T = "
                "%.3f. Values are rescaled for rendering where R + T is above 1.",
                side_name(front), x->most_theta_deg, x->most_phi_deg, x->most);
    }
    if (above && c->info.has[0][0] && c->info.has[1][0] && c->total_exchanged[0] <= 1 + tolerance &&
        c->total_exchanged[1] <= 1 + tolerance)
        say(c, ORL_BSDF_FAULT,
            "With Reflection Front and Reflection Back exchanged, R + T would stay below 1: they "
            "look swapped.");
    if (!above)
        say(c, ORL_BSDF_OK,
            "Energy is conserved: R + T is at most %.3f from the outside, %.3f "
            "from the inside.",
            c->total[0].most, c->total[1].most);
}

static void judge_share(struct orl_bsdf_check *c, const char *what, double share)
{
    if (share < 0)
        return;
    if (share <= 0.05)
        say(c, ORL_BSDF_OK, "%s is reciprocal except for %.1f %% of its light.", what, 100 * share);
    else
        say(c, share > 0.25 ? ORL_BSDF_WARNING : ORL_BSDF_NOTE,
            "%s is not reciprocal: %.0f %% of its light would have to move. Results depend a "
            "little on the direction in which rays are traced.",
            what, 100 * share);
}

static void judge_reciprocity(struct orl_bsdf_check *c)
{
    const double out = c->extremes[0][1].mean, in = c->extremes[1][1].mean;
    judge_share(c, "Reflection from the outside", c->irreciprocal_reflection[0]);
    judge_share(c, "Reflection from the inside", c->irreciprocal_reflection[1]);
    judge_share(c, "Transmission", c->irreciprocal_transmission);
    if (c->irreciprocal_transmission >= 0 && fabs(out - in) > 0.05 * fmax(out, in))
        say(c, ORL_BSDF_WARNING,
            "The diffuse transmittance is %.4f inwards and %.4f outwards; the two must be equal. "
            "One of the transmissions may not be real data.",
            out, in);
}

/* A shading device blocks the high sun, a redirecting one sends it up; both may be mounted
 * wrongly. */
static void judge_shading(struct orl_bsdf_check *c)
{
    const double above = c->redirection[0][1].transmitted, below = c->redirection[0][0].transmitted;
    const double clearly = 0.2 * fmax(above, below);
    if (above < below - clearly)
        say(c, ORL_BSDF_OK,
            "The transmittance for light from outside is %.3f from above, %.3f from below: it "
            "shades, so outside and up look right.",
            above, below);
    else if (below < above - clearly)
        say(c, ORL_BSDF_WARNING,
            "The transmittance for light from outside is %.3f from above, only %.3f from below: if "
            "it is a shading device, front and back are swapped, or it is upside down.",
            above, below);
}

static void judge_redirection(struct orl_bsdf_check *c)
{
    const double up = c->redirection[0][1].upward, down = 1 - c->redirection[0][0].upward;
    if (!(c->redirection[0][0].transmitted > 0) || !(c->redirection[0][1].transmitted > 0) ||
        fmax(up, down) < 0.1)
        return;
    if (fabs(up - down) < 0.1)
        say(c, ORL_BSDF_OK,
            "Of the light from above %.0f %% leaves upwards, of the light from below %.0f %% "
            "downwards: upside down it would behave almost the same.",
            100 * up, 100 * down);
    else if (up > down)
        say(c, ORL_BSDF_OK,
            "Of the light from above %.0f %% leaves upwards, of the light from below only %.0f %% "
            "downwards: up (+y) looks right.",
            100 * up, 100 * down);
    else
        say(c, ORL_BSDF_WARNING,
            "Of the light from below %.0f %% leaves downwards, of the light from above only %.0f "
            "%% upwards: it may be upside down.",
            100 * down, 100 * up);
}

/* Returns the decimals for three significant digits of a factor. */
static int decimals_of(double factor)
{
    return factor < 10 ? 2 : factor < 100 ? 1 : 0;
}

static void judge_peak(struct orl_bsdf_check *c)
{
    const struct orl_bsdf_peak *p = &c->strongest;
    if (p->share <= 0.01) {
        if (c->info.has[0][1] || c->info.has[1][1])
            say(c, ORL_BSDF_OK,
                "There is no peak in the straight-through direction: aBSDF would change nothing.");
        return;
    }
    say(c, ORL_BSDF_NOTE,
        "Straight through, the sun's disc is spread over %.*f times its size (%.*f at normal "
        "incidence): glare (DGP) may be too low by up to %.3f.",
        decimals_of(p->smear), p->smear, decimals_of(c->normal.smear), c->normal.smear,
        p->dgp_loss);
    if (p->straight > 0)
        say(c, ORL_BSDF_NOTE,
            "At theta %.0f, phi %.0f, %.1f %% of the light goes straight through: the material "
            "aBSDF keeps that part sharp, which is more accurate if the real pane is clear.",
            p->theta_deg, p->phi_deg, 100 * p->straight);
    else
        say(c, ORL_BSDF_OK,
            "The peak there is too broad or too faint to count as a clear view: aBSDF would change "
            "nothing there.");
}

void orl_bsdf_set_verdicts(struct orl_bsdf_check *check)
{
    judge_components(check);
    judge_values(check);
    judge_energy(check);
    judge_reciprocity(check);
    judge_shading(check);
    judge_redirection(check);
    judge_peak(check);
}
