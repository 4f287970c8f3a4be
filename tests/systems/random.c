/* Windows has this library of random numbers, bcryptprimitives.dll, and Debian's Wine does not. */
#include <stddef.h>

__declspec(dllimport) unsigned char SystemFunction036(void *, unsigned long);

__declspec(dllexport) int ProcessPrng(unsigned char *bytes, size_t length) {
    return SystemFunction036(bytes, (unsigned long)length);
}
