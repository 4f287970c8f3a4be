/* Calls that must be refused, each with its code, and leave their results as they were. */
#include "palpate.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static int failures;

static void expect(const char *what, PalpateError found, PalpateError expected) {
    if (found == expected) return;
    failures++;
    printf("%s: %s, expected: %s\n", what, palpate_error_text(found), palpate_error_text(expected));
}

static void expect_true(const char *what, int is) {
    if (is) return;
    failures++;
    printf("%s does not hold\n", what);
}

static const PalpateServoLimits limits = {8.0f, 0.05f, 0.5f, 10};
static const float knots[2] = {0.0f, 0.5f};
static const PalpateForce forces[4] = {{0, 0}, {0, 0}, {1, 4}, {1, 4}};

static void numbers(void) {
    double y = -7.0, aligned[2] = {0, 0};
    expect("null", palpate_normal_cdf(0.0, NULL), PALPATE_ERROR_NULL_POINTER);
    expect("unaligned", palpate_normal_cdf(0.0, (double *)((char *)aligned + 1)), PALPATE_ERROR_UNALIGNED);
    expect("NaN", palpate_normal_cdf(NAN, &y), PALPATE_ERROR_OUT_OF_RANGE);
    expect("probability", palpate_normal_quantile(1.0, &y), PALPATE_ERROR_OUT_OF_RANGE);
    expect_true("a refused call leaves its result", y == -7.0);
    expect_true("an unknown error has a text", strcmp(palpate_error_text(99), "an unknown error") == 0);
    expect_true("the last error has a text", strstr(palpate_error_text(PALPATE_ERROR_DEVICE), "capabilities") != NULL);
}

static void records(void) {
    double signal[4] = {0.1, 0.2, 0.2, 0.1}, zero[4] = {0, 0, 0, 0}, infinite[4] = {0, 0, INFINITY, 0};
    const PalpateComponents noise = {0.1, 0.1}, no_noise = {0.0, 0.1};
    const PalpateSeries right = {zero, signal, 4}, none = {zero, signal, 0}, shorter = {zero, signal, 3};
    const PalpateSeries missing = {NULL, signal, 4}, wrong = {zero, infinite, 4}, endless = {zero, signal, (size_t)-1 / 8};
    PalpateFilter filter;
    PalpateStatistic found;
    expect("no sample", palpate_matched_filter(&none, &noise, &filter), PALPATE_ERROR_EMPTY);
    expect("null samples", palpate_matched_filter(&missing, &noise, &filter), PALPATE_ERROR_NULL_POINTER);
    expect("infinite sample", palpate_matched_filter(&wrong, &noise, &filter), PALPATE_ERROR_NOT_FINITE);
    expect("too many", palpate_matched_filter(&endless, &noise, &filter), PALPATE_ERROR_LENGTH);
    expect("no noise", palpate_matched_filter(&right, &no_noise, &filter), PALPATE_ERROR_OUT_OF_RANGE);
    expect("lengths", palpate_theta(&right, &shorter, &right, &noise, &found), PALPATE_ERROR_LENGTH);

    PalpateScanMaximum maximum;
    double theta[2];
    expect("count", palpate_scan(&right, &shorter, &noise, theta, 1, &maximum), PALPATE_ERROR_LENGTH);
    expect("scan over its input", palpate_scan(&right, &shorter, &noise, zero + 1, 2, &maximum), PALPATE_ERROR_OVERLAP);
    double huge[4] = {0, 0, 0, 1e308};
    const PalpateSeries overflowing = {zero, huge, 4};
    theta[0] = theta[1] = -7.0;
    expect("overflow", palpate_scan(&overflowing, &shorter, &noise, theta, 2, &maximum), PALPATE_ERROR_OVERFLOW);
    expect_true("a refused scan leaves its list", theta[0] == -7.0 && theta[1] == -7.0);
    expect("scan", palpate_scan(&right, &shorter, &noise, theta, 2, &maximum), PALPATE_ERROR_OK);

    double covariance[4] = {1, 0.5, 0.4, 1}, scratch[8];
    PalpateThetaGamma pair;
    expect("symmetry", palpate_theta_coloured(zero, signal, covariance, 2, scratch, 8, &pair), PALPATE_ERROR_NOT_SYMMETRIC);
    covariance[1] = covariance[2] = 2;
    expect("definite", palpate_theta_coloured(zero, signal, covariance, 2, scratch, 8, &pair), PALPATE_ERROR_NOT_POSITIVE_DEFINITE);
    expect("scratch", palpate_theta_coloured(zero, signal, covariance, 2, scratch, 7, &pair), PALPATE_ERROR_LENGTH);
    PalpateColouredEvidence evidence;
    expect("amplitude", palpate_evidence_coloured(zero, signal, covariance, 2, -1, scratch, 8, &evidence), PALPATE_ERROR_OUT_OF_RANGE);
    expect("evidence over input", palpate_evidence_coloured(zero, scratch, covariance, 2, 1, scratch, 8, &evidence), PALPATE_ERROR_OVERLAP);
    expect("scratch over input", palpate_theta_coloured(zero, scratch, covariance, 2, scratch, 8, &pair), PALPATE_ERROR_OVERLAP);

    PalpateSubspaceStatistic statistic;
    double offset[4] = {1, 1, 1, 1}, flat[4] = {2, 2, 2, 2};
    expect("same memory", palpate_theta_nuisances(signal, signal, 4, offset, 1, 1, 0, 0, &statistic), PALPATE_ERROR_OVERLAP);
    expect("explained", palpate_theta_nuisances(zero, flat, 4, offset, 1, 1, 0, 0, &statistic), PALPATE_ERROR_NO_SIGNAL);
}

static void rows(void) {
    double memory[12], one = 1, signal = 2;
    PalpatePreparedSequential detector = {0};
    PalpateEvidence evidence = {-7, -7};
    PalpateSequentialRows all = {-7, 7, 7, 7};
    int8_t decision = 7;
    expect_true("memory", palpate_sequential_memory(1, 1) == 15 && palpate_sequential_memory(1, 0) == 8);
    expect("not made", palpate_sequential_push(&detector, 1, NULL, 0, &signal, 1), PALPATE_ERROR_NOT_INITIALISED);
    expect("no evidence", palpate_sequential_evidence(&detector, &evidence, 1), PALPATE_ERROR_NOT_INITIALISED);
    expect("no rows", palpate_sequential_rows(&detector, &all), PALPATE_ERROR_NOT_INITIALISED);
    expect("a table", palpate_table_force((PalpatePreparedTable *)&detector, 0, 0, NULL), PALPATE_ERROR_NULL_POINTER);
    expect("null memory", palpate_sequential_init(1, 0, NULL, 8, &detector), PALPATE_ERROR_NULL_POINTER);
    expect("memory", palpate_sequential_init(1, 0, memory, 9, &detector), PALPATE_ERROR_LENGTH);
    expect("no hypothesis", palpate_sequential_init(0, 1, memory, 10, &detector), PALPATE_ERROR_EMPTY);
    expect("within itself", palpate_sequential_init(1, 0, (double *)&detector, 8, &detector), PALPATE_ERROR_OVERLAP);
    expect("init", palpate_sequential_init(1, 0, memory, 8, &detector), PALPATE_ERROR_OK);
    PalpateForce force;
    expect("no table", palpate_table_force((PalpatePreparedTable *)&detector, 0, 0, &force), PALPATE_ERROR_NOT_INITIALISED);
    expect("push", palpate_sequential_push(&detector, 3, NULL, 0, &signal, 1), PALPATE_ERROR_OK);
    expect("a row of the memory", palpate_sequential_push(&detector, 3, NULL, 0, memory + 7, 1), PALPATE_ERROR_OVERLAP);
    expect("a row of the detector", palpate_sequential_push(&detector, 3, NULL, 0, (double *)&detector, 1), PALPATE_ERROR_OVERLAP);
    expect("another nuisance", palpate_sequential_push(&detector, 3, &one, 1, &signal, 1), PALPATE_ERROR_LENGTH);
    expect("no signal", palpate_sequential_push(&detector, 3, NULL, 0, NULL, 1), PALPATE_ERROR_NULL_POINTER);
    expect("infinite", palpate_sequential_push(&detector, INFINITY, NULL, 0, &signal, 1), PALPATE_ERROR_OUT_OF_RANGE);
    expect("missing", palpate_sequential_push(&detector, NAN, NULL, 0, &signal, 1), PALPATE_ERROR_OK);
    expect("evidence of two", palpate_sequential_evidence(&detector, &evidence, 2), PALPATE_ERROR_LENGTH);
    expect("over the memory", palpate_sequential_evidence(&detector, (PalpateEvidence *)(memory + 6), 1), PALPATE_ERROR_OVERLAP);
    expect_true("a refused call leaves its result", evidence.along == -7 && all.rows == 7);
    expect("evidence", palpate_sequential_evidence(&detector, &evidence, 1), PALPATE_ERROR_OK);
    expect("rows", palpate_sequential_rows(&detector, &all), PALPATE_ERROR_OK);
    /* 2·3 and 2². */
    expect_true("the evidence", evidence.along == 6 && evidence.gamma_squared == 4);
    expect_true("the rows", all.residual == 9 && all.rows == 1 && all.missing == 1 && all.rank == 0);
    expect("rates", palpate_wald(0.5, 0.5, 1, &decision), PALPATE_ERROR_OUT_OF_RANGE);
    expect("NaN", palpate_wald(0.01, 0.01, NAN, &decision), PALPATE_ERROR_OUT_OF_RANGE);
    expect_true("a refused test leaves its result", decision == 7);
    expect_true("it goes on", palpate_wald(0.01, 0.01, 4.6, &decision) == PALPATE_ERROR_OK && decision == 0);
    expect_true("an inclusion", palpate_wald(0.01, 0.01, 4.61, &decision) == PALPATE_ERROR_OK && decision == 1);
    expect_true("none", palpate_wald(0.01, 0.01, -4.61, &decision) == PALPATE_ERROR_OK && decision == -1);
}

static void servo(void) {
    float scratch[2], falling[2] = {0.5f, 0.0f};
    PalpateForce strong[4] = {{0, 0}, {0, 0}, {0, 101}, {0, 0}}, force;
    PalpatePreparedTable table, other;
    memset(&other, 0x5a, sizeof other);
    expect("knots", palpate_table_init(falling, 2, knots, 2, forces, scratch, 2, &table), PALPATE_ERROR_KNOTS);
    expect("one knot", palpate_table_init(knots, 1, knots, 2, forces, scratch, 1, &table), PALPATE_ERROR_KNOTS);
    expect("force", palpate_table_init(knots, 2, knots, 2, strong, scratch, 2, &table), PALPATE_ERROR_TABLE_FORCE);
    expect("scratch", palpate_table_init(knots, 2, knots, 2, forces, scratch, 3, &table), PALPATE_ERROR_LENGTH);
    expect("scratch over knots", palpate_table_init(falling, 2, knots, 2, forces, falling, 2, &table), PALPATE_ERROR_OVERLAP);
    expect("table", palpate_table_init(knots, 2, knots, 2, forces, scratch, 2, &table), PALPATE_ERROR_OK);
    expect("another table", palpate_table_force(&other, 0.1f, 0.0f, &force), PALPATE_ERROR_NOT_INITIALISED);

    /* A force is played, then a call is refused: its command is none, from which the next force grows, and the rest of the state stays. */
    PalpateServoState state = {0}, before;
    PalpateServoCommand command;
    PalpateServoSample sample = {0.1f, 0.1f, 1, 0, 0};
    palpate_step(&table, &limits, &sample, PALPATE_SERVO_REQUEST_NONE, &state, &command);
    sample.sequence = 2;
    palpate_step(&table, &limits, &sample, PALPATE_SERVO_REQUEST_ARM, &state, &command);
    sample.sequence = 3;
    sample.deadman = 255;
    palpate_step(&table, &limits, &sample, PALPATE_SERVO_REQUEST_NONE, &state, &command);
    expect_true("a force is played", command.playing == 1 && command.force.normal == 0.05f);
    before = state;
    const PalpateServoLimits no_limits = {8.0f, NAN, 0.5f, 10};
    expect("limits", palpate_step(&table, &no_limits, &sample, 0, &state, &command), PALPATE_ERROR_LIMITS);
    expect_true("no force", command.playing == 0 && command.force.lateral == 0.0f && command.force.normal == 0.0f);
    expect_true("the force starts anew", state.force.lateral == 0.0f && state.force.normal == 0.0f);
    state.force = before.force;
    expect_true("the rest of the state stays", memcmp(&before, &state, sizeof state) == 0);
    expect("no state", palpate_step(&table, &limits, &sample, 0, NULL, &command), PALPATE_ERROR_NULL_POINTER);
    expect("state over command", palpate_step(&table, &limits, &sample, 0, &state, (PalpateServoCommand *)&state), PALPATE_ERROR_OVERLAP);
    command.playing = 1;
    command.force.normal = 1.0f;
    expect("state over sample", palpate_step(&table, &limits, (const PalpateServoSample *)&state, 0, &state, &command), PALPATE_ERROR_OVERLAP);
    expect_true("no force beside it", command.playing == 0 && command.force.normal == 0.0f);
    expect("no table", palpate_step(NULL, &limits, &sample, 0, &state, &command), PALPATE_ERROR_NULL_POINTER);
    expect("no command", palpate_step(&table, &limits, &sample, 0, &state, NULL), PALPATE_ERROR_NULL_POINTER);

    /* Bytes that are no mode count as memory overwritten, and no request as one to disarm. */
    state.mode = 77;
    state.force.lateral = state.force.normal = 1.0f;
    expect("mode", palpate_step(&table, &limits, NULL, 0, &state, &command), PALPATE_ERROR_OK);
    expect_true("a fault of the state", state.mode == PALPATE_SERVO_MODE_FAULT_STATE && command.playing == 0);
    expect_true("at once", command.force.lateral == 0.0f && command.force.normal == 0.0f);
    state = before;
    sample.sequence = 4;
    expect("request", palpate_step(&table, &limits, &sample, 200, &state, &command), PALPATE_ERROR_OK);
    expect_true("disarmed", state.mode == PALPATE_SERVO_MODE_DISARMED && command.playing == 0);
}

static void reports(void) {
    uint8_t bytes[PALPATE_LENGTH_CAPABILITIES];
    PalpatePositionReport position = {-5, 6, 1, 0, 700, 800};
    PalpateCapabilities device = {2, 1000, 1000, 8000, 1000, 15, 0, 0};
    PalpateServoSample sample;
    uint8_t control;
    expect("length", palpate_position_report_encode(&position, bytes, 10), PALPATE_ERROR_LENGTH);
    expect("encode", palpate_position_report_encode(&position, bytes, PALPATE_LENGTH_POSITION_REPORT), PALPATE_ERROR_OK);
    expect("number", palpate_force_report_decode(bytes, PALPATE_LENGTH_FORCE_REPORT, NULL), PALPATE_ERROR_NULL_POINTER);
    expect("control", palpate_control_encode(3, bytes, PALPATE_LENGTH_CONTROL), PALPATE_ERROR_REPORT);
    expect("other report", palpate_control_decode(bytes, PALPATE_LENGTH_CONTROL, &control), PALPATE_ERROR_REPORT);
    expect("device", palpate_sample_of_report(&device, &position, &sample), PALPATE_ERROR_DEVICE);
    expect_true("the descriptor ends with the end of the collection",
                palpate_report_descriptor()[PALPATE_LENGTH_DESCRIPTOR - 1] == 0xC0);
}

int main(void) {
    numbers();
    records();
    rows();
    servo();
    reports();
    printf("misuse: %d failures\n", failures);
    return failures != 0;
}
