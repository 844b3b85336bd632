/* Sensor files: lines of "x y z dx dy dz". */
#include <stdlib.h>

#include <oriel/base/limits.h>

#include "fuzz/fuzz.h"
#include "run/request/job_inputs.h"

bool fuzz_sensors(const uint8_t *data, size_t size)
{
    struct orl_sensor *sensors = NULL;
    struct orl_error err = {0};
    size_t count = 0;
    const int code =
        orl_sensors_parse("sensors.txt", (const char *)data, size, &sensors, &count, &err);
    if (code < 0) {
        fuzz_check_error(code, &err);
        FUZZ_PROMISE(sensors == NULL && count == 0);
        return false;
    }
    FUZZ_PROMISE(count > 0 && count <= ORL_LIMIT_SENSORS);
    for (size_t i = 0; i < count; i++) {
        fuzz_check_finite(sensors[i].position);
        fuzz_check_unit(orl_normalize(sensors[i].direction));
    }
    free(sensors);
    return true;
}
