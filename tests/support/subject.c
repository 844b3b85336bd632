#include "support/subject.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "support/extent.h"
#include "support/scene_text.h"

#define POLYGON "m polygon p 0 0 9 0 0 0 1 0 0 0 1 0\n"

enum { RINGS = 16, SECTORS = 16, BINS = 2 * RINGS * SECTORS, FINE = 48, LOBE_DRAWS = 200000 };

int subject_draws(void)
{
    static int draws;
    if (draws == 0)
        draws = (int)extent(50000, LOBE_DRAWS);
    return draws;
}

struct subject subject_of(const char *text, const char *resource, const char *resource_text)
{
    struct subject s;
    char scene[1024];
    snprintf(scene, sizeof scene, "%s" POLYGON, text);
    s.parsed_scene = scene_parse_text(scene, resource, resource_text);
    s.material = &s.parsed_scene.materials[s.parsed_scene.surfaces[0].material];
    s.hit = (struct orl_hit){
        .distance = 1, .normal = orl_normalize(orl_v3(0.2, -0.7, 0.5)), .front = true};
    /* A BSDF uses its own frame, so that a direction means the same to both. */
    s.frame = s.material->kind == ORL_MATERIAL_BSDF ? orl_bsdf_frame(s.material, s.hit.normal)
                                                    : orl_frame_about(s.hit.normal);
    return s;
}

struct orl_vec3 subject_direction(const struct subject *s, double theta_deg, double phi_deg)
{
    const double t = theta_deg * ORL_DEG_TO_RAD, p = phi_deg * ORL_DEG_TO_RAD;
    return orl_to_world(&s->frame, orl_v3(sin(t) * cos(p), sin(t) * sin(p), cos(t)));
}

void subject_done(struct subject *s)
{
    orl_parsed_scene_done(&s->parsed_scene);
}

/* z = 3.72: exceeded with probability 1e-4. */
static double chi_square_bound(double n, double z)
{
    const double c = 2 / (9 * n), root = fmax(1 - c + z * sqrt(c), 0);
    return n * root * root * root;
}

struct tally subject_draw(const struct subject *s, struct orl_vec3 from,
                          enum orl_transport transport, enum orl_lobes lobes, uint64_t seed)
{
    const int draws = subject_draws();
    struct tally t = {.squares = 0};
    for (int i = 0; i < draws; i++) {
        struct orl_random random = orl_random_stream(seed, ORL_PURPOSE_BENCH, (uint64_t)i);
        const struct orl_surface_sample d =
            orl_material_sample(s->material, &s->hit, from, transport, lobes, &random);
        struct orl_rgb *sum = d.event == ORL_EVENT_STRAIGHT    ? &t.straight
                              : d.event == ORL_EVENT_MIRROR    ? &t.mirror
                              : d.event == ORL_EVENT_DIFFUSE   ? &t.diffuse
                              : d.event == ORL_EVENT_GLOSSY    ? &t.glossy
                              : d.event == ORL_EVENT_REFRACTED ? &t.refracted
                                                               : NULL;
        if (!sum)
            continue;
        assert_true(fabs(orl_length(d.direction) - 1) < 1e-9);
        assert_int_equal(d.transmitted,
                         orl_dot(d.direction, s->hit.normal) * orl_dot(from, s->hit.normal) < 0);
        *sum = orl_rgb_add(*sum, orl_rgb_scale(d.weight, 1.0 / draws));
        t.most = fmax(t.most, orl_rgb_max(d.weight));
        t.squares += orl_luma(d.weight) * orl_luma(d.weight) / draws;
    }
    return t;
}

/* Returns a bin of equal projected solid angle in the subject's frame, front side first. */
static int bin_of(const struct subject *s, struct orl_vec3 d)
{
    const struct orl_vec3 l = orl_to_local(&s->frame, d);
    double turn = atan2(l.y, l.x) / (2 * ORL_PI);
    turn = turn < 0 ? turn + 1 : turn;
    const int ring = (int)((1 - l.z * l.z) * RINGS), sector = (int)(turn * SECTORS);
    return ((l.z < 0) * RINGS + (ring < RINGS ? ring : RINGS - 1)) * SECTORS +
           (sector < SECTORS ? sector : SECTORS - 1);
}

/* ---- Quadrature ------------------------------------------------------------------------------ */

/* A density over the sphere: f |cos| of the green channel, or the pdf. */
struct density {
    const struct subject *s;
    struct orl_vec3 from;
    enum orl_transport transport;
    enum orl_lobes lobes;
    bool is_pdf;
};

static double density_at(const struct density *d, struct orl_vec3 to, double cosine)
{
    const struct subject *s = d->s;
    if (d->is_pdf)
        return orl_material_pdf(s->material, &s->hit, d->from, d->transport, d->lobes, to);
    return cosine * (d->transport == ORL_TRANSPORT_LIGHT
                         ? orl_material_eval_lobes(s->material, &s->hit, d->from, to).g
                         : orl_material_eval_lobes(s->material, &s->hit, to, d->from).g);
}

/* Midpoint rule with n by n points. Equal steps of the cosine are fine enough at grazing angles,
 * where lobes are thin. */
static double integrate_bin(const struct density *d, int b, int n)
{
    const int ring = b / SECTORS % RINGS;
    const double top = sqrt(1 - (double)ring / RINGS), low = sqrt(1 - (ring + 1.0) / RINGS);
    double sum = 0;
    for (int k = 0; k < n; k++) {
        const double phi = 2 * ORL_PI * (b % SECTORS + (k + 0.5) / n) / SECTORS;
        const double x = cos(phi), y = sin(phi);
        for (int i = 0; i < n; i++) {
            const double c = top - (top - low) * (i + 0.5) / n, q = sqrt(1 - c * c);
            const struct orl_vec3 to =
                orl_to_world(&d->s->frame, orl_v3(q * x, q * y, b < BINS / 2 ? c : -c));
            sum += density_at(d, to, c);
        }
    }
    return sum * 2 * ORL_PI * (top - low) / ((double)SECTORS * n * n);
}

/*
 * Computes integrals over the bins; returns their sum. The points per side are doubled from 6 until
 * the error of the rule, which falls by 4 each time, is 1/50 of the standard deviation of the
 * expected number of samples in the bin, or 1/8 of the slack; at most FINE. A BSDF has steps, which
 * few points may miss, so it starts with FINE.
 */
static double integrate(const struct density *d, double slack, double ret_bins[BINS])
{
    const int least = d->s->material->kind == ORL_MATERIAL_BSDF ? FINE : FINE / 4;
    const double draws = subject_draws();
    double sum = 0;
    for (int b = 0; b < BINS; b++) {
        double coarse = least < FINE ? integrate_bin(d, b, least / 2) : 0;
        for (int n = least; n <= FINE; n *= 2) {
            ret_bins[b] = integrate_bin(d, b, n);
            const double error = fabs(ret_bins[b] - coarse) / 3;
            if (error <= 0.02 * sqrt(ret_bins[b] / draws) + slack / 8 * ret_bins[b])
                break;
            coarse = ret_bins[b];
        }
        sum += ret_bins[b];
    }
    return sum;
}

/* ---- Samples --------------------------------------------------------------------------------- */

/* Bins whose expected weight is below that of 50 samples are pooled. A small albedo leaves few
 * glossy samples, so more samples are taken then. */
double subject_check_lobe(const struct subject *s, struct orl_vec3 from,
                          enum orl_transport transport, double slack, uint64_t seed)
{
    static double expected[BINS], sum[BINS], squares[BINS];
    const struct density density = {.s = s, .from = from, .transport = transport};
    const double albedo = integrate(&density, slack, expected);
    const int draws = (int)fmin(LOBE_DRAWS, subject_draws() / albedo);
    double chi2 = 0, cells = 0, mean = 0, mean_square = 0, pool[3] = {0, 0, 0};
    const enum orl_lobes lobes = (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_TRANSMITTED);
    memset(sum, 0, sizeof sum);
    memset(squares, 0, sizeof squares);
    for (int i = 0; i < draws; i++) {
        struct orl_random random = orl_random_stream(seed, ORL_PURPOSE_BENCH, (uint64_t)i);
        const struct orl_surface_sample d =
            orl_material_sample(s->material, &s->hit, from, transport, lobes, &random);
        if (d.event != ORL_EVENT_GLOSSY) /* other samples are specular or absorbed */
            continue;
        assert_true(fabs(orl_length(d.direction) - 1) < 1e-9);
        assert_int_equal(d.transmitted,
                         orl_dot(d.direction, s->hit.normal) * orl_dot(from, s->hit.normal) < 0);
        const int b = bin_of(s, d.direction);
        sum[b] += d.weight.g / draws;
        squares[b] += d.weight.g * d.weight.g / draws / draws;
        mean += d.weight.g / draws;
        mean_square += d.weight.g * d.weight.g / draws;
    }
    for (int b = 0; b < BINS; b++) {
        const double variance = squares[b] - sum[b] * sum[b] / draws;
        if (expected[b] < 50 * albedo / draws || !(variance > 0)) {
            pool[0] += sum[b], pool[1] += expected[b], pool[2] += fmax(variance, 0);
            continue;
        }
        const double off = fmax(fabs(sum[b] - expected[b]) - slack * expected[b], 0);
        chi2 += off * off / variance;
        cells++;
    }
    assert_true(cells >= 1);
    assert_true(chi2 < chi_square_bound(cells, 3.72));
    assert_true(fabs(pool[0] - pool[1]) < 4 * sqrt(pool[2]) + 20 * albedo / draws);
    /* Energy: the sampled weight does not exceed the incident one, within noise. */
    const double noise = 4 * sqrt(fmax(mean_square - mean * mean, 0) / draws);
    assert_true(fabs(mean - albedo) < noise + slack * albedo);
    assert_true(mean <= 1 + noise);
    return albedo;
}

void subject_check_pdf(const struct subject *s, struct orl_vec3 from, enum orl_transport transport,
                       enum orl_lobes lobes, double slack, uint64_t seed)
{
    static double expected[BINS], count[BINS];
    const struct density density = {s, from, transport, lobes, true};
    const double share = integrate(&density, slack, expected);
    const int draws = (int)fmin(LOBE_DRAWS, subject_draws() / share); /* number for a lobe */
    double chi2 = 0, cells = 0, drawn = 0, pool[2] = {0, 0};
    memset(count, 0, sizeof count);
    for (int i = 0; i < draws; i++) {
        struct orl_random random = orl_random_stream(seed, ORL_PURPOSE_BENCH, (uint64_t)i);
        const struct orl_surface_sample d =
            orl_material_sample(s->material, &s->hit, from, transport, lobes, &random);
        if (d.event != ORL_EVENT_DIFFUSE && d.event != ORL_EVENT_GLOSSY)
            continue;
        drawn++;
        count[bin_of(s, d.direction)]++;
    }
    assert_true(fabs(drawn - share * draws) <=
                4 * sqrt(share * fmax(1 - share, 0) * draws) + slack * draws + 1e-3 * draws);
    for (int b = 0; b < BINS; b++) {
        const double n = expected[b] * draws;
        if (n < 20) {
            pool[0] += count[b], pool[1] += n;
            continue;
        }
        const double off = fmax(fabs(count[b] - n) - slack * n, 0);
        chi2 += off * off / (n * (1 - expected[b]) + 1e-9);
        cells++;
    }
    assert_true(cells >= 1);
    assert_true(chi2 < chi_square_bound(cells, 3.72));
    assert_true(slack > 0 || chi2 > chi_square_bound(cells, -3.72));
    assert_true(fabs(pool[0] - pool[1]) < 4 * sqrt(pool[1]) + 5 + slack * draws);
}

void subject_check_reciprocity(const struct subject *s, uint64_t seed)
{
    struct orl_random random = orl_random_stream(seed, ORL_PURPOSE_BENCH, 0);
    for (int i = 0; i < 20000; i++) {
        const double a = 180 * orl_random_uniform(&random), b = 180 * orl_random_uniform(&random);
        const struct orl_vec3 l = subject_direction(s, a, 360 * orl_random_uniform(&random));
        const struct orl_vec3 e = subject_direction(s, b, 360 * orl_random_uniform(&random));
        const struct orl_rgb f = orl_material_eval_lobes(s->material, &s->hit, l, e);
        const struct orl_rgb r = orl_material_eval_lobes(s->material, &s->hit, e, l);
        assert_true(orl_rgb_is_finite(f) && f.r >= 0 && f.g >= 0 && f.b >= 0);
        assert_true(fabs(f.r - r.r) <= 1e-9 * f.r + 1e-300);
        assert_true(fabs(f.b - r.b) <= 1e-9 * f.b + 1e-300);
    }
}
