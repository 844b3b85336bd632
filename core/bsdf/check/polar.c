/* Polar maps of scattered light, and their peaks: see oriel/bsdf/bsdf_polar.h. */
#include <math.h>

#include <oriel/base/vec.h>
#include <oriel/bsdf/bsdf_polar.h>

#include "bsdf/bsdf_internal.h"

enum { SIDE = 4, BEAM = ORL_BSDF_BEAM }; /* SIDE: sample points along either side of a cell */

static struct orl_vec3 direction_by_sine(double sine_squared, double phi, bool front)
{
    const double sine = sqrt(sine_squared), cosine = sqrt(1 - sine_squared);
    return orl_v3(sine * cos(phi), sine * sin(phi), front ? cosine : -cosine);
}

static double square(double value)
{
    return value * value;
}

/* Returns the mean over a cell of the map. Points are uniform in the squared sine of theta, that is
 * in projected solid angle. */
static double cell_mean(const struct orl_bsdf *bsdf, const struct orl_vec3 beam[BEAM], bool front,
                        int theta, int phi)
{
    const double step = ORL_PI / 2 / ORL_POLAR_THETAS, turn = 2 * ORL_PI / ORL_POLAR_PHIS;
    const double low = square(sin(theta * step)), high = square(sin((theta + 1) * step));
    double sum = 0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        const int row = i / SIDE, column = i % SIDE;
        const double u = (row + 0.5) / SIDE, v = (column + 0.5) / SIDE;
        const struct orl_vec3 out =
            direction_by_sine(low + u * (high - low), (phi + v) * turn, front);
        for (int k = 0; k < BEAM; k++)
            sum += orl_luma(orl_bsdf_eval(bsdf, beam[k], out));
    }
    return sum / (SIDE * SIDE * BEAM);
}

void orl_bsdf_polar(const struct orl_bsdf *bsdf, bool front, double theta_deg, double phi_deg,
                    struct orl_bsdf_polar *ret_polar)
{
    struct orl_vec3 beam[BEAM];
    orl_bsdf_spread_beam(
        direction_by_sine(square(sin(theta_deg * ORL_DEG_TO_RAD)), phi_deg * ORL_DEG_TO_RAD, front),
        beam);
    *ret_polar = (struct orl_bsdf_polar){.reflected = 0};
    for (int k = 0; k < BEAM; k++) {
        ret_polar->reflected += orl_luma(orl_bsdf_albedo(bsdf, beam[k], ORL_BSDF_REFLECT)) / BEAM;
        ret_polar->transmitted +=
            orl_luma(orl_bsdf_albedo(bsdf, beam[k], ORL_BSDF_TRANSMIT)) / BEAM;
        ret_polar->straight += orl_luma(orl_bsdf_straight(bsdf, beam[k])) / BEAM;
    }
    for (int through = 0; through < 2; through++)
        for (int theta = 0; theta < ORL_POLAR_THETAS; theta++)
            for (int phi = 0; phi < ORL_POLAR_PHIS; phi++)
                ret_polar->values[through][theta][phi] =
                    cell_mean(bsdf, beam, front != (through == 1), theta, phi);
}

/* ---- Peaks of a polar map and their neighbourhoods ------------------------------------------- */

enum { GRID = 121, STEPS = 3 };
static const double reach_deg = 2.5, apart_deg = 5, plateau_deg = 15;
static const double least_of_first = 0.01, above_even = 4;

/* Light around a direction: its centre, its share of the incident light, its largest value
 * (1/sr). */
struct about {
    struct orl_vec3 middle;
    double share, most;
};

static struct about integrate_about(const struct orl_bsdf *bsdf, struct orl_vec3 in,
                                    struct orl_vec3 at)
{
    const struct orl_frame frame = orl_frame_about(at);
    const double reach = reach_deg * ORL_DEG_TO_RAD, step = 2 * reach / GRID;
    struct about about = {.middle = orl_v3(0, 0, 0)};
    for (int i = 0; i < GRID * GRID; i++) {
        const int row = i / GRID, column = i % GRID;
        const double x = (column + 0.5) * step - reach, y = (row + 0.5) * step - reach;
        const struct orl_vec3 out = orl_normalize(orl_to_world(&frame, orl_v3(x, y, 1)));
        if (x * x + y * y > reach * reach || (out.z > 0) != (at.z > 0))
            continue;
        const double f = orl_luma(orl_bsdf_eval(bsdf, in, out));
        const double flux = f * fabs(out.z) * step * step;
        about.share += flux;
        about.most = fmax(about.most, f);
        about.middle = orl_madd(about.middle, out, flux);
    }
    about.middle = about.share > 0 ? orl_normalize(about.middle) : at;
    return about;
}

/* Returns true if no neighbour is brighter; the map's azimuth is periodic. */
static bool is_top(const double values[ORL_POLAR_THETAS][ORL_POLAR_PHIS], int theta, int phi)
{
    for (int j = -1; j <= 1; j++)
        for (int i = -1; i <= 1; i++) {
            const int t = theta + j, p = (phi + i + ORL_POLAR_PHIS) % ORL_POLAR_PHIS;
            if ((i || j) && t >= 0 && t < ORL_POLAR_THETAS && values[t][p] > values[theta][phi])
                return false;
        }
    return true;
}

/* Returns the centre of a plateau: the mean direction of nearby cells that are as bright. Cells of
 * the data cause plateaus. */
static struct orl_vec3 start_of(const double values[ORL_POLAR_THETAS][ORL_POLAR_PHIS], int theta,
                                int phi, bool front)
{
    const double dtheta = 90.0 / ORL_POLAR_THETAS, dphi = 360.0 / ORL_POLAR_PHIS;
    const double level = values[theta][phi] * (1 - 1e-3);
    const struct orl_vec3 at =
        orl_bsdf_direction_at((theta + 0.5) * dtheta, (phi + 0.5) * dphi, front);
    struct orl_vec3 sum = orl_v3(0, 0, 0);
    for (int t = 0; t < ORL_POLAR_THETAS; t++)
        for (int p = 0; p < ORL_POLAR_PHIS; p++) {
            const struct orl_vec3 d =
                orl_bsdf_direction_at((t + 0.5) * dtheta, (p + 0.5) * dphi, front);
            if (values[t][p] >= level && orl_dot(d, at) > cos(plateau_deg * ORL_DEG_TO_RAD))
                sum = orl_madd(sum, d, fabs(d.z) * sin((t + 0.5) * dtheta * ORL_DEG_TO_RAD));
        }
    return orl_normalize(sum);
}

/* Inserts a peak in order of brightness, unless a brighter one is near. Returns the new count. */
static size_t insert_peak(const struct orl_bsdf_lobe *lobe, struct orl_vec3 at,
                          struct orl_vec3 *places, struct orl_bsdf_lobe *peaks, size_t n)
{
    size_t k = 0;
    for (size_t i = 0; i < n; i++) {
        const bool level = fabs(peaks[i].f - lobe->f) <= 1e-3 * lobe->f;
        const double apart = level ? plateau_deg : apart_deg;
        if (orl_dot(at, places[i]) > cos(apart * ORL_DEG_TO_RAD) &&
            (level || peaks[i].f >= lobe->f))
            return n;
    }
    while (k < n && peaks[k].f >= lobe->f)
        k++;
    if (k == ORL_BSDF_PEAKS)
        return n;
    const size_t last = n < ORL_BSDF_PEAKS ? n : ORL_BSDF_PEAKS - 1;
    for (size_t i = last; i > k; i--) {
        peaks[i] = peaks[i - 1];
        places[i] = places[i - 1];
    }
    peaks[k] = *lobe;
    places[k] = at;
    return last + 1;
}

/* Removes faint peaks, and those that were inserted before a brighter one near them. Returns the
 * new count. */
static size_t thin_peaks(struct orl_vec3 *places, struct orl_bsdf_lobe *peaks, size_t n)
{
    size_t kept = 0;
    for (size_t i = 0; i < n; i++) {
        bool stands = peaks[i].f >= least_of_first * peaks[0].f;
        for (size_t k = 0; k < kept; k++)
            stands = stands && orl_dot(places[i], places[k]) <= cos(apart_deg * ORL_DEG_TO_RAD);
        if (!stands)
            continue;
        peaks[kept] = peaks[i];
        places[kept++] = places[i];
    }
    return kept;
}

size_t orl_bsdf_find_peaks(const struct orl_bsdf *bsdf, bool front, double theta_deg,
                           double phi_deg, const struct orl_bsdf_polar *polar, bool transmitted,
                           struct orl_bsdf_lobe ret_peaks[ORL_BSDF_PEAKS])
{
    const double even = (transmitted ? polar->transmitted : polar->reflected) / ORL_PI;
    const struct orl_vec3 in = orl_bsdf_direction_at(theta_deg, phi_deg, front);
    struct orl_vec3 places[ORL_BSDF_PEAKS];
    size_t n = 0;
    for (int t = 0; t < ORL_POLAR_THETAS; t++)
        for (int p = 0; p < ORL_POLAR_PHIS; p++) {
            if (!(polar->values[transmitted][t][p] > above_even * even) ||
                !is_top(polar->values[transmitted], t, p))
                continue;
            const struct orl_vec3 at =
                start_of(polar->values[transmitted], t, p, front != transmitted);
            struct about about = integrate_about(bsdf, in, at);
            for (int k = 1; k < STEPS; k++)
                about = integrate_about(bsdf, in, about.middle);
            const struct orl_bsdf_angles to = orl_bsdf_angles_of(about.middle);
            const struct orl_bsdf_lobe lobe = {to.theta_deg, to.phi_deg, about.most, about.share};
            n = insert_peak(&lobe, about.middle, places, ret_peaks, n);
        }
    return thin_peaks(places, ret_peaks, n);
}
