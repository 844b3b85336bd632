#include <oriel/job/library_versions.h>

#include <OpenEXR/openexr.h>
#include <expat.h>
#include <nettle/version.h>
#include <png.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <tiffio.h>
#include <zlib.h>

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

/* Embree tells its version only through a device: major * 10000 + minor * 100 + patch. */
static void format_embree(struct orl_library_version *library)
{
    RTCDevice device = rtcNewDevice("threads=1");
    const int number = device ? (int)rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION) : 0;
    if (device)
        rtcReleaseDevice(device);
    if (number > 0)
        snprintf(library->version, sizeof library->version, "%d.%d.%d", number / 10000,
                 number / 100 % 100, number % 100);
}

static void format_openexr(struct orl_library_version *library)
{
    int major, minor, patch;
    const char *extra;
    exr_get_library_version(&major, &minor, &patch, &extra);
    snprintf(library->version, sizeof library->version, "%d.%d.%d", major, minor, patch);
}

/* Copies the first word of the text that begins with a digit: "LIBTIFF, Version 4.5.0" has the
 * version at its end, others have only that. */
static void copy_version(struct orl_library_version *library, const char *text)
{
    const char *at = strpbrk(text, "0123456789");
    if (at)
        snprintf(library->version, sizeof library->version, "%.*s", (int)strcspn(at, " \n"), at);
}

void orl_core_library_versions(struct orl_library_version ret_versions[ORL_CORE_LIBRARIES])
{
    char nettle[ORL_LIBRARY_VERSION_TEXT];
    snprintf(nettle, sizeof nettle, "%d.%d", nettle_version_major(), nettle_version_minor());
    const struct {
        const char *name, *text; /* NULL: formatted below */
    } libraries[ORL_CORE_LIBRARIES] = {
        {"Embree", NULL},
        {"OpenEXRCore", NULL},
        {"libpng", png_get_libpng_ver(NULL)},
        {"libtiff", TIFFGetVersion()},
        {"zlib", zlibVersion()},
        {"expat", XML_ExpatVersion()},
        {"libsodium", sodium_version_string()},
        {"Nettle", nettle},
    };
    for (int i = 0; i < ORL_CORE_LIBRARIES; i++) {
        ret_versions[i] = (struct orl_library_version){.name = libraries[i].name, .version = "?"};
        if (libraries[i].text)
            copy_version(&ret_versions[i], libraries[i].text);
    }
    format_embree(&ret_versions[0]);
    format_openexr(&ret_versions[1]);
}
