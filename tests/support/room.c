#include "support/room.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support/cli.h"

const struct orl_sensor room_sensors[ROOM_SENSORS] = {{{1, 3, 0}, {0, 0, 1}},
                                                      {{3, 3, 0}, {0, 0, 1}},
                                                      {{2, 4, 1.2}, {0, 0, 1}},
                                                      {{2, 4, 1.2}, {0, -1, 0}},
                                                      {{2, 3, 3}, {0, 0, -1}}};

const char room_flipped[] = ROOM_SKY ROOM_SUN ROOM_GREY ROOM_CLEAR
    "w polygon floor 0 0 12 0 5 0 4 5 0 4 0 0 0 0 0\n"
    "w polygon ceiling 0 0 12 4 0 3 4 5 3 0 5 3 0 0 3\n"
    "w polygon west 0 0 12 0 0 3 0 5 3 0 5 0 0 0 0\n"
    "w polygon east 0 0 12 4 5 0 4 5 3 4 0 3 4 0 0\n"
    "w polygon north 0 0 12 0 5 3 4 5 3 4 5 0 0 5 0\n"
    "w polygon south 0 0 30 1 0 1 1 0 2.5 3 0 2.5 3 0 1 1 0 1 0 0 0 4 0 0 4 0 3 0 0 3 0 0 0\n"
    "w polygon shelf 0 0 12 0 2.4 1 4 2.4 1 4 2 1 0 2 1\n" ROOM_PANE;

static struct orl_vec3 turned(const struct room_change *c, struct orl_vec3 v)
{
    const double s = sin(c->turn_deg * ORL_DEG_TO_RAD), k = cos(c->turn_deg * ORL_DEG_TO_RAD);
    return orl_v3(k * v.x - s * v.y, s * v.x + k * v.y, v.z);
}

static struct orl_vec3 moved(const struct room_change *c, struct orl_vec3 p)
{
    return orl_add(orl_scale(turned(c, p), c->scale), c->shift);
}

/* Writes the room's polygons with every vertex transformed. */
static void write_room(const struct room_change *c, char *ret_text, size_t size)
{
    struct orl_parsed_scene room =
        scene_parse_text(ROOM_GREY ROOM_CLEAR ROOM_SHELL ROOM_PANE, NULL, NULL);
    const struct orl_vec3 sun = turned(c, orl_v3(0, -1, 1));
    size_t at = (size_t)snprintf(ret_text, size,
                                 ROOM_SKY ROOM_GREY ROOM_CLEAR
                                 "void light l 0 0 3 1e6 1e6 1e6\n"
                                 "l source sun 0 0 4 %.17g %.17g %.17g .533\n",
                                 sun.x, sun.y, sun.z);
    for (size_t s = 0; s < room.n_surfaces; s++) {
        const struct orl_surface *surface = &room.surfaces[s];
        at += (size_t)snprintf(ret_text + at, size - at, "%s polygon %s 0 0 %u",
                               room.materials[surface->material].name, surface->name,
                               3 * surface->n_vertices);
        for (uint32_t v = 0; v < surface->n_vertices; v++) {
            const struct orl_vec3 p = moved(c, surface->vertices[v]);
            at += (size_t)snprintf(ret_text + at, size - at, " %.17g %.17g %.17g", p.x, p.y, p.z);
        }
        at += (size_t)snprintf(ret_text + at, size - at, "\n");
    }
    assert_true(at < size);
    orl_parsed_scene_done(&room);
}

void room_changed_lx(const struct room_change *change, uint64_t global, uint64_t seed,
                     double ret_lx[ROOM_SENSORS])
{
    struct orl_sensor places[ROOM_SENSORS];
    char text[16384];
    write_room(change, text, sizeof text);
    for (int i = 0; i < ROOM_SENSORS; i++)
        places[i] = (struct orl_sensor){moved(change, room_sensors[i].position),
                                        turned(change, room_sensors[i].direction)};
    scene_run_lx(&(struct scene_run){.scene = text,
                                     .sensors = places,
                                     .n_sensors = ROOM_SENSORS,
                                     .seed = seed,
                                     .global = global},
                 ret_lx);
}

struct room_bytes room_run_all(uint32_t threads, uint64_t seed)
{
    static const char view[] = "-vtv -vp 2 4.5 1.5 -vd 0 -1 0 -vu 0 0 1 -vh 70 -vv 55";
    char xml[2048], folder[64], path[512];
    struct room_bytes b;
    scene_uniform_bsdf(0.2, xml);
    cli_make_folder(folder);
    struct orl_result result = scene_run(
        &(struct scene_run){.scene = ROOM_SKY ROOM_SUN ROOM_GREY ROOM_BSDF ROOM_SHELL ROOM_PANE,
                            .resource_name = "pane.xml",
                            .resource_text = xml,
                            .sensors = room_sensors,
                            .n_sensors = ROOM_SENSORS,
                            .view = view,
                            .width = 32,
                            .height = 24,
                            .seed = seed,
                            .global = 30000,
                            .caustic = 30000,
                            .samples = 512,
                            .threads = threads,
                            .folder = folder});
    memcpy(b.lx, result.illuminance_lx, sizeof b.lx);
    b.health = result.health;
    scene_map_path(&result, folder, "global", path);
    b.data[0] = scene_read_bytes(path, &b.size[0]);
    scene_map_path(&result, folder, "caustic", path);
    b.data[1] = scene_read_bytes(path, &b.size[1]);
    snprintf(path, sizeof path, "%s/view.hdr", folder);
    b.data[2] = scene_read_bytes(path, &b.size[2]);
    orl_result_done(&result);
    cli_remove_folder(folder);
    return b;
}

void room_free_bytes(struct room_bytes *bytes)
{
    for (int i = 0; i < 3; i++)
        free(bytes->data[i]);
}

bool room_same_bytes(const struct room_bytes *a, const struct room_bytes *b)
{
    bool same = memcmp(a->lx, b->lx, sizeof a->lx) == 0 &&
                memcmp(&a->health, &b->health, sizeof a->health) == 0;
    for (int i = 0; i < 3; i++)
        same = same && a->size[i] == b->size[i] && memcmp(a->data[i], b->data[i], a->size[i]) == 0;
    return same;
}
