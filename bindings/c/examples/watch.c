/* Decides sample by sample, beside an unknown offset of the sensor: a record ends as soon as one percent of errors of either kind allows. */
#include <palpate.h>

#include <math.h>
#include <stdio.h>

#define SAMPLES 40

/* Says why a call was refused, and gives 1 then. */
static int refused(const char *call, PalpateError error) {
    if (error == PALPATE_ERROR_OK) return 0;
    fprintf(stderr, "%s: %s\n", call, palpate_error_text(error));
    return 1;
}

int main(void) {
    /* N: of one sample, and what the sensor adds. */
    const double noise_sd = 0.1, offset = 0.4;
    double memory[15]; /* as many numbers as palpate_sequential_memory(1, 1) says */
    PalpatePreparedSequential detector;
    if (refused("init", palpate_sequential_init(1, 1, memory, sizeof memory / sizeof *memory, &detector))) return 1;

    for (int sample = 0; sample < SAMPLES; sample++) {
        /* A force of 1.8 N without the inclusion; the inclusion adds a bump of 0.4 N about the middle, which is there. The noise of a
           sensor would come in addition. */
        const double place = (sample - SAMPLES / 2) / 6.0, without = 1.8, bump = 0.4 * exp(-place * place);
        const double measured = without + bump + offset;

        const double of_offset = 1 / noise_sd, signal = bump / noise_sd;
        if (refused("push", palpate_sequential_push(&detector, (measured - without) / noise_sd, &of_offset, 1, &signal, 1))) return 1;
        PalpateEvidence evidence;
        if (refused("evidence", palpate_sequential_evidence(&detector, &evidence, 1))) return 1;
        const double theta = evidence.along - evidence.gamma_squared / 2;
        int8_t decision;
        if (refused("wald", palpate_wald(0.01, 0.01, theta, &decision))) return 1;
        if (decision != 0) {
            printf("after %d of %d samples: theta %.4f, gamma %.4f: %s\n", sample + 1, SAMPLES, theta, sqrt(evidence.gamma_squared),
                   decision > 0 ? "an inclusion" : "no inclusion");
            return 0;
        }
    }
    printf("the record ended before the test\n");
    return 0;
}
