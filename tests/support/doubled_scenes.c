/* The rows for scenes: the text repeated n times. Numbers differ between repetitions where equal
 * ones would coincide. */
#include <stdlib.h>
#include <string.h>

#include <oriel/base/vec.h>

#include "support/doubled.h"

#define GREY "void plastic m 0 0 5 .5 .5 .5 0 0\n"

/* ---- Scenes: one line repeated with its number ----------------------------------------------- */

#define LINES(name, head, format)                                                                  \
    static void name(FILE *f, size_t n)                                                            \
    {                                                                                              \
        fputs(head, f);                                                                            \
        for (size_t i = 0; i < n; i++)                                                             \
            fprintf(f, format, i, i, i);                                                           \
        fputs(GREY, f);                                                                            \
    }
/* A comment hides the unused numbers. */
LINES(write_comments, "", "# %zu a comment %zu %zu\n")
LINES(write_materials, "", "void plastic m%zu 0 0 5 .5 .5 .5 0 0\n# %zu%zu\n")
LINES(write_plastic2, "", "void plastic2 m%zu 4 1 0 0 . 0 6 .5 .5 .5 .1 .1 .2\n# %zu%zu\n")
LINES(write_trans, "", "void trans m%zu 0 0 7 .5 .5 .5 0 0 .5 .5\n# %zu%zu\n")
LINES(write_glass, "", "void glass m%zu 0 0 3 .9 .9 .9\n# %zu%zu\n")
LINES(write_dielectric, "", "void dielectric m%zu 0 0 5 .9 .9 .9 1.5 0\n# %zu%zu\n")
LINES(write_interface, "", "void interface m%zu 0 0 8 .9 .9 .9 1.5 .9 .9 .9 1.3\n# %zu%zu\n")
LINES(write_mirror, GREY, "void mirror r%zu 1 m 0 3 .9 .9 .9\n# %zu%zu\n")
LINES(write_light, "", "void light m%zu 0 0 3 9 9 9\n# %zu%zu\n")
LINES(write_glow, "", "void glow m%zu 0 0 4 9 9 9 0\n# %zu%zu\n")
LINES(write_spotlight, "", "void spotlight m%zu 0 0 7 9 9 9 60 0 0 -1\n# %zu%zu\n")
LINES(write_illum, GREY, "void illum i%zu 1 m 0 3 1 1 1\n# %zu%zu\n")
LINES(write_bsdfs, "", "void BSDF b%zu 6 0 panel.xml 0 0 1 . 0 0\n# %zu%zu\n")
LINES(write_skies, "",
      "void brightfunc s%zu 2 skybright skybright.cal 0 7 1 1 1 .5 0 0 1\ns%zu glow g%zu 0 0 4 1 1 "
      "1 0\n")
LINES(write_same_name, "", "void plastic m 0 0 5 .5 .5 .5 0 0\n# %zu%zu%zu\n")
LINES(write_aliases, GREY "void alias a m\n", "void alias b%zu a\nvoid alias a b%zu\n# %zu\n")
LINES(write_polygons, GREY, "m polygon p%zu 0 0 9 %zu 0 0 %zu 0 1 0 1 0\n")
LINES(write_spheres, GREY, "m sphere s%zu 0 0 4 %zu %zu 0 .1\n")
LINES(write_bubbles, GREY, "m bubble s%zu 0 0 4 %zu %zu 0 .1\n")
LINES(write_cylinders, GREY, "m cylinder s%zu 0 0 7 %zu 0 0 %zu 0 1 .1\n")
LINES(write_tubes, GREY, "m tube s%zu 0 0 7 %zu 0 0 %zu 0 1 .1\n")
LINES(write_cones, GREY, "m cone s%zu 0 0 8 %zu 0 0 %zu 0 1 .1 .2\n")
LINES(write_cups, GREY, "m cup s%zu 0 0 8 %zu 0 0 %zu 0 1 .1 .2\n")
LINES(write_rings, GREY, "m ring s%zu 0 0 8 %zu %zu 0 0 0 1 0 .1\n")
LINES(write_sources, "void light l 0 0 3 9 9 9\n", "l source s%zu 0 0 4 1 %zu %zu .5\n")
LINES(write_degenerate, GREY, "m polygon p%zu 0 0 9 %zu 0 0 %zu 0 0 1 0 0\n")
LINES(write_no_modifier, GREY, "void sphere s%zu 0 0 4 %zu %zu 0 .1\n")
LINES(write_quotes, GREY, "'m' \"sphere\" 's 'o%zu 0 0 4 '%zu' \"%zu\" 0 .1\n")
LINES(write_unsupported, GREY, "void plasfunc t%zu 0 0 0\nt%zu metal m%zu 0 0 5 .5 .5 .5 0 0\n")
LINES(write_includes, GREY, "!xform -t %zu %zu %zu part.rad\n")
LINES(write_pipes, GREY, "!genbox m b%zu 1 2 3 | xform -t %zu %zu 0 | xform -s 2\n")

/* Many triangles in one place. */
LINES(write_equal_triangles, GREY, "m polygon t%zu 0 0 9 0 0 0 1 0 0 0 1 0\n# %zu%zu\n")
LINES(write_equal_panes, "void glass g 0 0 3 .9 .9 .9\n",
      "g polygon t%zu 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0\n# %zu%zu\n")
LINES(write_equal_lamps, "void light l 0 0 3 9 9 9\n",
      "l polygon t%zu 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0\n# %zu%zu\n")
LINES(write_equal_spheres, GREY, "m sphere s%zu 0 0 4 0 0 0 1\n# %zu%zu\n")
LINES(write_equal_cylinders, GREY, "m cylinder c%zu 0 0 7 0 0 0 0 0 1 .1\n# %zu%zu\n")
LINES(write_equal_rings, GREY, "m ring r%zu 0 0 8 0 0 0 0 0 1 0 .1\n# %zu%zu\n")
/* Triangles side by side in one plane: all overlap along the sum of the axes. */
static void write_long_triangles(FILE *f, size_t n)
{
    fputs(GREY, f);
    for (size_t i = 0; i < n; i++)
        fprintf(f, "m polygon t%zu 0 0 9 %zu 0 0 %zu.5 0 0 %zu 10000 0\n", i, i, i, i);
}
/* Ground under tiles: one polygon that loses to all others. */
static void write_tiled_ground(FILE *f, size_t n)
{
    fprintf(f, GREY "m polygon ground 0 0 12 -1 -1 0 %zu -1 0 %zu 2 0 -1 2 0\n", n + 1, n + 1);
    for (size_t i = 0; i < n; i++)
        fprintf(f, "m polygon t%zu 0 0 12 %zu 0 0 %zu.9 0 0 %zu.9 1 0 %zu 1 0\n", i, i, i, i, i);
}
/* Squares in one plane, each within all later ones, which win. */
static void write_nested(FILE *f, size_t n)
{
    fputs(GREY, f);
    for (size_t i = 1; i <= n; i++)
        fprintf(f, "m polygon s%zu 0 0 12 0 0 0 %zu 0 0 %zu %zu 0 0 %zu 0\n", i, i, i, i, i);
}

static void write_daylit(FILE *f, size_t n)
{
    for (size_t i = 0; i < n; i++)
        fprintf(f, "!gendaylit 3 22 12 -a %zu.5 -o 71 -m 75 -W 800 100\n", i % 60);
    fputs(GREY, f);
}
static void write_skies_made(FILE *f, size_t n)
{
    for (size_t i = 0; i < n; i++)
        fprintf(f, "!gensky 3 22 12 -a %zu.5 -o 71 -m 75\n", i % 60);
    fputs(GREY, f);
}
static void write_boxes(FILE *f, size_t n)
{
    fputs(GREY, f);
    for (size_t i = 0; i < n; i++)
        fprintf(f, "!genbox m b%zu 1 2 %zu\n", i, i + 1);
}

static void write_solids(FILE *f, size_t n)
{
    fputs(GREY, f);
    for (size_t i = 0; i < n; i++)
        fprintf(f,
                "!genbox m b%zu 1 2 3 -r .%zu -n 3\n!genprism m p%zu 3 0 0 1 0 0 1 -r .1\n"
                "!genblinds m s%zu 1 2 3 2 %zu +r 4\n",
                i, i % 9 + 1, i, i, i);
}

/* ---- Scenes: one object of growing size ------------------------------------------------------ */

static void write_long_comment(FILE *f, size_t n)
{
    fprintf(f, "# %*s\n" GREY, (int)n, "");
}
static void write_blanks(FILE *f, size_t n)
{
    fprintf(f, "void plastic m%*s 0 0 5 .5 .5 .5 0 0\n", (int)n, "");
}
static void write_strings(FILE *f, size_t n)
{
    fprintf(f, GREY "void brightfunc s %zu", n);
    for (size_t i = 0; i < n; i++)
        fprintf(f, " word%zu", i);
    fputs(" 0 0\n", f);
}
static void write_long_numbers(FILE *f, size_t n)
{
    for (size_t i = 0; i < n; i++)
        fprintf(f, "void glass m%zu 0 0 3 .%0400d1 .9 .9e-%0300d\n", i, 0, 0);
}
static void write_command_words(FILE *f, size_t n)
{
    fputs(GREY "!genbox m b 1 2 3 |xform", f);
    for (size_t i = 0; i < n; i++)
        fputs(" -rz 1", f);
    fputc('\n', f);
}
static void write_command_lines(FILE *f, size_t n)
{
    fputs(GREY "!genbox m b 1 2 3 |xform", f);
    for (size_t i = 0; i < n; i++)
        fputs(" -rz\\\n 1", f);
    fputc('\n', f);
}
static void write_array(FILE *f, size_t n)
{
    fprintf(f, GREY "!xform -n x -a %zu -t 0 0 1 part.rad\n", n);
}
static void write_arrays_nested(FILE *f, size_t n)
{
    fprintf(f, GREY "!xform -n x -a 4 -t 0 0 1 -a %zu -rz 1 -a 5 -t 1 0 0 part.rad\n", n);
}
/* Doubles the command's length for the same copies. */
static void write_array_transforms(FILE *f, size_t n)
{
    fputs(GREY "!xform -n x -a 300", f);
    for (size_t i = 0; i < n; i++)
        fputs(" -t 0 0 1", f);
    fputs(" part.rad\n", f);
}
/* Doubles both the command's length and the copies: costs at most the sum. */
static void write_array_both(FILE *f, size_t n)
{
    fprintf(f, GREY "!xform -n x -a %zu", n);
    for (size_t i = 0; i < n; i++)
        fputs(" -t 0 0 1", f);
    fputs(" part.rad\n", f);
}
static void write_array_flags(FILE *f, size_t n)
{
    fprintf(f, GREY "!xform -n x -a %zu", n);
    for (size_t i = 0; i < n; i++)
        fputs(" -i 2 -rx 1 -mx", f);
    fputs(" part.rad\n", f);
}
static void write_array_options(FILE *f, size_t n)
{
    fputs(GREY "!xform -n x", f);
    for (size_t i = 0; i < n; i++)
        fputs(" -I -c -m m -e", f);
    fprintf(f, " -a %zu -t 0 0 1 part.rad\n", n);
}
static void write_array_files(FILE *f, size_t n)
{
    fputs(GREY "!xform -n x -a 20 -t 0 0 1", f);
    for (size_t i = 0; i < n; i++)
        fputs(" part.rad", f);
    fputc('\n', f);
}
/* A branch of n shoots, a slat of n parts in all, a prism of n sides. */
static void write_branch(FILE *f, size_t n)
{
    fprintf(f, GREY "!genbranch -bm m -lm m -r 1 -n %zu\n", n);
}
static void write_slats(FILE *f, size_t n)
{
    fprintf(f, GREY "!genblinds m b 1 2 3 %zu 20 -r 4\n", n);
}
static void write_worm(FILE *f, size_t n)
{
    fprintf(f, GREY "!genworm m b t 'sin(t)' t^2 1+t %zu\n", n);
}
static void write_vase(FILE *f, size_t n)
{
    fprintf(f, GREY "!genrev m b t '2+sin(9*t)' %zu\n", n);
}
static void write_ground(FILE *f, size_t n)
{
    fprintf(f, GREY "!gensurf m b '9*s' '9*t' '.5*sin(7*s*t)' %zu 10 -s\n", n / 10 + 1);
}
static void write_prism(FILE *f, size_t n)
{
    fprintf(f, GREY "!genprism m p %zu", n);
    for (size_t i = 0; i < n; i++)
        fprintf(f, " %.9g %.9g", cos((double)i / (double)n), sin((double)i / (double)n));
    fputs(" -r .001\n", f);
}
static void write_markers(FILE *f, size_t n)
{
    fprintf(f, GREY "!genblinds mark b 1 2 3 %zu 20 | replmarks -x part.rad mark\n", n);
}
static void write_files(FILE *f, size_t n)
{
    fputs(GREY "!cat", f);
    for (size_t i = 0; i < n; i++)
        fputs(" part.rad", f);
    fputc('\n', f);
}
/* args.txt has n lines. */
static void write_argument_file(FILE *f, size_t n)
{
    (void)n;
    fputs(GREY "!xform -n x -f args.txt part.rad\n", f);
}
static void write_argument_file_and_words(FILE *f, size_t n)
{
    fputs(GREY "!xform -n x -f args.txt", f);
    for (size_t i = 0; i < n; i++)
        fputs(" -t 0 0 1", f);
    fputs(" part.rad\n", f);
}
static void write_piped_arrays(FILE *f, size_t n)
{
    fprintf(f, GREY "!genbox m b 1 2 3 | xform -n x -a %zu -t 0 0 4\n", n);
}

/* ---- Polygons -------------------------------------------------------------------------------- */

/* Writes a polygon whose corners follow a formula. */
static void write_outline(FILE *f, size_t n, double (*radius)(size_t i, size_t n))
{
    fprintf(f, GREY "m polygon p 0 0 %zu\n", 3 * n);
    for (size_t i = 0; i < n; i++) {
        const double angle = 2 * ORL_PI * (double)i / (double)n, r = radius(i, n);
        fprintf(f, "%.9g %.9g 0\n", r * cos(angle), r * sin(angle));
    }
}
static double round_radius(size_t i, size_t n)
{
    (void)i, (void)n;
    return 10;
}
static double star_radius(size_t i, size_t n)
{
    (void)n;
    return i % 2 ? 10 : 5;
}
static void write_disc(FILE *f, size_t n)
{
    write_outline(f, n, round_radius);
}
static void write_star(FILE *f, size_t n)
{
    write_outline(f, n, star_radius);
}
static void write_comb(FILE *f, size_t n)
{
    fprintf(f, GREY "m polygon p 0 0 %zu\n", 3 * (2 * n + 2));
    for (size_t i = 0; i < n; i++)
        fprintf(f, "%zu 1 0 %zu.5 9 0\n", i, i);
    fprintf(f, "%zu 0 0 0 0 0\n", n);
}
static void write_spiral(FILE *f, size_t n)
{
    fprintf(f, GREY "m polygon p 0 0 %zu\n", 6 * n);
    for (size_t k = 0; k < 2 * n; k++) {
        const size_t i = k < n ? k : 2 * n - 1 - k;
        const double angle = (double)i * 0.3, r = 1 + (double)i * 0.05 + (k < n ? 0 : 0.2);
        fprintf(f, "%.9g %.9g 0\n", r * cos(angle), r * sin(angle));
    }
}
/* Writes an outline that crosses itself once per tooth. */
static void write_zigzag(FILE *f, size_t n)
{
    fprintf(f, GREY "m polygon p 0 0 %zu\n", 3 * (n + 2));
    for (size_t i = 0; i < n; i++)
        fprintf(f, "%zu %d 0\n", i, i % 2 ? 1 : -1);
    fprintf(f, "%zu 0.01 0 -1 0.02 0\n", n);
}
/* Writes holes joined by seams. */
static void write_holes(FILE *f, size_t n)
{
    fprintf(f, GREY "m polygon p 0 0 %zu\n0 0 0 0 9 0 %zu 9 0 %zu 0 0\n", 3 * (4 + 5 * n),
            4 * n + 4, 4 * n + 4);
    for (size_t k = n; k-- > 0;)
        fprintf(f, "%zu 0 0 %zu 2 0 %zu 2 0 %zu 4 0 %zu 0 0\n", 4 * k + 2, 4 * k + 2, 4 * k + 4,
                4 * k + 2, 4 * k + 2);
}
/* Floor tiles side by side in one plane; or tiles that each cover half of a neighbour. */
static void write_tiles_wide(FILE *f, size_t n, double wide)
{
    fputs(GREY, f);
    for (size_t i = 0; i < n; i++) {
        const double x = (double)(i % 40), y = (double)(i / 40);
        fprintf(f, "m polygon t%zu 0 0 12 %g %g 0 %g %g 0 %g %g 0 %g %g 0\n", i, x, y, x + wide, y,
                x + wide, y + 1, x, y + 1);
    }
}
static void write_tiles(FILE *f, size_t n)
{
    write_tiles_wide(f, n, 1);
}
static void write_tiles_lapping(FILE *f, size_t n)
{
    write_tiles_wide(f, n, 1.5);
}
static void write_walls(FILE *f, size_t n)
{
    fputs(GREY, f);
    for (size_t i = 0; i < n; i++)
        fprintf(f, "m polygon w%zu 0 0 12 %zu 0 0 %zu 0 1 %zu 1 1 %zu 1 0\n", i, i, i, i, i);
}
/* Writes n polygons in one place. */
static void write_stack(FILE *f, size_t n)
{
    fputs(GREY, f);
    for (size_t i = 0; i < n; i++)
        fprintf(f, "m polygon w%zu 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0\n", i);
}

/* Each has its own function, material and surface; some names are from the standard set. */
static void write_patterns(FILE *f, size_t n)
{
    for (size_t i = 0; i < n; i++)
        fprintf(f,
                "void brightfunc f%zu 2 bound(0,noise3(Px,U,%zu),1) . 0 0\n"
                "f%zu plastic m%zu 0 0 5 .5 .5 .5 0 0\nm%zu sphere s%zu 0 0 4 %zu 0 0 .4\n",
                i, i, i, i, i, i, i);
}

/* Writes a spectrum, a lobe of it, glazing, and a mixture of both, under separate names. */
static void write_shares(FILE *f, size_t n)
{
    for (size_t i = 0; i < n; i++)
        fprintf(f,
                "void spectrum s%zu 0 0 7 380 780 .1 .2 .3 .4 .5\n"
                "s%zu ashik2 a%zu 4 1 0 0 . 0 8 .5 .5 .5 .1 .1 .1 9 9\n"
                "void BRTDfunc g%zu 10 .1 .1 .1 .8 .8 .8 0 0 0 . 0 9 0 0 0 0 0 0 0 0 0\n"
                "void mixfunc x%zu 4 a%zu g%zu Px . 0 0\nx%zu sphere b%zu 0 0 4 %zu 0 0 .4\n"
                "void prism1 p%zu 5 .5 Dx Dy Dz . 0 0\n"
                "void plasfunc f%zu 2 floor . 0 4 .5 .5 .5 0\n"
                "void WGMDfunc d%zu 13 s%zu Px/9 .1+Py/99 .1 void 0 0 0 void 0 0 1 . 0 9 .1 .1 .1 "
                ".1 .1 .1 0 0 0\n",
                i, i, i, i, i, i, i, i, i, i, i, i, i, i);
}

/* Volumes that each cut what the previous one cuts, and one more wall. */
static void write_antimatters(FILE *f, size_t n)
{
    for (size_t i = 0; i < n; i++)
        fprintf(f,
                "void plastic w%zu 0 0 5 .5 .5 .5 0 0\nvoid antimatter a%zu 2 w%zu w%zu 0 0\n"
                "!genbox w%zu b%zu 1 1 1 | xform -t 0 0 %zu\na%zu sphere s%zu 0 0 4 .5 .5 %zu .3\n",
                i, i, i, i ? i - 1 : 0, i, i, i, i, i, i);
}

/* Volumes that overlap the next one. */
static void write_mists(FILE *f, size_t n)
{
    fprintf(f, "void mist fog 0 0 7 .1 .2 .3 .5 .5 .5 .5\n");
    for (size_t i = 0; i < n; i++)
        fprintf(f, "fog sphere s%zu 0 0 4 0 0 %zu 1\n", i, i);
}

/* ---- The table ------------------------------------------------------------------------------- */

#define SCENE(name, n)                                                                             \
    {                                                                                              \
#name, DOUBLED_SCENE, n, write_##name, 0                                                   \
    }
#define WORLD(name, n)                                                                             \
    {                                                                                              \
#name ", checked", DOUBLED_WORLD, n, write_##name, 0                                       \
    }
const struct doubled doubled_scenes[] = {
    SCENE(comments, 2000),
    SCENE(long_comment, 50000),
    SCENE(blanks, 20000),
    SCENE(materials, 500),
    SCENE(plastic2, 500),
    SCENE(trans, 500),
    SCENE(glass, 500),
    SCENE(dielectric, 500),
    SCENE(interface, 500),
    SCENE(mirror, 500),
    SCENE(light, 500),
    SCENE(glow, 500),
    SCENE(spotlight, 500),
    SCENE(illum, 500),
    SCENE(bsdfs, 500),
    SCENE(skies, 250),
    SCENE(same_name, 500),
    SCENE(aliases, 500),
    SCENE(polygons, 500),
    SCENE(spheres, 500),
    SCENE(bubbles, 500),
    SCENE(cylinders, 500),
    SCENE(tubes, 500),
    SCENE(cones, 500),
    SCENE(cups, 500),
    SCENE(rings, 500),
    SCENE(sources, 500),
    SCENE(degenerate, 500),
    SCENE(no_modifier, 500),
    SCENE(quotes, 500),
    SCENE(unsupported, 300),
    SCENE(boxes, 25),
    SCENE(solids, 4),
    SCENE(branch, 50),
    SCENE(slats, 40),
    SCENE(worm, 100),
    SCENE(vase, 100),
    SCENE(ground, 40),
    SCENE(prism, 60),
    SCENE(markers, 100),
    SCENE(files, 200),
    SCENE(skies_made, 40),
    SCENE(daylit, 40),
    SCENE(patterns, 80),
    SCENE(shares, 8),
    SCENE(antimatters, 30),
    SCENE(mists, 500),
    SCENE(includes, 500),
    SCENE(pipes, 30),
    SCENE(strings, 3000),
    SCENE(long_numbers, 60),
    SCENE(command_words, 500),
    SCENE(command_lines, 500),
    SCENE(array, 500),
    SCENE(arrays_nested, 30),
    SCENE(array_transforms, 100),
    SCENE(array_both, 200),
    SCENE(array_flags, 150),
    SCENE(array_options, 100),
    SCENE(array_files, 80),
    SCENE(argument_file, 500),
    SCENE(argument_file_and_words, 200),
    SCENE(piped_arrays, 100),
    WORLD(polygons, 200),
    WORLD(spheres, 200),
    WORLD(patterns, 3),
    WORLD(shares, 3),
    WORLD(antimatters, 10),
    WORLD(mists, 200),
    WORLD(disc, 500),
    WORLD(star, 200),
    WORLD(comb, 100),
    WORLD(spiral, 100),
    WORLD(zigzag, 200),
    WORLD(holes, 80),
    WORLD(tiles, 200),
    WORLD(tiles_lapping, 100),
    WORLD(walls, 200),
    WORLD(equal_triangles, 500),
    WORLD(equal_panes, 500),
    WORLD(equal_lamps, 500),
    WORLD(equal_spheres, 500),
    WORLD(equal_cylinders, 500),
    WORLD(equal_rings, 500),
    WORLD(long_triangles, 500),
    WORLD(tiled_ground, 100),
    WORLD(mirror, 100),
    WORLD(glass, 100),
    WORLD(light, 100),
    WORLD(bsdfs, 100),
    WORLD(nested, 60),
    WORLD(stack, 25),
};
const size_t doubled_n_scenes = sizeof doubled_scenes / sizeof *doubled_scenes;
