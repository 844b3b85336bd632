#include "support/http_wire.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MOST = 1 << 20 };

static void send_all(int fd, const char *text, size_t size)
{
    while (size > 0) {
        const ssize_t n = write(fd, text, size);
        assert_true(n > 0);
        text += n;
        size -= (size_t)n;
    }
}

/* Receives until the connection ends. */
static char *receive_all(int fd, size_t *ret_size)
{
    char *text = malloc(MOST + 1);
    size_t size = 0;
    ssize_t n = 1;
    assert_non_null(text);
    while (n > 0 && size < MOST) {
        n = read(fd, text + size, MOST - size);
        size += n > 0 ? (size_t)n : 0;
    }
    text[size] = '\0';
    *ret_size = size;
    return text;
}

void http_wire_ask(const struct daemon *daemon, const char *line, const char *headers,
                   const char *body, struct reply *ret_reply)
{
    char *request = NULL;
    size_t size = 0;
    const int fd = daemon_dial(daemon);
    const int length = asprintf(&request, "%s HTTP/1.1\r\n%sConnection: close\r\n", line, headers);
    assert_true(length > 0);
    send_all(fd, request, (size_t)length);
    free(request);
    if (body) {
        char extent[64];
        snprintf(extent, sizeof extent, "Content-Length: %zu\r\n", strlen(body));
        send_all(fd, extent, strlen(extent));
    }
    send_all(fd, "\r\n", 2);
    if (body)
        send_all(fd, body, strlen(body));
    char *text = receive_all(fd, &size);
    close(fd);
    const char *end = strstr(text, "\r\n\r\n");
    if (strncmp(text, "HTTP/1.1 ", 9) != 0 || !end)
        fail_msg("%s: no answer: %.200s", line, text);
    memset(ret_reply, 0, sizeof *ret_reply);
    ret_reply->status = strtol(text + 9, NULL, 10);
    ret_reply->body = strdup(end + 4);
    ret_reply->size = strlen(end + 4);
    text[end + 2 - text] = '\0';
    ret_reply->headers = text;
    ret_reply->json = json_loads(ret_reply->body, 0, NULL);
}
