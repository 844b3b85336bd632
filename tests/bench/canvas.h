/*
 * A picture to look at: eight bits a channel, sRGB, put together of parts.
 */
#ifndef ORL_TESTS_BENCH_CANVAS_H
#define ORL_TESTS_BENCH_CANVAS_H

struct bench_canvas {
    int width, height;
    unsigned char *pixels; /* from the top left, three bytes each; owned */
};

/* White all over. */
struct bench_canvas bench_canvas_new(int width, int height);
void bench_canvas_done(struct bench_canvas *canvas);

/* A place's colour, parts 0 to 1, linear. */
void bench_canvas_set(struct bench_canvas *canvas, int x, int y, const double rgb[3]);

/* Blue where share is -1 and below, white at 0, red from 1 on. */
void bench_canvas_set_share(struct bench_canvas *canvas, int x, int y, double share);

/*
 * A radiance as the eye might see it where `average` is the mean: compressed after Reinhard et al.
 * 2002, the same for every picture with the same average.
 */
void bench_canvas_set_radiance(struct bench_canvas *canvas, int x, int y, const double rgb[3],
                               double average);

void bench_canvas_write(const struct bench_canvas *canvas, const char *path);

#endif
