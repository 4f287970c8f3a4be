/* load MODULE: whether Windows finds all that a Python module needs, and the function that Python calls first. */
#include <stdio.h>
#include <windows.h>

int main(int count, char **arguments) {
    HMODULE module = count == 2 ? LoadLibraryA(arguments[1]) : NULL;
    if (!module || !GetProcAddress(module, "PyInit_palpate")) {
        printf("not loaded: error %lu\n", GetLastError());
        return 1;
    }
    puts("loaded");
    return 0;
}
