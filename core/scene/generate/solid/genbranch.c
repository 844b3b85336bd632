/*
 * genbranch: a branch of a fir tree. Each branch is a stick with shoots to its right and left,
 * which are branches themselves, down to leaves. A stick is a cone with a sphere at its tip.
 */
#include <stdio.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "scene/generate/solid/solids.h"

/* Limits: sticks of one branch, and nested levels of branches. */
enum {
    STICKS_MAX = ORL_LIMIT_SURFACES < 500000 ? (int)ORL_LIMIT_SURFACES : 500000,
    LEVELS_MAX = 16
};

struct branch {
    const char *bark, *leaf;
    struct orl_vec3 start, end;
    double radius, narrowing, ratio, variation;
    int shoots, levels;
    uint64_t state; /* state of its random number generator */
    size_t sticks;  /* written so far */
    struct orl_text *text;
};

/* POSIX's drand48: x' = 25214903917 x + 11 modulo 2^48, starting from 0 like the C library. */
#define MULTIPLIER 25214903917U
#define MODULUS ((uint64_t)1 << 48)

static double draw_random(struct branch *branch)
{
    branch->state = (branch->state * MULTIPLIER + 11) % MODULUS;
    return (double)branch->state / (double)MODULUS;
}

static double draw_variation(struct branch *branch)
{
    return branch->variation * (0.5 - draw_random(branch));
}

/* Skips n random numbers, by repeated squaring. */
static void skip_random(struct branch *branch, int n)
{
    uint64_t a = MULTIPLIER, c = 11;
    for (; n > 0; n >>= 1) {
        if (n & 1)
            branch->state = (branch->state * a + c) % MODULUS;
        c = (a * c + c) % MODULUS;
        a = a * a % MODULUS;
    }
}

/* ---- Words ----------------------------------------------------------------------------------- */

static int read_option(struct branch *branch, struct orl_words *words, struct orl_error *err)
{
    const struct {
        const char *name;
        double *number;
    } numbers[] = {{"-bt", &branch->radius},
                   {"-bn", &branch->narrowing},
                   {"-br", &branch->ratio},
                   {"-v", &branch->variation}};
    const char *option = orl_words_take(words);
    int seed = 0;
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (strcmp(option, numbers[i].name) == 0)
            return orl_words_number(words, option, numbers[i].number, err);
    if (strcmp(option, "-bs") == 0)
        return orl_words_point(words, option, &branch->start, err);
    if (strcmp(option, "-be") == 0)
        return orl_words_point(words, option, &branch->end, err);
    if (strcmp(option, "-bm") == 0)
        return orl_words_name(words, option, &branch->bark, err);
    if (strcmp(option, "-lm") == 0)
        return orl_words_name(words, option, &branch->leaf, err);
    if (strcmp(option, "-n") == 0)
        return orl_words_int(words, option, 0, STICKS_MAX, &branch->shoots, err);
    if (strcmp(option, "-r") == 0)
        return orl_words_int(words, option, 0, LEVELS_MAX, &branch->levels, err);
    if (strcmp(option, "-s") != 0)
        return orl_words_refuse(words, option, err);
    const int code = orl_words_int(words, option, 0, 2000000000, &seed, err);
    skip_random(branch, seed);
    return code;
}

static int check_size(const struct branch *branch, struct orl_error *err)
{
    double sticks = 1, last = 1;
    for (int i = 0; i < branch->levels; i++) {
        last *= 2 * branch->shoots;
        sticks += last;
    }
    if (sticks <= STICKS_MAX)
        return 0;
    return orl_error_refuse(err, ORL_ERR_LIMIT, "use fewer shoots (-n) or levels (-r)",
                            "genbranch: the branch has %.3g segments, more than %d", sticks,
                            STICKS_MAX);
}

/* ---- The branch ------------------------------------------------------------------------------ */

static void add_stick(struct branch *branch, const char *material, struct orl_vec3 from,
                      struct orl_vec3 to, double radius)
{
    const double end = branch->narrowing * radius;
    orl_text_add(branch->text, "'%s' cone s%zu\n0\n0\n8", material, branch->sticks);
    orl_text_add_point(branch->text, from);
    orl_text_add_point(branch->text, to);
    orl_text_add(branch->text, " %.12g %.12g\n'%s' sphere e%zu\n0\n0\n4", radius, end, material,
                 branch->sticks);
    orl_text_add_point(branch->text, to);
    orl_text_add(branch->text, " %.12g\n", end);
    branch->sticks++;
}

static void add_branch(struct branch *branch, struct orl_vec3 from, struct orl_vec3 to,
                       double radius, int level);

/* Adds a shoot to one side; which: from 1. Every random number has a fixed position in the
 * sequence. */
static void add_shoot(struct branch *branch, struct orl_vec3 from, struct orl_vec3 to,
                      double radius, int level, int which, double side)
{
    const struct orl_vec3 way = orl_sub(to, from);
    double t = (which + draw_variation(branch)) / (branch->shoots + 2);
    struct orl_vec3 start, end;
    t = (t + sqrt(t)) / 2;
    start = orl_v3(way.x * t + from.x, way.y * t + from.y, way.z * t + from.z);
    end.x = start.x + way.x * (1 + draw_variation(branch)) / (branch->shoots + 2);
    end.y = start.y + way.y * (1 + draw_variation(branch)) / (branch->shoots + 2);
    end.z = start.z + way.z * (1 + draw_variation(branch)) / (branch->shoots + 2);
    const double ratio = side * branch->ratio;
    end.x += (to.z - start.z) * ratio * (1 + draw_variation(branch));
    end.y += (to.y - start.y) * branch->ratio * (1 + draw_variation(branch));
    end.z -= (to.x - start.x) * ratio * (1 + draw_variation(branch));
    add_branch(branch, start, end,
               (1 - (1 - branch->narrowing) * t) * (1 + 2 * branch->ratio) / 3 * radius, level - 1);
}

static void add_branch(struct branch *branch, struct orl_vec3 from, struct orl_vec3 to,
                       double radius, int level)
{
    add_stick(branch, level == 0 ? branch->leaf : branch->bark, from, to, radius);
    for (int i = 1; i <= branch->shoots && level > 0; i++) {
        add_shoot(branch, from, to, radius, level, i, 1);
        add_shoot(branch, from, to, radius, level, i, -1);
    }
}

int orl_genbranch(const char *const *words, size_t count, struct orl_text *text,
                  struct orl_error *err)
{
    struct branch branch = {.bark = "m_bark",
                            .leaf = "m_leaf",
                            .end = {28, 8, 0},
                            .radius = .6,
                            .narrowing = .4,
                            .ratio = .4,
                            .variation = .3,
                            .shoots = 7,
                            .levels = 3,
                            .text = text};
    struct orl_words rest = {"genbranch", words + 1, count - 1};
    int code = 0;
    while (code == 0 && rest.left > 0)
        code = read_option(&branch, &rest, err);
    if (code == 0)
        code = check_size(&branch, err);
    if (code == 0)
        add_branch(&branch, branch.start, branch.end, branch.radius, branch.levels);
    return code;
}
