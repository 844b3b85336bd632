#include "function/ray_names.h"

const char *const orl_function_ray_names[ORL_RAY_INPUTS] = {
    "Dx", "Dy", "Dz", "Nx", "Ny", "Nz", "Px", "Py", "Pz", "T", "Ts", "Rdot", "S", "Tx", "Ty", "Tz",
    "Ix", "Iy", "Iz", "Jx", "Jy", "Jz", "Kx", "Ky", "Kz", "Lu", "Lv", "NxP", "NyP", "NzP", "RdotP",
    "CrP", "CgP", "CbP", "DxA", "DyA", "DzA",
    /* Names that cannot occur in texts. */
    "light`1", "light`2", "light`3", "data`1", "data`2", "data`3"};
