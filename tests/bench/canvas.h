/*
 * A picture of parts: eight bits per channel, sRGB.
 */
#ifndef ORL_TESTS_BENCH_CANVAS_H
#define ORL_TESTS_BENCH_CANVAS_H

struct bench_canvas {
    int width, height;
    unsigned char *pixels; /* from the top left, three bytes per pixel; owned */
};

/* Returns a white canvas. */
struct bench_canvas bench_canvas_new(int width, int height);
void bench_canvas_done(struct bench_canvas *canvas);

/* Sets a pixel's colour; components are 0 to 1, linear. */
void bench_canvas_set(struct bench_canvas *canvas, int x, int y, const double rgb[3]);

/* Sets a pixel by a diverging scale: blue for share <= -1, white at 0, red for share >= 1. */
void bench_canvas_set_share(struct bench_canvas *canvas, int x, int y, double share);

/*
 * Sets a pixel by tone mapping a radiance (Reinhard et al. 2002) for the mean `average`; pictures
 * with equal averages map alike.
 */
void bench_canvas_set_radiance(struct bench_canvas *canvas, int x, int y, const double rgb[3],
                               double average);

void bench_canvas_write(const struct bench_canvas *canvas, const char *path);

#endif
