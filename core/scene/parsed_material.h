/*
 * Materials of a parsed scene: a head that all kinds have, and a union with one struct for each
 * kind, or for each group of kinds that share a model.
 *
 * Code that reads a material calls the functions orl_..._of, which assert in builds with ORL_DEBUG
 * that the material has that struct; or one of the functions after them, which give any kind an
 * answer. Only code that fills in or changes materials names the union: the parser, the cache, the
 * planner (plan/decide.c), and the makers of single materials. tests/check_boundaries lists them.
 *
 * Units: those of the scene files, unless said otherwise. Ownership: names, mixed materials and
 * lists lie in the parsed scene's arena; patterns belong to the parsed scene; a BSDF is a reference
 * that the material owns, so a copy of a material in the parsed scene's table takes its own.
 */
#ifndef ORL_SCENE_PARSED_MATERIAL_H
#define ORL_SCENE_PARSED_MATERIAL_H

#ifdef ORL_DEBUG
#include <assert.h>
#endif
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <oriel/base/vec.h>
#include <oriel/bsdf/bsdf.h>

struct orl_material;
struct orl_pattern;

enum orl_material_kind {
    ORL_MATERIAL_VOID,           /* void, or a modifier that is refused, while files are read */
    ORL_MATERIAL_PLASTIC,        /* reflector */
    ORL_MATERIAL_METAL,          /* reflector */
    ORL_MATERIAL_TRANS,          /* reflector */
    ORL_MATERIAL_ASHIKHMIN,      /* ashikhmin: ashik2 */
    ORL_MATERIAL_GLASS,          /* glass */
    ORL_MATERIAL_GLAZING,        /* glazing: BRTDfunc without lobes */
    ORL_MATERIAL_DIELECTRIC,     /* interface: a dielectric has air in front */
    ORL_MATERIAL_FUNCTION_LOBES, /* function_lobes: plasfunc, metfunc, transfunc and the like */
    ORL_MATERIAL_PRISM,          /* prism: prism1, prism2 */
    ORL_MATERIAL_MIRROR,         /* the head alone: color on the front; the back is black */
    ORL_MATERIAL_BSDF,           /* bsdf_surface: BSDF, aBSDF */
    ORL_MATERIAL_LIGHT,          /* the head alone; sampled directly */
    ORL_MATERIAL_GLOW,           /* glow; sampled directly if max_radius is above 0 */
    ORL_MATERIAL_SPOTLIGHT,      /* spotlight: a light within a cone */
    ORL_MATERIAL_MIXTURE,        /* mixture: two materials of different kinds, or a sum */
    ORL_MATERIAL_ILLUM,          /* illum: a light that view rays see as another material */
    ORL_MATERIAL_MIST,           /* mist: a participating medium inside (built/scene.h) */
    ORL_MATERIAL_ANTIMATTER,     /* antimatter: removes surfaces inside it
                                    (geometry/antimatter/antimatter.h) */
};
enum { ORL_MATERIAL_KINDS = ORL_MATERIAL_ANTIMATTER + 1 };

/* ---- Kinds ----------------------------------------------------------------------------------- */

/*
 * Division of the light by plastic, metal, trans and function lobes: `specular` is reflected
 * specularly (white for plastic and trans), the rest takes the material's colour.
 */
struct orl_reflector_shares {
    double specular;             /* 0..1 */
    double transmitted;          /* trans: fraction of the light not reflected specularly, 0..1 */
    double transmitted_specular; /* trans: fraction of the transmitted light that is not diffuse */
};

/* Incident side of the diffuse reflection: both sides, or only the front or the back. */
enum orl_diffuse_side { ORL_DIFFUSE_SIDE_BOTH, ORL_DIFFUSE_SIDE_FRONT, ORL_DIFFUSE_SIDE_BACK };

/* Plastic, metal and trans, isotropic or not; head: color is the reflectance as written. */
struct orl_reflector {
    struct orl_reflector_shares shares;
    /* rms slope along the anisotropy axis and across it; equal: isotropic; 0: smooth */
    double roughness[2];
    struct orl_vec3 anisotropy_axis; /* plastic2 and the like: as written, not projected */
    struct orl_pattern
        *roughness_pattern;             /* factors of both roughnesses over the surface; or NULL */
    enum orl_diffuse_side diffuse_side; /* for terms of a sum: sides that reflect diffusely */
};

/* Lobes by functions or data (material/function_brdf/function_lobes.c). */
struct orl_function_lobes {
    struct orl_reflector_shares shares;
    struct orl_pattern *functions; /* BRDF values by direction (function_brdf.h) */
    bool tints_lobes;              /* reflection has the material's colour (metfunc) */
    bool is_whole_bsdf;            /* the functions are the whole BRDF and BTDF (BRTDfunc) */
};

/* ashik2; head: color is the diffuse reflectance. */
struct orl_ashikhmin {
    struct orl_rgb gloss; /* specular reflectance at the normal */
    double power[2];      /* exponents of the lobe, along the anisotropy axis and across it */
    struct orl_vec3 anisotropy_axis; /* as written, not projected */
};

/* Thin glass; head: the pattern is a factor of the transmitted light. */
struct orl_glass {
    struct orl_rgb transmissivity; /* as written (at normal incidence, one pass) */
    double ior;                    /* 1.52 unless written */
};

/* Diffuse reflectances of the front and of the back, and transmittance in both directions. */
struct orl_diffuse_parts {
    struct orl_rgb front, back, through;
};

/* Specular shares by functions of the angle (material/function_brdf/glazing.c). */
struct orl_glazing {
    struct orl_diffuse_parts diffuse;
    double transmitted;         /* upper bound of the direct transmittance */
    struct orl_pattern *angles; /* six functions of the angle */
};

struct orl_medium {
    struct orl_rgb transmissivity; /* per unit of length, 0..1 */
    double ior;
};

/* Surface between two clear media: dielectric, interface. */
struct orl_interface {
    struct orl_medium media[2]; /* behind the normal, in front of it */
};

struct orl_prism {
    struct orl_pattern *rays; /* directions of the outgoing rays (function_brdf.h) */
};

struct orl_bsdf_surface {
    struct orl_bsdf *bsdf;            /* one reference, owned */
    double thickness;                 /* as written, signed */
    struct orl_vec3 up;               /* as written, not projected */
    struct orl_diffuse_parts diffuse; /* added to the data (3, 6 or 9 reals) */
    uint32_t file;                    /* index into the parsed scene's files */
    bool peak;                        /* aBSDF: nearly direct transmission is taken as direct */
};

/* Head of all lights: color is the radiance. */
struct orl_glow {
    double max_radius; /* fourth argument */
};

struct orl_spotlight {
    struct orl_vec3 beam_axis; /* unit */
    double cos_cone;           /* cosine of the half angle */
    double focus;              /* distance of the beam's apex behind the lamp */
};

enum { ORL_SEEN_AS_ITSELF = -1, ORL_SEEN_AS_NOTHING = -2 };

struct orl_illum {
    struct orl_glass pane; /* transmits the light of suns and lamps; transmissivity 0: opaque */
    int32_t seen_as;       /* index of the material that view rays see, or ORL_SEEN_AS_NOTHING */
};

struct orl_mixture {
    /* the first material's share (a factor of 1, see patterns/pattern.h); NULL: the sum of both */
    struct orl_pattern *share;
    const struct orl_material *mixed; /* two materials; none of them has a BSDF */
};

struct orl_mist {
    struct orl_rgb extinction, scattering; /* coefficients, 1/m */
    double asymmetry;                      /* of its phase function (built/scene.h) */
};

struct orl_antimatter {
    const uint32_t *cut; /* materials that are removed inside it */
    size_t n_cut;
    int32_t lining; /* material of the inner face where it cuts a surface, or -1 */
};

/* ---- Materials ------------------------------------------------------------------------------- */

struct orl_material {
    enum orl_material_kind kind;
    int32_t sky; /* light, glow: index into skies that scales color, or -1 */
    char *name;
    struct orl_rgb color; /* reflectance as written, or radiance; 0 for kinds that have neither */
    struct orl_pattern *pattern; /* factor of color (material/patterns/pattern.h); or NULL */
    struct orl_pattern *texture; /* perturbs the normal (material/patterns/texture.h); or NULL */
    /* index + 1 of the material that this one copies, except for texture or window group; 0: none
     */
    uint32_t copy_of;
    uint32_t window_group; /* window group (surfaces.h), from 1; 0: none */
    union {
        /* The largest comes first: initialisers that leave the union out set all of it to 0. */
        struct orl_bsdf_surface bsdf_surface;
        struct orl_reflector reflector;
        struct orl_function_lobes function_lobes;
        struct orl_ashikhmin ashikhmin;
        struct orl_glass glass;
        struct orl_glazing glazing;
        struct orl_interface interface;
        struct orl_prism prism;
        struct orl_glow glow;
        struct orl_spotlight spotlight;
        struct orl_illum illum;
        struct orl_mixture mixture;
        struct orl_mist mist;
        struct orl_antimatter antimatter;
    } as;
};
_Static_assert(sizeof((struct orl_material *)0)->as == sizeof(struct orl_bsdf_surface),
               "the first member of the union is the largest");

/* ---- Structs of kinds ------------------------------------------------------------------------ */

/* Asserts in debug builds that a material has the struct that is read. */
static inline void orl_material_require(bool has)
{
#ifdef ORL_DEBUG
    assert(has);
#else
    (void)has;
#endif
}

/* Returns true for plastic, metal and trans. */
static inline bool orl_material_is_reflector(const struct orl_material *material)
{
    return material->kind == ORL_MATERIAL_PLASTIC || material->kind == ORL_MATERIAL_METAL ||
           material->kind == ORL_MATERIAL_TRANS;
}

static inline const struct orl_reflector *orl_reflector_of(const struct orl_material *material)
{
    orl_material_require(orl_material_is_reflector(material));
    return &material->as.reflector;
}

static inline const struct orl_function_lobes *
orl_function_lobes_of(const struct orl_material *material)
{
    orl_material_require(material->kind == ORL_MATERIAL_FUNCTION_LOBES);
    return &material->as.function_lobes;
}

static inline const struct orl_ashikhmin *orl_ashikhmin_of(const struct orl_material *material)
{
    orl_material_require(material->kind == ORL_MATERIAL_ASHIKHMIN);
    return &material->as.ashikhmin;
}

static inline const struct orl_glass *orl_glass_of(const struct orl_material *material)
{
    orl_material_require(material->kind == ORL_MATERIAL_GLASS);
    return &material->as.glass;
}

static inline const struct orl_glazing *orl_glazing_of(const struct orl_material *material)
{
    orl_material_require(material->kind == ORL_MATERIAL_GLAZING);
    return &material->as.glazing;
}

static inline const struct orl_interface *orl_interface_of(const struct orl_material *material)
{
    orl_material_require(material->kind == ORL_MATERIAL_DIELECTRIC);
    return &material->as.interface;
}

static inline const struct orl_prism *orl_prism_of(const struct orl_material *material)
{
    orl_material_require(material->kind == ORL_MATERIAL_PRISM);
    return &material->as.prism;
}

static inline const struct orl_bsdf_surface *
orl_bsdf_surface_of(const struct orl_material *material)
{
    orl_material_require(material->kind == ORL_MATERIAL_BSDF);
    return &material->as.bsdf_surface;
}

static inline const struct orl_glow *orl_glow_of(const struct orl_material *material)
{
    orl_material_require(material->kind == ORL_MATERIAL_GLOW);
    return &material->as.glow;
}

static inline const struct orl_spotlight *orl_spotlight_of(const struct orl_material *material)
{
    orl_material_require(material->kind == ORL_MATERIAL_SPOTLIGHT);
    return &material->as.spotlight;
}

static inline const struct orl_illum *orl_illum_of(const struct orl_material *material)
{
    orl_material_require(material->kind == ORL_MATERIAL_ILLUM);
    return &material->as.illum;
}

static inline const struct orl_mixture *orl_mixture_of(const struct orl_material *material)
{
    orl_material_require(material->kind == ORL_MATERIAL_MIXTURE);
    return &material->as.mixture;
}

static inline const struct orl_mist *orl_mist_of(const struct orl_material *material)
{
    orl_material_require(material->kind == ORL_MATERIAL_MIST);
    return &material->as.mist;
}

static inline const struct orl_antimatter *orl_antimatter_of(const struct orl_material *material)
{
    orl_material_require(material->kind == ORL_MATERIAL_ANTIMATTER);
    return &material->as.antimatter;
}

/* ---- Properties that any kind may be asked for ----------------------------------------------- */

/* Returns the BSDF, borrowed; NULL for other kinds. */
static inline struct orl_bsdf *orl_material_bsdf(const struct orl_material *material)
{
    return material->kind == ORL_MATERIAL_BSDF ? material->as.bsdf_surface.bsdf : NULL;
}

/* Returns a BSDF's thickness, signed; 0 for other kinds. */
static inline double orl_material_thickness(const struct orl_material *material)
{
    return material->kind == ORL_MATERIAL_BSDF ? material->as.bsdf_surface.thickness : 0;
}

/* Returns the distance of a spotlight's apex behind the lamp; 0 for other kinds. */
static inline double orl_material_focus(const struct orl_material *material)
{
    return material->kind == ORL_MATERIAL_SPOTLIGHT ? material->as.spotlight.focus : 0;
}

/* Returns the index of the material that views see in place of an illum, or ORL_SEEN_AS_NOTHING;
 * ORL_SEEN_AS_ITSELF for other kinds. */
static inline int32_t orl_material_seen_as(const struct orl_material *material)
{
    return material->kind == ORL_MATERIAL_ILLUM ? material->as.illum.seen_as : ORL_SEEN_AS_ITSELF;
}

/* Returns the two materials of a mixture; NULL for other kinds. */
static inline const struct orl_material *orl_material_mixed(const struct orl_material *material)
{
    return material->kind == ORL_MATERIAL_MIXTURE ? material->as.mixture.mixed : NULL;
}

/* Returns the pattern of the roughness of plastic, metal and trans, or NULL. */
static inline struct orl_pattern *
orl_material_roughness_pattern(const struct orl_material *material)
{
    return orl_material_is_reflector(material) ? material->as.reflector.roughness_pattern : NULL;
}

/* Returns the index of the material that this one is a copy of, or its own index. */
static inline uint32_t orl_material_origin(const struct orl_material *material, uint32_t index)
{
    return material->copy_of > 0 ? material->copy_of - 1 : index;
}

/* Returns true if two materials are equal except for name, window group and origin. */
bool orl_material_same(const struct orl_material *a, const struct orl_material *b);

#endif
