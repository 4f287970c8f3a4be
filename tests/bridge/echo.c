/* In place of `palpate play --device pipe` for so many seconds: a program that does nothing but answer each position with a force. Its round trip
 * is the least that this machine allows. */
#define _GNU_SOURCE
#include <sched.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

static int all(uint8_t *bytes, size_t length) {
    while (length > 0) {
        ssize_t count = read(0, bytes, length);
        if (count <= 0) return 0;
        bytes += count, length -= count;
    }
    return 1;
}

int main(int count, char **arguments) {
    struct sched_param priority = {.sched_priority = 80};
    uint8_t device[17], position[11], force[8] = {2, 0, 0, 0, 0, 0, 0, 1};
    const uint8_t enable[] = {4, 2, 4, 1};
    time_t end = time(0) + (count > 1 ? atoi(arguments[1]) : 60);
    /* As palpate asks; it says if it may not. */
    sched_setscheduler(0, SCHED_FIFO, &priority);
    mlockall(MCL_CURRENT | MCL_FUTURE);
    if (!all(device, sizeof device) || write(1, enable, sizeof enable) < 0) return 1;
    for (uint16_t sequence = 1; time(0) < end && all(position, sizeof position); sequence++) {
        force[5] = sequence & 255, force[6] = sequence >> 8;
        if (write(1, force, sizeof force) < 0) return 1;
    }
    return 0;
}
