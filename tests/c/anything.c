/* Any number in any input of a tick: outputs stay finite and in their ranges, and the state that is left can be saved
   and restored. */

#include "knee.h"

/* A random number of so many. */
static uint32_t draw(uint32_t count) {
    static uint64_t state = 0x9e3779b97f4a7c15u;
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)(state >> 33) % count;
}

#define COUNT(list) (sizeof list / sizeof list[0])
#define DRAWS 20000

/* No compiler folds these into errors. */
static volatile float huge_f32 = 3.4e38f;
static float odd_f32(void) {
    const float infinite = huge_f32 * huge_f32;
    const float list[] = {0.0f, -0.0f, 1e-45f, -1e-30f, 0.1f, 0.5f, 1.0f, 1.5f, -1.0f, 20.0f, 300.0f, -1e6f, 1e20f, huge_f32,
                          -huge_f32, infinite, -infinite, infinite - infinite};
    return list[draw(COUNT(list))];
}
static int32_t odd_fixed(void) {
    static const int32_t list[] = {0, 1, -1, 65536, 160000, 8388608, 16777216, -16777216, 25165824, 1 << 30, -(1 << 30),
                                   INT32_MAX, INT32_MIN, INT32_MIN + 1};
    return list[draw(COUNT(list))];
}

#define A(name) name##_f32
#define F(name) vm_f32_##name
#define T(name) Vm##name##F32
#define WORDS(thing) VM_##thing##_F32_WORDS
#define STATE_WORDS VM_F32_STATE_WORDS
#define W uint32_t
#define N float
#define ONE 1.0f
#define PATH 0.16f
#define TORQUE(nm) ((float)(nm))
#define ODD odd_f32()
#define INPUT {ODD, ODD, ODD}
#define FORCE force_n
/* Neither infinite nor not a number. */
#define FINITE(value) ((value) - (value) == 0)
#include "anything_rows.h"
#undef A
#undef F
#undef T
#undef WORDS
#undef STATE_WORDS
#undef N
#undef ONE
#undef PATH
#undef TORQUE
#undef ODD
#undef INPUT
#undef FORCE
#undef FINITE

#define A(name) name##_fixed
#define F(name) vm_fixed_##name
#define T(name) Vm##name##Fixed
#define WORDS(thing) VM_##thing##_FIXED_WORDS
#define STATE_WORDS VM_FIXED_STATE_WORDS
#define N int32_t
#define ONE 16777216
#define PATH 160000
#define TORQUE(nm) ((int32_t)(nm) * 65536)
#define ODD odd_fixed()
#define INPUT {ODD, (uint16_t)ODD, (uint16_t)ODD}
#define FORCE force_mn
#define FINITE(value) 1
#include "anything_rows.h"

/* Lines of the rows are told apart by 6000 and 7000. */
int anything(void) {
    int line = anything_f32();
    if (line) return 6000 + line;
    line = anything_fixed();
    return line ? 7000 + line : 0;
}
