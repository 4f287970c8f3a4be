/* Decides whether a record holds an inclusion: forces at 5 positions of the probe, without, with, and as they were measured. */
#include <palpate.h>

#include <stdio.h>

#define SAMPLES 5

static const double nothing[SAMPLES] = {0, 0, 0, 0, 0};
static const double without[SAMPLES] = {1.80, 1.80, 1.80, 1.80, 1.80};
static const double with_inclusion[SAMPLES] = {1.82, 1.95, 2.20, 1.95, 1.82};
static const double measured[SAMPLES] = {1.85, 1.91, 2.13, 2.02, 1.78};

/* Says why a call was refused, and gives 1 then. */
static int refused(const char *call, PalpateError error) {
    if (error == PALPATE_ERROR_OK) return 0;
    fprintf(stderr, "%s: %s\n", call, palpate_error_text(error));
    return 1;
}

int main(void) {
    /* N. The lateral forces are 0 here: the normal one decides alone. */
    const PalpateSeries f0 = {nothing, without, SAMPLES};
    const PalpateSeries f1 = {nothing, with_inclusion, SAMPLES};
    const PalpateSeries record = {nothing, measured, SAMPLES};
    const PalpateComponents noise_sd = {0.05, 0.1};

    PalpateStatistic found;
    if (refused("palpate_theta", palpate_theta(&record, &f0, &f1, &noise_sd, &found))) return 1;

    /* At most 1 % of false alarms. */
    double eta;
    if (refused("threshold", palpate_neyman_pearson_false_alarm_threshold(found.gamma, 0.01, &eta))) return 1;
    uint8_t inclusion;
    if (refused("palpate_decide", palpate_decide(found.theta, eta, &inclusion))) return 1;
    PalpateErrorRates rates;
    if (refused("palpate_error_rates", palpate_error_rates(found.gamma, eta, &rates))) return 1;

    printf("theta %.4f, gamma %.4f, threshold %.4f: %s\n", found.theta, found.gamma, eta,
           inclusion ? "an inclusion" : "no inclusion");
    printf("false alarms %.4f, misses %.4f\n", rates.false_alarm, rates.miss);
    return 0;
}
