/* Plays a force table at 1 kHz: a hand presses to 4 mm and comes back, twice a second. The device is simulated here; on a real
   one `receive` reads a position report and `send` writes a force report. */
#define _POSIX_C_SOURCE 200809L
#include <palpate.h>

#include <math.h>
#include <stdio.h>
#include <time.h>

#define DEPTHS 3
#define LATERALS 2
#define CYCLES 1000

static const float depth_knots[DEPTHS] = {0.0f, 0.002f, 0.004f};
static const float lateral_knots[LATERALS] = {-0.01f, 0.01f};
static const PalpateForce forces[DEPTHS * LATERALS] = {
    {0.0f, 0.0f}, {0.0f, 0.0f}, {0.1f, 0.8f}, {-0.1f, 0.8f}, {0.3f, 2.4f}, {-0.3f, 2.4f},
};

/* 1 µm and 1 mN a count, at most 8 N, 1 ms, 15 ms. */
static const PalpateCapabilities device = {1, 1000, 1000, 8000, 1000, 15, 600, 140};

/* What a device would report in a cycle: the switch is held from the third report on. */
static PalpatePositionReport receive(unsigned cycle) {
    const double depth_um = 2000.0 * (1.0 - cos(2.0 * 3.14159265358979 * cycle / 500.0));
    PalpatePositionReport report = {0, 0, 0, 0, 0, 0};
    report.normal = (int16_t)-depth_um;
    report.buttons = cycle >= 2;
    report.sequence = (uint16_t)cycle;
    return report;
}

static double largest_n;

static void send(const PalpateForceReport *report) {
    const double force_n = report->normal * (device.force_unit_un * 1e-6);
    if (force_n > largest_n) largest_n = force_n;
}

static void wait_until(struct timespec *next) {
    next->tv_nsec += 1000000;
    if (next->tv_nsec >= 1000000000) {
        next->tv_nsec -= 1000000000;
        next->tv_sec += 1;
    }
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, next, NULL);
}

int main(void) {
    float scratch[DEPTHS + LATERALS - 2];
    PalpatePreparedTable table;
    PalpateError error = palpate_table_init(depth_knots, DEPTHS, lateral_knots, LATERALS, forces, scratch,
                                            DEPTHS + LATERALS - 2, &table);
    const PalpateServoLimits limits = {8.0f, 0.05f, 0.5f, 10};
    PalpateServoState state = {0};
    PalpateServoCommand command = {0};
    struct timespec next;
    clock_gettime(CLOCK_MONOTONIC, &next);
    for (unsigned cycle = 0; error == PALPATE_ERROR_OK && cycle < CYCLES; cycle++) {
        const PalpatePositionReport position = receive(cycle);
        PalpateServoSample sample;
        error = palpate_sample_of_report(&device, &position, &sample);
        if (error != PALPATE_ERROR_OK) break;
        /* The person asks to arm before the hand takes the switch. */
        const uint8_t request = cycle == 1 ? PALPATE_SERVO_REQUEST_ARM : PALPATE_SERVO_REQUEST_NONE;
        error = palpate_step(&table, &limits, &sample, request, &state, &command);
        if (error != PALPATE_ERROR_OK) break;
        PalpateForceReport report;
        error = palpate_report_of_command(&device, &command, (uint16_t)cycle, &report);
        if (error == PALPATE_ERROR_OK) send(&report);
        wait_until(&next);
    }
    if (error != PALPATE_ERROR_OK) {
        fprintf(stderr, "loop: %s\n", palpate_error_text(error));
        return 1;
    }
    printf("%d cycles, mode %d, largest force %.3f N\n", CYCLES, state.mode, largest_n);
    return state.mode == PALPATE_SERVO_MODE_ARMED ? 0 : 1;
}
