#include <string.h>

#include "scene/generate/solid/genbox.h"

const char orl_box_inset[6][5] = {"dhgc", "oqmk", "OPNM", "feij", "plnr", "SQRT"};
const char orl_box_edges[12][3] = {"st", "sw", "su", "vt", "vu", "vz",
                                   "xt", "xw", "xz", "yu", "yw", "yz"};
const char orl_box_ends[8][2] = {"s", "t", "u", "v", "w", "x", "y", "z"};

unsigned orl_box_code(char letter)
{
    static const char letters[] =
        "0123456789._ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz";
    return (unsigned)(strchr(letters, letter) - letters);
}

struct orl_vec3 orl_box_corner(const struct orl_genbox *box, char letter)
{
    const unsigned code = orl_box_code(letter);
    double at[3];
    for (unsigned axis = 0; axis < 3; axis++) {
        const bool far = ((code >> axis & 1) != 0) != box->inverted;
        if (code >> axis & 8)
            at[axis] = far ? box->size[axis] - box->bevel : box->bevel;
        else
            at[axis] = far ? box->size[axis] : 0.0;
    }
    return orl_v3(at[0], at[1], at[2]);
}
