/* Misuse and any numbers, of a library with the feature `units`. */

#include "check.h"

int units(void);

int main(void) {
    int line = misuse();
    if (line == 0) line = control();
    if (line == 0) line = anything();
    if (line == 0) line = units();
    return platform_end(line);
}
