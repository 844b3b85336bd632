#include <oriel/bsdf/bsdf_polar.h>

#include <math.h>

#include <oriel/base/units.h>

enum {
    SIDE = 4, /* sample points along either side of a cell */
    BEAM = 4,
};

static struct orl_vec3 direction(double sine_squared, double phi, bool front)
{
    const double sine = sqrt(sine_squared), cosine = sqrt(1 - sine_squared);
    return orl_v3(sine * cos(phi), sine * sin(phi), front ? cosine : -cosine);
}

static double square(double value)
{
    return value * value;
}

/*
 * Computes the corners of a beam 0.1 degrees wide. Round angles lie on borders of the data's cells,
 * where rounding would choose the cell of a single direction.
 */
static void spread_beam(struct orl_vec3 in, struct orl_vec3 ret_beam[BEAM])
{
    const struct orl_frame frame = orl_frame_about(in);
    const double half = 0.05 * ORL_DEG_TO_RAD;
    for (int k = 0; k < BEAM; k++)
        ret_beam[k] = orl_normalize(
            orl_to_world(&frame, orl_v3(k & 1 ? half : -half, k & 2 ? half : -half, 1)));
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
        const struct orl_vec3 out = direction(low + u * (high - low), (phi + v) * turn, front);
        for (int k = 0; k < BEAM; k++)
            sum += orl_luma(orl_bsdf_eval(bsdf, beam[k], out));
    }
    return sum / (SIDE * SIDE * BEAM);
}

void orl_bsdf_polar(const struct orl_bsdf *bsdf, bool front, double theta_deg, double phi_deg,
                    struct orl_bsdf_polar *ret_polar)
{
    struct orl_vec3 beam[BEAM];
    spread_beam(direction(square(sin(theta_deg * ORL_DEG_TO_RAD)), phi_deg * ORL_DEG_TO_RAD, front),
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
