/*
 * What daemon and child say to each other: packets over a socket, each a byte that says what it is
 * and what belongs to it. A packet comes whole or not at all, whoever dies meanwhile.
 *
 *     daemon -> child   REQUEST ..., REQUEST_END: a JSON text, in parts
 *     child -> daemon   FILE (its name), DATA ..., FILE, ...: files unpacked
 *                       VERDICT ..., VERDICT_END: a JSON text, in parts
 *     keeper -> daemon  END: struct orl_child_end, when the child is no more
 *
 * Threads: any; one at a time for each socket. Errors: false, errno says why.
 */
#ifndef ORL_SERVER_CHECKS_FRAMES_H
#define ORL_SERVER_CHECKS_FRAMES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum orl_frame_kind {
    ORL_FRAME_REQUEST = 'r',
    ORL_FRAME_REQUEST_END = 'R',
    ORL_FRAME_FILE = 'f',
    ORL_FRAME_DATA = 'd',
    ORL_FRAME_VERDICT = 'v',
    ORL_FRAME_VERDICT_END = 'V',
    ORL_FRAME_END = 'E',
};

enum { ORL_FRAME_BYTES = 64 << 10 }; /* at most, the first byte left out */

struct orl_child_end {
    int32_t status; /* as waitpid has it */
    int32_t pid;
    uint64_t peak_bytes; /* resident */
    uint64_t cpu_ms;     /* user and system time */
};

/* Waits until there is room. */
bool orl_frame_send(int fd, enum orl_frame_kind kind, const void *data, size_t size);
/* Likewise, in as many packets as it takes; the last is of the kind end. */
bool orl_frame_send_text(int fd, enum orl_frame_kind part, enum orl_frame_kind end,
                         const char *text, size_t size);

/* A text that comes in parts. */
struct orl_frame_text {
    char *text; /* owned; free() */
    size_t size, room;
};
/* Appends; ends with a NUL behind. False: more than most, or no memory. */
bool orl_frame_text_add(struct orl_frame_text *text, const char *data, size_t size, size_t most);

#endif
