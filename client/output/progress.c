#include "output/terminal.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <time.h>
#include <unistd.h>

double orl_clock_s(void *unused)
{
    struct timespec now;
    (void)unused;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void orl_format_duration(double seconds, char *ret_text, size_t size)
{
    const double rounded = seconds < 0 ? -1 : ceil(seconds);
    if (!(rounded >= 0) || rounded > 1e7)
        snprintf(ret_text, size, "?");
    else if (rounded < 60)
        snprintf(ret_text, size, "%.0f s", rounded);
    else if (rounded < 3600)
        snprintf(ret_text, size, "%d:%02d", (int)rounded / 60, (int)rounded % 60);
    else
        snprintf(ret_text, size, "%d:%02d:%02d", (int)rounded / 3600, (int)rounded / 60 % 60,
                 (int)rounded % 60);
}

void orl_format_amount(double amount, const char *unit, char *ret_text, size_t size)
{
    static const char *const prefix[] = {"", "k", "M", "G", "T"};
    size_t step = 0;
    while (amount >= 999.95 && step + 1 < sizeof prefix / sizeof prefix[0]) {
        amount /= 1000;
        step++;
    }
    snprintf(ret_text, size, "%.*f%s%s%s", step ? 1 : 0, amount, *unit || step ? " " : "",
             prefix[step], unit);
}

void orl_progress_start(struct orl_progress_line *progress)
{
    *progress = (struct orl_progress_line){
        .terminal = isatty(STDERR_FILENO) != 0, .drawn_s = -1, .tenth = -1};
}

void orl_progress_end(struct orl_progress_line *progress)
{
    if (progress->line_open)
        fputs("\r\033[K", stderr);
    progress->line_open = false;
}

void orl_progress_note(struct orl_progress_line *progress, const char *format, ...)
{
    va_list args;
    orl_progress_end(progress);
    va_start(args, format);
    vfprintf(stderr, format, args);
    va_end(args);
    fputc('\n', stderr);
}

static void draw_bar(struct orl_progress_line *progress, const char *stage, double fraction,
                     const char *eta)
{
    struct winsize window;
    char bar[61];
    int columns = 80, width, filled;
    if (ioctl(STDERR_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col > 0)
        columns = window.ws_col;
    /* Text beside the bar takes about 40 columns; a very narrow window gets no bar. */
    width = columns - 40;
    width = width < 0 ? 0 : width > 40 ? 40 : width;
    filled = (int)(fraction * width);
    memset(bar, '#', (size_t)filled);
    memset(bar + filled, '.', (size_t)(width - filled));
    bar[width] = '\0';
    fprintf(stderr, "\r[%s] %3.0f %%  %-8s ETA %s\033[K", bar, 100 * fraction, stage, eta);
    fflush(stderr);
    progress->line_open = true;
}

void orl_progress_show(struct orl_progress_line *progress, const char *stage, double fraction,
                       double eta_s)
{
    const double now_s = orl_clock_s(NULL);
    const bool new_stage = strncmp(stage, progress->stage, sizeof progress->stage - 1) != 0;
    char eta[32];
    fraction = fraction > 0 ? fmin(fraction, 1) : 0; /* a NaN counts as 0 */
    int tenth = (int)(10 * fraction);
    orl_format_duration(eta_s, eta, sizeof eta);
    if (progress->terminal) {
        if (!new_stage && now_s - progress->drawn_s < 0.1)
            return;
        draw_bar(progress, stage, fraction, eta);
    } else if (new_stage || tenth != progress->tenth) {
        fprintf(stderr, "%3.0f %%  %-8s ETA %s\n", 100 * fraction, stage, eta);
    }
    progress->drawn_s = now_s;
    progress->tenth = tenth;
    snprintf(progress->stage, sizeof progress->stage, "%s", stage);
}

void orl_progress_show_local(struct orl_progress_line *progress, const char *stage, double fraction,
                             double left_s)
{
    const double now_s = orl_clock_s(NULL);
    orl_eta_update(&progress->eta, left_s, now_s);
    orl_progress_show(progress, stage, fraction, orl_eta_s(&progress->eta, now_s));
}
