/* press MILLISECONDS COMMAND: runs the command in a new console, presses Ctrl-C after that time, says after how many milliseconds the
   command ended, and gives its exit code. The keys reach all in the console, this program too, which does not heed them. */
#include <stdio.h>
#include <stdlib.h>
#include <windows.h>

int main(int count, char **arguments) {
    STARTUPINFOA start = {.cb = sizeof start, .dwFlags = STARTF_USESTDHANDLES};
    start.hStdInput = GetStdHandle(STD_INPUT_HANDLE);
    start.hStdOutput = GetStdHandle(STD_OUTPUT_HANDLE);
    start.hStdError = GetStdHandle(STD_ERROR_HANDLE);
    FreeConsole();
    PROCESS_INFORMATION child;
    if (count != 3 || !AllocConsole() || !CreateProcessA(NULL, arguments[2], NULL, NULL, TRUE, 0, NULL, NULL, &start, &child)) {
        fprintf(stderr, "press: not started: error %lu\n", GetLastError());
        return 99;
    }
    Sleep(atoi(arguments[1]));
    // After the start, for a child inherits it.
    SetConsoleCtrlHandler(NULL, TRUE);
    DWORD pressed = GetTickCount(), code = 98;
    if (!GenerateConsoleCtrlEvent(CTRL_C_EVENT, 0)) {
        fprintf(stderr, "press: not pressed: error %lu\n", GetLastError());
        return 97;
    }
    WaitForSingleObject(child.hProcess, 10000);
    fprintf(stderr, "%lu\n", GetTickCount() - pressed);
    GetExitCodeProcess(child.hProcess, &code);
    TerminateProcess(child.hProcess, 96);
    return code;
}
