#include "scene/geometry/embree_device.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>

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
