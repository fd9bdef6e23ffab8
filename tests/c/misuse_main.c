/* Misuse alone, of a library with the feature `units`. */

#include "check.h"

int units(void);

int main(void) {
    int line = misuse();
    if (line == 0) line = control();
    if (line == 0) line = units();
    return platform_end(line);
}
