/* Plays forces of palpate on the device of any maker (POSIX): bridge palpate play --map gel.json --device pipe --seconds 60 */
/* Implements: HID-113. */
#include "vendor.h"
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdint.h>
#include <sys/select.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* Version, nm and uN a count, largest mN, us between positions, ms until the force drops, damping (mN s/m), friction (mN). */
static const uint16_t about[8] = {1, 1000, 500, 8000, 1000, 15, 600, 140};
static void put(uint8_t *at, int value) { at[0] = value & 255, at[1] = value >> 8 & 255; }
static int get(const uint8_t *at) { return (int16_t)(at[0] | at[1] << 8); }
static int position(double m) { return lround(fmin(fmax(m * 1e9 / about[1], -32767), 32767)); }
static volatile sig_atomic_t ended;
static void end(int signal_number) { ended = signal_number; }
static double now_us(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * 1e6 + now.tv_nsec * 1e-3;
}
int main(int arguments, char **argument) {
    int to[2], from[2], status = 0, enabled = 0, sequence = 0;
    if (arguments < 2 || vendor_open() || pipe(to) || pipe(from)) return 2;
    if (fork() == 0) { /* palpate, between the pipes */
        dup2(to[0], 0), dup2(from[1], 1), close(to[1]), close(from[0]);
        execvp(argument[1], argument + 1), _exit(127);
    }
    close(to[0]), close(from[1]), signal(SIGPIPE, SIG_IGN), fcntl(to[1], F_SETFL, O_NONBLOCK);
    /* Of Ctrl-C, palpate knows too: it stops and ends its output. Without these lines the device would keep its last force. */
    const struct sigaction stop = {.sa_handler = end};
    signal(SIGINT, SIG_IGN), sigaction(SIGTERM, &stop, 0), sigaction(SIGHUP, &stop, 0);
    uint8_t feature[17] = {3}, input[11] = {1}, output[8] = {0};
    for (int number = 0; number < 8; number++) put(feature + 1 + 2 * number, about[number]);
    int alive = write(to[1], feature, sizeof feature) == sizeof feature, have = 0;
    for (double due = now_us(), last = due; alive && !ended;) {
        const VendorPosition at = vendor_get_position();
        put(input + 1, position(at.lateral_m)), put(input + 3, position(at.normal_m)), put(input + 7, ++sequence);
        input[5] = at.button && isfinite(at.lateral_m + at.normal_m); /* what is no position lets go of the switch */
        alive = write(to[1], input, sizeof input) > 0 || errno == EAGAIN;
        due = fmax(due + about[4], now_us());
        for (double left; alive && !ended && (left = due - now_us()) > 0;) { /* reports, until the next position is due */
            fd_set ready;
            FD_ZERO(&ready);
            FD_SET(from[0], &ready);
            if (pselect(from[0] + 1, &ready, 0, 0, &(struct timespec){0, (long)(left * 1e3)}, 0) <= 0) continue;
            const int length = have == 0 ? 1 : output[0] == 2 ? 8 : 2, got = read(from[0], output + have, length - have);
            alive = got > 0 && (output[0] == 2 || output[0] == 4), have += got;
            if (!alive || have < 2 || have < length) continue;
            have = 0, last = now_us();
            if (output[0] == 4 && output[1] != 2) enabled = output[1] == 1;
            const double unit = output[0] == 2 && enabled && output[7] & 1 ? about[2] * 1e-6 : 0;
            vendor_set_force(get(output + 1) * unit, get(output + 3) * unit);
            if (output[0] == 2) input[9] = output[5], input[10] = output[6]; /* played */
        }
        if (now_us() - last > about[5] * 1e3) vendor_set_force(0, 0); /* the watchdog */
    }
    vendor_set_force(0, 0);
    close(to[1]), close(from[0]);
    while (wait(&status) < 0 && errno == EINTR) {}
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}
