#include "output/terminal.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "output/style.h"

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
    *progress = (struct orl_progress_line){.terminal = orl_terminal_can_rewrite(stderr),
                                           .drawn_s = -1,
                                           .tenth = -1,
                                           .rate_from_s = -1};
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

void orl_progress_warn(struct orl_progress_line *progress, const char *warning)
{
    orl_progress_note(progress, "%swarning:%s %s", orl_style_begin(stderr, ORL_STYLE_WARNING),
                      orl_style_end(stderr), warning);
}

/* Measures the rate over the last seconds, in percent per second; 0: not known yet. */
static double measure_rate(struct orl_progress_line *progress, double fraction, double now_s)
{
    const double span_s = 5;
    if (progress->rate_from_s < 0 || fraction < progress->rate_from) {
        progress->rate_from_s = now_s;
        progress->rate_from = fraction;
        progress->rate = 0;
    }
    const double elapsed_s = now_s - progress->rate_from_s;
    if (elapsed_s < 1)
        return progress->rate;
    progress->rate = 100 * (fraction - progress->rate_from) / elapsed_s;
    if (elapsed_s > span_s) {
        progress->rate_from_s = now_s;
        progress->rate_from = fraction;
    }
    return progress->rate;
}

/* Formats "3.2 %/s" or "4.8 %/min", or "" if unknown. */
static void format_rate(double rate, char *ret_text, size_t size)
{
    if (!(rate > 0))
        ret_text[0] = '\0';
    else if (rate >= 1)
        snprintf(ret_text, size, "%.1f %%/s", rate);
    else
        snprintf(ret_text, size, "%.2g %%/min", 60 * rate);
}

/* Rewrites the line: a bar, then the text. The last column stays free, because some terminals wrap
 * a line that fills it. A window without room for both gets the text, cut to its width. */
static void draw_bar(struct orl_progress_line *progress, double fraction, const char *text)
{
    enum { LEAST = 10, MOST = 40, AROUND = 3 };
    char bar[MOST + 1];
    const int free_columns = orl_terminal_columns(stderr) - 1, length = (int)strlen(text);
    int width = free_columns - length - AROUND;
    width = width < LEAST ? 0 : width > MOST ? MOST : width;
    const int filled = (int)(fraction * width);
    memset(bar, '#', (size_t)filled);
    memset(bar + filled, '.', (size_t)(width - filled));
    bar[width] = '\0';
    fputc('\r', stderr);
    if (width > 0)
        fprintf(stderr, "[%s%.*s%s%s] ", orl_style_begin(stderr, ORL_STYLE_GOOD), filled, bar,
                orl_style_end(stderr), bar + filled);
    fprintf(stderr, "%.*s\033[K", free_columns, text);
    fflush(stderr);
    progress->line_open = true;
}

void orl_progress_show(struct orl_progress_line *progress, const char *stage, double fraction,
                       double eta_s)
{
    const double now_s = orl_clock_s(NULL);
    const bool new_stage = strncmp(stage, progress->stage, sizeof progress->stage - 1) != 0;
    char eta[32], rate[32], text[160];
    fraction = fraction > 0 ? fmin(fraction, 1) : 0; /* a NaN counts as 0 */
    const int tenth = (int)(10 * fraction);
    if (progress->terminal && !new_stage && now_s - progress->drawn_s < 0.1)
        return;
    orl_format_duration(eta_s, eta, sizeof eta);
    format_rate(measure_rate(progress, fraction, now_s), rate, sizeof rate);
    snprintf(text, sizeof text, "%3.0f %%  %-8s ETA %s%s%s", 100 * fraction, stage, eta,
             *rate ? "  " : "", rate);
    if (progress->terminal)
        draw_bar(progress, fraction, text);
    else if (new_stage || tenth != progress->tenth)
        fprintf(stderr, "%s\n", text);
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
