/*
 * Skies as scene text, digit by digit as Radiance's gendaylit and gensky print it.
 */
#include "scene/generate/generate.h"

/* Warns if meridian and longitude are more than three hours apart, usually by a wrong sign. */
static void warn_site(struct orl_text *text, const char *program, const struct orl_location *site)
{
    const double in_hours = 12.0 / ORL_PI;
    const double west =
        orl_sun_hours_apart(site->longitude_rad * in_hours, site->meridian_rad * in_hours);
    if (fabs(west) > 3.0)
        orl_text_warn(text,
                      "%s: longitude and time zone differ by %.1f hours (both are degrees west)",
                      program, west);
}

/* Writes a sun as both programs do; the angle is text because they print different digits. */
static void write_sun(const struct orl_sky_numbers *sky, const char *angle, struct orl_text *text)
{
    const double r = sky->sun_radiance;
    if (sky->has_sun && !sky->black)
        orl_text_add(text,
                     "void light solar\n0\n0\n3 %.3e %.3e %.3e\n"
                     "solar source sun\n0\n0\n4 %f %f %f %s\n",
                     r, r, r, sky->sun.x, sky->sun.y, sky->sun.z, angle);
}

int orl_gendaylit(const char *const *words, size_t count, struct orl_text *text,
                  struct orl_error *err)
{
    struct orl_sky_numbers sky;
    const double *a = sky.pattern.a;
    const int code = orl_gendaylit_numbers(words, count, NULL, text, &sky, err);
    if (code < 0)
        return code;
    if (sky.by_clock)
        warn_site(text, "gendaylit", &sky.site);
    if (sky.no_gradation)
        orl_text_warn(text, "gendaylit: the sky model has no solution here: the sky is black");
    write_sun(&sky, "0.533000", text);
    orl_text_add(text, "void brightfunc skyfunc\n2 skybright perezlum.cal\n0\n");
    if (sky.black)
        orl_text_add(text, "10 0 0 0 0 0 0 0 %f %f %f\n", a[7], a[8], a[9]);
    else
        orl_text_add(text, "10 %.3e %.3e %f %f %f %f %f %f %f %f\n", a[0], a[1], a[2], a[3], a[4],
                     a[5], a[6], a[7], a[8], a[9]);
    return 0;
}

int orl_gensky(const char *const *words, size_t count, struct orl_text *text, struct orl_error *err)
{
    struct orl_sky_numbers sky;
    const double *a = sky.pattern.a;
    const int code = orl_gensky_numbers(words, count, NULL, text, &sky, err);
    if (code < 0)
        return code;
    if (sky.by_clock)
        warn_site(text, "gensky", &sky.site);
    write_sun(&sky, "0.5", text);
    orl_text_add(text, "void brightfunc skyfunc\n2 skybr skybright.cal\n0\n");
    if (sky.pattern.n_args == 3)
        orl_text_add(text, "3 %d %.3e %.3e\n", (int)a[0], a[1], a[2]);
    else
        orl_text_add(text, "7 %d %.3e %.3e %.3e %f %f %f\n", (int)a[0], a[1], a[2], a[3], a[4],
                     a[5], a[6]);
    return 0;
}
