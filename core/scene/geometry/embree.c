#include "scene/geometry/intersect.h"

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/thread_pool.h>

#include "scene/geometry/embree_device.h"
#include "scene/geometry/instances.h"
#include "scene/geometry/packed.h"

static pthread_key_t key;
static bool has_key;
static pthread_once_t key_made = PTHREAD_ONCE_INIT;

static void release_device(void *device)
{
    rtcReleaseDevice(device);
}

static void make_key(void)
{
    has_key = pthread_key_create(&key, release_device) == 0;
}

static bool has_room(void)
{
    enum { ROOM = 256 << 10 };
    void *room = malloc(ROOM);
    free(room);
    return room != NULL;
}

/*
 * Creates a device with its error slot. Embree allocates a slot per thread and device when the
 * first error occurs; if that allocation fails, it throws in a place that ends the process. So the
 * slot is allocated before anything can fail.
 */
static RTCDevice new_device(void)
{
    if (!has_room())
        return NULL;
    rtcGetDeviceError(NULL);
    /* One build thread makes the hierarchy, and with it the order of ties, reproducible. */
    RTCDevice device = rtcNewDevice("threads=1");
    if (device && !has_room()) {
        rtcReleaseDevice(device);
        return NULL;
    }
    if (device)
        rtcGetDeviceError(device);
    return device;
}

/* Builds a scene of one triangle. If that fails, the scene must not be released. */
static bool build_trial_scene(RTCDevice device)
{
    /* Embree reads four floats at a time */
    static const float corners[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    static const unsigned indices[3] = {0, 1, 2};
    RTCScene scene = rtcNewScene(device);
    RTCGeometry mesh = scene ? rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE) : NULL;
    if (mesh) {
        rtcSetSharedGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, corners, 0,
                                   3 * sizeof(float), 3);
        rtcSetSharedGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices, 0,
                                   sizeof indices, 1);
        rtcCommitGeometry(mesh);
        rtcAttachGeometryByID(scene, mesh, 0);
        rtcReleaseGeometry(mesh);
        rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
        rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
        rtcCommitScene(scene);
    }
    const bool good = mesh && rtcGetDeviceError(device) == RTC_ERROR_NONE;
    if (scene && good)
        rtcReleaseScene(scene);
    return good;
}

RTCDevice orl_embree_device(void)
{
    pthread_once(&key_made, make_key);
    RTCDevice device = has_key ? pthread_getspecific(key) : NULL;
    if (device || !has_key)
        return device;
    device = new_device();
    if (device && build_trial_scene(device) && has_room() && pthread_setspecific(key, device) == 0)
        return device;
    if (device)
        rtcReleaseDevice(device);
    return NULL;
}

enum { GEOMETRY_TRIANGLES = 0, GEOMETRY_CURVED = 1, GEOMETRY_INSTANCE = 2 };

/* Callbacks for user geometry. Only single rays are traced, so N is 1. */
static void curved_bounds(const struct RTCBoundsFunctionArguments *args)
{
    const struct orl_geometry *geometry = args->geometryUserPtr;
    struct orl_vec3 low, high;
    struct orl_facet own;
    orl_quadric_bounds(orl_facet_get_own(geometry, geometry->n_facets - 1 - args->primID, &own),
                       &low, &high);
    /* Pads by more than an ulp of the scene's size, because conversion to float may round either
     * way. */
    const double pad = geometry->radius * 1e-6;
    args->bounds_o->lower_x = (float)(low.x - pad);
    args->bounds_o->lower_y = (float)(low.y - pad);
    args->bounds_o->lower_z = (float)(low.z - pad);
    args->bounds_o->upper_x = (float)(high.x + pad);
    args->bounds_o->upper_y = (float)(high.y + pad);
    args->bounds_o->upper_z = (float)(high.z + pad);
}

static bool curved_test(const struct orl_geometry *geometry, uint32_t primitive,
                        const struct RTCRay *ray, double *ret_t, struct orl_vec3 *ret_normal)
{
    struct orl_facet own;
    const struct orl_facet *facet =
        orl_facet_get_own(geometry, geometry->n_facets - 1 - primitive, &own);
    const struct orl_vec3 direction = orl_v3(ray->dir_x, ray->dir_y, ray->dir_z);
    /* In a prototype the direction is not unit: it is scaled by the instance's transform. */
    const double length = geometry->n_uses > 0 ? orl_length(direction) : 1;
    /* Facets without area are not part of this geometry. */
    if (!(facet->area > 0) ||
        !orl_quadric_intersect(facet, orl_v3(ray->org_x, ray->org_y, ray->org_z),
                               orl_scale(direction, 1 / length), length * (double)ray->tnear,
                               length * (double)ray->tfar, ret_t, ret_normal))
        return false;
    *ret_t /= length;
    return true;
}

static void curved_intersect(const struct RTCIntersectFunctionNArguments *args)
{
    struct RTCRayHit *rayhit = (struct RTCRayHit *)args->rayhit;
    struct orl_vec3 normal;
    double t;
    if (!args->valid[0] ||
        !curved_test(args->geometryUserPtr, args->primID, &rayhit->ray, &t, &normal))
        return;
    rayhit->ray.tfar = (float)t;
    rayhit->hit.geomID = args->geomID;
    rayhit->hit.primID = args->primID;
    rayhit->hit.instID[0] = args->context->instID[0];
}

static void curved_occluded(const struct RTCOccludedFunctionNArguments *args)
{
    struct RTCRay *ray = (struct RTCRay *)args->ray;
    struct orl_vec3 normal;
    double t;
    if (args->valid[0] && curved_test(args->geometryUserPtr, args->primID, ray, &t, &normal))
        ray->tfar = -INFINITY;
}

/* Fills Embree's index buffer with single triangles. */
static bool list_triangles(struct orl_geometry *geometry, RTCGeometry mesh)
{
    const size_t n = orl_geometry_count_triangles(geometry);
    uint32_t *const corners = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0,
                                                      RTC_FORMAT_UINT3, 3 * sizeof *corners, n);
    size_t at = 0;
    geometry->triangle_of_primitive = malloc((n + 1) * sizeof *geometry->triangle_of_primitive);
    if (!corners || !geometry->triangle_of_primitive)
        return false;
    for (size_t i = 0; i < orl_geometry_triangles_end(geometry); i++) {
        if (orl_triangle_is_unused(geometry, i))
            continue;
        for (unsigned k = 0; k < 3; k++)
            corners[3 * at + k] = orl_triangle_corner(geometry, i, k);
        geometry->triangle_of_primitive[at++] = (uint32_t)i;
    }
    return true;
}

static bool set_corners(const struct orl_geometry *geometry, RTCGeometry mesh)
{
    const size_t n = geometry->n_corners;
    if (geometry->packed) {
        rtcSetSharedGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                   geometry->packed->high, 0, sizeof *geometry->packed->high, n);
        return true;
    }
    float *vertices = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                              3 * sizeof(float), n);
    for (size_t i = 0; vertices && i < n; i++) {
        vertices[3 * i] = (float)geometry->corners[i].x;
        vertices[3 * i + 1] = (float)geometry->corners[i].y;
        vertices[3 * i + 2] = (float)geometry->corners[i].z;
    }
    return vertices != NULL;
}

/*
 * Large geometries pass quads to Embree as quads: half the memory of triangles, and faster. In
 * small ones triangles are faster.
 */
static int build_triangles(struct orl_geometry *geometry, RTCDevice device, RTCScene scene)
{
    const bool vast = orl_geometry_is_vast(geometry);
    RTCGeometry mesh =
        rtcNewGeometry(device, vast ? RTC_GEOMETRY_TYPE_QUAD : RTC_GEOMETRY_TYPE_TRIANGLE);
    if (!set_corners(geometry, mesh) || (!vast && !list_triangles(geometry, mesh))) {
        rtcReleaseGeometry(mesh);
        return ORL_ERR_NOMEM;
    }
    if (vast)
        rtcSetSharedGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4,
                                   geometry->quads, offsetof(struct orl_mesh_quad, corners),
                                   sizeof(struct orl_mesh_quad), geometry->n_quads);
    rtcCommitGeometry(mesh);
    rtcAttachGeometryByID(scene, mesh, GEOMETRY_TRIANGLES);
    rtcReleaseGeometry(mesh);
    return 0;
}

static void build_curved(struct orl_geometry *geometry, RTCDevice device, RTCScene scene,
                         unsigned count)
{
    RTCGeometry curved = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(curved, count);
    rtcSetGeometryUserData(curved, geometry);
    rtcSetGeometryBoundsFunction(curved, curved_bounds, NULL);
    rtcSetGeometryIntersectFunction(curved, curved_intersect);
    rtcSetGeometryOccludedFunction(curved, curved_occluded);
    rtcCommitGeometry(curved);
    rtcAttachGeometryByID(scene, curved, GEOMETRY_CURVED);
    rtcReleaseGeometry(curved);
}

static bool build_instances(const struct orl_geometry *geometry, RTCDevice device, RTCScene scene)
{
    for (size_t i = 0; i < geometry->n_instances; i++) {
        const struct orl_instance *const instance = &geometry->instance[i];
        RTCGeometry rtc_instance = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
        float rows[12];
        if (!rtc_instance)
            return false;
        for (size_t k = 0; k < 3; k++) {
            const double offsets[3] = {instance->to.offset.x, instance->to.offset.y,
                                       instance->to.offset.z};
            rows[4 * k] = (float)instance->to.row[k].x;
            rows[4 * k + 1] = (float)instance->to.row[k].y;
            rows[4 * k + 2] = (float)instance->to.row[k].z;
            rows[4 * k + 3] = (float)offsets[k];
        }
        rtcSetGeometryInstancedScene(rtc_instance, instance->prototype->scene);
        rtcSetGeometryTransform(rtc_instance, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, rows);
        rtcCommitGeometry(rtc_instance);
        rtcAttachGeometryByID(scene, rtc_instance, GEOMETRY_INSTANCE + (unsigned)i);
        rtcReleaseGeometry(rtc_instance);
    }
    return true;
}

/* Progress callback, which Embree calls many times while it builds. */
static bool continue_build(void *ctx, double fraction)
{
    const atomic_bool *cancel = ctx;
    (void)fraction;
    return !orl_is_cancelled(cancel);
}

static int refuse_build(enum RTCError failure, struct orl_error *err)
{
    if (failure == RTC_ERROR_CANCELLED)
        return orl_error_set(err, ORL_ERR_CANCELLED, "cancelled while building the scene");
    /* RTC_ERROR_UNKNOWN is an exception that Embree does not expect, such as a nested
     * out-of-memory. */
    if (failure == RTC_ERROR_OUT_OF_MEMORY || failure == RTC_ERROR_UNKNOWN)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory building the scene");
    return orl_error_set(err, ORL_ERR_INTERNAL, "Embree failed to build the scene (error %d)",
                         (int)failure);
}

int orl_embree_prepare(struct orl_error *err)
{
    return orl_embree_device() ? 0
                               : orl_error_set(err, ORL_ERR_NOMEM, "out of memory to start Embree");
}

int orl_embree_build(struct orl_geometry *geometry, const atomic_bool *cancel,
                     struct orl_error *err)
{
    const unsigned n_curved = (unsigned)geometry->n_quadrics;
    const int rc = orl_embree_prepare(err);
    if (rc)
        return rc;
    RTCDevice device = orl_embree_device();
    RTCScene scene = rtcNewScene(device);
    if (!scene)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory to start Embree");
    geometry->scene = scene;
    rtcGetDeviceError(device); /* discards errors of earlier scenes */
    geometry->curved = n_curved > 0;
    for (size_t i = 0; i < geometry->n_prototypes; i++)
        geometry->curved = geometry->curved || geometry->prototypes[i]->curved;
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
    if (geometry->n_quads > 0 && build_triangles(geometry, device, scene) < 0)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the scene's triangles");
    if (n_curved > 0)
        build_curved(geometry, device, scene, n_curved);
    if (!build_instances(geometry, device, scene))
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu instances",
                             geometry->n_instances);
    if (cancel)
        rtcSetSceneProgressMonitorFunction(scene, continue_build, (void *)(uintptr_t)cancel);
    rtcCommitScene(scene);
    const enum RTCError failure = rtcGetDeviceError(device);
    return failure == RTC_ERROR_NONE ? 0 : refuse_build(failure, err);
}

void orl_embree_free(struct orl_geometry *geometry)
{
    if (geometry->scene)
        rtcReleaseScene(geometry->scene);
    geometry->scene = NULL;
}

static inline void set_ray(struct RTCRay *ray, struct orl_vec3 origin, struct orl_vec3 direction,
                           double max_distance)
{
    ray->org_x = (float)origin.x;
    ray->org_y = (float)origin.y;
    ray->org_z = (float)origin.z;
    ray->tnear = 0.0F;
    ray->dir_x = (float)direction.x;
    ray->dir_y = (float)direction.y;
    ray->dir_z = (float)direction.z;
    ray->time = 0.0F;
    ray->tfar = (float)max_distance;
    ray->mask = 0xffffffffU;
    ray->id = 0;
    ray->flags = 0;
}

/* Embree's own assertion aborts the process for rays from beyond 1.8e18; nothing is hit from
 * there. */
static inline bool is_traceable(struct orl_vec3 origin, struct orl_vec3 direction)
{
    const double far = 1e18;
    return fabs(origin.x) < far && fabs(origin.y) < far && fabs(origin.z) < far &&
           isfinite(direction.x + direction.y + direction.z);
}

/* Returns orl_embree_hit.instance for an instance. */
static inline uint32_t instance_index(unsigned rtc_instance)
{
    return rtc_instance == RTC_INVALID_GEOMETRY_ID ? 0 : rtc_instance - GEOMETRY_INSTANCE + 1;
}

static inline uint32_t curved_facet(const struct orl_geometry *geometry, uint32_t instance,
                                    unsigned primitive)
{
    const struct orl_geometry *const of =
        instance > 0 ? geometry->instance[instance - 1].prototype : geometry;
    return (uint32_t)(of->n_facets - 1 - primitive);
}

/* Sets the triangle that was hit. For a quad, Embree's u + v exceeds 1 in the second half; both
 * are rounded. */
static inline void choose_triangle(const struct orl_geometry *geometry, unsigned primitive, float u,
                                   float v, struct orl_embree_hit *hit)
{
    const struct orl_geometry *const of =
        hit->instance > 0 ? geometry->instance[hit->instance - 1].prototype : geometry;
    if (of->triangle_of_primitive) {
        hit->index = of->triangle_of_primitive[primitive];
        return;
    }
    const float across = u + v - 1;
    hit->index = 2 * primitive + (across > 0);
    hit->seam = fabsf(across) < 1e-5F;
}

bool orl_embree_intersect(const struct orl_geometry *geometry, struct orl_vec3 origin,
                          struct orl_vec3 direction, double max_distance,
                          struct orl_embree_hit *ret_hit)
{
    struct RTCRayHit rayhit; /* sets only what Embree reads: this is in the innermost loop */
    if (!is_traceable(origin, direction))
        return false;
    set_ray(&rayhit.ray, origin, direction, max_distance);
    rayhit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rayhit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR >= 4
    rtcIntersect1(geometry->scene, &rayhit, NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(geometry->scene, &context, &rayhit);
#endif
    if (rayhit.hit.geomID == RTC_INVALID_GEOMETRY_ID)
        return false;
    ret_hit->distance = rayhit.ray.tfar;
    ret_hit->curved = rayhit.hit.geomID == GEOMETRY_CURVED;
    ret_hit->instance = instance_index(rayhit.hit.instID[0]);
    ret_hit->seam = false;
    if (ret_hit->curved)
        ret_hit->index = curved_facet(geometry, ret_hit->instance, rayhit.hit.primID);
    else
        choose_triangle(geometry, rayhit.hit.primID, rayhit.hit.u, rayhit.hit.v, ret_hit);
    return true;
}

/* Rays traced together by Embree's packets. */
enum { ABREAST = 8 };
struct packet {
    struct RTCRayHit8 rays;
    _Alignas(32) int valid[ABREAST];
};

static void fill_packet(const struct orl_ray *rays, size_t n, struct packet *packet)
{
    struct RTCRay8 *r = &packet->rays.ray;
    for (size_t i = 0; i < ABREAST; i++) {
        const struct orl_ray *ray = &rays[i < n ? i : 0];
        packet->valid[i] = i < n && is_traceable(ray->origin, ray->direction) ? -1 : 0;
        r->org_x[i] = (float)ray->origin.x;
        r->org_y[i] = (float)ray->origin.y;
        r->org_z[i] = (float)ray->origin.z;
        r->tnear[i] = 0.0F;
        r->dir_x[i] = (float)ray->direction.x;
        r->dir_y[i] = (float)ray->direction.y;
        r->dir_z[i] = (float)ray->direction.z;
        r->time[i] = 0.0F;
        r->tfar[i] = INFINITY;
        r->mask[i] = 0xffffffffU;
        r->id[i] = 0;
        r->flags[i] = 0;
        packet->rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
        packet->rays.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
}

static void trace_packet(const struct orl_geometry *geometry, bool alike, struct packet *packet)
{
#if RTC_VERSION_MAJOR >= 4
    struct RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.flags = alike ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    rtcIntersect8(packet->valid, geometry->scene, &packet->rays, &arguments);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags =
        alike ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    rtcIntersect8(packet->valid, geometry->scene, &context, &packet->rays);
#endif
}

void orl_embree_intersect_many(const struct orl_geometry *geometry, const struct orl_ray *rays,
                               size_t n, bool alike, struct orl_embree_hit *ret_hits,
                               bool *ret_found)
{
    struct packet packet;
    /* User geometry handles one ray at a time. */
    for (size_t i = 0; i < n && geometry->curved; i++)
        ret_found[i] = orl_embree_intersect(geometry, rays[i].origin, rays[i].direction, INFINITY,
                                            &ret_hits[i]);
    for (size_t first = 0; first < n && !geometry->curved; first += ABREAST) {
        fill_packet(rays + first, n - first, &packet);
        trace_packet(geometry, alike, &packet);
        for (size_t i = 0; i < ABREAST && first + i < n; i++) {
            ret_found[first + i] = packet.rays.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
            ret_hits[first + i] =
                (struct orl_embree_hit){.distance = (double)packet.rays.ray.tfar[i],
                                        .instance = instance_index(packet.rays.hit.instID[0][i])};
            if (ret_found[first + i])
                choose_triangle(geometry, packet.rays.hit.primID[i], packet.rays.hit.u[i],
                                packet.rays.hit.v[i], &ret_hits[first + i]);
        }
    }
}

bool orl_embree_occluded(const struct orl_geometry *geometry, struct orl_vec3 origin,
                         struct orl_vec3 direction, double max_distance)
{
    struct RTCRay ray;
    if (!is_traceable(origin, direction))
        return false;
    set_ray(&ray, origin, direction, max_distance);
#if RTC_VERSION_MAJOR >= 4
    rtcOccluded1(geometry->scene, &ray, NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(geometry->scene, &context, &ray);
#endif
    return ray.tfar < 0.0F;
}
