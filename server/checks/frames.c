#include "checks/frames.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/uio.h>

bool orl_frame_send(int fd, enum orl_frame_kind kind, const void *data, size_t size)
{
    char first = (char)kind;
    struct iovec parts[2] = {{&first, 1}, {(void *)(uintptr_t)data, size}};
    const struct msghdr message = {.msg_iov = parts, .msg_iovlen = size > 0 ? 2 : 1};
    ssize_t sent;
    do
        sent = sendmsg(fd, &message, MSG_NOSIGNAL);
    while (sent < 0 && errno == EINTR);
    return sent >= 0;
}

bool orl_frame_send_text(int fd, enum orl_frame_kind part, enum orl_frame_kind end,
                         const char *text, size_t size)
{
    for (; size > ORL_FRAME_BYTES; text += ORL_FRAME_BYTES, size -= ORL_FRAME_BYTES)
        if (!orl_frame_send(fd, part, text, ORL_FRAME_BYTES))
            return false;
    return orl_frame_send(fd, end, text, size);
}

bool orl_frame_text_add(struct orl_frame_text *text, const char *data, size_t size, size_t most)
{
    if (size > most - text->size)
        return false;
    if (text->size + size + 1 > text->capacity) {
        const size_t capacity = 2 * text->capacity + size + 1;
        char *grown = realloc(text->text, capacity);
        if (!grown)
            return false;
        text->text = grown;
        text->capacity = capacity;
    }
    if (size > 0)
        memcpy(text->text + text->size, data, size);
    text->size += size;
    text->text[text->size] = '\0';
    return true;
}
