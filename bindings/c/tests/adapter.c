/* The C library behind the oracle's lines (spec/oracle.md): `palpate-conform -- adapter` asks it the questions of the vectors.
   Needs jansson, which refuses what is no JSON. */
#include "palpate.h"

#include <jansson.h>
#include <math.h>
#include <setjmp.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(list) (sizeof(list) / sizeof((list)[0]))

/* The request in work: a refusal leaves it by `refused`, and what it took is given back at its end. */
static struct {
    json_t *args, *ok;
    size_t taken;
    void *memory[32];
    const char *code;
    json_error_t wrong;
    jmp_buf refused;
} call;

static _Noreturn void refuse(const char *code, const char *why) {
    if (why != call.wrong.text) snprintf(call.wrong.text, sizeof call.wrong.text, "%s", why);
    call.code = code;
    longjmp(call.refused, 1);
}

static void check(PalpateError error) {
    const char *code = error == PALPATE_ERROR_OVERFLOW ? "overflow" : "out_of_range";
    if (error != PALPATE_ERROR_OK) refuse(code, palpate_error_text(error));
}

/* Takes arguments apart as `json_unpack` does; all of them, and no other ones. */
#define ARGUMENTS(...) \
    if (json_unpack_ex(call.args, &call.wrong, JSON_STRICT, __VA_ARGS__)) refuse("bad_argument", call.wrong.text)

/* Memory until the end of the request; one entry more, so that a list without entries is there too. */
static void *take(size_t count, size_t size) {
    void *memory = calloc(count + 1, size);
    if (memory == NULL || call.taken == COUNT(call.memory)) refuse("failed", "out of memory");
    return call.memory[call.taken++] = memory;
}

static int is(const char *one, const char *other) { return strcmp(one, other) == 0; }
static size_t length_of(const json_t *list) {
    if (!json_is_array(list)) refuse("bad_argument", "expected a list");
    return json_array_size(list);
}

static void copy_numbers(const json_t *list, double *numbers, size_t count) {
    if (length_of(list) != count) refuse("bad_argument", "a list has another length than those beside it");
    for (size_t i = 0; i < count; i++) {
        if (!json_is_number(json_array_get(list, i))) refuse("bad_argument", "expected a list of numbers");
        numbers[i] = json_number_value(json_array_get(list, i));
    }
}

static double *numbers(const json_t *list, size_t count) {
    double *numbers = take(count, sizeof *numbers);
    copy_numbers(list, numbers, count);
    return numbers;
}

/* Rows of `columns` numbers, one after the other. */
static double *rows(const json_t *list, size_t columns) {
    size_t count = length_of(list);
    double *matrix = take(count * columns, sizeof *matrix);
    for (size_t row = 0; row < count; row++) copy_numbers(json_array_get(list, row), matrix + row * columns, columns);
    return matrix;
}

static PalpateSeries series(const json_t *lateral, const json_t *normal) {
    size_t samples = length_of(lateral);
    return (PalpateSeries){numbers(lateral, samples), numbers(normal, samples), samples};
}

static double number_of(const char *name) {
    const json_t *value = json_object_get(call.args, name);
    if (!json_is_number(value)) refuse("bad_argument", "an argument is missing, or no number");
    return json_number_value(value);
}

static long long whole(double value, double least, double most) {
    if (value != floor(value)) refuse("bad_argument", "expected a whole number");
    if (value < least || value > most) refuse("out_of_range", "a whole number is out of its range");
    return (long long)value;
}

static float float_of(const json_t *value) {
    const char *digits = json_is_string(value) ? json_string_value(value) : "";
    if (strlen(digits) != 10 || strncmp(digits, "0x", 2) != 0 || strspn(digits + 2, "0123456789abcdefABCDEF") != 8)
        refuse("bad_argument", "expected 0x and eight hexadecimal digits");
    union { uint32_t bits; float number; } both = {(uint32_t)strtoul(digits, NULL, 16)};
    return both.number;
}

static float *knots(const json_t *list) {
    size_t count = length_of(list);
    const double *from = numbers(list, count);
    float *knots = take(count, sizeof *knots);
    for (size_t i = 0; i < count; i++) knots[i] = (float)from[i];
    return knots;
}

static json_t *list_of(const double *numbers, size_t count) {
    json_t *list = json_array();
    for (size_t i = 0; i < count; i++) json_array_append_new(list, json_real(numbers[i]));
    return list;
}

static json_t *bits_of(float value) {
    union { float number; uint32_t bits; } both = {value};
    return json_sprintf("0x%08lx", (unsigned long)both.bits);
}

/* Ops from numbers to one or two numbers. */
#define OP(op, type, function) \
    static void op(const double *x, double *y) { \
        type found; \
        check(function); \
        memcpy(y, &found, sizeof found); \
    }
OP(normal_cdf, double, palpate_normal_cdf(x[0], &found))
OP(normal_quantile, double, palpate_normal_quantile(x[0], &found))
OP(two_afc, double, palpate_two_afc(x[0], &found))
OP(gamma_from_two_afc, double, palpate_gamma_from_two_afc(x[0], &found))
OP(required_gamma, double, palpate_required_gamma(x[0], x[1], &found))
OP(error_rates, PalpateErrorRates, palpate_error_rates(x[0], x[1], &found))
OP(chi_square_tail, PalpateTails, palpate_chi_square_tail(x[0], x[1], x[2], &found))
OP(student_tail, PalpateTails, palpate_student_tail(x[0], x[1], x[2], &found))
OP(f_tail, PalpateTails, palpate_f_tail(x[0], x[1], x[2], x[3], &found))

OP(map, double, palpate_map_threshold(x[0], &found))
OP(bayes, double, palpate_bayes_threshold(x[0], &(PalpateCosts){x[1], x[2], x[3], x[4]}, &found))
OP(bound_miss, double, palpate_neyman_pearson_miss_threshold(x[0], x[1], &found))
OP(bound_false_alarm, double, palpate_neyman_pearson_false_alarm_threshold(x[0], x[1], &found))
OP(wilson, PalpateInterval, palpate_wilson(whole(x[0], 0, 1e9), whole(x[1], 1, 1e9), x[2], &found))
OP(clopper_pearson, PalpateInterval, palpate_clopper_pearson(whole(x[0], 0, 1e9), whole(x[1], 1, 1e9), x[2], &found))

/* Where an op is several, the argument `choice` says which. */
static const struct {
    const char *op, *choice, *value, *from[5], *to[2];
    void (*function)(const double *x, double *y);
} plain[] = {
    {"normal_cdf", 0, 0, {"x"}, {"p"}, normal_cdf},
    {"normal_quantile", 0, 0, {"p"}, {"x"}, normal_quantile},
    {"two_afc", 0, 0, {"gamma"}, {"p_correct"}, two_afc},
    {"gamma_from_two_afc", 0, 0, {"p_correct"}, {"gamma"}, gamma_from_two_afc},
    {"required_gamma", 0, 0, {"max_false_alarm", "max_miss"}, {"gamma"}, required_gamma},
    {"error_rates", 0, 0, {"gamma", "eta"}, {"false_alarm", "miss"}, error_rates},
    {"chi_square_tail", 0, 0, {"x", "degrees", "noncentrality"}, {"lower", "upper"}, chi_square_tail},
    {"student_tail", 0, 0, {"x", "degrees", "noncentrality"}, {"lower", "upper"}, student_tail},
    {"f_tail", 0, 0, {"x", "numerator", "denominator", "noncentrality"}, {"lower", "upper"}, f_tail},
    {"threshold", "criterion", "map", {"prior_h1"}, {"eta"}, map},
    {"threshold", "criterion", "bayes", {"prior_h1", "c00", "c01", "c10", "c11"}, {"eta"}, bayes},
    {"threshold", "criterion", "neyman_pearson_miss", {"gamma", "max_miss"}, {"eta"}, bound_miss},
    {"threshold", "criterion", "neyman_pearson_false_alarm", {"gamma", "max_false_alarm"}, {"eta"}, bound_false_alarm},
    {"proportion_interval", "method", "wilson", {"successes", "trials", "confidence"}, {"lower", "upper"}, wilson},
    {"proportion_interval", "method", "clopper_pearson", {"successes", "trials", "confidence"}, {"lower", "upper"}, clopper_pearson},
};

static json_t *roc(void) {
    double gamma, auc;
    json_t *list;
    ARGUMENTS("{sF so}", "gamma", &gamma, "false_alarm", &list);
    size_t count = length_of(list);
    double *rates = numbers(list, count);
    if (count == 0) refuse("bad_argument", "false_alarm is empty");
    for (size_t i = 0; i < count; i++) check(palpate_roc_miss(gamma, rates[i], &rates[i]));
    check(palpate_two_afc(gamma, &auc));
    return json_pack("{so sf}", "miss", list_of(rates, count), "auc", auc);
}

static json_t *noise_budget(void) {
    double signal, alarm, miss;
    json_t *sources;
    ARGUMENTS("{sF sF sF so}", "signal_n", &signal, "max_false_alarm", &alarm, "max_miss", &miss, "sources_n", &sources);
    size_t count = length_of(sources);
    PalpateNoiseBudget budget;
    check(palpate_noise_budget(signal, alarm, miss, numbers(sources, count), count, &budget));
    return json_pack("{sf sf sf}", "gamma", budget.gamma, "total_allowed_n", budget.total_allowed_n, "remaining_n",
                     budget.remaining_n);
}

static json_t *matched_filter(void) {
    json_t *x, *y;
    PalpateComponents noise;
    ARGUMENTS("{so so sF sF}", "template_x", &x, "template_y", &y, "noise_sd_x", &noise.lateral, "noise_sd_y", &noise.normal);
    PalpateSeries template = series(x, y);
    PalpateFilter filter;
    check(palpate_matched_filter(&template, &noise, &filter));
    return json_pack("{sf sf sf sf sf}", "b_x", filter.b.lateral, "b_y", filter.b.normal, "sigma_x", filter.sigma.lateral,
                     "sigma_y", filter.sigma.normal, "gamma", filter.gamma);
}

static json_t *theta(void) {
    json_t *px, *py, *f0x, *f0y, *f1x, *f1y;
    PalpateComponents noise;
    ARGUMENTS("{so so so so so so sF sF}", "observed_x", &px, "observed_y", &py, "f0_x", &f0x, "f0_y", &f0y, "f1_x", &f1x, "f1_y",
              &f1y, "noise_sd_x", &noise.lateral, "noise_sd_y", &noise.normal);
    PalpateSeries observed = series(px, py), f0 = series(f0x, f0y), f1 = series(f1x, f1y);
    PalpateStatistic found;
    check(palpate_theta(&observed, &f0, &f1, &noise, &found));
    return json_pack("{sf sf sf sf}", "theta", found.theta, "y_x", found.y.lateral, "y_y", found.y.normal, "gamma", found.gamma);
}

static json_t *theta_colored(void) {
    json_t *r, *t, *k;
    ARGUMENTS("{so so so}", "residual", &r, "template", &t, "covariance", &k);
    size_t n = length_of(r), length = palpate_coloured_scratch(n);
    if (n % 2 == 1 || n > 1000 || length_of(k) != n) refuse("bad_argument", "expected an even number of samples, and a row for each");
    const double *residual = numbers(r, n), *template = numbers(t, n), *covariance = rows(k, n);
    PalpateThetaGamma found;
    check(palpate_theta_coloured(residual, template, covariance, n, take(length, sizeof(double)), length, &found));
    return json_pack("{sf sf}", "theta", found.theta, "gamma", found.gamma);
}

/* The logarithm of a sum, by the logarithms of its terms. */
static double log_sum(double a, double b) {
    double low = fmin(a, b), high = fmax(a, b);
    return low == -INFINITY ? high : high + log1p(exp(low - high));
}

static double positive(double value) {
    if (!(value > 0)) refuse("out_of_range", "a number that must be above 0 is not");
    return value;
}

/* The evidence of each class and signal, averaged as spec/oracle.md says. */
static json_t *robust_evidence(void) {
    const double shape_share = 0.15, amplitude_sd = 0.4;
    json_t *y, *r, *w, *c, *s, *rho, *pi, *b;
    ARGUMENTS("{so so so so so so so so}", "record", &y, "noise", &r, "weights", &w, "covariances", &c, "signals", &s, "sizes", &rho,
              "prior", &pi, "shape", &b);
    size_t n = length_of(y), classes = length_of(w), signals = length_of(rho), length = palpate_coloured_scratch(n);
    if (n > 200 || classes > 100 || signals > 1000) refuse("out_of_range", "too many modes, classes or signals");
    if (n * classes * signals == 0 || length_of(c) != classes * n || length_of(s) != signals || length_of(b) != n)
        refuse("bad_argument", "no modes, classes or signals, or not a row for each");
    const double *record = numbers(y, n), *noise = numbers(r, n), *weight = numbers(w, classes), *shape = rows(b, n);
    const double *covariances = rows(c, n), *means = rows(s, n), *size = numbers(rho, signals), *prior = numbers(pi, signals);
    double *sum = take(n * n, sizeof(double)), *scratch = take(length, sizeof(double)), *with = take(signals, sizeof(double));
    double whole = 0, total = 0, low = INFINITY, high = -INFINITY, totals[2] = {-INFINITY, -INFINITY}, best = -INFINITY, distance = 0;
    for (size_t i = 0; i < n; i++) positive(noise[i]);
    for (size_t k = 0; k < classes; k++) whole += positive(weight[k]);
    for (size_t k = 0; k < signals; k++) {
        if (prior[k] < 0) refuse("out_of_range", "a prior is below 0");
        total += prior[k], with[k] = -INFINITY;
        low = fmin(low, log(positive(size[k]))), high = fmax(high, log(size[k]));
    }
    if (fabs(total - 1) > 1e-9) refuse("out_of_range", "the priors do not add up to 1");
    double step = fmax((high - low) / 7, 1e-3);
    double *without = take(classes, sizeof(double)), *by_class = take(classes, sizeof(double));
    for (size_t class = 0; class < classes; class++) {
        double log_weight = log(weight[class] / whole), any = -INFINITY;
        for (size_t k = 0; k < signals; k++) {
            PalpateColouredEvidence found;
            for (int beside = 0; beside < 2; beside++) { /* Without the signal its shape is not uncertain. */
                double share = beside * shape_share * exp(low + step * round((log(size[k]) - low) / step));
                for (size_t i = 0; i < n * n; i++) sum[i] = covariances[class * n * n + i] + share * share * shape[i];
                for (size_t i = 0; i < n; i++) sum[i * n + i] += noise[i];
                check(palpate_evidence_coloured(record, means + k * n, sum, n, amplitude_sd, scratch, length, &found));
                double density = log_weight + (beside ? found.with : found.without);
                if (density > best) best = density, distance = beside ? found.distance_with : found.distance_without;
                if (!beside) without[class] = density;
                else with[k] = log_sum(with[k], density), any = log_sum(any, density + log(prior[k]));
            }
        }
        by_class[class] = any;
        totals[0] = log_sum(totals[0], without[class]), totals[1] = log_sum(totals[1], any);
    }
    return json_pack("{so so so sf sf}", "without", list_of(without, classes), "by_class", list_of(by_class, classes), "with",
                     list_of(with, signals), "theta", totals[1] - totals[0], "distance", distance);
}

static json_t *theta_nuisances(void) {
    json_t *r, *t, *others;
    const char *level;
    double bias, eta;
    ARGUMENTS("{so so so ss sF sF}", "residual", &r, "template", &t, "nuisances", &others, "level", &level, "bias", &bias, "eta", &eta);
    size_t n = length_of(r), count = length_of(others);
    if ((!is(level, "known") && !is(level, "unknown")) || count > 100) refuse("out_of_range", "level is unknown, or over 100 nuisances");
    double *residual = numbers(r, n), *template = numbers(t, n), *nuisances = rows(others, n);
    PalpateSubspaceStatistic found;
    check(palpate_theta_nuisances(residual, template, n, nuisances, count, is(level, "known"), bias, eta, &found));
    return json_pack("{sf sf sf sf sf sf sf sI sI}", "t", found.t, "gamma", found.gamma, "gamma_nominal", found.gamma_nominal,
                     "residual", found.residual, "theta", found.theta, "false_alarm", found.rates.false_alarm, "miss",
                     found.rates.miss, "rank", (json_int_t)found.rank, "degrees", (json_int_t)found.degrees);
}

static json_t *sequential_evidence(void) {
    json_t *r, *t, *others;
    double alarm, miss;
    ARGUMENTS("{so so so sF sF}", "residual", &r, "templates", &t, "nuisances", &others, "max_false_alarm", &alarm, "max_miss", &miss);
    size_t n = length_of(r), signals = length_of(t), count = length_of(others), length = palpate_sequential_memory(signals, count);
    if (n == 0 || signals == 0) refuse("bad_argument", "no rows, or no templates");
    if (signals > 1000 || count > 100) refuse("out_of_range", "over 1000 templates or 100 nuisances");
    const double *residual = numbers(r, n), *templates = rows(t, n), *nuisances = rows(others, n);
    double *row = take(count + signals, sizeof(double)), *theta = take(signals, sizeof(double)), *gamma = take(signals, sizeof(double));
    PalpateEvidence *found = take(signals, sizeof *found);
    PalpatePreparedSequential detector;
    PalpateSequentialRows all;
    /* By what is answered: none, or an inclusion. */
    json_int_t *ends[2] = {take(signals, sizeof **ends), take(signals, sizeof **ends)};
    check(palpate_sequential_init(signals, count, take(length, sizeof(double)), length, &detector));
    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; k < count; k++) row[k] = nuisances[k * n + i];
        for (size_t k = 0; k < signals; k++) row[count + k] = templates[k * n + i];
        check(palpate_sequential_push(&detector, residual[i], row, count, row + count, signals));
        check(palpate_sequential_evidence(&detector, found, signals));
        for (size_t k = 0; k < signals; k++) {
            int8_t decision;
            theta[k] = found[k].along - found[k].gamma_squared / 2, gamma[k] = sqrt(found[k].gamma_squared);
            check(palpate_wald(alarm, miss, theta[k], &decision));
            if (decision != 0 && ends[0][k] + ends[1][k] == 0) ends[decision > 0][k] = (json_int_t)i + 1;
        }
    }
    check(palpate_sequential_rows(&detector, &all));
    json_t *at[2] = {json_array(), json_array()};
    for (size_t k = 0; k < 2 * signals; k++) json_array_append_new(at[k % 2], json_integer(ends[k % 2][k / 2]));
    return json_pack("{so so so so sf sI}", "no_inclusion_at", at[0], "inclusion_at", at[1], "theta", list_of(theta, signals), "gamma",
                     list_of(gamma, signals), "residual", all.residual, "rank", (json_int_t)all.rank);
}

static json_t *scan(void) {
    json_t *rx, *ry, *tx, *ty;
    PalpateComponents noise;
    ARGUMENTS("{so so so so sF sF}", "residual_x", &rx, "residual_y", &ry, "template_x", &tx, "template_y", &ty, "noise_sd_x",
              &noise.lateral, "noise_sd_y", &noise.normal);
    PalpateSeries residual = series(rx, ry), template = series(tx, ty);
    size_t count = residual.samples < template.samples ? 0 : residual.samples - template.samples + 1;
    if (count * template.samples > 10000000) refuse("out_of_range", "the scan takes more than 10000000 products");
    double *found = take(count, sizeof *found);
    PalpateScanMaximum maximum;
    check(palpate_scan(&residual, &template, &noise, found, count, &maximum));
    return json_pack("{so sf sI}", "theta", list_of(found, count), "max_theta", maximum.theta, "argmax", (json_int_t)maximum.shift);
}

static json_t *servo_axis(void) {
    json_t *list, *bits;
    ARGUMENTS("{so so}", "knots", &list, "coordinate_bits", &bits);
    size_t count = length_of(list), cells = count == 0 ? 0 : count - 1;
    PalpateCell cell;
    check(palpate_axis_locate(knots(list), count, take(cells, sizeof(float)), cells, float_of(bits), &cell));
    return json_pack("{sI so}", "cell", (json_int_t)cell.index, "fraction_bits", bits_of(cell.fraction));
}

static json_t *servo_interpolate(void) {
    json_t *d, *l, *table, *depth, *lateral;
    ARGUMENTS("{so so so so so}", "depth_knots", &d, "lateral_knots", &l, "table_bits", &table, "depth_bits", &depth, "lateral_bits",
              &lateral);
    size_t depths = length_of(d), laterals = length_of(l), length = depths + laterals < 2 ? 0 : depths + laterals - 2;
    if (length_of(table) != depths) refuse("bad_argument", "table_bits has another number of rows than depth_knots");
    PalpateForce *forces = take(depths * laterals, sizeof *forces), force;
    for (size_t row = 0; row < depths; row++) {
        json_t *list = json_array_get(table, row);
        if (length_of(list) != laterals) refuse("bad_argument", "table_bits has a row of another length than lateral_knots");
        for (size_t column = 0; column < laterals; column++)
            forces[row * laterals + column].normal = float_of(json_array_get(list, column));
    }
    PalpatePreparedTable prepared;
    check(palpate_table_init(knots(d), depths, knots(l), laterals, forces, take(length, sizeof(float)), length, &prepared));
    check(palpate_table_force(&prepared, float_of(depth), float_of(lateral), &force));
    return json_pack("{so}", "force_bits", bits_of(force.normal));
}

static json_t *report_decode(void) {
    const char *digits;
    ARGUMENTS("{ss}", "bytes", &digits);
    size_t length = strlen(digits) / 2;
    if (length == 0 || strlen(digits) % 2 != 0 || strspn(digits, "0123456789abcdefABCDEF") != 2 * length)
        refuse("bad_argument", "bytes is expected to be pairs of hexadecimal digits");
    uint8_t *bytes = take(length, 1), control;
    for (size_t i = 0; i < length; i++) bytes[i] = (uint8_t)strtoul((char[]){digits[2 * i], digits[2 * i + 1], 0}, NULL, 16);
    PalpatePositionReport p;
    PalpateForceReport f;
    PalpateCapabilities c;
    switch (bytes[0]) {
    case 1: check(palpate_position_report_decode(bytes, length, &p));
        return json_pack("{si si si si si si si}", "report", 1, "lateral", p.lateral, "normal", p.normal, "buttons", p.buttons, "status",
                         p.status, "sequence", p.sequence, "force_sequence", p.force_sequence);
    case 2: check(palpate_force_report_decode(bytes, length, &f));
        return json_pack("{si si si si si}", "report", 2, "lateral", f.lateral, "normal", f.normal, "sequence", f.sequence, "flags", f.flags);
    case 3: check(palpate_capabilities_decode(bytes, length, &c));
        return json_pack("{si si si si si si si si si}", "report", 3, "version", c.version, "position_unit_nm", c.position_unit_nm,
                         "force_unit_un", c.force_unit_un, "largest_force_mn", c.largest_force_mn, "period_us", c.period_us,
                         "watchdog_ms", c.watchdog_ms, "damping_mn_s_per_m", c.damping_mn_s_per_m, "friction_mn", c.friction_mn);
    case 4: check(palpate_control_decode(bytes, length, &control));
        return json_pack("{si si}", "report", 4, "control", control);
    default: refuse("out_of_range", "the report's number is unknown; give 1 to 4");
    }
}

static int16_t signed_of(const char *name) { return (int16_t)whole(number_of(name), INT16_MIN, INT16_MAX); }
static uint16_t word_of(const char *name) { return (uint16_t)whole(number_of(name), 0, UINT16_MAX); }
static uint8_t byte_of(const char *name) { return (uint8_t)whole(number_of(name), 0, UINT8_MAX); }

static json_t *report_encode(void) {
    static const size_t arguments[] = {7, 5, 9, 2}, lengths[] = {PALPATE_LENGTH_POSITION_REPORT, PALPATE_LENGTH_FORCE_REPORT,
                                                                 PALPATE_LENGTH_CAPABILITIES, PALPATE_LENGTH_CONTROL};
    int report = (int)whole(number_of("report"), 1, 4);
    if (json_object_size(call.args) != arguments[report - 1]) refuse("bad_argument", "unknown argument");
    uint8_t bytes[PALPATE_LENGTH_CAPABILITIES];
    size_t length = lengths[report - 1];
    switch (report) {
    case 1:
        check(palpate_position_report_encode(
            &(PalpatePositionReport){signed_of("lateral"), signed_of("normal"), byte_of("buttons"), byte_of("status"),
                                     word_of("sequence"), word_of("force_sequence")}, bytes, length)); break;
    case 2:
        check(palpate_force_report_encode(
            &(PalpateForceReport){signed_of("lateral"), signed_of("normal"), word_of("sequence"), byte_of("flags")}, bytes, length)); break;
    case 3:
        check(palpate_capabilities_encode(
            &(PalpateCapabilities){word_of("version"), word_of("position_unit_nm"), word_of("force_unit_un"), word_of("largest_force_mn"),
                                   word_of("period_us"), word_of("watchdog_ms"), word_of("damping_mn_s_per_m"), word_of("friction_mn")},
            bytes, length)); break;
    default: check(palpate_control_encode(byte_of("control"), bytes, length));
    }
    char digits[2 * sizeof bytes + 1];
    for (size_t i = 0; i < length; i++) snprintf(digits + 2 * i, 3, "%02x", bytes[i]);
    return json_pack("{ss}", "bytes", digits);
}

#define OTHER(op) {#op, op}
static const struct {
    const char *op;
    json_t *(*function)(void);
} others[] = {OTHER(roc), OTHER(noise_budget), OTHER(matched_filter), OTHER(theta), OTHER(theta_colored), OTHER(theta_nuisances), OTHER(sequential_evidence), OTHER(robust_evidence),
              OTHER(scan), OTHER(servo_axis), OTHER(servo_interpolate), OTHER(report_decode), OTHER(report_encode)};

static json_t *plain_op(size_t number) {
    double x[5], y[2];
    size_t used = 0;
    for (; used < COUNT(x) && plain[number].from[used] != NULL; used++) x[used] = number_of(plain[number].from[used]);
    if (json_object_size(call.args) != used + (plain[number].choice != NULL)) refuse("bad_argument", "unknown argument");
    plain[number].function(x, y);
    json_t *found = json_object();
    for (size_t k = 0; k < COUNT(y) && plain[number].to[k] != NULL; k++)
        json_object_set_new(found, plain[number].to[k], json_real(y[k]));
    return found;
}

static json_t *perform(const char *op) {
    json_t *ops = is(op, "capabilities") ? json_array() : NULL;
    for (size_t i = 0; i < COUNT(others); json_array_append_new(ops, json_string(others[i++].op)))
        if (is(op, others[i].op)) return others[i].function();
    for (size_t i = 0; i < COUNT(plain); json_array_append_new(ops, json_string(plain[i++].op))) {
        const char *value = plain[i].choice ? json_string_value(json_object_get(call.args, plain[i].choice)) : NULL;
        if (is(op, plain[i].op) && (!plain[i].choice || (value && is(value, plain[i].value)))) return plain_op(i);
    }
    if (ops == NULL) refuse("unknown_op", "the op, or what its text argument asks for, is unknown");
    return json_pack("{ss so}", "version", "palpate C library", "ops", ops);
}

static json_t *request(const json_t *line, const json_t *id) {
    const json_t *op = json_object_get(line, "op");
    call.args = json_object_get(line, "args");
    if (id == NULL || !json_is_string(op) || json_object_size(line) != (call.args == NULL ? 2 : 3))
        refuse("bad_request", "expected an object with id, op and args");
    if (call.args != NULL && !json_is_object(call.args)) refuse("bad_argument", "args is expected to be an object");
    return perform(json_string_value(op));
}

static json_t *answer(const json_t *line) {
    json_t *id = json_object_get(line, "id");
    json_t *const named = json_is_string(id) || json_is_number(id) ? id : NULL;
    if (setjmp(call.refused) != 0)
        return json_pack("{sO? s{ss ss}}", "id", named, "error", "code", call.code, "message", call.wrong.text);
    if (line == NULL) refuse("bad_json", call.wrong.text);
    return json_pack("{sO? so}", "id", named, "ok", request(line, named));
}

int main(void) {
    char *line = NULL;
    size_t room = 0;
    for (ssize_t length; (length = getline(&line, &room, stdin)) >= 0;) {
        json_t *parsed = json_loadb(line, (size_t)length, JSON_REJECT_DUPLICATES | JSON_DECODE_INT_AS_REAL, &call.wrong);
        json_t *answered = answer(parsed);
        json_dumpf(answered, stdout, JSON_COMPACT | JSON_REAL_PRECISION(17));
        puts("");
        fflush(stdout);
        while (call.taken > 0) free(call.memory[--call.taken]);
        json_decref(answered);
        json_decref(parsed);
    }
    free(line);
}
