/* The oracle's ops (spec/oracle.md) in plain C11, as firmware would compute them: libm, no palpate, and no double unless asked for.

       gcc -std=c11 -O2 -ffp-contract=off -DREAL=float adapter.c -o adapter -ljansson -lm
       palpate-conform --profile f32 -- ./adapter

   REAL, double (profile f64) or float (profile f32), is the precision of every number, sum and function: <tgmath.h> takes erfcf for
   erfc where the argument is a float. The servo kernel needs -ffp-contract=off: fused operations give other bits. */
#define _POSIX_C_SOURCE 200809L
#ifndef REAL
#define REAL double
#endif
#include "oracle_lines.h"

#include <float.h>
#include <stdint.h>
#include <tgmath.h>

#define EPSILON (sizeof(REAL) == sizeof(float) ? (REAL)FLT_EPSILON : (REAL)DBL_EPSILON)
static const REAL ROOT_2 = 1.41421356237309504880, ROOT_2_PI = 2.50662827463100050242;

/* ---- The normal law ---- */

/* erfc keeps all digits of a small lower tail; 1 − erf would lose them. */
static REAL phi(REAL x) { return erfc(-x / ROOT_2) / 2; }

/* Φ(x) − p, near the centre without rounding beside ½. */
static REAL excess(REAL x, REAL p) { return 4 * p < 1 ? phi(x) - p : erf(x / ROOT_2) / 2 - (2 * p - 1) / 2; }

/* Hastings's approximation (Abramowitz and Stegun 26.2.23) is within 4.5e-4; a Halley step makes an error e to (x² + 2)/12 e³,
   so two of them leave rounding alone. */
static REAL quantile(REAL p) {
    static const REAL a[] = {2.515517, 0.802853, 0.010328}, b[] = {1.432788, 0.189269, 0.001308};
    if (2 * p > 1) return -quantile(1 - p);
    REAL t = sqrt(-2 * log(p)), x = (a[0] + t * (a[1] + t * a[2])) / (1 + t * (b[0] + t * (b[1] + t * b[2]))) - t;
    for (int step = 0; step < 2; step++) {
        REAL newton = excess(x, p) * ROOT_2_PI * exp(x * x / 2);
        x -= newton / (1 + x * newton / 2);
    }
    return x;
}

static void normal_cdf(void) { give("p", phi(number("x"))); }
static void normal_quantile(void) { give("x", quantile(probability("p"))); }
static void two_afc(void) { give("p_correct", phi(not_negative("gamma") / ROOT_2)); }
static void gamma_from_two_afc(void) { give("gamma", ROOT_2 * quantile(probability("p_correct"))); }

/* ---- Thresholds and rates ---- */

static void error_rates(void) {
    REAL gamma = not_negative("gamma"), eta = number("eta");
    give("false_alarm", gamma > 0 ? phi(-eta / gamma - gamma / 2) : eta <= 0);
    give("miss", gamma > 0 ? phi(eta / gamma - gamma / 2) : eta > 0);
}

static void roc(void) {
    REAL gamma = not_negative("gamma");
    List rates = list("false_alarm");
    if (rates.n == 0) refuse("bad_argument", "no rates");
    for (size_t i = 0; i < rates.n; i++) {
        REAL rate = rates.at[i];
        if (rate < 0 || rate > 1) refuse("out_of_range", "a rate is not between 0 and 1");
        rates.at[i] = rate == 0 ? 1 : rate == 1 ? 0 : phi(-quantile(rate) - gamma);
    }
    give_list("miss", rates);
    give("auc", phi(gamma / ROOT_2));
}

static void threshold(void) {
    const char *criterion = text("criterion");
    if (is(criterion, "map") || is(criterion, "bayes")) {
        REAL prior = probability("prior_h1"), odds = (1 - prior) / prior;
        if (is(criterion, "bayes")) {
            REAL alarm = number("c10") - number("c00"), miss = number("c01") - number("c11");
            if (alarm <= 0 || miss <= 0) refuse("out_of_range", "a wrong decision must cost more than a right one");
            odds *= alarm / miss;
        }
        give("eta", log(odds));
    } else if (is(criterion, "neyman_pearson_miss")) {
        REAL gamma = not_negative("gamma");
        give("eta", gamma * (gamma / 2 + quantile(probability("max_miss"))));
    } else if (is(criterion, "neyman_pearson_false_alarm")) {
        REAL gamma = positive("gamma");
        give("eta", -gamma * (gamma / 2 + quantile(probability("max_false_alarm"))));
    } else refuse("out_of_range", "no such criterion");
}

static REAL needed_gamma(void) {
    REAL gamma = -quantile(probability("max_false_alarm")) - quantile(probability("max_miss"));
    return gamma > 0 ? gamma : 0;
}

static void required_gamma(void) { give("gamma", needed_gamma()); }

static void noise_budget(void) {
    REAL gamma = needed_gamma(), total = positive("signal_n") / gamma, used = 0;
    List sources = list("sources_n");
    for (size_t i = 0; i < sources.n; i++) {
        if (sources.at[i] < 0) refuse("out_of_range", "a source is below 0");
        used = hypot(used, sources.at[i]);
    }
    give("gamma", gamma);
    give("total_allowed_n", total);
    give("remaining_n", total > used ? sqrt((total - used) * (total + used)) : 0);
}

/* ---- The statistic ---- */

static REAL dot(const REAL *a, const REAL *b, size_t n) {
    REAL sum = 0;
    for (size_t i = 0; i < n; i++) sum += a[i] * b[i];
    return sum;
}

/* Of one channel: the root mean square of Δ, and γ of the channel. */
static REAL filter(List delta, REAL sd, const char *b, const char *sigma) {
    REAL norm = sqrt(dot(delta.at, delta.at, delta.n)), root = sqrt((REAL)delta.n);
    give(b, norm / root);
    give(sigma, sd / root);
    return norm / sd;
}

static void matched_filter(void) {
    List x = list("template_x"), y = series("template_y", x.n);
    REAL gamma_x = filter(x, positive("noise_sd_x"), "b_x", "sigma_x");
    REAL gamma_y = filter(y, positive("noise_sd_y"), "b_y", "sigma_y");
    give("gamma", hypot(gamma_x, gamma_y));
}

/* Of one channel: what it adds to Θ, and its γ. Y is 0 without a signal. */
static REAL channel(List record, List f0, List f1, REAL sd, const char *y, REAL *gamma) {
    REAL theta = 0, *delta = f1.at;
    for (size_t i = 0; i < record.n; i++) {
        record.at[i] -= f0.at[i];
        delta[i] -= f0.at[i];
        theta += (record.at[i] - delta[i] / 2) * delta[i];
    }
    REAL norm = sqrt(dot(delta, delta, record.n));
    give(y, norm > 0 ? dot(record.at, delta, record.n) / norm / sqrt((REAL)record.n) : 0);
    *gamma = norm / sd;
    return theta / sd / sd;
}

static void theta(void) {
    List x = list("observed_x"), y = series("observed_y", x.n), f0x = series("f0_x", x.n), f0y = series("f0_y", x.n);
    List f1x = series("f1_x", x.n), f1y = series("f1_y", x.n);
    REAL gamma_x, gamma_y, sum = channel(x, f0x, f1x, positive("noise_sd_x"), "y_x", &gamma_x);
    give("theta", sum + channel(y, f0y, f1y, positive("noise_sd_y"), "y_y", &gamma_y));
    give("gamma", hypot(gamma_x, gamma_y));
}

/* Row by row: L of K = L Lᵀ, and with it L⁻¹r and L⁻¹Δ. */
static void theta_colored(void) {
    List r = list("residual"), delta = series("template", r.n);
    size_t n = r.n;
    if (n % 2 == 1) refuse("bad_argument", "two channels have an even number of samples");
    const REAL *k = matrix("covariance", n, n);
    REAL *l = take(n * n), sum = 0, least = 4 * (REAL)(n + 2) * EPSILON, near = fmax((REAL)1e-12, 2 * EPSILON);
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < i; j++) {
            if (!(fabs(k[i * n + j] - k[j * n + i]) <= near * sqrt(k[i * n + i] * k[j * n + j])))
                refuse("out_of_range", "the covariance is not symmetric");
            l[i * n + j] = (k[i * n + j] - dot(l + i * n, l + j * n, j)) / l[j * n + j];
        }
        REAL pivot = k[i * n + i] - dot(l + i * n, l + i * n, i);
        if (!(k[i * n + i] > 0 && pivot > least * k[i * n + i])) refuse("out_of_range", "the covariance is not positive definite");
        l[i * n + i] = sqrt(pivot);
        r.at[i] = (r.at[i] - dot(l + i * n, r.at, i)) / l[i * n + i];
        delta.at[i] = (delta.at[i] - dot(l + i * n, delta.at, i)) / l[i * n + i];
    }
    for (size_t i = 0; i < n; i++) sum += (r.at[i] - delta.at[i] / 2) * delta.at[i];
    give("theta", sum);
    give("gamma", sqrt(dot(delta.at, delta.at, n)));
}

/* Of one channel, added to Θ of every shift. */
static void slide(List record, List delta, REAL sd, List theta) {
    for (size_t shift = 0; shift < theta.n; shift++) {
        REAL sum = 0;
        for (size_t i = 0; i < delta.n; i++) sum += (record.at[shift + i] - delta.at[i] / 2) * delta.at[i];
        theta.at[shift] += sum / sd / sd;
    }
}

static void scan(void) {
    List x = list("residual_x"), y = series("residual_y", x.n), dx = list("template_x"), dy = series("template_y", dx.n);
    if (dx.n > x.n) refuse("bad_argument", "the template is longer than the record");
    size_t shifts = x.n - dx.n + 1, first = 0;
    List theta = {shifts, memset(take(shifts), 0, shifts * sizeof(REAL))};
    slide(x, dx, positive("noise_sd_x"), theta);
    slide(y, dy, positive("noise_sd_y"), theta);
    for (size_t shift = 1; shift < shifts; shift++)
        if (theta.at[shift] > theta.at[first]) first = shift;
    give_list("theta", theta);
    give("max_theta", theta.at[first]);
    give_whole("argmax", first);
}

/* ---- The force table ---- */

/* The last cell that begins at or before `x`, or the first; outside of the axis the fraction is outside of [0, 1]. */
static size_t locate(List knots, REAL x, REAL *fraction) {
    size_t cell = 0;
    while (cell + 2 < knots.n && knots.at[cell + 1] <= x) cell++;
    *fraction = (x - knots.at[cell]) / (knots.at[cell + 1] - knots.at[cell]);
    return cell;
}

static List axis(const char *name) {
    List knots = list(name);
    if (knots.n < 2) refuse("bad_argument", "an axis has fewer than two knots");
    for (size_t i = 1; i < knots.n; i++)
        if (!(knots.at[i] > knots.at[i - 1])) refuse("out_of_range", "an axis does not increase");
    return knots;
}

static void interpolate(void) {
    List depths = axis("depths_m"), laterals = axis("laterals_m");
    const REAL *table = matrix("table_n", depths.n, laterals.n);
    REAL s, t;
    size_t row = locate(depths, number("depth_m"), &s), column = locate(laterals, number("lateral_m"), &t);
    const REAL *above = table + row * laterals.n + column, *below = above + laterals.n;
    give("force_n", (1 - s) * ((1 - t) * above[0] + t * above[1]) + s * ((1 - t) * below[0] + t * below[1]));
}

/* ---- The servo kernel's table: floats to the bit, in this order of operations (VEC-011) ---- */

static float single_of(const json_t *value) {
    const char *digits = json_is_string(value) ? json_string_value(value) : "";
    if (strlen(digits) != 10 || strncmp(digits, "0x", 2) != 0 || strspn(digits + 2, "0123456789abcdef") != 8)
        refuse("bad_argument", "expected 0x and eight hexadecimal digits");
    union { uint32_t bits; float number; } both = {(uint32_t)strtoul(digits, NULL, 16)};
    return both.number;
}

static void give_bits(const char *name, float value) {
    union { float number; uint32_t bits; } both = {value};
    json_object_set_new(call.ok, name, json_sprintf("0x%08lx", (unsigned long)both.bits));
}

static List servo_knots(const char *name) {
    List knots = list(name);
    int fits = 2 <= knots.n && knots.n <= 1024;
    for (size_t i = 0; i < knots.n; i++)
        fits = fits && fabs(knots.at[i]) <= 1 && (i == 0 || (float)knots.at[i] - (float)knots.at[i - 1] >= 1e-6f);
    if (!fits) refuse("out_of_range", "expected 2 to 1024 knots within 1 m, each at least 1 um above the one before");
    return knots;
}

/* One cell beyond the axis at most. */
static size_t servo_locate(List knots, float x, float *fraction) {
    size_t cell = 0;
    while (cell + 2 < knots.n && (float)knots.at[cell + 1] <= x) cell++;
    float start = (float)knots.at[cell], end = (float)knots.at[cell + 1];
    float low = x < (float)knots.at[0] ? -1 : x >= (float)knots.at[knots.n - 1] ? 1 : 0;
    *fraction = fminf(fmaxf((x - start) * (1 / (end - start)), low), low + 1);
    return cell;
}

static float blend(float a, float b, float t) {
    float value = (1 - t) * a + t * b;
    return t < 0 || t > 1 ? value : fminf(fmaxf(value, fminf(a, b)), fmaxf(a, b));
}

static void servo_axis(void) {
    float fraction;
    give_whole("cell", servo_locate(servo_knots("knots"), single_of(argument("coordinate_bits")), &fraction));
    give_bits("fraction_bits", fraction);
}

static void servo_interpolate(void) {
    List depths = servo_knots("depth_knots"), laterals = servo_knots("lateral_knots");
    const json_t *table = argument("table_bits"), *row;
    float depth = single_of(argument("depth_bits")), lateral = single_of(argument("lateral_bits")), s, t, edge[2] = {0, 0};
    size_t i = servo_locate(depths, depth, &s), j = servo_locate(laterals, lateral, &t);
    if (json_array_size(table) != depths.n) refuse("bad_argument", "expected a row of forces for each depth");
    for (size_t k = 0; k < depths.n; k++) {
        row = json_array_get(table, k);
        if (json_array_size(row) != laterals.n) refuse("bad_argument", "expected a force for each lateral position");
        for (size_t c = 0; c < laterals.n; c++)
            if (!(fabsf(single_of(json_array_get(row, c))) <= 100)) refuse("out_of_range", "a force is beyond 100 N");
        if (k == i || k == i + 1) edge[k - i] = blend(single_of(json_array_get(row, j)), single_of(json_array_get(row, j + 1)), t);
    }
    give_bits("force_bits", depth < 0 ? 0 : blend(edge[0], edge[1], s));
}

/* ---- All of them ---- */

#define OP(name) {#name, name}

int main(void) {
    static const Op ops[] = {OP(normal_cdf), OP(normal_quantile), OP(two_afc), OP(gamma_from_two_afc), OP(error_rates), OP(roc),
                             OP(threshold), OP(required_gamma), OP(noise_budget), OP(matched_filter), OP(theta), OP(theta_colored),
                             OP(scan), OP(interpolate), OP(servo_axis), OP(servo_interpolate)};
    answer_lines(ops, COUNT(ops));
}
