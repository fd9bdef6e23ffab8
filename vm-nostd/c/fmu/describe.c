/* Prints the variables of the unit, for build.py: reference, name, unit, description, causality, bytes, start. */

#include "muscle.h"

#include <stdio.h>

int main(void) {
    const State start = unit_start();
    char message[MESSAGE];
    for (size_t reference = 1; reference <= variable_count(); reference++) {
        const Variable *v = variable(reference);
        double real = 0.0;
        int32_t whole = 0;
        const uint32_t here = (uint32_t)reference;
        /* Outputs have no start. */
        if (v->causality != OUTPUT && (v->bytes == 8 ? unit_get_reals(&start, &here, 1, &real, message)
                                                     : unit_get_integers(&start, &here, 1, &whole, message))) {
            return 1;
        }
        printf("%u\t%s\t%s\t%s\t%d\t%u\t", (unsigned)reference, v->name, v->unit ? v->unit : "", v->description,
               (int)v->causality, (unsigned)v->bytes);
        if (v->bytes == 8) {
            printf("%.17g\n", real);
        } else {
            printf("%ld\n", (long)whole);
        }
    }
    return 0;
}
