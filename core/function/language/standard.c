#include "function/function.h"

#include <stddef.h>
#include <string.h>

/* Names that every file may use. */
static const char start[] =
    /* Arguments and vectors by number; older names of noise3's gradient. */
    "AC = arg(0); A1 = arg(1); A2 = arg(2); A3 = arg(3); A4 = arg(4); A5 = arg(5);\n"
    "A6 = arg(6); A7 = arg(7); A8 = arg(8); A9 = arg(9); A10 = arg(10);\n"
    "D(i) = select(i, Dx, Dy, Dz); N(i) = select(i, Nx, Ny, Nz); P(i) = select(i, Px, Py, Pz);\n"
    "noise3a(x,y,z) : noise3x(x,y,z); noise3b(x,y,z) : noise3y(x,y,z);\n"
    "noise3c(x,y,z) : noise3z(x,y,z);\n"
    "noise3d(i,x,y,z) : select(i, noise3x(x,y,z), noise3y(x,y,z), noise3z(x,y,z));\n"
    /* Constants. */
    "PI : 3.14159265358979323846; DEGREE : PI/180; FTINY : 1e-7;\n"
    /* Library functions that have a value everywhere. */
    "bound(a,x,b) : if(a-x, a, if(x-b, b, x));\n"
    "Acos(x) : acos(bound(-1, x, 1)); Asin(x) : asin(bound(-1, x, 1));\n"
    "Atan2(y,x) : if(x*x+y*y, atan2(y,x), 0); Exp(x) : if(-100-x, 0, exp(x));\n"
    "Sqrt(x) : if(x, sqrt(x), 0);\n"
    /* Conditions. */
    "and(a,b) : if(a, b, a); or(a,b) : if(a, a, b); not(a) : if(a, -1, 1);\n"
    "xor(a,b) : if(a, not(b), b); inside(a,x,b) : and(x-a, b-x);\n"
    /* Functions of a number. */
    "abs(x) : if(x, x, -x); sgn(x) : if(x, 1, if(-x, -1, 0)); sq(x) : x*x; noop(v) : v;\n"
    "frac(x) : x - floor(x); mod(n,d) : n - d*floor(n/d); tri(n,d) : d - abs(d - mod(n, 2*d));\n"
    "linterp(t,p0,p1) : (1-t)*p0 + t*p1;\n"
    "clip(v) : bound(0, v, 1); noneg(v) : max(v, 0);\n"
    /* Functions of a colour: luminance by the primaries' shares. */
    "red(r,g,b) : noneg(r); green(r,g,b) : noneg(g); blue(r,g,b) : noneg(b);\n"
    "grey(r,g,b) : noneg(.265074126*r + .670114631*g + .064811243*b);\n"
    "clip_r(r,g,b) : clip(r); clip_g(r,g,b) : clip(g); clip_b(r,g,b) : clip(b);\n"
    "clipgrey(r,g,b) : min(grey(r,g,b), 1);\n"
    /* Functions of vectors, which are functions of an index. */
    "dot(v1,v2) : v1(1)*v2(1) + v1(2)*v2(2) + v1(3)*v2(3);\n"
    "cross(i,v1,v2) : select(i, v1(2)*v2(3) - v1(3)*v2(2), v1(3)*v2(1) - v1(1)*v2(3),\n"
    "                        v1(1)*v2(2) - v1(2)*v2(1));\n"
    /* Interpolation by distance, from near to far. */
    "fade(near_val,far_val,dist) : if(dist-15.99, far_val,\n"
    "                                 linterp(1/(1+dist*dist), far_val, near_val));\n"
    /* Cubics: by ends and slopes, by Bernstein's polynomials, uniform B-spline. */
    "hermite(p0,p1,r0,r1,t) : linterp(t*t*(3-2*t), p0, p1) + t*(1-t)*(r0*(1-t) - r1*t);\n"
    "bezier(p1,p2,p3,p4,t) : (1-t)^3*p1 + 3*t*(1-t)^2*p2 + 3*t*t*(1-t)*p3 + t^3*p4;\n"
    "bspline(pp,p0,p1,pn,t) : ((1-t)^3*pp + (4 - 6*t^2 + 3*t^3)*p0\n"
    "                          + (1 + 3*t + 3*t^2 - 3*t^3)*p1 + t^3*pn)/6;\n"
    /* Octaves of noise from the scale s to 1. */
    "turbulence(x,y,z,s) : if(s-1.01, 0, abs(noise3(x/s,y/s,z/s)*s) + turbulence(x,y,z,2*s));\n"
    "turbulencex(x,y,z,s) : if(s-1.01, 0, sgn(noise3(x/s,y/s,z/s))*noise3x(x/s,y/s,z/s)\n"
    "                                     + turbulencex(x,y,z,2*s));\n"
    "turbulencey(x,y,z,s) : if(s-1.01, 0, sgn(noise3(x/s,y/s,z/s))*noise3y(x/s,y/s,z/s)\n"
    "                                     + turbulencey(x,y,z,2*s));\n"
    "turbulencez(x,y,z,s) : if(s-1.01, 0, sgn(noise3(x/s,y/s,z/s))*noise3z(x/s,y/s,z/s)\n"
    "                                     + turbulencez(x,y,z,2*s));\n"
    /* The normal distribution's quantiles: Abramowitz and Stegun, 26.2.23. */
    "un2`P.(t) : t - (2.515517 + t*(.802853 + t*.010328))\n"
    "                / (1 + t*(1.432788 + t*(.189269 + t*.001308)));\n"
    "un1`P.(p) : un2`P.(sqrt(-2*log(p)));\n"
    "unif2norm(p) : if(and(p, 1-p), if(p-.5, un1`P.(1-p), -un1`P.(p)), 0);\n"
    "nrand(x) = unif2norm(rand(x));\n"
    /* Coordinates in a plane: along the horizontal, and N = U x V; of a floor, the world's. */
    "crosslen`P. = Nx*Nx + Ny*Ny;\n"
    "U = if(crosslen`P. - FTINY, (Py*Nx - Px*Ny)/crosslen`P., Px);\n"
    "V = if(crosslen`P. - FTINY, (Pz - Nz*(Px*Nx + Py*Ny + Pz*Nz))/crosslen`P., Py);\n"
    /* A frame of the perturbed normal and the last three arguments, which point upwards. */
    "upward`P.(i) = arg(AC - 3 + i); normal`P.(i) = select(i, NxP, NyP, NzP);\n"
    "Vux`P. = cross(1, upward`P., normal`P.); Vuy`P. = cross(2, upward`P., normal`P.);\n"
    "Vuz`P. = cross(3, upward`P., normal`P.);\n"
    "vnorm`P. = if(Vux`P.^2 + Vuy`P.^2 + Vuz`P.^2 - FTINY^2,\n"
    "              1/sqrt(Vux`P.^2 + Vuy`P.^2 + Vuz`P.^2), 0);\n"
    "Vnx`P. = vnorm`P.*Vux`P.; Vny`P. = vnorm`P.*Vuy`P.; Vnz`P. = vnorm`P.*Vuz`P.;\n"
    "across`P.(i) = select(i, Vnx`P., Vny`P., Vnz`P.);\n"
    "Unx`P. = cross(1, normal`P., across`P.); Uny`P. = cross(2, normal`P., across`P.);\n"
    "Unz`P. = cross(3, normal`P., across`P.);\n"
    "Ldx(dx,dy,dz) = dx*Unx`P. + dy*Uny`P. + dz*Unz`P.;\n"
    "Ldy(dx,dy,dz) = dx*Vnx`P. + dy*Vny`P. + dz*Vnz`P.;\n"
    "Ldz(dx,dy,dz) = dx*NxP + dy*NyP + dz*NzP;\n"
    "Idx = -Ldx(Dx,Dy,Dz); Idy = -Ldy(Dx,Dy,Dz); Idz = RdotP;\n";

/* Angles to the sun and blending at the horizon, shared by both skies. */
#define SKY                                                                                        \
    "wmean(a,x,b,y) : (a*x + b*y)/(a + b); gamma = Acos(cosgamma); eta = Acos(Dz);\n"              \
    "above = (Dz + 1.01)^10;\n"

/* The skies of gensky(1): clear and intermediate by CIE's formulas, overcast by Moon and
 * Spencer's. */
static const char skybright[] = SKY
    "cosgamma = Dx*A5 + Dy*A6 + Dz*A7; zt = Acos(A7);\n"
    "sunnysky = A2*(.91 + 10*exp(-3*gamma) + .45*cosgamma^2)\n"
    "           *if(Dz-.01, 1 - exp(-.32/Dz), 1)/A4;\n"
    "cloudysky = A2*(1 + 2*Dz)/3; unifsky = A2;\n"
    "intersky = A2*((1.35*sin(5.631 - 3.59*eta) + 3.12)*sin(4.396 - 2.6*zt) + 6.37 - eta)/2.326\n"
    "           *exp(-.563*gamma*((2.629 - eta)*(1.562 - zt) + .812))/A4;\n"
    "skybr = wmean(above, select(A1, sunnysky, cloudysky, unifsky, intersky), 1/above, A3);\n";

/* The sky of gendaylit(1): Perez, Seals and Michalsky 1993. */
static const char perezlum[] =
    SKY "cosgamma = Dx*A8 + Dy*A9 + Dz*A10; zt = Acos(A10);\n"
        "intersky = A1*(1 + A3*Exp(A4/max(Dz, .01)))*(1 + A5*Exp(A6*gamma) + A7*cosgamma^2);\n"
        "skybright = wmean(above, intersky, 1/above, A2);\n";

/* Coordinates of mkillum(1)'s tables: for all directions, and for the hemisphere about the axis A7
 * to A9. */
static const char illum[] =
    "norm_rad(r) : if(r, r, r + 2*PI); il_alt = Dz; il_azi = norm_rad(Atan2(Dy, Dx));\n"
    "il_alth = (Dx*A7 + Dy*A8 + Dz*A9)^2;\n"
    "il_azih = norm_rad(Atan2(-(Dx*A4 + Dy*A5 + Dz*A6), -(Dx*A1 + Dy*A2 + Dz*A3)));\n";

/* Normals of genrev(1) -s, about z: along it A1 z + A2, away from it A3 r + A4. */
static const char rev[] =
    "rev_rad = sqrt(Px*Px + Py*Py); rev_dr = A3*rev_rad + A4;\n"
    "rev_dx = rev_dr*Px/rev_rad; rev_dy = rev_dr*Py/rev_rad; rev_dz = A1*Pz + A2;\n";

/* Smooth normals of gensurf(1) -s, by the two coordinates beside the axis A1. A2 to A13 are four
 * vectors: coefficients of the coordinates' product, the first, the second, and 1. */
static const char surf[] =
    "u`R. = select(A1 + 1, Py, Pz, Px); v`R. = select(A1 + 1, Pz, Px, Py);\n"
    "turn`R.(i) = u`R.*(v`R.*arg(i + 1) + arg(i + 4)) + v`R.*arg(i + 7) + arg(i + 10);\n"
    "surf_dx = turn`R.(1); surf_dy = turn`R.(2); surf_dz = turn`R.(3);\n";

/* Interpolation between the corners of a triangle: three values, each linear in the two coordinates
 * beside the axis A1. Normals use all three, minus the triangle's normal; picture coordinates use
 * two. */
static const char tmesh[] =
    "bu = select(A1 + 1, Py, Pz, Px); bv = select(A1 + 1, Pz, Px, Py);\n"
    "at`T.(i) = bu*arg(3*i - 1) + bv*arg(3*i) + arg(3*i + 1);\n"
    "v1 = at`T.(1); v2 = at`T.(2); v3 = at`T.(3); nf = 1/sqrt(v1*v1 + v2*v2 + v3*v3);\n"
    "dx = v1*nf - Nx; dy = v2*nf - Ny; dz = v3*nf - Nz; u = frac(v1); v = frac(v2);\n";

/* Luminaires by ies2rad(1): theta from the z axis downwards, phi from x towards y, in degrees.
 * Corrections of an intensity distribution for flat sources, boxes A2 A3 A4 and cylinders A2 A3,
 * all in metres. */
static const char source[] =
    "src_theta = Acos(Dz)/DEGREE; src_phi = mod(Atan2(-Dy, -Dx)/DEGREE, 360);\n"
    "src_phi2 = tri(src_phi, 180); src_phi4 = tri(src_phi, 90);\n"
    "srcB_vert = Atan2(-Dx, Dz)/DEGREE; srcB_horiz = Atan2(Dy, Dz)/DEGREE;\n"
    "srcB_vert2 = abs(srcB_vert); srcB_horiz2 = abs(srcB_horiz);\n"
    "box`S.(x,y,z) = A3*A4*x + A2*A4*y + A2*A3*z;\n"
    "away`S.(p,d,side) = noneg(abs(p - d*Ts) - side/2)/Ts;\n"
    "corr(v) = noneg(if(AC-.5, A1, 1)*v); flatcorr(v) = corr(v)/Rdot;\n"
    "boxcorr(v) = corr(v)/box`S.(abs(Dx), abs(Dy), abs(Dz));\n"
    "lboxcorr(v) = corr(v)/box`S.(away`S.(Px,Dx,A2), away`S.(Py,Dy,A3), away`S.(Pz,Dz,A4));\n"
    "cylcorr(v) = corr(v)/(A2*(A3*Sqrt(1 - Dz*Dz) + A2*PI/4*abs(Dz)));\n";

/* Tilt of a luminaire, in degrees: the angle of its axis from hanging straight, and the rotation
 * about it that ies2rad uses for horizontal lamps: the world's y axis above the luminaire's x y
 * plane, from 90 on. */
static const char tilt[] = "tilt_ang = Acos(Kz)/DEGREE; tilt_ang2 = tri(tilt_ang, 90);\n"
                           "tilt_xang = if(Jy*Jy - FTINY, Atan2(Jy, abs(Jz))/DEGREE, 0);\n"
                           "tilt_xang2 = tri(tilt_xang, 90);\n";

/* Pictures in the plane z = 0, from the origin on, with aspect A1 (height by width) and a shorter
 * side of 1: once, tiled, mirrored at the edges, or staggered like bricks. */
static const char picture[] =
    "pic_u = Px; pic_v = Py; pic_aspect = if(AC-.5, A1, 1);\n"
    "wide`I. = max(1, 1/pic_aspect); high`I. = max(1, pic_aspect);\n"
    "inpic = if(and(inside(0, Px, wide`I.), inside(0, Py, high`I.)), 1, 0);\n"
    "tile_u = mod(Px, wide`I.); tile_v = mod(Py, high`I.);\n"
    "match_u = tri(Px, wide`I.); match_v = tri(Py, high`I.);\n"
    "stag_u = mod(if(frac(Py/high`I./2)-.5, Px, Px + wide`I./2), wide`I.); stag_v = tile_v;\n";

/* Coated and fritted panes as described by genglaze(1). At grazing angles the reflectance is 1;
 * uncoated glass reflects .076 and transmits .883 at normal incidence. Single pane: A10 is 1 if its
 * plain side is the front; A11 is the fritted share; or A11 to A13 and A14 to A16 are the
 * reflectances of the plain and of the coated side, and A17 to A19 the transmittance. Double pane:
 * functions of numbers that are written in the scene. */
#define GLAZE "grazing`G. = exp(-5.85*abs(Rdot)) - exp(-5.85);\n"
static const char glaze1[] = GLAZE
    "fresne_refl(r) = r + (1 - r)*grazing`G.; fresne_trans(t) = t - t*grazing`G.;\n"
    "glass_refl = fresne_refl(.076); glass_trans = fresne_trans(.883);\n"
    "clear_side = A10*Rdot; frac_glass = 1 - arg(11);\n"
    "sr_frit_r = if(clear_side, 1, frac_glass)*glass_refl; st_frit_r = frac_glass*glass_trans;\n"
    "sr_frit_g = sr_frit_r; sr_frit_b = sr_frit_r; st_frit_g = st_frit_r; st_frit_b = st_frit_r;\n"
    "side`G.(i) = fresne_refl(if(clear_side, arg(10 + i), arg(13 + i)));\n"
    "sr_clear_r = side`G.(1); sr_clear_g = side`G.(2); sr_clear_b = side`G.(3);\n"
    "st_clear_r = fresne_trans(arg(17)); st_clear_g = fresne_trans(arg(18));\n"
    "st_clear_b = fresne_trans(arg(19));\n";
static const char glaze2[] = GLAZE
    "fr(r) = r + (1 - r)*grazing`G.; ft(t) = t - t*grazing`G.; rclr = fr(.076); tclr = ft(.883);\n"
    "cr(front,t,back) : front + t*t*back;\n";

/* Patterns of strength A1: dirt by fractal noise; wood rings about a line along x, y or z, bent by
 * noise, alternately bright and dark; veins by turbulence. */
static const char dirt[] = "dirt = 1 - .5*A1 - .5*A1*fnoise3(Px,Py,Pz);\n";
static const char woodpat[] =
    "off`W.(x) = mod(x, 50) - 25; bend`W. = 7*fnoise3(Px/40, Py/40, Pz/40);\n"
    "ring`W.(a,b) = bend`W. + sqrt(off`W.(a)^2 + off`W.(b)^2 + 25);\n"
    "shade`W.(r) = hermite(.6 - .5*A1, .6 + .5*A1, 2, .5, 2*tri(r, .5));\n"
    "xgrain = shade`W.(ring`W.(Py,Pz)); ygrain = shade`W.(ring`W.(Px,Pz));\n"
    "zgrain = shade`W.(ring`W.(Px,Py));\n";
static const char marble[] = "marble = 1 + A1*(turbulence(Px,Py,Pz,.05) - 1);\n";

/* Brick walls: joints A1 wide, courses A2 high, bricks A3 long, each course shifted by A4 relative
 * to the one below; bricks have reflectance A5, mortar A6. For walls along y or x, or both. */
static const char brick[] = "course`B. = floor(Pz/A2); on`B. = Pz - A2*course`B. - A1;\n"
                            "of`B.(h) = and(on`B., mod(h + A4*course`B., A3) - A1);\n"
                            "f_brick_x = of`B.(Px); f_brick_y = of`B.(Py);\n"
                            "f_brick_xy = if(.5 - Nx^2, of`B.(Px + 2*A1), of`B.(Py + 2*A1));\n"
                            "brick_x = if(f_brick_x, A5, A6); brick_y = if(f_brick_y, A5, A6);\n"
                            "brick_xy = if(f_brick_xy, A5, A6);\n";

/* Normals of wrinkles A1 high and A2 long, A3 apart, alternately along x, y or z. */
static const char wrinkle[] =
    "turn`W. = noise3(Px/(3*A2), Py/(3*A2), Pz/(3*A2)); rise`W. = Rdot*A1/A3;\n"
    "xwrink = rise`W.*Sqrt(-turn`W.)*fnoise3(Px/A3, Py/A2, Pz/A2);\n"
    "ywrink = rise`W.*Sqrt(1 - abs(turn`W.))*fnoise3(Px/A2, Py/A3, Pz/A2);\n"
    "zwrink = rise`W.*Sqrt(turn`W.)*fnoise3(Py/A2, Py/A2, Pz/A3);\n";

/* Normals of plaster with roughness A1: the gradient of noise, plus five times that of coarser
 * noise in cracks, which lie where a sum of noises is near zero. */
static const char adobe[] =
    "bend`A. = fnoise3(Px, Py, Pz)/30; cu = Px/3 + bend`A.; cv = Py/3 + bend`A.;\n"
    "cw = Pz/3 + bend`A.; in_crack = .02 - abs(noise3(cu,cv,cw) + .4*fnoise3(cu,cv,cw));\n"
    "cdx = 5*A1*noise3x(cu,cv,cw); cdy = 5*A1*noise3y(cu,cv,cw); cdz = 5*A1*noise3z(cu,cv,cw);\n"
    "dx = A1*noise3x(Px,Py,Pz) + if(in_crack, cdx, 0);\n"
    "dy = A1*noise3y(Px,Py,Pz) + if(in_crack, cdy, 0);\n"
    "dz = A1*noise3z(Px,Py,Pz) + if(in_crack, cdz, 0);\n";

/* Normals of sawn wood with roughness A1 and grain along x, y or z: rotated across it by noise that
 * is ten times as long in z. */
static const char woodtex[] =
    "turn`W. = PI*fnoise3(Px, Py, Pz/10); sin`W. = A1*Rdot*sin(turn`W.);\n"
    "cos`W. = A1*Rdot*cos(turn`W.); xgrain_dx = 0; xgrain_dy = sin`W.; xgrain_dz = cos`W.;\n"
    "ygrain_dx = cos`W.; ygrain_dy = 0; ygrain_dz = sin`W.; zgrain_dx = cos`W.;\n"
    "zgrain_dy = sin`W.; zgrain_dz = 0;\n";

static const struct {
    const char *name, *text;
} texts[] = {{ORL_STANDARD_START, start},
             {"skybright.cal", skybright},
             {"perezlum.cal", perezlum},
             {"illum.cal", illum},
             {"rev.cal", rev},
             {"surf.cal", surf},
             {"tmesh.cal", tmesh},
             {"glaze1.cal", glaze1},
             {"glaze2.cal", glaze2},
             {"source.cal", source},
             {"tilt.cal", tilt},
             {"picture.cal", picture},
             {"dirt.cal", dirt},
             {"woodpat.cal", woodpat},
             {"marble.cal", marble},
             {"brick.cal", brick},
             {"wrinkle.cal", wrinkle},
             {"adobe.cal", adobe},
             {"woodtex.cal", woodtex}};

const char *orl_standard_text(const char *name)
{
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        if (strcmp(texts[i].name, name) == 0)
            return texts[i].text;
    return NULL;
}

const char *const orl_function_ray_names[ORL_RAY_INPUTS] = {
    "Dx", "Dy", "Dz", "Nx", "Ny", "Nz", "Px", "Py", "Pz", "T", "Ts", "Rdot", "S", "Tx", "Ty", "Tz",
    "Ix", "Iy", "Iz", "Jx", "Jy", "Jz", "Kx", "Ky", "Kz", "Lu", "Lv", "NxP", "NyP", "NzP", "RdotP",
    "CrP", "CgP", "CbP", "DxA", "DyA", "DzA",
    /* Names that cannot occur in texts. */
    "light`1", "light`2", "light`3", "data`1", "data`2", "data`3"};
