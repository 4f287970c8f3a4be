/* A stub of a maker's library: a hand that takes the switch after 50 positions, and presses to 4 mm and comes back twice a second.
   At the end it tells what it was asked, in the order of the positions. */
#include "vendor.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define MOST 1000000
static double round_trip_us[MOST];
static long positions, round_trips;
static double asked_us, lateral, normal, largest;

static double now_us(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * 1e6 + now.tv_nsec * 1e-3;
}

static int by_size(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void tell(void) {
    qsort(round_trip_us, round_trips, sizeof *round_trip_us, by_size);
    const double *at = round_trip_us;
    const long n = round_trips;
    fprintf(stderr, "vendor: %ld positions, largest force %.4f N, last force %.4f %.4f N\n", positions, largest, lateral, normal);
    if (n > 0)
        fprintf(stderr, "vendor: %ld round trips, us: p50 %.1f, p99 %.1f, p99.9 %.1f, max %.1f\n", n, at[n / 2], at[n * 99 / 100],
                at[n * 999 / 1000], at[n - 1]);
}

int vendor_open(void) { return atexit(tell); }

VendorPosition vendor_get_position(void) {
    const double depth = 0.002 * (1 - cos(2 * 3.14159265358979 * positions / 500.0));
    const VendorPosition at = {0.003 * sin(positions / 700.0), -depth, positions > 50};
    positions++;
    asked_us = now_us();
    return at;
}

void vendor_set_force(double lateral_n, double normal_n) {
    if (asked_us > 0 && round_trips < MOST) round_trip_us[round_trips++] = now_us() - asked_us;
    asked_us = 0;
    if ((normal_n == 0) != (normal == 0)) fprintf(stderr, "vendor: force %.4f N at position %ld\n", normal_n, positions);
    lateral = lateral_n, normal = normal_n;
    largest = fmax(largest, fabs(normal_n));
}
